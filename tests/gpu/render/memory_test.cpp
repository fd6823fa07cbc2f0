// SPDX-License-Identifier: Apache-2.0
// The memory that remains allocated after a scene is on the device.
#include <gtest/gtest.h>

#include "harness.h"
#include "render/scene/device_scene.h"
#include "scene_builder.h"

namespace quintet::test {
namespace {

TEST(DeviceSceneMemory, FreesTemporaryMemory) {
  gpu::Context context({.device = testContext().info().name});
  SceneBuilder builder;
  for (int i = 0; i < 8; ++i) builder.add(sphere({3.0f * static_cast<float>(i), 0, 0}, 1.0f, 5), lambert(vec3(0.5f)));
  scene::Scene& scene = builder.scene;
  for (int i = 0; i < 3; ++i) {
    scene.images.push_back({"noise", io::makeImage(1024, 1024, 3, io::PixelType::u8, io::ColorEncoding::sRgb)});
    scene.textures.push_back({"noise", i, {}});
    scene.materials[static_cast<std::size_t>(i)].baseColorTexture.texture = i;
  }
  const render::DeviceScene device(context, std::move(scene), builder.environment);
  const render::DeviceSceneStatistics& statistics = device.statistics();
  EXPECT_GE(statistics.textureBytes, 12 * kMiB);
  EXPECT_GT(statistics.build.peakScratchBytes, 0u);
  const std::uint64_t needed =
      statistics.geometryBytes + statistics.textureBytes + statistics.build.bytes + statistics.primitiveMapBytes;
  const gpu::DeviceMemory memory = context.memory();
  const auto held = [&](gpu::Purpose purpose) { return memory.held[static_cast<std::size_t>(purpose)]; };
  EXPECT_EQ(held(gpu::Purpose::scratch), 0u);
  EXPECT_EQ(held(gpu::Purpose::staging), 0u);
  const std::uint64_t ofScene =
      held(gpu::Purpose::geometry) + held(gpu::Purpose::textures) + held(gpu::Purpose::accelerationStructures);
  EXPECT_GE(ofScene, needed);
  EXPECT_LE(ofScene, needed + kMiB);  // alignment, the top level
  EXPECT_LE(held(gpu::Purpose::tables), 4 * kMiB);
  // Unused memory in blocks of 32 MiB: a device has one partial block for each memory type in use, and keeps one empty
  // block.
  EXPECT_LE(memory.now, ofScene + held(gpu::Purpose::tables) + 96 * kMiB);
}

}  // namespace
}  // namespace quintet::test
