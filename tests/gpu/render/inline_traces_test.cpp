// SPDX-License-Identifier: Apache-2.0
// Traces by ray queries (lavapipe) find the same hits as calls of the hit and miss shaders. On other devices, both programs call
// shaders.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "harness.h"
#include "pane_scenes.h"
#include "program/inline_traces.h"
#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

// With copies of the library's hit shaders, for which ray queries do not stand.
program::Program withCalls(program::Program program) {
  const std::string head = "#version 460\n#extension GL_EXT_ray_tracing : require\n";
  const auto own = [&](std::string& file) {
    if (file.empty()) return;
    const std::string name = file.substr(file.rfind('/') + 1, file.size() - file.rfind('/') - 2);
    program.files[name] = head + "#include " + file + "\n";
    file = name;
  };
  for (program::HitGroup& group : program.hitGroups) {
    for (auto& [ray, shaders] : group.shaders) {
      own(shaders.closestHit);
      own(shaders.anyHit);
    }
  }
  return program;
}

bool definesInlineTraces(const render::DeviceScene& device) {
  return std::ranges::any_of(device.defines(),
                             [](const auto& define) { return define.first == program::kInlineTraces; });
}

void expectSameHits(const SceneBuilder& scene, std::initializer_list<const char*> programs) {
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  EXPECT_EQ(definesInlineTraces(device), testContext().info().quirks.slowTraceCalls);
  for (const char* name : programs) {
    const program::Program program = program::loadProgram(fmt::format("<programs/{}>", name));
    std::vector<std::string> ids;
    if (std::string_view(name) == "pathtracer") ids = {"instance_id", "material_id", "primitive_id"};
    const Layers expected = renderLayers(device, scene.scene, withCalls(program), ids);
    const Layers found = renderLayers(device, scene.scene, program, ids);
    EXPECT_EQ(found.rays, expected.rays) << name;
    ASSERT_EQ(found.planes.size(), 1 + ids.size());
    EXPECT_EQ(found.planes, expected.planes) << name;
    EXPECT_GT(std::ranges::count_if(found.planes[0], [](const vec4& pixel) { return pixel.x > 0.0f; }), 500) << name;
  }
}

SceneBuilder lampThicket() {
  SceneBuilder scene = thicket();
  scene::Light lamp;
  lamp.position = {1, 1.5f, 1};
  lamp.intensity = vec3(4.0f);
  scene.light(lamp);
  return scene;
}

TEST(InlineTraces, FindTheSameOpaqueSurfaces) {
  SceneBuilder scene = lampThicket();
  scene.scene.instances[2].worldFromObject[3].x += 0.05f;  // not merged
  scene.scene.instances.push_back(scene.scene.instances[1]);
  scene.scene.instances.back().worldFromObject = moved(0.5f, 0.2f, 0.1f);
  scene.scene.instances[1].mask = 0;
  expectSameHits(scene, {"ao"});
}

TEST(InlineTraces, FindTheSameMergedSurfaces) { expectSameHits(lampThicket(), {"pathtracer"}); }

TEST(InlineTraces, PassAlphaAlike) {
  SceneBuilder scene = lampThicket();
  scene::Material& leaves = scene.scene.materials[2];
  leaves.alphaMode = scene::AlphaMode::mask;
  leaves.baseColorTexture.texture = addTexel(scene.scene, {255, 255, 255, 255, 255, 255, 255, 40});
  scene::Geometry& geometry = scene.scene.meshes[2].geometries[0];
  for (std::size_t i = 0; i < geometry.positions.size(); ++i)
    geometry.uvs[0].push_back({0.25f * static_cast<float>(i % 4), 0.5f});
  expectSameHits(scene, {"naive"});
  leaves.alphaMode = scene::AlphaMode::blend;
  scene.scene.instances.push_back(scene.scene.instances[2]);
  scene.scene.instances.back().worldFromObject = moved(0.5f, 0.2f, 0.1f);
  scene.scene.instances.back().flags = scene::kInstanceForceOpaque;
  expectSameHits(scene, {"pathtracer"});
}

// Shadow rays go down from z = 1. They meet sheets at z = 0 and -1: mask with an opaque and a clear half, blend over blend, blend over
// both halves of a mask, and a sheet without alpha. Each layer of blend passes 3/4 of the light.
TEST(InlineTraces, LightArrivesWhereAlphaLetsItPass) {
  if (!testContext().info().rayQuery) GTEST_SKIP() << "the device has no ray queries";
  SceneBuilder scene;
  const auto sheet = [](float x, float width, float z) {
    scene::Geometry g = quad({x, -1, z}, {width, 0, 0}, {0, 2, 0});
    g.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    return g;
  };
  scene::Material halves = veil(lambert(vec3(0.5f)), 1.0f, scene::AlphaMode::mask);
  halves.baseColorTexture.texture = addTexel(scene.scene, {255, 255, 255, 255, 255, 255, 255, 0});
  const scene::Material quarter = veil(lambert(vec3(0.5f)), 0.25f, scene::AlphaMode::blend);
  scene.add(sheet(0, 2, 0), halves)
      .add(sheet(2, 2, 0), quarter)
      .add(sheet(2, 1, -1), quarter)
      .add(sheet(3, 2, -1), halves)
      .add(sheet(6, 1, 0), lambert(vec3(0.5f)));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  device.prepareFor(1);
  const gpu::Buffer frame =
      gpu::makeBufferOf(testContext(), std::vector<shared::Frame>{device.frameTemplate()}, 0, "frame");
  struct ShadowRay {
    float x, tmax;
    float transmittance;  // 0: no light arrives
  };
  const std::vector<ShadowRay> rays{{0.5f, 9, 0.0f},    {1.5f, 9, 1.0f},     {0.5f, 0.5f, 1.0f}, {0.5f, 0, 1.0f},
                                    {2.5f, 9, 0.5625f}, {2.5f, 1.5f, 0.75f}, {3.5f, 9, 0.0f},    {3.5f, 1.5f, 0.75f},
                                    {4.5f, 9, 1.0f},    {5.5f, 9, 1.0f},     {6.5f, 9, 0.0f},    {6.5f, 0.5f, 1.0f}};
  struct Found {
    vec3 transmittance;
    std::uint32_t visible;
  };
  const auto found = runCompute<Found>(R"(
    #include <quintet/ray_query.glsl>
    layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
    struct ShadowRay { float x; float tmax; float transmittance; };
    struct Found { vec3 transmittance; uint visible; };
    #define In ShadowRay
    #define Out Found
    Out run(uint index, In ray) {
      Found a;
      a.visible = queryVisible(topLevelAS, vec3(ray.x, 0.3, 1.0), vec3(0.0, 0.0, -1.0), ray.tmax, a.transmittance) ? 1u : 0u;
      return a;
    }
  )",
                                       rays, rays.size(), {.set = &device.set(), .frame = frame.address()});
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const vec3 arriving = found[i].visible != 0 ? found[i].transmittance : vec3(0.0f);
    EXPECT_EQ(arriving, vec3(rays[i].transmittance)) << i;
    EXPECT_EQ(found[i].visible != 0, rays[i].transmittance > 0.0f) << i;
  }
}

TEST(InlineTraces, LeavePanesAndBoxesToShaders) {
  SceneBuilder pane = lampThicket();
  pane.add(quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}), clearGlass(1.5f, 0.0f));
  EXPECT_FALSE(definesInlineTraces({testContext(), std::move(pane.scene), pane.environment}));
  SceneBuilder boxes = lampThicket();
  boxes.scene.meshes.push_back(boxScene()->meshes[0]);
  boxes.scene.instances.emplace_back().mesh = static_cast<int>(boxes.scene.meshes.size()) - 1;
  EXPECT_FALSE(definesInlineTraces({testContext(), std::move(boxes.scene), boxes.environment}));
}

}  // namespace
}  // namespace quintet::test
