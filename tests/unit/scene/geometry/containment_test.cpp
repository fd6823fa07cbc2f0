// SPDX-License-Identifier: Apache-2.0
// Points inside and outside of meshes and solids.
#include "scene/geometry/containment.h"

#include <gtest/gtest.h>

#include <tuple>
#include <utility>
#include <vector>

namespace quintet::test {
namespace {

using glm::dvec3;

// A cube has 1/6 of the solid angle behind each side.
TEST(WindingNumber, IsTheFractionOfTheSolidAngle) {
  const std::vector<vec3> p{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                            {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  std::vector<uvec3> t{{0, 3, 2}, {0, 2, 1}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                       {2, 3, 7}, {2, 7, 6}, {0, 4, 7}, {0, 7, 3}, {1, 2, 6}, {1, 6, 5}};
  EXPECT_NEAR(scene::windingNumber(p, t, dvec3(0.3, -0.9, 0.99)), 1.0, 1e-12);
  EXPECT_NEAR(scene::windingNumber(p, t, dvec3(0.3, -1.1, 0.99)), 0.0, 1e-12);
  for (uvec3& triangle : t) std::swap(triangle.x, triangle.y);
  EXPECT_NEAR(scene::windingNumber(p, t, dvec3(0.0)), -1.0, 1e-12);
  t.resize(2);
  EXPECT_NEAR(scene::windingNumber(p, t, dvec3(0.0)), -1.0 / 6.0, 1e-12);
  EXPECT_EQ(scene::windingNumber({}, {}, dvec3(0.0)), 0.0);
}

// The implicit equations of the canonical solids, at the points p of a transformed solid.
TEST(Contains, FollowsTheEquationsOfTheSolids) {
  const mat4 placed = glm::scale(glm::translate(mat4(1.0f), vec3(1, 2, 3)), vec3(2.0f, 0.5f, 1.0f));
  const auto at = [&](scene::PrimitiveType type, const dvec3& p) {
    const scene::Primitive primitive{.type = type, .objectFromPrimitive = placed};
    return scene::contains(primitive, dvec3(glm::dmat4(placed) * glm::dvec4(p, 1.0)));
  };
  using enum scene::PrimitiveType;
  EXPECT_TRUE(at(sphere, {0.57, 0.57, 0.57}));
  EXPECT_FALSE(at(sphere, {0.58, 0.58, 0.58}));
  EXPECT_TRUE(at(box, {0.99, -0.99, 0.99}));
  EXPECT_FALSE(at(box, {0, 1.01, 0}));
  EXPECT_TRUE(at(cylinder, {0.7, 0.99, 0.7}));
  EXPECT_FALSE(at(cylinder, {0.71, 0, 0.71}));
  EXPECT_FALSE(at(cylinder, {0, -1.01, 0}));
  EXPECT_TRUE(at(cone, {0.49, 0, 0}));
  EXPECT_FALSE(at(cone, {0.51, 0, 0}));
  EXPECT_FALSE(at(cone, {0, -1.01, 0}));
  EXPECT_TRUE(at(torus, {0, 0.24, 1}));
  EXPECT_FALSE(at(torus, {0, 0.26, 1}));
  EXPECT_FALSE(at(torus, {0, 0, 0}));
}

TEST(Contains, EvaluatesTrees) {
  using enum scene::CsgOperation;
  scene::PrimitiveSet set;
  set.kind = scene::PrimitiveSetKind::csg;
  set.primitives.resize(2);
  set.primitives[1].objectFromPrimitive = glm::translate(mat4(1.0f), vec3(1, 0, 0));
  const auto at = [&](scene::CsgOperation operation, double x) {
    set.nodes = {{.primitive = 0}, {.primitive = 0}, {.primitive = 1}, {.operation = operation}};
    return scene::contains(set, {.firstNode = 1, .nodeCount = 3}, dvec3(x, 0, 0));
  };
  for (const auto& [operation, left, both, right] :
       {std::tuple(unite, true, true, true), std::tuple(intersect, false, true, false),
        std::tuple(subtract, true, false, false)}) {
    EXPECT_EQ(at(operation, -0.5), left);
    EXPECT_EQ(at(operation, 0.5), both);
    EXPECT_EQ(at(operation, 1.5), right);
    EXPECT_FALSE(at(operation, 2.5));
  }
}

}  // namespace
}  // namespace quintet::test
