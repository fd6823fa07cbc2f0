// SPDX-License-Identifier: Apache-2.0
// The report of glTF files: nothing in a file is left out, and everything has a use with a reason.
#include "scene/gltf/inventory.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "scene/error_matcher.h"
#include "scene/gltf/gltf.h"
#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

using scene::Feature;
using scene::FeatureUse;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

// "KIND NAME: USE COUNT" of the features of a kind.
std::vector<std::string> featuresOf(const scene::Report& report, const std::string& kind) {
  std::vector<std::string> list;
  for (const Feature& f : report.features)
    if (f.kind == kind) list.push_back(f.name + ": " + nameOf(f.use) + " " + std::to_string(f.count));
  return list;
}

const Feature& featureAt(const scene::Report& report, const std::string& location) {
  for (const Feature& f : report.features)
    if (f.location == location) return f;
  static const Feature kNothing;
  ADD_FAILURE() << "no feature at " << location;
  return kNothing;
}

TEST(GltfInventory, IsExactForAFileThatIsUsedAsItIs) {
  GltfBuilder builder;
  builder.addTriangle();
  const scene::Report report = builder.load().report;
  EXPECT_TRUE(report.isExact());
  EXPECT_THAT(featuresOf(report, "attribute"), ElementsAre("POSITION: used 1"));
  EXPECT_THAT(featuresOf(report, "primitive"), ElementsAre("TRIANGLES: used 1"));
  EXPECT_THAT(featuresOf(report, "node"), ElementsAre("transform: used 1", "mesh: used 1"));
}

TEST(GltfInventory, ReportsEveryUnknownPropertyAndExtension) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["materials"] = {{{"rougness", 1}, {"extensions", {{"EXT_paint", {{"a", 1}}}}}}};
  builder.root["materials"].push_back(builder.root["materials"][0]);
  builder.root["extensionsUsed"] = {"EXT_paint", "EXT_nowhere", "KHR_materials_ior", "KHR_xmp"};
  builder.root["asset"]["extras"] = "by hand";
  builder.root["cameras"] = {
      {{"type", "perspective"},
       {"perspective", {{"yfov", 1}, {"znear", 1}, {"extensions", {{"KHR_materials_ior", 1}}}}}}};
  const scene::Report report = builder.load().report;
  EXPECT_THAT(report.ignored,
              UnorderedElementsAre(IsErrorAt("/materials/0/rougness", "unknown property (2 times)"),
                                   IsErrorAt("/materials/0/extensions/EXT_paint", "not supported (2 objects)"),
                                   IsErrorAt("/cameras/0/perspective/extensions/KHR_materials_ior", "not defined"),
                                   IsErrorAt("/extensionsUsed/1", "EXT_nowhere")));
  EXPECT_THAT(featuresOf(report, "extension"),
              UnorderedElementsAre("EXT_paint: ignored 2", "EXT_nowhere: ignored 1", "KHR_materials_ior: ignored 1",
                                   "KHR_materials_ior: unused 1", "KHR_xmp: unused 1"));
  EXPECT_THAT(featuresOf(report, "property"),
              UnorderedElementsAre("extras: unused 1", "znear: unused 1", "rougness: ignored 2"));
  EXPECT_THAT(unusedLines(report), Contains(IsErrorAt("/asset/extras", "application")));
}

TEST(GltfInventory, CountsUsedExtensions) {
  GltfBuilder builder;
  builder.addTriangle();
  for (int i = 0; i < 3; ++i) builder.add("materials", {{"extensions", {{"KHR_materials_unlit", Json::object()}}}});
  EXPECT_THAT(featuresOf(builder.load().report, "extension"), ElementsAre("KHR_materials_unlit: used 3"));
}

// Objects that no node of the scene has.
TEST(GltfInventory, ListsUnusedObjects) {
  GltfBuilder builder;
  const int positions = builder.addTriangle();
  builder.add("meshes", {{"primitives", Json::array({{{"attributes", {{"POSITION", positions}}}, {"material", 0}}})}});
  builder.add("materials", {{"name", "paint"}});
  builder.add("cameras", {{"type", "perspective"}, {"name", "lost"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}});
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"name", "dark"}}};
  builder.add("images", {{"uri", "none.png"}});
  builder.add("textures", {{"source", 0}});
  builder.add("nodes", {{"mesh", 1}});
  builder.add("skins", {{"joints", {0}}});
  builder.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}, {"name", "second"}}};
  const scene::Report report = builder.load().report;
  EXPECT_TRUE(report.isExact());
  const std::pair<const char*, const char*> unused[] = {{"/meshes/1/primitives/0", "node"},
                                                        {"/meshes/1/primitives/0/attributes/POSITION", "node"},
                                                        {"/materials/0", "mesh"},
                                                        {"/cameras/0", "node"},
                                                        {"/extensions/KHR_lights_punctual/lights/0", "node"},
                                                        {"/textures/0", "material"},
                                                        {"/images/0", "texture"},
                                                        {"/nodes/1", "scene"},
                                                        {"/skins/0", "node"},
                                                        {"/scenes/1", "selected"}};
  for (const auto& [location, reason] : unused) {
    EXPECT_EQ(featureAt(report, location).use, FeatureUse::unused) << location;
    EXPECT_THAT(featureAt(report, location).reason, HasSubstr(reason));
  }
  EXPECT_EQ(featureAt(report, "/cameras/0").name, "lost");
}

TEST(GltfInventory, StatesWhyAttributesAreUnused) {
  GltfBuilder builder;
  builder.addTriangle();
  Json& attributes = builder.primitive()["attributes"];
  attributes["_MINE"] = 0;
  attributes["TEXCOORD_0"] = attributes["TEXCOORD_3"] = builder.addAccessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  attributes["TANGENT"] = builder.addAccessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4");
  attributes["WEIGHTS_0"] = attributes["TANGENT"];
  const scene::Report report = builder.load().report;
  EXPECT_THAT(featuresOf(report, "attribute"),
              ElementsAre("POSITION: used 1", "TANGENT: unused 1", "TEXCOORD_0: unused 1", "TEXCOORD_3: ignored 1",
                          "WEIGHTS_0: unused 1", "_MINE: unused 1"));
  EXPECT_THAT(report.ignored, ElementsAre(IsErrorAt("/meshes/0/primitives/0/attributes/TEXCOORD_3", "not supported")));
}

TEST(GltfInventory, ReportsAttributesOfMorphTargetsAndInstances) {
  GltfBuilder builder;
  const int positions = builder.addTriangle();
  builder.primitive()["targets"] = {{{"POSITION", positions}, {"COLOR_0", positions}}};
  builder.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", positions},
                                                                                     {"COLOR", positions}};
  const scene::Report report = builder.load().report;
  EXPECT_THAT(featuresOf(report, "morph target"), UnorderedElementsAre("POSITION: used 1", "COLOR_0: ignored 1"));
  EXPECT_THAT(report.ignored,
              UnorderedElementsAre(IsErrorAt("/meshes/0/primitives/0/targets/0/COLOR_0", ""),
                                   IsErrorAt("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/COLOR", "")));
}

TEST(GltfInventory, ReportsIndicesAfterTheLastTriangle) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["indices"] = builder.addAccessor<std::uint16_t>({0, 1, 2, 0, 1}, "SCALAR");
  const scene::Report report = builder.load().report;
  EXPECT_THAT(report.repaired, ElementsAre(IsErrorAt("/meshes/0/primitives/0", "2 indices")));
  EXPECT_EQ(featureAt(report, "/meshes/0/primitives/0").use, FeatureUse::repaired);
}

TEST(GltfInventory, StrictLoadingListsEverything) {
  GltfBuilder builder;
  builder.addTriangle();
  const TempFolder folder;
  const std::filesystem::path file = folder / "a.glb";
  writeFile(file, builder.glb());
  EXPECT_NO_THROW(scene::loadGltf(file, {.strict = true}));
  builder.primitive()["attributes"]["COLOR_1"] = 0;
  builder.root["nodes"][0]["rotation"] = {0, 0, 0, 2};
  builder.root["nodes"][0]["paint"] = "red";
  writeFile(file, builder.glb());
  EXPECT_NO_THROW(scene::loadGltf(file));
  EXPECT_THAT([&] { scene::loadGltf(file, {.strict = true}); },
              testing::ThrowsMessage<FileError>(testing::AllOf(
                  HasSubstr(file.string()), HasSubstr("2 ignored, 1 repaired"), HasSubstr("COLOR_1"),
                  HasSubstr("/nodes/0/paint: unknown property"), HasSubstr("/nodes/0/rotation: length 2"))));
}

}  // namespace
}  // namespace quintet::test
