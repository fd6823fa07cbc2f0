// SPDX-License-Identifier: Apache-2.0
// Instances in one acceleration structure (lavapipe): what rays find, and which instances are merged.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "harness.h"
#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

Layers renderMerged(render::DeviceScene& device, const scene::Scene& scene, bool merges) {
  program::Program program = program::loadProgram("pathtracer");
  program.mergesInstances = merges;
  return renderLayers(device, scene, program, {"instance_id", "material_id", "primitive_id"});
}

bool merges() { return testContext().info().quirks.slowInstances; }

TEST(MergedInstances, HaveTheSameHits) {
  const SceneBuilder scene = thicket();
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  const Layers separate = renderMerged(device, scene.scene, false);
  EXPECT_EQ(device.statistics().mergedInstances, 0u);
  const Layers merged = renderMerged(device, scene.scene, true);
  EXPECT_EQ(device.statistics().mergedInstances, merges() ? 2u : 0u);
  EXPECT_EQ(merged.rays, separate.rays);
  ASSERT_EQ(merged.planes.size(), 4u);
  EXPECT_EQ(merged.planes, separate.planes);
  // The ids are those of all instances of the scene.
  std::vector<int> seen(4);
  for (const vec4& id : merged.planes[1]) ++seen.at(static_cast<std::size_t>(id.x));
  for (const std::size_t instance : {1u, 2u, 3u}) EXPECT_GT(seen[instance], 20) << instance;
  // A program that does not permit it has its own structure again.
  EXPECT_EQ(renderMerged(device, scene.scene, false).planes, separate.planes);
  EXPECT_EQ(device.statistics().mergedInstances, 0u);
}

std::uint32_t mergedOf(const SceneBuilder& scene, const render::DeviceSceneOptions& options = {}) {
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment, options);
  device.prepareFor(2, false, false, true);
  return device.statistics().mergedInstances;
}

TEST(MergedInstances, AreThoseThatCannotDiffer) {
  const std::uint32_t both = merges() ? 2u : 0u;
  EXPECT_EQ(mergedOf(thicket()), both);
  SceneBuilder masked = thicket();
  masked.scene.instances[1].mask = 0x01;
  EXPECT_EQ(mergedOf(masked), 0u);
  SceneBuilder flagged = thicket();
  flagged.scene.instances[2].flags = scene::kInstanceForceOpaque;
  EXPECT_EQ(mergedOf(flagged), 0u);
  SceneBuilder moved = thicket();
  moved.scene.instances[2].worldFromObject[3].x += 1e-3f;
  EXPECT_EQ(mergedOf(moved), 0u);
  SceneBuilder twice = thicket();  // a mesh with two instances stays as it is
  twice.scene.instances.push_back(twice.scene.instances[2]);
  EXPECT_EQ(mergedOf(twice), 0u);
  SceneBuilder moving = thicket();
  moving.scene.instances[0].keyframes = {{0.0f, vec3(0.0f)}, {1.0f, vec3(1.0f)}};
  EXPECT_EQ(mergedOf(moving), 0u);
  SceneBuilder holes = thicket();
  holes.scene.materials[1].alphaMode = scene::AlphaMode::blend;
  holes.scene.materials[1].baseColor.a = 0.5f;
  EXPECT_EQ(mergedOf(holes), 0u);
  EXPECT_EQ(mergedOf(thicket(), {.keepInputOrder = true}), 0u);
  EXPECT_EQ(mergedOf(thicket(), {.editable = true}), 0u);
}

TEST(MergedInstances, LeaveOutTrianglesThatAreNotFinite) {
  SceneBuilder scene = thicket();
  scene.scene.meshes[1].geometries[0].positions[4].y = std::numeric_limits<float>::quiet_NaN();
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  const Layers separate = renderMerged(device, scene.scene, false);
  EXPECT_EQ(renderMerged(device, scene.scene, true).planes, separate.planes);
  EXPECT_EQ(device.statistics().mergedInstances, merges() ? 2u : 0u);
}

}  // namespace
}  // namespace quintet::test
