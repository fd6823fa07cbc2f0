// SPDX-License-Identifier: Apache-2.0
// Instances as programs see them: order, custom index, masks, and keyframes.
#include <gtest/gtest.h>

#include <map>

#include "harness.h"
#include "program/description/parser.h"
#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

// Colors a surface with gl_InstanceID, the user's custom index, and the index in the scene; alpha 1. A miss gives 0.
program::Program indexProgram(bool keepsOrder) {
  const std::map<std::string, std::string> files{{"index.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/camera.glsl>
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT vec4 color;
void main() {
  const Ray ray = cameraRay(vec2(launchPixel()) + 0.5, vec2(0.5));
  traceRayEXT(topLevelAS, 0u, 0x01u, kRay_primary, kRayTypeCount, kMiss_primary, ray.origin, 0.0, ray.direction, kInfinity, 0);
  storeOutput(kOutput_color, launchPixel(), loadOutput(kOutput_color, launchPixel()) + color);
  countRays(launchPixel(), 1u, 0u);
})"},
                                                 {"index.rmiss", R"(#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec4 color;
void main() { color = vec4(0.0); })"},
                                                 {"index.rchit", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit.glsl>
layout(location = 0) rayPayloadInEXT vec4 color;
void main() { color = vec4(gl_InstanceID, instanceCustomIndex(), gl_InstanceCustomIndexEXT, 1.0); })"}};
  program::Program program = program::parseProgram(R"(
[program]
ray_generation = "index.rgen"
[[ray]]
name = "primary"
miss = "index.rmiss"
[[hit_group]]
name = "all"
primary = { closest_hit = "index.rchit" }
[[output]]
name = "color"
)",
                                                   "index", "<test>", files);
  program.keepsInstanceOrder = keepsOrder;
  return program;
}

// Unit squares side by side along x, in an order that is not the spatial one. Pixel x sees the square at x.
constexpr std::uint32_t kSquares = 7;
std::uint32_t positionOf(std::uint32_t instance) { return instance * 3 % kSquares; }

SceneBuilder row() {
  SceneBuilder scene;
  for (std::uint32_t i = 0; i < kSquares; ++i) {
    scene.add(quad({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}), lambert(vec3(0.5f)),
              glm::translate(mat4(1.0f), vec3(positionOf(i), 0, 0)));
    scene.scene.instances.back().customIndex = 100 + i;
  }
  scene.camera(orthographic({3, 0, 1}, {3, 0, 0}, 0.5f));
  scene.scene.cameras[0].orthographicHalfSize = vec2(3.5f, 0.5f);
  return scene;
}

std::vector<vec4> renderRow(render::DeviceScene& device, const scene::Scene& scene, const program::Program& program) {
  ImageOptions options;
  options.program = program;
  options.width = kSquares;
  options.height = 1;
  render::Renderer renderer = makeRenderer(device, program, settingsFor(scene.cameras.at(0), options));
  renderer.renderBatch(1);
  return renderer.film().downloadBatch(0);
}

TEST(Instances, KeepTheirOrderAndCustomIndex) {
  SceneBuilder scene = row();
  // An instance without geometry among the others, which the build skips.
  scene.scene.meshes.emplace_back().geometries.emplace_back();
  scene.scene.instances.insert(scene.scene.instances.begin() + 2, scene::Instance{});
  scene.scene.instances[2].mesh = static_cast<int>(kSquares);
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  // The same scene with and without order: the structure fits the program that was prepared last.
  for (const bool keeps : {true, false, true}) {
    const std::vector<vec4> pixels = renderRow(device, scene.scene, indexProgram(keeps));
    for (std::uint32_t i = 0; i < kSquares; ++i) {
      const auto inScene = static_cast<float>(i < 2 ? i : i + 1);
      const vec4 seen = pixels[positionOf(i)];
      if (keeps) {
        EXPECT_EQ(seen.x, inScene);
      }
      EXPECT_EQ(seen.y, static_cast<float>(100 + i));
      EXPECT_EQ(seen.z, inScene);
    }
  }
}

TEST(Instances, HideFromRaysWithADifferentMask) {
  SceneBuilder scene = row();
  scene.scene.instances[3].mask = 0xFE;
  scene.scene.instances[5].mask = 0x03;
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  const std::vector<vec4> pixels = renderRow(device, scene.scene, indexProgram(false));
  for (std::uint32_t i = 0; i < kSquares; ++i) EXPECT_EQ(pixels[positionOf(i)].w, i == 3 ? 0.0f : 1.0f) << i;
}

TEST(Instances, FollowTheirKeyframes) {
  SceneBuilder scene = row();
  EXPECT_FALSE(render::DeviceScene(testContext(), scene::Scene(scene.scene), scene.environment).animated());
  // Instance 4 starts far away, passes its position at frame 10, and turns its back from frame 20 on.
  const auto at = [](float frame, float x, float angle) {
    return scene::Keyframe{frame, vec3(x, 0, 0), glm::angleAxis(angle, vec3(0, 1, 0)), vec3(1.0f)};
  };
  const auto position = static_cast<float>(positionOf(4));
  scene.scene.instances[4].keyframes = {at(5, position + 500.0f, 0), at(15, position - 500.0f, 0), at(20, position, 0),
                                        at(30, position, kPi)};
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  EXPECT_TRUE(device.animated());
  const program::Program program = indexProgram(false);
  for (const auto& [frame, visible] :
       {std::pair(0.0f, false), {10.0f, true}, {12.0f, false}, {20.0f, true}, {99.0f, true}, {-3.0f, false}}) {
    device.setFrame(frame);
    const std::vector<vec4> pixels = renderRow(device, scene.scene, program);
    for (std::uint32_t i = 0; i < kSquares; ++i)
      EXPECT_EQ(pixels[positionOf(i)].w, i == 4 && !visible ? 0.0f : 1.0f) << "instance " << i << " at frame " << frame;
  }
}

// Attributes are fetched through the instance table, which moves with the acceleration structure.
TEST(Instances, ShadeAtTheirCurrentTransform) {
  SceneBuilder scene;
  scene.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), lambert(vec3(0.5f)));
  scene.scene.instances[0].keyframes = {{0.0f, vec3(0.0f), quat(1, 0, 0, 0), vec3(1.0f)},
                                        {10.0f, vec3(0.0f), glm::angleAxis(1.0f, vec3(0, 1, 0)), vec3(1.0f)}};
  scene.camera(orthographic({0, 0, 3}, vec3(0.0f), 0.2f));
  ImageOptions options;
  options.program = program::loadProgram("normals");
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(scene.scene.cameras[0], options));
  device.setFrame(5.0f);
  renderer.renderBatch(1);
  const vec4 color = renderer.film().downloadBatch(0)[0];
  EXPECT_NEAR(color.x, 0.5f + 0.5f * std::sin(0.5f), 1e-5f);
  EXPECT_NEAR(color.z, 0.5f + 0.5f * std::cos(0.5f), 1e-5f);
}

}  // namespace
}  // namespace quintet::test
