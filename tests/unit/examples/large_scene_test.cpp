// SPDX-License-Identifier: Apache-2.0
// The scene for measurements of loading, read back by the importer.
#include "demo/large_scene.h"

#include <gtest/gtest.h>

#include "base/file.h"
#include "scene/load.h"
#include "temp_folder.h"

namespace quintet::demo {
namespace {

TEST(LargeScene, HasTheRequestedContents) {
  const test::TempFolder folder;
  const std::uint64_t count = writeLargeScene(
      folder / "a.glb", {.triangles = 6000, .meshes = 3, .textures = 2, .textureSize = 16, .normalMaps = true});
  const scene::Scene scene = scene::loadScene(folder / "a.glb");
  EXPECT_EQ(scene::countTriangles(scene).stored, count);
  EXPECT_NEAR(static_cast<double>(count), 6000.0, 200.0);
  EXPECT_EQ(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.images.size(), 4u);
  EXPECT_TRUE(scene.report.repaired.empty());
  EXPECT_TRUE(scene.report.ignored.empty());
  // The normals agree with the faces, except at the poles.
  const scene::Geometry& g = scene.meshes[1].geometries[0];
  ASSERT_EQ(g.tangents.size(), g.positions.size());
  std::size_t reversed = 0;
  for (const uvec3& t : g.triangles) {
    const vec3 face = glm::cross(g.positions[t.y] - g.positions[t.x], g.positions[t.z] - g.positions[t.x]);
    if (glm::length(face) > 1e-6f && glm::dot(glm::normalize(face), g.normals[t.x]) < 0.5f) ++reversed;
  }
  EXPECT_EQ(reversed, 0u);
}

TEST(LargeScene, IsDeterministic) {
  const test::TempFolder folder;
  writeLargeScene(folder / "a.glb", {.triangles = 5000});
  writeLargeScene(folder / "b.glb", {.triangles = 5000});
  EXPECT_EQ(readFile(folder / "a.glb"), readFile(folder / "b.glb"));
}

}  // namespace
}  // namespace quintet::demo
