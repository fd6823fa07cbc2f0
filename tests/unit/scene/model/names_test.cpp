// SPDX-License-Identifier: Apache-2.0
#include "scene/model/names.h"

#include <gmock/gmock.h>

namespace quintet::scene {
namespace {

using testing::ElementsAre;

Scene withInstances(const std::vector<std::pair<std::string, int>>& instances) {
  Scene scene;
  scene.meshes.resize(2);
  scene.meshes[0].name = "mesh";
  for (const auto& [name, mesh] : instances) {
    Instance& instance = scene.instances.emplace_back();
    instance.name = name;
    instance.mesh = mesh;
  }
  return scene;
}

TEST(Names, KeepsTheNamesOfInstances) {
  EXPECT_THAT(instanceNames(withInstances({{"a", 0}, {"b", 1}})), ElementsAre("a", "b"));
  EXPECT_THAT(instanceNames(withInstances({})), ElementsAre());
}

TEST(Names, UsesTheMeshNameForUnnamedInstances) {
  EXPECT_THAT(instanceNames(withInstances({{"", 0}, {"", 1}, {"", kNone}, {"", 0}})),
              ElementsAre("mesh", "instance", "instance#2", "mesh#2"));
}

TEST(Names, NumbersRepeatedNames) {
  EXPECT_THAT(instanceNames(withInstances({{"a", 0}, {"a", 0}, {"b", 0}, {"a", 0}})),
              ElementsAre("a", "a#2", "b", "a#3"));
  // An object that already has such a name keeps it.
  EXPECT_THAT(instanceNames(withInstances({{"a", 0}, {"a", 0}, {"a#2", 0}, {"a#2", 0}})),
              ElementsAre("a", "a#3", "a#2", "a#2#2"));
}

TEST(Names, NamesLights) {
  Scene scene;
  scene.lights.resize(3);
  scene.lights[1].name = "sun";
  EXPECT_THAT(lightNames(scene), ElementsAre("light", "sun", "light#2"));
}

TEST(Names, AppendsTheDefaultMaterial) {
  Scene scene;
  for (const char* name : {"red", "", "red", "", "default"}) scene.materials.emplace_back().name = name;
  EXPECT_THAT(materialNames(scene), ElementsAre("red", "material", "red#2", "material#2", "default", "default#2"));
}

}  // namespace
}  // namespace quintet::scene
