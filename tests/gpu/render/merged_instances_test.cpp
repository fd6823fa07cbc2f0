// SPDX-License-Identifier: Apache-2.0
// Instances in one acceleration structure (lavapipe): what rays find, and which instances are merged.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "harness.h"
#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

// Small quads in all directions within a unit cube.
scene::Geometry scattered(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-0.5f, 0.5f);
  const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
  scene::Geometry all;
  for (int i = 0; i < count; ++i) {
    const scene::Geometry one = quad(point(), 0.3f * point(), 0.3f * point());
    const auto base = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), one.positions.begin(), one.positions.end());
    for (const uvec3& triangle : one.triangles) all.triangles.push_back(triangle + base);
  }
  return all;
}

// Two meshes, one of them with two geometries and one of these emissive, in the same space, turned and mirrored alike; a
// ground with a different transform.
SceneBuilder thicket() {
  const mat4 turned = glm::rotate(scaled(-1.0f, 1.2f, 1.0f), 0.4f, vec3(0.3f, 1.0f, 0.1f));
  SceneBuilder scene;
  scene.add(quad({-3, -1, 3}, {6, 0, 0}, {0, 0, -6}), lambert(vec3(0.5f)));
  scene.add(scattered(150, 1), lambert({0.6f, 0.3f, 0.2f}), turned);
  scene.add(scattered(400, 2), lambert({0.2f, 0.6f, 0.3f}), turned);
  scene.scene.materials.push_back(emitter(vec3(3.0f)));
  scene::Geometry lights = scattered(20, 3);
  lights.material = static_cast<int>(scene.scene.materials.size()) - 1;
  scene.scene.meshes[2].geometries.push_back(lights);
  scene.sky(vec3(0.4f)).camera(perspective({0.3f, 0.4f, 2.2f}, {0, 0, 0}, 40.0f));
  return scene;
}

struct Rendered {
  std::vector<std::vector<vec4>> planes;  // color, then the ids
  std::uint64_t rays = 0;
};

Rendered renderLayers(render::DeviceScene& device, const scene::Scene& scene, bool merges) {
  ImageOptions options;
  options.width = options.height = 48;
  program::Program program = program::loadProgram("pathtracer");
  program.mergesInstances = merges;
  render::RenderSettings settings = settingsFor(scene.cameras.at(0), options);
  settings.outputs = {"instance_id", "material_id", "primitive_id"};
  render::Renderer renderer = makeRenderer(device, program, settings);
  renderer.renderBatch();
  Rendered result;
  for (std::size_t i = 0; i < program.outputs.size(); ++i) {
    const std::string& name = program.outputs[i].name;
    if (name == "color" || std::ranges::count(settings.outputs, name))
      result.planes.push_back(renderer.film().downloadBatch(i));
  }
  result.rays = renderer.rays().rays;
  return result;
}

bool merges() { return testContext().info().quirks.slowInstances; }

TEST(MergedInstances, HaveTheSameHits) {
  const SceneBuilder scene = thicket();
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  const Rendered separate = renderLayers(device, scene.scene, false);
  EXPECT_EQ(device.statistics().mergedInstances, 0u);
  const Rendered merged = renderLayers(device, scene.scene, true);
  EXPECT_EQ(device.statistics().mergedInstances, merges() ? 2u : 0u);
  EXPECT_EQ(merged.rays, separate.rays);
  ASSERT_EQ(merged.planes.size(), 4u);
  EXPECT_EQ(merged.planes, separate.planes);
  // The ids are those of all instances of the scene.
  std::vector<int> seen(4);
  for (const vec4& id : merged.planes[1]) ++seen.at(static_cast<std::size_t>(id.x));
  for (const std::size_t instance : {1u, 2u, 3u}) EXPECT_GT(seen[instance], 20) << instance;
  // A program that does not permit it has its own structure again.
  EXPECT_EQ(renderLayers(device, scene.scene, false).planes, separate.planes);
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
  const Rendered separate = renderLayers(device, scene.scene, false);
  EXPECT_EQ(renderLayers(device, scene.scene, true).planes, separate.planes);
  EXPECT_EQ(device.statistics().mergedInstances, merges() ? 2u : 0u);
}

}  // namespace
}  // namespace quintet::test
