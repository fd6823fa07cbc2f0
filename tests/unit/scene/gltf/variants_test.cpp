// SPDX-License-Identifier: Apache-2.0
// KHR_materials_variants: each variant selects the materials of the primitives that it names.
#include "scene/gltf/variants.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "scene/error_matcher.h"
#include "scene/gltf_builder.h"
#include "scene/load.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

// Three triangles with the material "plain". The first is red or green, the second is red only.
class VariantBuilder : public GltfBuilder {
 public:
  VariantBuilder() {
    for (const char* name : {"plain", "red", "green"}) add("materials", {{"name", name}});
    for (int i = 0; i < 3; ++i) addTriangle();
    for (std::size_t i = 0; i < 3; ++i) primitive(i)["material"] = 0;
    root["extensions"]["KHR_materials_variants"]["variants"] = {
        {{"name", "Red"}}, {{"name", "Green"}}, {{"name", "Dark red"}}};
    mappings(0) = {{{"material", 1}, {"variants", {0, 2}}}, {{"material", 2}, {"variants", {1, 2}}}};
    mappings(1) = Json::array({{{"material", 1}, {"variants", {0}}}});
  }
  Json& mappings(std::size_t mesh) { return primitive(mesh)["extensions"]["KHR_materials_variants"]["mappings"]; }
};

std::vector<int> materialsOf(const VariantBuilder& builder, const std::string& variant) {
  const TempFolder folder;
  writeFile(folder / "a.glb", builder.glb());
  const scene::Scene scene = scene::loadScene(folder / "a.glb", {.variant = variant});
  std::vector<int> materials;
  for (const scene::Mesh& mesh : scene.meshes) materials.push_back(mesh.geometries.at(0).material);
  return materials;
}

TEST(GltfVariants, SelectTheMaterialsOfPrimitives) {
  const VariantBuilder builder;
  EXPECT_THAT(builder.load().report.variants, testing::ElementsAre("Red", "Green", "Dark red"));
  EXPECT_EQ(materialsOf(builder, ""), (std::vector{0, 0, 0}));
  EXPECT_EQ(materialsOf(builder, "Red"), (std::vector{1, 1, 0}));
  EXPECT_EQ(materialsOf(builder, "Green"), (std::vector{2, 0, 0}));
  EXPECT_EQ(materialsOf(builder, "Dark red"), (std::vector{1, 0, 0})) << "the first mapping of several counts";
}

TEST(GltfVariants, UnknownNamesAreErrorsThatListTheVariants) {
  EXPECT_THAT(
      [] { materialsOf(VariantBuilder(), "red"); },
      ThrowsMessage<UsageError>(AllOf(HasSubstr("a.glb: no variant 'red'"), HasSubstr("Red, Green, Dark red"))));
  VariantBuilder without;
  without.root.erase("extensions");
  for (std::size_t i = 0; i < 3; ++i) without.primitive(i).erase("extensions");
  EXPECT_THAT([&] { materialsOf(without, "Red"); }, ThrowsMessage<UsageError>(HasSubstr("has no material variants")));
}

TEST(GltfVariants, IndicesAreChecked) {
  VariantBuilder builder;
  builder.mappings(0)[0]["variants"][1] = 3;
  EXPECT_THAT(errorOf(builder),
              IsErrorAt("/meshes/0/primitives/0/extensions/KHR_materials_variants/mappings/0/variants/1", "3"));
  builder.mappings(0)[0]["variants"][1] = 2;
  builder.mappings(0)[0]["material"] = 3;
  EXPECT_THAT(errorOf(builder),
              IsErrorAt("/meshes/0/primitives/0/extensions/KHR_materials_variants/mappings/0/material", "3"));
}

TEST(GltfVariants, SceneFilesSelectThemPerFile) {
  const TempFolder folder;
  writeFile(folder / "a.glb", VariantBuilder().glb());
  const std::string text = "[[file]]\nname = \"a\"\npath = \"a.glb\"\n";
  writeFile(folder / "a.scene.toml", text + "variant = \"Green\"\n");
  const scene::Scene scene = scene::loadScene(folder / "a.scene.toml");
  EXPECT_EQ(scene.meshes.at(0).geometries.at(0).material, 2);
  EXPECT_THAT(scene.report.variants, testing::Contains("a/Dark red"));
  EXPECT_THAT([&] { scene::loadScene(folder / "a.scene.toml", {.variant = "Green"}); },
              ThrowsMessage<UsageError>(HasSubstr("[[file]]")));
}

TEST(GltfVariants, UnknownNamesInSceneFilesAreErrorsAtTheirLine) {
  const TempFolder folder;
  writeFile(folder / "a.glb", VariantBuilder().glb());
  writeFile(folder / "a.scene.toml", "[[file]]\nname = \"a\"\npath = \"a.glb\"\nvariant = \"Blue\"\n");
  EXPECT_THAT([&] { scene::loadScene(folder / "a.scene.toml"); },
              ThrowsMessage<FileError>(AllOf(IsErrorAt((folder / "a.scene.toml").string() + ": line 4", "'Blue'"),
                                             HasSubstr("Red, Green, Dark red"))));
}

}  // namespace
}  // namespace quintet::test
