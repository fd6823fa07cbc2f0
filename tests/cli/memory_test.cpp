// SPDX-License-Identifier: Apache-2.0
// --max-memory holds for every file that a command reads.
#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"

namespace quintet::test {
namespace {

class Memory : public CliTest {
 protected:
  // The header states 192 MiB of pixels, which do not follow.
  Memory() {
    write(folder_ / "sky.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 4096\n");
    write(folder_ / "small.png", io::encodePng(testImage(4, 4)));
  }
  void expectLimited(std::vector<std::string> arguments, const std::string& file, const std::string& limit,
                     const std::string& limitText) {
    arguments.insert(arguments.end(), {"--max-memory", limit});
    expectError(quintet(arguments), 1, {file + ": the file requires more than " + limitText, "--max-memory raises it"});
  }
};

TEST_F(Memory, OfImages) {
  expectLimited(quick({"--env", "sky.hdr", "-o", "a.png"}), "sky.hdr", "1M", "1.0 MiB");
  expectLimited({"compare", "small.png", "sky.hdr"}, "sky.hdr", "1M", "1.0 MiB");
  // Without the option, the header is compared with 80 % of the memory, and then with the file.
  expectError(quintet({"compare", "small.png", "sky.hdr"}), 1, {"sky.hdr", "ends early"});
  EXPECT_EQ(quintet({"compare", "small.png", "small.png", "--max-memory", "1M"}).status, 0);
  for (const char* command : {"compare", "merge"})
    expectError(quintet({command, "a.qfilm", "b.qfilm", "-o", "a.png", "--max-memory", "x"}), 2,
                {"--max-memory", "'x'"});
}

TEST_F(Memory, OfImagesOfParameters) {
  write(folder_ / "photo.rt.glsl",
        "uniform sampler2D photo;\nvoid main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(texture(photo, "
        "vec2(0.5))); }\n");
  const auto render = [](const std::string& image) {
    return std::vector<std::string>{
        "run", "photo.rt.glsl", "--set", "photo=" + image, "--size", "8x8", "--frames", "1", "-q", "-o", "a.png"};
  };
  expectLimited(render("sky.hdr"), "sky.hdr", "1M", "1.0 MiB");
  EXPECT_EQ(quintet(render("small.png")).status, 0);
}

TEST_F(Memory, OfFilms) {
  ASSERT_EQ(quintet(quick({"-o", "a.qfilm"})).status, 0);
  ASSERT_EQ(quintet(quick({"-o", "b.qfilm", "--seed", "1"})).status, 0);
  expectLimited({"merge", "a.qfilm", "-o", "a.png"}, "a.qfilm", "10K", "10.0 KiB");
  expectLimited({"compare", "a.qfilm", "b.qfilm", "--z-test"}, "a.qfilm", "10K", "10.0 KiB");
  expectLimited({"info", "a.qfilm"}, "a.qfilm", "10K", "10.0 KiB");
}

}  // namespace
}  // namespace quintet::test
