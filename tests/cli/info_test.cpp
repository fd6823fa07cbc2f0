// SPDX-License-Identifier: Apache-2.0
// `info` for devices, scenes and images, as text and as JSON.
#include <gmock/gmock.h>

#include "fixtures.h"
#include "io/codec.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

class Info : public CliTest {};

TEST_F(Info, DescribesDevices) {
  const RunResult text = quintet({"info"});
  EXPECT_EQ(text.status, 0);
  EXPECT_EQ(text.err, "");
  EXPECT_THAT(text.out, HasSubstr("driver"));
  EXPECT_THAT(text.out, ::testing::ContainsRegex("usable +yes\n"));
  const auto json = nlohmann::json::parse(quintet({"info", "--json"}).out);
  ASSERT_GE(json["devices"].size(), 1u);
  EXPECT_NE(json["devices"][0]["name"], "");
  EXPECT_GT(json["devices"][0]["limits"]["handleSize"], 0);
  for (const auto& device : json["devices"]) {
    EXPECT_TRUE(device.at("software").is_boolean());
    EXPECT_EQ(device.at("usable").get<bool>(), device.at("unusableReason") == "") << device;
  }
}

TEST_F(Info, DescribesAGltfScene) {
  const RunResult text = quintet({"info", "scene.gltf"});
  EXPECT_EQ(text.status, 0);
  for (const char* part : {"quintet tests", "2 stored, 2 in instances", "'front'", "'side'", "1 with 1 geometries"})
    EXPECT_THAT(text.out, HasSubstr(part));
}

TEST_F(Info, DescribesASceneAsJson) {
  write(folder_ / "textured.glb", texturedGlb(io::encodePng(testImage(16, 8)), "image/png"));
  const auto json = nlohmann::json::parse(quintet({"info", "textured.glb", "--json"}).out);
  EXPECT_EQ(json["kind"], "scene");
  EXPECT_EQ(json["meshes"], 1);
  EXPECT_EQ(json["triangles"]["stored"], 2);
  EXPECT_EQ(json["images"][0]["width"], 16);
  EXPECT_EQ(json["cameras"][0]["name"], "front");
  EXPECT_EQ(json["bounds"]["min"][0], -1.0);
  EXPECT_EQ(json["hash"].get<std::string>().size(), 32u);
}

TEST_F(Info, DescribesASceneFile) {
  write(folder_ / "s.scene.toml",
        "[[spheres]]\nitems = [{}, {}]\n[[csg]]\ntree = { intersection = [{ box = {} }, { sphere = { center = [9, 0, "
        "0] } }] }\n"
        "[[mesh]]\nname = 'm'\nshape = 'cube'\n[[instance]]\nof = 'm'\nmask = 1\n");
  const RunResult text = quintet({"info", "s.scene.toml"});
  EXPECT_EQ(text.status, 0);
  for (const char* part : {"s.scene.toml: scene\n", "2 sets: 2 solids, 1 trees of 2 leaves, 0 custom boxes",
                           "3 (2 procedural, 1 with a mask)", "line 4: 'tree' of [[csg]]"})
    EXPECT_THAT(text.out, HasSubstr(part));
  const auto json = nlohmann::json::parse(quintet({"info", "s.scene.toml", "--json"}).out);
  EXPECT_EQ(json["procedural"]["trees"], 1);
  EXPECT_EQ(json["instancesWith"]["mask"], 1);
  EXPECT_EQ(json["bounds"]["max"][0], 1.0);
}

TEST_F(Info, ListsIgnoredContent) {
  nlohmann::json json = quadScene();
  json["extensionsUsed"] = {"EXT_unsupported"};
  json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  write(folder_ / "odd.gltf", json.dump());
  const auto report = nlohmann::json::parse(quintet({"info", "odd.gltf", "--json"}).out);
  EXPECT_EQ(report["extensions"]["ignored"], nlohmann::json({"EXT_unsupported"}));
  ASSERT_EQ(report["ignored"].size(), 1u);
  EXPECT_THAT(report["ignored"][0].get<std::string>(), HasSubstr("/meshes/0/primitives/1"));
}

TEST_F(Info, DescribesAnImage) {
  write(folder_ / "gradient.png", io::encodePng(testImage(16, 8), {{"Title", "A gradient"}}));
  const RunResult text = quintet({"info", "gradient.png"});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("PNG, 16x8"));
  EXPECT_THAT(text.out, HasSubstr("A gradient"));
  const auto json = nlohmann::json::parse(quintet({"info", "gradient.png", "--json"}).out);
  EXPECT_EQ(json["format"], "PNG");
  EXPECT_EQ(json["metadata"]["Title"], "A gradient");
}

}  // namespace
}  // namespace quintet::test
