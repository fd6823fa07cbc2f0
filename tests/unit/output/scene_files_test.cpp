// SPDX-License-Identifier: Apache-2.0
// Names of the files of several scenes.
#include "output/scene_files.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "base/error.h"

namespace quintet::output {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string errorFor(const std::filesystem::path& pattern, const std::vector<std::filesystem::path>& scenes) {
  try {
    sceneFiles(pattern, scenes);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(SceneFiles, ReplaceNamesOfSceneAndFolder) {
  EXPECT_EQ(sceneFile("out/{scene}.png", "models/fox.glb"), "out/fox.png");
  EXPECT_EQ(sceneFile("{scene}.png", "a/fox.scene.toml"), "fox.png");
  EXPECT_EQ(sceneFile("{scene}.png", "fox.v2.gltf"), "fox.v2.png");
  EXPECT_EQ(sceneFile("{folder}/{scene}_{scene}.exr", "/models/fox/scene.gltf"), "fox/scene_scene.exr");
  EXPECT_EQ(sceneFile("{folder}.png", std::filesystem::current_path() / "x/../y/scene.gltf"), "y.png");
  EXPECT_EQ(sceneFile("{scene}.png", "-"), "stdin.png") << "-.png would be standard output";
  EXPECT_EQ(sceneFile("{other}{.png", "fox.glb"), "{other}{.png");
  EXPECT_EQ(sceneFile("{scene}.png", "{folder}.glb"), "{folder}.png") << "names are no patterns";
}

TEST(SceneFiles, AreDifferent) {
  EXPECT_THAT(sceneFiles("", std::vector<std::filesystem::path>{"a.glb", "x/b.gltf"}), ElementsAre("a.png", "b.png"));
  EXPECT_THAT(errorFor("out.png", {"a.glb", "b.glb"}),
              AllOf(HasSubstr("out.png"), HasSubstr("a.glb"), HasSubstr("b.glb"), HasSubstr("'{scene}.png'")));
  EXPECT_THAT(errorFor("{scene}.png", {"x/scene.gltf", "y/scene.gltf"}),
              AllOf(HasSubstr("scene.png"), HasSubstr("y/scene.gltf"), HasSubstr("'{folder}_{scene}.png'")));
  EXPECT_EQ(errorFor("{folder}.png", {"x/scene.gltf", "y/scene.gltf"}), "");
  EXPECT_NE(errorFor("{scene}.png", {"a.glb", "./a.glb"}), "") << "the same scene twice";
  EXPECT_EQ(errorFor("out.png", {"a.glb"}), "");
}

}  // namespace
}  // namespace quintet::output
