// SPDX-License-Identifier: Apache-2.0
// Repairs of imported geometry.
#include "scene/geometry/repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/gltf_builder.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;

TEST(Repair, DropsManyUnusedVertices) {
  scene::Geometry g;
  for (int i = 0; i < 10; ++i) g.positions.emplace_back(i, 0, 0);
  g.colors.assign(10, vec4(1));
  g.colors[7] = vec4(0.5f);
  g.triangles = {{9, 7, 2}, {2, 7, 4}};
  scene::dropUnusedVertices(g);
  EXPECT_THAT(g.positions, ElementsAre(vec3(2, 0, 0), vec3(4, 0, 0), vec3(7, 0, 0), vec3(9, 0, 0)));
  EXPECT_THAT(g.triangles, ElementsAre(uvec3(3, 2, 0), uvec3(0, 2, 1)));
  EXPECT_EQ(g.colors[2], vec4(0.5f));
  EXPECT_TRUE(g.normals.empty());

  g.positions.emplace_back(100, 0, 0);  // one in five is too few
  g.colors.emplace_back(1);
  scene::dropUnusedVertices(g);
  EXPECT_EQ(g.positions.size(), 5u);
}

TEST(Repair, MovesNonFiniteVerticesToAFinitePosition) {
  scene::Geometry g;
  g.positions = {{NAN, 0, 0}, {1, 2, 3}, {0, INFINITY, 0}};
  g.triangles = {{1, 1, 1}, {0, 1, 2}};
  EXPECT_EQ(scene::dropNonFiniteTriangles(g), 1u);
  EXPECT_THAT(g.positions, testing::Each(vec3(1, 2, 3)));  // bounds of all positions stay tight
  EXPECT_THAT(g.fileTriangles, ElementsAre(0u));
}

TEST(Repair, KeepsOnlyTheVerticesOfEachPrimitive) {
  GltfBuilder builder;
  std::vector<float> positions(3 * 100, 0.0f);
  const int p = builder.addAccessor(positions, "VEC3");
  for (std::uint8_t i = 0; i < 5; ++i)
    builder.addMesh(
        {{"attributes", {{"POSITION", p}}}, {"indices", builder.addAccessor<std::uint8_t>({i, 50, 99}, "SCALAR")}});
  for (const scene::Mesh& mesh : builder.load().meshes) EXPECT_EQ(mesh.geometries[0].positions.size(), 3u);
}

TEST(Repair, ReturnsAPerpendicularVector) {
  for (const vec3& n :
       {vec3(0, 0, 1), vec3(0, 0, -1), vec3(1, 0, 0), glm::normalize(vec3(1, -2, 3)), vec3(0, 1, -0.0f)}) {
    const vec3 t = scene::anyPerpendicular(n);
    EXPECT_NEAR(glm::dot(n, t), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::length(t), 1.0f, 1e-6f);
  }
}

TEST(Repair, RigidFrameRemovesScaleAndMirroring) {
  mat4 m = glm::translate(mat4(1.0f), vec3(1, 2, 3));
  m = glm::scale(glm::rotate(m, 0.5f, vec3(0, 1, 0)), vec3(-2, 3, 4));
  const mat4 frame = scene::rigidFrame(m);
  EXPECT_NEAR(glm::determinant(mat3(frame)), 1.0f, 1e-6f);
  EXPECT_LT(glm::distance(vec3(frame[2]), glm::normalize(vec3(m[2]))), 1e-6f);
  EXPECT_LT(glm::distance(vec3(frame[1]), vec3(0, 1, 0)), 1e-6f);
  EXPECT_EQ(vec3(frame[3]), vec3(1, 2, 3));
  EXPECT_EQ(scene::rigidFrame(mat4(0.0f))[2], vec4(0, 0, 1, 0));
}

}  // namespace
}  // namespace quintet::test
