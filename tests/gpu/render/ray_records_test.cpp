// SPDX-License-Identifier: Apache-2.0
// The rays that `quintet bench` records and replays: those of a program with known rays are stored in order, each at its
// pixel, and counted by kind; the program `replay` traces stored rays as they are.
#include <gtest/gtest.h>

#include <cstring>

#include "../program/run_program.h"
#include "gpu/buffer.h"
#include "harness.h"
#include "program/description/parser.h"
#include "quintet/shared/frame.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kStoredRays = 3;  // per pixel
constexpr render::Region kStoredRegion{10, 20, 4, 3};

// The wall z = -1 begins at x = 11.5. Each pixel traces a ray and a shadow ray from (x, y) to it, and none for the shadow
// ray of length 0; every second pixel traces a third ray. The last pixel traces two more than fit.
const Files kTracingFiles = {{"main.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#define QUINTET_SHADOW_RAYS
#include <quintet/output.glsl>
#include <quintet/trace.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  const vec2 at = vec2(pixel);
  const vec3 back = vec3(0.0, 0.0, -1.0);
  const HitPayload first = traceClosest(vec3(at, -0.8), back, 1000.0, 0u);
  const bool visible = traceVisible(vec3(at, -0.9), back, 9.0, 0u);
  const bool unblocked = traceVisible(vec3(at, -0.9), back, frame.width > 0u ? 0.0 : 9.0, 0u);
  if ((pixel.x + pixel.y) % 2u == 1u) traceClosest(vec3(at, 0.5), back, 50.0, 0u);
  if (pixel == uvec2(13u, 22u))
    for (int i = 0; i < 2; ++i) traceVisible(vec3(at, -0.9), back, 9.0, 0u);
  storeOutput(kOutput_color, pixel, vec4(first.t, visible ? 1.0 : 0.0, unblocked ? 1.0 : 0.0, 1.0));
}
)"}};

constexpr const char* kTracingToml = R"([program]
ray_generation = "main.rgen"
[[ray]]
name = "radiance"
miss = "<quintet/stages/radiance.rmiss>"
[[ray]]
name = "shadow"
miss = "<quintet/stages/shadow.rmiss>"
[[hit_group]]
name = "opaque"
geometry = "opaque"
radiance = { closest_hit = "<quintet/stages/surface.rchit>" }
[[output]]
name = "color"
)";

TEST(RayRecords, StoreTheRaysOfEachPixel) {
  SceneBuilder scene;
  scene.add(quad({11.5f, -99, -1}, {99, 0, 0}, {0, 198, 0}), lambert(vec3(0.5f)));
  scene.camera(perspective({0, 0, 5}, {0, 0, 0}, 40.0f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.program = program::parseProgram(kTracingToml, "test", "<test>", kTracingFiles);
  options.width = 16;
  options.height = 24;
  const std::size_t pixels = std::size_t{kStoredRegion.width} * kStoredRegion.height;
  const std::size_t words = (sizeof(shared::RayKinds) + pixels * kStoredRays * sizeof(shared::RayRecord)) / 4;
  const gpu::Buffer buffer = gpu::makeBufferOf(testContext(), std::vector<std::uint32_t>(words), 0, "ray records");
  render::RenderSettings settings = settingsFor(scene.scene.cameras[0], options);
  settings.region = kStoredRegion;
  settings.rayRecords = &buffer;
  settings.rayRecordCapacity = kStoredRays;
  render::Renderer renderer = makeRenderer(device, options.program, settings, {{"QUINTET_RECORD_RAYS", "1"}});
  renderer.renderBatch(1);
  const io::Image image = renderer.image();

  const std::vector<std::byte> bytes = buffer.downloadAs<std::byte>(words * 4);
  shared::RayKinds kinds, expected{};
  std::memcpy(&kinds, bytes.data(), sizeof kinds);
  for (std::uint32_t y = 0; y < kStoredRegion.height; ++y)
    for (std::uint32_t x = 0; x < kStoredRegion.width; ++x) {
      const uvec2 pixel(kStoredRegion.x + x, kStoredRegion.y + y);
      const bool wall = pixel.x >= 12, third = (pixel.x + pixel.y) % 2 == 1;
      const auto ray = [&](float z, float tmax, std::uint32_t kind) {
        return shared::RayRecord{{pixel.x, pixel.y, z}, tmax, {0, 0, -1}, kind};
      };
      std::vector<shared::RayRecord> rays{ray(-0.8f, 1000, shared::kRecordClosest),
                                          ray(-0.9f, 9, shared::kRecordShadow)};
      if (third) rays.push_back(ray(0.5f, 50, shared::kRecordClosest));
      rays.resize(kStoredRays, shared::RayRecord{});
      for (std::size_t i = 0; i < kStoredRays; ++i) {
        shared::RayRecord stored;
        const std::size_t index = (std::size_t{y} * kStoredRegion.width + x) * kStoredRays + i;
        std::memcpy(&stored, bytes.data() + sizeof kinds + index * sizeof stored, sizeof stored);
        EXPECT_TRUE(stored.origin == rays[i].origin && stored.direction == rays[i].direction &&
                    stored.tmax == rays[i].tmax && stored.kind == rays[i].kind)
            << "pixel " << pixel.x << "," << pixel.y << " ray " << i << " of kind " << stored.kind << " from "
            << stored.origin.x << "," << stored.origin.y << "," << stored.origin.z;
      }
      const std::uint32_t shadows = pixel == uvec2(13, 22) ? 3 : 1;
      expected.camera += 1, expected.cameraHits += wall ? 1 : 0;
      expected.shadow += shadows, expected.shadowHits += wall ? shadows : 0;
      expected.continuation += third ? 1 : 0, expected.continuationHits += third && wall ? 1 : 0;
      const auto values = image.pixel<float>(x, y);
      EXPECT_NEAR(values[0], wall ? 0.2f : -1.0f, 1e-5f);
      EXPECT_EQ(values[1], wall ? 0.0f : 1.0f);
      EXPECT_EQ(values[2], 1.0f);
    }
  EXPECT_EQ(kinds.camera, expected.camera);
  EXPECT_EQ(kinds.cameraHits, expected.cameraHits);
  EXPECT_EQ(kinds.continuation, expected.continuation);
  EXPECT_EQ(kinds.continuationHits, expected.continuationHits);
  EXPECT_EQ(kinds.shadow, expected.shadow);
  EXPECT_EQ(kinds.shadowHits, expected.shadowHits);
}

// Each pixel shows the sum of the lengths of its rays. A shadow ray that hits the floor z = 0 counts as long as the ray before
// it, because no shader runs.
TEST(RayRecords, AreReplayed) {
  SceneBuilder scene;
  scene.add(quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}), lambert(vec3(0.5f)));
  scene.camera(perspective({0, 0, 5}, {0, 0, 0}, 40.0f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  const auto down = [](float height, float tmax, std::uint32_t kind = shared::kRecordClosest) {
    return shared::RayRecord{{0.5f, 0.25f, height}, tmax, {0, 0, -1}, kind};
  };
  struct Pixel {
    std::vector<shared::RayRecord> rays;
    float sum;
  };
  const Pixel cases[] = {
      {{}, 0.0f},
      {{down(1, 9, shared::kRecordShadow), down(0.2f, 9), down(1, 9, shared::kRecordShadow), down(5, 3)}, 0.4f},
      {{down(5, 9)}, 5.0f},
      {{down(2, 9), down(2, 1, shared::kRecordShadow)}, 2.0f},
      {{down(3, 9), down(4, 9)}, 7.0f},
      {{down(-1, 9)}, 0.0f}};
  constexpr std::uint32_t kCapacity = 4;
  std::vector<std::uint32_t> words(sizeof(shared::RayKinds) / 4);
  std::uint64_t count = 0;
  for (const Pixel& pixel : cases) {
    std::vector<shared::RayRecord> rays = pixel.rays;
    count += rays.size();
    rays.resize(kCapacity, shared::RayRecord{});
    words.resize(words.size() + kCapacity * sizeof(shared::RayRecord) / 4);
    std::memcpy(words.data() + words.size() - kCapacity * sizeof(shared::RayRecord) / 4, rays.data(),
                kCapacity * sizeof(shared::RayRecord));
  }
  const gpu::Buffer buffer = gpu::makeBufferOf(testContext(), words, 0, "ray records");
  ImageOptions options;
  options.program = program::loadProgram("replay");
  render::RenderSettings settings = settingsFor(scene.scene.cameras[0], options);
  settings.region = {4, 5, 3, 2};
  settings.rayRecords = &buffer;
  settings.rayRecordCapacity = kCapacity;
  render::Renderer renderer = makeRenderer(device, options.program, settings);
  renderer.renderBatch(1);
  const io::Image image = renderer.image();
  for (std::uint32_t i = 0; i < 6; ++i) {
    const auto values = image.pixel<float>(i % 3, i / 3);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(values[c], cases[i].sum, 1e-5f) << i;
    EXPECT_EQ(values[3], 1.0f) << i;
  }
  EXPECT_EQ(renderer.rays().rays, count);
  EXPECT_EQ(renderer.rays().droppedSamples, 0u);
}

}  // namespace
}  // namespace quintet::test
