// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/material_properties.h"

#include <gmock/gmock.h>

#include "base/error.h"

namespace quintet::job::interactive {
namespace {

void set(scene::Material& material, const std::string& name, std::vector<double> values) {
  setMaterialProperty(material, name, values);
}

TEST(MaterialProperties, AreSetByName) {
  scene::Material material;
  material.baseColor.a = 0.5f;
  set(material, "roughness", {0.25});
  set(material, "baseColor", {1, 0, 0.5});
  set(material, "emissive", {1, 2, 3});
  set(material, "doubleSided", {1});
  EXPECT_EQ(material.roughness, 0.25f);
  EXPECT_EQ(material.baseColor, vec4(1, 0, 0.5f, 0.5f)) << "alpha stays";
  EXPECT_EQ(material.emissive, vec3(1, 2, 3));
  EXPECT_TRUE(material.doubleSided);
  set(material, "baseColor", {1, 0, 0.5, 0.75});
  EXPECT_EQ(material.baseColor.a, 0.75f);
}

TEST(MaterialProperties, AreReadByName) {
  scene::Material material;
  material.baseColor = {0.25f, 0.5f, 0.75f, 1.0f};
  EXPECT_EQ(materialPropertyValue(material, "baseColor"), (std::vector<double>{0.25, 0.5, 0.75, 1.0}));
  EXPECT_EQ(materialPropertyValue(material, "unlit"), std::vector<double>{0});
  EXPECT_THROW(materialPropertyValue(material, "color"), UsageError);
  scene::Material copy;
  copy.roughness = 0.125f;
  copy.doubleSided = true;
  for (const std::string& name : materialProperties()) set(material, name, materialPropertyValue(copy, name));
  for (const std::string& name : materialProperties())
    EXPECT_EQ(materialPropertyValue(material, name), materialPropertyValue(copy, name)) << name;
}

TEST(MaterialProperties, RejectsWrongNamesAndForms) {
  scene::Material material;
  EXPECT_THAT([&] { set(material, "rougness", {1}); },
              testing::ThrowsMessage<UsageError>(testing::HasSubstr("did you mean 'roughness'?")));
  EXPECT_THAT([&] { set(material, "emissive", {1}); },
              testing::ThrowsMessage<UsageError>(testing::HasSubstr("three numbers")));
  EXPECT_THROW(set(material, "roughness", {1, 2}), UsageError);
  EXPECT_THROW(set(material, "unlit", {0.5}), UsageError);
  for (const std::string& name : materialProperties()) EXPECT_THROW(set(material, name, {}), UsageError) << name;
}

}  // namespace
}  // namespace quintet::job::interactive
