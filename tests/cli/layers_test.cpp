// Layers of OpenEXR files: `info` shows them, `compare` takes one.
#include <gmock/gmock.h>

#include <cmath>

#include "fixtures.h"
#include "io/cryptomatte.h"
#include "io/exr.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

class Layers : public CliTest {
 protected:
  // 4x2: beauty, normal and depth; `normalY` in normal.Y.
  io::ExrPicture layers(float normalY) {
    io::ExrPicture picture{4, 2, {}};
    for (const char* name : {"R", "G", "B", "A"}) picture.channels.push_back({name, io::ExrType::half, std::vector(8, 0.5f)});
    for (const char* name : {"normal.X", "normal.Y", "normal.Z", "depth.Z"})
      picture.channels.push_back({name, io::ExrType::f32, std::vector(8, name[7] == 'Y' ? normalY : 0.25f), true});
    return picture;
  }
};

TEST_F(Layers, InfoShowsThem) {
  io::ExrPicture picture = layers(0.5f);
  picture.place = {2, 1, 10, 5};
  const std::vector<std::string> names{"bunny"};
  picture.metadata = io::cryptomatteMetadata("CryptoObject", names);
  write(folder_ / "a.exr", io::encodeExr(picture, {io::ExrCompression::piz, std::nullopt, 16}));
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

TEST_F(Layers, InfoShowsPartsOfLossyFiles) {
  write(folder_ / "a.exr", io::encodeExr(layers(0.5f), {io::ExrCompression::dwaa}));
  const RunResult text = quintet({"info", "a.exr"});
  EXPECT_THAT(text.out, ::testing::ContainsRegex("part rgba +dwaa\n"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("part data +zip\n"));
}

TEST_F(Layers, CompareTakesOne) {
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
              {"a.exr", "'nornal' (did you mean 'normal'?)", "beauty, depth, normal"});
  write(folder_ / "a.png", std::string_view("?"));
  expectError(quintet({"compare", "a.png", "b.exr", "--layer", "normal"}), 1, {"a.png", "not an OpenEXR file"});
}

}  // namespace
}  // namespace quintet::test
