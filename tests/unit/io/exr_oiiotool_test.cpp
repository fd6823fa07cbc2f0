// SPDX-License-Identifier: Apache-2.0
// Reads our OpenEXR files with an independent program, oiiotool (OpenImageIO): every compression, layers, types,
// windows and attributes. Fails if oiiotool is not installed; `make setup` installs it.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "base/file.h"
#include "io/exr/cryptomatte.h"
#include "io/exr/exr.h"
#include "io/exr_samples.h"
#include "temp_folder.h"

namespace quintet::io {
namespace {

using test::layeredImage;
using testing::AllOf;
using testing::HasSubstr;

// Returns the output of oiiotool on both streams; fails the test if it is missing or reports an error.
std::string oiiotool(const std::string& arguments) {
  std::FILE* pipe = ::popen(("oiiotool " + arguments + " 2>&1").c_str(), "r");
  std::string text;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) text.append(buffer.data(), count);
  const int status = ::pclose(pipe);
  EXPECT_EQ(WEXITSTATUS(status), 0) << "oiiotool " << arguments
                                    << " (package openimageio-tools, installed by 'make setup'):\n"
                                    << text;
  return text;
}

class ExrOiiotoolTest : public testing::TestWithParam<std::size_t> {
 protected:
  std::string write(const std::string& name, const ExrImage& image, const ExrOptions& options) {
    const auto file = folder_ / name;
    writeFile(file, encodeExr(image, options));
    return file.string();
  }

  quintet::test::TempFolder folder_;
};

TEST_P(ExrOiiotoolTest, ReadsEveryCompression) {
  const auto compression = static_cast<ExrCompression>(GetParam());
  for (const std::uint32_t tile : {0u, 16u}) {
    const std::string file = write("a.exr", layeredImage(40, 30), {compression, std::nullopt, tile});
    const std::string info = oiiotool("--info -v -a " + file);
    EXPECT_THAT(info,
                AllOf(HasSubstr("40 x   30"), HasSubstr("compression: \"" + exrCompressionNames()[GetParam()] + "\"")));
    EXPECT_THAT(info, HasSubstr("exact.id (uint), normal.X (float), normal.Y (float), normal.Z (float), uv.U (float)"));
    const bool split =
        info.find("2 subimages") != info.npos;  // oiiotool prints the type once if all channels of a part have it
    EXPECT_THAT(info, HasSubstr(split ? "7 channel, half openexr" : "R (half), G (half), B (half), A (half), "));
    EXPECT_THAT(info, HasSubstr(split ? "R, G, B, A, albedo.R, albedo.G, albedo.B"
                                      : "albedo.R (half), albedo.G (half), albedo.B (half), depth.Z (float)"));
    EXPECT_EQ(info.find("tile size: 16 x 16") != info.npos, tile > 0) << info;
    oiiotool("--stats -a " + file);  // reads the pixels
  }
}

INSTANTIATE_TEST_SUITE_P(Compressions, ExrOiiotoolTest, testing::Range(std::size_t{0}, std::size_t{7}),
                         [](const auto& index) { return exrCompressionNames()[index.param]; });

using ExrOiiotool = ExrOiiotoolTest;

// oiiotool decodes the file and writes the same samples without compression.
TEST_F(ExrOiiotool, DecodesSamples) {
  const ExrImage image = layeredImage(40, 30);
  for (const ExrCompression compression : {ExrCompression::zips, ExrCompression::piz, ExrCompression::rle}) {
    const std::string file = write("a.exr", image, {compression});
    const std::string copy = (folder_ / "b.exr").string();
    oiiotool(file + " --compression none -o " + copy);
    const ExrImage back = decodeExr(readFile(copy), copy);
    ASSERT_EQ(back.channels.size(), image.channels.size());
    for (const ExrChannel& channel : image.channels) {
      const auto read = std::ranges::find(back.channels, channel.name, &ExrChannel::name);
      ASSERT_NE(read, back.channels.end()) << channel.name;
      if (channel.type == ExrType::u32) continue;  // oiiotool converts to floats
      EXPECT_EQ(read->samples, channel.samples) << channel.name;
    }
  }
}

TEST_F(ExrOiiotool, ReadsRegionsAndAttributes) {
  ExrImage image = layeredImage(30, 20);
  image.window = {5, 7, 100, 50};
  const std::vector<std::string> names{"bunny", "default"};
  image.metadata = cryptomatteMetadata("CryptoObject", names);
  image.metadata.emplace_back("Software", "quintet");
  image.attributes = {{"samples", 64}, {"worldToCamera", mat4(2.0f)}};
  const std::string info = oiiotool("--info -v " + write("a.exr", image, {}));
  EXPECT_THAT(
      info, AllOf(HasSubstr("pixel data origin: x=5, y=7"), HasSubstr("full/display size: 100 x 50"),
                  HasSubstr("samples: 64"), HasSubstr("worldToCamera: 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2"),
                  HasSubstr("Software: \"quintet\""), HasSubstr("cryptomatte/3ae39a5/name: \"CryptoObject\""),
                  HasSubstr("cryptomatte/3ae39a5/hash: \"MurmurHash3_32\""),
                  HasSubstr("cryptomatte/3ae39a5/conversion: \"uint32_to_float32\""), HasSubstr("13851a76")));
}

TEST_F(ExrOiiotool, ReadsTwoPartsOfLossyFiles) {
  const std::string info = oiiotool("--info -v -a " + write("a.exr", layeredImage(40, 30), {ExrCompression::dwaa}));
  EXPECT_THAT(info, AllOf(HasSubstr("2 subimages"), HasSubstr("oiio:subimagename: \"rgba\""),
                          HasSubstr("oiio:subimagename: \"data\""), HasSubstr("compression: \"zip\"")));
}

// The Cryptomatte plug-ins compare bits, so no bit may change.
TEST_F(ExrOiiotool, KeepsIdsOfCryptomatteUnderDwa) {
  const ExrImage image = layeredImage(40, 30);
  const std::string file = write("a.exr", image, {ExrCompression::dwab, 100.0f});
  const std::string copy = (folder_ / "b.exr").string();
  oiiotool(file + " --subimage 1 --ch CryptoObject00.R --compression none -o " + copy);
  const ExrImage back = decodeExr(readFile(copy), copy);
  const auto before = std::ranges::find(image.channels, "CryptoObject00.R", &ExrChannel::name);
  ASSERT_EQ(back.channels.size(), 1u);
  EXPECT_EQ(back.channels[0].samples, before->samples);
}

}  // namespace
}  // namespace quintet::io
