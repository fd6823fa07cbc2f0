// SPDX-License-Identifier: Apache-2.0
// Surface areas of solids under transforms, against closed forms.
#include "render/lights/light_emitters.h"

#include <gtest/gtest.h>

#include "render/lights/light_table.h"

namespace quintet::render {
namespace {

using scene::PrimitiveType;
constexpr double kPiDouble = glm::pi<double>();

double area(PrimitiveType type, const mat4& objectFromPrimitive, const mat4& worldFromObject = mat4(1.0f),
            float parameter = 0.25f) {
  scene::Primitive primitive;
  primitive.type = type;
  primitive.objectFromPrimitive = objectFromPrimitive;
  primitive.parameter = parameter;
  return solidArea(primitive, glm::dmat3(mat3(worldFromObject)));
}

mat4 scaled(float x, float y, float z) { return glm::scale(mat4(1.0f), vec3(x, y, z)); }

TEST(SolidArea, IsExactUnderSimilarity) {
  const mat4 twice = glm::rotate(scaled(2, 2, 2), 1.0f, glm::normalize(vec3(1, 2, 3)));
  EXPECT_NEAR(area(PrimitiveType::sphere, twice), 16 * kPiDouble, 1e-4);
  EXPECT_NEAR(area(PrimitiveType::box, twice), 96, 1e-3);
  EXPECT_NEAR(area(PrimitiveType::cylinder, twice), 24 * kPiDouble, 1e-3);
  EXPECT_NEAR(area(PrimitiveType::cone, twice), 4 * kPiDouble * (1 + std::sqrt(5.0)), 1e-3);
  EXPECT_NEAR(area(PrimitiveType::torus, twice), 4 * 4 * kPiDouble * kPiDouble * 0.25, 1e-3);
}

TEST(SolidArea, IntegratesUnderStretch) {
  const mat4 first = scaled(1, 3, 1), second = glm::rotate(mat4(1.0f), 0.4f, vec3(0, 0, 1));
  EXPECT_NEAR(area(PrimitiveType::box, scaled(1, 2, 3), second), 8 * (2 + 3 + 6), 1e-4);
  EXPECT_NEAR(area(PrimitiveType::cylinder, first, second), 2 * kPiDouble + 12 * kPiDouble, 1e-3);
  EXPECT_NEAR(area(PrimitiveType::cone, scaled(1, 2, -1), second), kPiDouble * (1 + std::sqrt(17.0)), 1e-3);
  // Prolate spheroid with semi-axes 1, 1, 3: 2π (1 + c/e asin e), where e² = 1 - 1/9.
  const double e = std::sqrt(8.0 / 9.0);
  EXPECT_NEAR(area(PrimitiveType::sphere, first, second), 2 * kPiDouble * (1 + 3 / e * std::asin(e)), 0.1);
}

// Solids whose material does not emit are never sampled, and CSG trees are not lights.
TEST(SolidArea, GivesThePowerInTheLightTable) {
  scene::Scene scene;
  scene.materials.resize(2);
  scene.materials[1].emissive = vec3(2.0f);
  scene::PrimitiveSet set;
  set.primitives.resize(3);
  set.primitives[0].material = 1;
  set.primitives[1].material = 0;
  set.primitives[2].material = 1;
  set.primitives[2].objectFromPrimitive = scaled(2, 2, 2);
  scene::PrimitiveSet tree = set;
  tree.kind = scene::PrimitiveSetKind::csg;
  tree.nodes = {{scene::CsgOperation::leaf, 0}};
  tree.trees = {{0, 1}};
  scene.meshes.emplace_back().primitiveSets = {tree, set};
  scene.instances.resize(1);
  scene.instances[0].mesh = 0;
  const LightTable table = buildLightTable(scene, {});
  ASSERT_EQ(table.slots, (std::vector<std::uint32_t>{shared::kNoLight, 0}));
  ASSERT_EQ(table.lights.size(), 3u);
  EXPECT_EQ(table.lights[2].type, shared::kLightSolid);
  EXPECT_EQ(table.lights[2].geometry, 1u);
  EXPECT_EQ(table.lights[2].primitive, 2u);
  EXPECT_NEAR(table.entries[0].probability, 0.2f, 1e-6f);
  EXPECT_EQ(table.entries[1].probability, 0.0f);
  EXPECT_NEAR(table.entries[2].probability, 0.8f, 1e-6f);
}

}  // namespace
}  // namespace quintet::render
