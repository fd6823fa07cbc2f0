// SPDX-License-Identifier: Apache-2.0
// `info` for devices, scenes and images, as text and as JSON.
#include <set>

#include <gmock/gmock.h>

#include "base/parse.h"
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
  for (const char* part : {"quintet tests", "2 stored, 2 in instances", "'front'", "'side'", "1 with 1 geometry\n"})
    EXPECT_THAT(text.out, HasSubstr(part));
}

// The hash of the scene's contents and the scene's name are different facts.
TEST_F(Info, AFilmHasEachFactOnce) {
  ASSERT_EQ(quintet(quick({"-o", "a.qfilm"})).status, 0);
  const RunResult text = quintet({"info", "a.qfilm"});
  std::set<std::string> labels;
  for (const std::string& line : splitText(text.out, '\n'))
    if (line.starts_with("   ")) {
      EXPECT_TRUE(labels.insert(line.substr(3, line.find("  ", 3) - 3)).second) << text.out;
    }
  for (const char* label : {"scene", "scene contents", "camera", "camera projection"})
    EXPECT_TRUE(labels.contains(label)) << text.out;
}

// "1 sample", not "1 samples".
TEST_F(Info, PluralsFollowTheNumber) {
  const std::vector<std::string> one = quick({"-o", "a.qfilm", "--spp", "1"});
  ASSERT_EQ(quintet(one).status, 0);
  ASSERT_EQ(quintet(quick({"--spp", "8", "-o", "b.png", "--checkpoint", "0", "--keep-checkpoint"})).status, 0);
  expectError(quintet(quick({"--spp", "1", "--batches", "3", "-o", "c.qfilm"})), 2,
              {"the last batch of 1 sample is 0"});
  expectError(quintet({"compare", "a.qfilm", "a.qfilm", "--z-test"}), 1, {"1 batch of 4 samples"});
  EXPECT_THAT(quintet({"info", "a.qfilm"}).out, HasSubstr(", sample 0 of 1, "));
  EXPECT_THAT(quintet({"info", "scene.gltf"}).out, ::testing::Not(::testing::ContainsRegex("[^0-9]1 [a-z]+s[,\n]")));
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
  for (const char* part : {"s.scene.toml: scene\n", "2 sets: 2 solids, 1 tree of 2 leaves, 0 custom boxes",
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
  ASSERT_EQ(report["ignored"].size(), 2u);
  EXPECT_THAT(report["ignored"][0].get<std::string>(), HasSubstr("/meshes/0/primitives/1"));
  EXPECT_THAT(report["ignored"][1].get<std::string>(), HasSubstr("EXT_unsupported"));
  for (const nlohmann::json& feature : report["features"])
    if (feature["name"] == "LINES") {
      EXPECT_EQ(feature["use"], "ignored");
    }
  const std::string text = quintet({"info", "odd.gltf"}).out;
  for (const char* part :
       {"primitives    used: TRIANGLES (1)\n", "ignored: LINES (1)\n", "ignored: EXT_unsupported (1)\n"})
    EXPECT_THAT(text, HasSubstr(part));
  expectError(quintet({"info", "odd.gltf", "--strict"}), 1, {"odd.gltf", "2 ignored", "EXT_unsupported", "LINES"});
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
