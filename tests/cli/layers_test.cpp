// SPDX-License-Identifier: Apache-2.0
// OpenEXR files: `info` lists their layers, `compare` selects one, and `render` writes types, compressions and tiles.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "base/file.h"
#include "fixtures.h"
#include "io/exr/cryptomatte.h"
#include "io/exr/exr.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

class Layers : public CliTest {
 protected:
  // 4x2 pixels with the layers beauty, normal and depth. normal.Y is `normalY`.
  io::ExrImage layers(float normalY) {
    io::ExrImage image{4, 2, {}};
    for (const char* name : {"R", "G", "B", "A"})
      image.channels.push_back({name, io::ExrType::half, std::vector(8, 0.5f)});
    for (const char* name : {"normal.X", "normal.Y", "normal.Z", "depth.Z"})
      image.channels.push_back({name, io::ExrType::f32, std::vector(8, name[7] == 'Y' ? normalY : 0.25f), true});
    return image;
  }
};

TEST_F(Layers, InfoListsLayers) {
  io::ExrImage image = layers(0.5f);
  image.window = {2, 1, 10, 5};
  const std::vector<std::string> names{"bunny"};
  image.metadata = io::cryptomatteMetadata("CryptoObject", names);
  write(folder_ / "a.exr", io::encodeExr(image, {io::ExrCompression::piz, std::nullopt, 16}));
  const RunResult text = quintet({"info", "a.exr"});
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("OpenEXR, 10x5, 8 channels, piz, tiles of 16x16"));
  EXPECT_THAT(text.out, HasSubstr("data window  4x2 at 2, 1"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("\\(beauty\\) +half +R G B A\n"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("normal +float +X Y Z\n"));
  EXPECT_THAT(text.out, HasSubstr("cryptomatte/3ae39a5/name CryptoObject\n"));
  const auto json = nlohmann::json::parse(quintet({"info", "a.exr", "--json"}).out);
  EXPECT_EQ(json["format"], "OpenEXR");
  EXPECT_EQ(json["width"], 10);
  EXPECT_EQ(json["channels"], 8);
  const auto& part = json["parts"][0];
  EXPECT_EQ(part["compression"], "piz");
  EXPECT_EQ(part["tiles"], nlohmann::json({16, 16}));
  EXPECT_EQ(part["dataWindow"], nlohmann::json({2, 1, 4, 2}));
  EXPECT_EQ(part["layers"][0], nlohmann::json({{"name", ""}, {"type", "half"}, {"channels", {"R", "G", "B", "A"}}}));
  EXPECT_EQ(part["layers"][2]["channels"], nlohmann::json({"X", "Y", "Z"}));
  EXPECT_EQ(part["attributes"]["cryptomatte/3ae39a5/hash"]["value"], "MurmurHash3_32");
}

TEST_F(Layers, InfoListsTheParts) {
  write(folder_ / "a.exr", io::encodeExr(layers(0.5f), {io::ExrCompression::dwaa}));
  const RunResult text = quintet({"info", "a.exr"});
  EXPECT_THAT(text.out, ::testing::ContainsRegex("part rgba +dwaa\n"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("part data +zip\n"));
}

TEST_F(Layers, CompareSelectsALayer) {
  write(folder_ / "a.exr", io::encodeExr(layers(0.5f)));
  write(folder_ / "b.exr", io::encodeExr(layers(0.75f), {io::ExrCompression::dwab}));
  const auto rmse = [&](const std::string& layer) {
    const RunResult result = quintet({"compare", "a.exr", "b.exr", "--layer", layer, "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out)["rmse"].get<double>();
  };
  EXPECT_NEAR(rmse("beauty"), 0.0, 1e-3);
  EXPECT_NEAR(rmse("normal"), 0.25 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(rmse("normal.Y"), 0.25, 1e-6);
  EXPECT_EQ(rmse("depth"), 0.0);
  expectError(quintet({"compare", "a.exr", "b.exr", "--layer", "nornal"}), 2,
              {"a.exr", "'nornal'", "'normal'", "beauty, depth, normal"});
  write(folder_ / "a.png", std::string_view("?"));
  expectError(quintet({"compare", "a.png", "b.exr", "--layer", "normal"}), 1, {"a.png", "OpenEXR"});
}

std::vector<io::ExrPartInfo> inspect(const std::filesystem::path& file) {
  return io::inspectExr(readFile(file), file.string());
}

TEST_F(Layers, RenderWritesTypesCompressionsAndTiles) {
  const auto rendered = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"-o", "out.exr"});
    const RunResult result = quintet(quick(more));
    EXPECT_EQ(result.status, 0) << result.err;
    return inspect(folder_ / "out.exr").at(0);
  };
  const io::ExrPartInfo defaults = rendered({});
  EXPECT_EQ(defaults.compression, "zip");
  EXPECT_EQ(defaults.tileWidth, 0u);
  ASSERT_EQ(defaults.channels.size(), 3u);
  EXPECT_EQ(defaults.channels[0].type, io::ExrType::half);
  const io::ExrPartInfo other = rendered({"--exr-type", "float", "--exr-compression", "piz", "--exr-tiles", "16"});
  EXPECT_EQ(other.compression, "piz");
  EXPECT_EQ(other.tileWidth, 16u);
  EXPECT_EQ(other.channels[0].type, io::ExrType::f32);
  EXPECT_EQ(rendered({"--exr-compression", "dwab:80.5"}).compression, "dwab");
  EXPECT_EQ(rendered({"--exr-compression", "zips:9", "--transparent"}).channels.size(), 4u);
}

TEST_F(Layers, RegionIsTheDataWindow) {
  ASSERT_EQ(quintet(quick({"-o", "all.exr"})).status, 0);
  ASSERT_EQ(quintet(quick({"-o", "part.exr", "--region", "5,7,19,11"})).status, 0);
  const io::ExrPartInfo info = inspect(folder_ / "part.exr").at(0);
  EXPECT_EQ(info.data.x, 5);
  EXPECT_EQ(info.data.y, 7);
  EXPECT_EQ(info.data.width, 19u);
  EXPECT_EQ(info.data.height, 11u);
  const io::Image whole = readImage("all.exr"), part = readImage("part.exr");
  ASSERT_EQ(part.width, whole.width);
  ASSERT_EQ(part.height, whole.height);
  for (std::uint32_t y = 0; y < whole.height; ++y)
    for (std::uint32_t x = 0; x < whole.width; ++x) {
      const bool inside = x >= 5 && x < 24 && y >= 7 && y < 18;
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_EQ(part.pixel<float>(x, y)[c], inside ? whole.pixel<float>(x, y)[c] : 0.0f) << x << ' ' << y;
    }
}

// The limits of a file hold for the region, not for the whole image.
TEST_F(Layers, RegionOfAnImageThatIsTooLargeForAFile) {
  const RunResult result = quintet(quick({"-o", "part.exr", "--size", "65536x65536", "--region", "5,7,19,11"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(inspect(folder_ / "part.exr").at(0).display.width, 65536u);
}

TEST_F(Layers, InvalidOptions) {
  const auto expectRejected = [&](std::vector<std::string> more, const std::vector<std::string>& parts) {
    if (std::ranges::find(more, "-o") == more.end()) more.insert(more.end(), {"-o", "out.exr"});
    expectError(quintet(quick(more)), 2, parts);
  };
  expectRejected({"--exr-type", "haf"}, {"--exr-type", "'haf'", "'half'"});
  expectRejected({"--exr-compression", "dwa"}, {"--exr-compression", "'dwa'", "'dwaa'", "zips"});
  for (const char* level : {"dwaa:-1", "dwaa:", "zip:10", "zip:1.5", "piz:1"})
    expectRejected({"--exr-compression", level}, {"--exr-compression"});
  expectRejected({"--exr-tiles", "0"}, {"--exr-tiles", "0"});
  expectRejected({"--exr-tiles", "5000"}, {"--exr-tiles", "5000"});
  expectRejected({"--exr-type", "half", "-o", "out.png"}, {"out.png", "OpenEXR", ".exr"});
  expectRejected({"--exr-tiles", "16", "-o", "-"}, {"OpenEXR", ".exr"});
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

}  // namespace
}  // namespace quintet::test
