// SPDX-License-Identifier: Apache-2.0
// `render -o out.mp4`: frames go to ffmpeg, for which a script stands here.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "fixtures.h"

namespace quintet::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Its frames are a number of launches of a program, so that no animated scene is required.
class Video : public CliTest {
 protected:
  Video() {
    write(folder_ / "count.rt.glsl",
          "void main() { /**** RAY GENERATION SHADER ****/\n"
          "  gsnSetPixel(vec4(float(frameID) * 16.0 / 255.0, 0.0, 0.0, 1.0));\n}\n");
    std::filesystem::create_directory(folder_ / "bin");
    write(folder_ / "bin" / "ffmpeg",
          std::string("#!/bin/sh\necho \"$@\" > arguments.txt\nfor file; do :; done\ncat > \"$file\"\n"));
    std::filesystem::permissions(folder_ / "bin" / "ffmpeg", std::filesystem::perms::owner_all);
  }
  RunResult render(const std::vector<std::string>& more, bool withFfmpeg = true) {
    std::vector<std::string> arguments{"run", "count.rt.glsl", "--size", "5x3"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const std::string folder = (folder_ / (withFfmpeg ? "bin" : "missing")).string();
    return quintet(arguments, {.environment = {{"PATH", withFfmpeg ? folder + ":/usr/bin:/bin" : folder}}});
  }
};

TEST_F(Video, PipesEachFrame) {
  const RunResult result = render({"--frames", "3", "--fps", "12.5", "--crf", "21", "-o", "out.mp4", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::vector<std::byte> bytes = readFile(folder_ / "out.mp4");
  ASSERT_EQ(bytes.size(), 3u * 6 * 4 * 3);  // sides are even
  for (std::size_t frame = 0; frame < 3; ++frame) {
    EXPECT_EQ(std::to_integer<int>(bytes[frame * 72]), static_cast<int>(16 * frame));
    EXPECT_EQ(std::to_integer<int>(bytes[frame * 72 + 1]), 0);
  }
  EXPECT_THAT(readTextFile(folder_ / "arguments.txt"),
              testing::AllOf(HasSubstr("6x4"), HasSubstr("12.5"), HasSubstr("-crf 21")));
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["files"], nlohmann::json::array({"out.mp4"}));
  EXPECT_EQ(json["frames"].size(), 3u);
  EXPECT_THAT(fileNames(), ElementsAre("arguments.txt", "bin", "count.rt.glsl", "out.mp4", "scene.gltf"));
}

TEST_F(Video, Errors) {
  expectError(render({"--frames", "3", "-o", "out.mp4", "-q"}, false), 1, {"out.mp4: ", "ffmpeg", "not found"});
  expectError(render({"-o", "out.mp4", "-q"}), 2, {"out.mp4: a video requires --frames"});
  expectError(render({"--frames", "3", "-o", "out.png", "--crf", "3", "-q"}), 2, {"--crf requires a video"});
  expectError(render({"--frames", "3", "-o", "out.gif", "--crf", "3", "-q"}), 2, {"no rate factor"});
  expectError(render({"--frames", "3", "-o", "out.mp4", "--all-outputs", "-q"}), 2, {"one output"});
  write(folder_ / "bin" / "ffmpeg", std::string("#!/bin/sh\necho 'Unknown encoder' >&2\nexit 1\n"));
  expectError(render({"--frames", "3", "-o", "out.mp4", "-q"}), 1, {"out.mp4: ffmpeg failed: Unknown encoder"});
  EXPECT_THAT(fileNames(), ElementsAre("bin", "count.rt.glsl", "scene.gltf"));
}

}  // namespace
}  // namespace quintet::test
