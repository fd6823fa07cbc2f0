// SPDX-License-Identifier: Apache-2.0
// TLAS: transforms, masks, records per instance, and rebuilds while the device is busy.
#include "base/error.h"
#include "rt_test_support.h"

namespace quintet::rt::test {
namespace {

Blas buildQuad() {
  const Mesh mesh = quad(0);
  const BlasInput input{.geometries = {mesh.geometry()}, .options = {.name = "quad"}};
  return std::move(BlasBuilder(quintet::test::testContext()).build({&input, 1})[0]);
}

mat4 translation(float x, float z) { return glm::translate(mat4(1.0f), vec3(x, 0, z)); }

TEST(RtInstances, MissesAnEmptyTlas) {
  for (const std::uint32_t capacity : {0u, 4u}) {
    Tlas tlas(quintet::test::testContext(), capacity);
    tlas.buildAndWait({});
    const auto hits = traceRays(tlas, contentsOf({}, {5}), {Ray{}});
    EXPECT_EQ(hits[0].t, -1.0f);
    EXPECT_EQ(hits[0].tag, 5u);
  }
}

TEST(RtInstances, AppliesTransformsIndicesMasksAndRecords) {
  const Blas blas = buildQuad();
  constexpr std::uint32_t kCount = 101;
  std::vector<InstanceInput> instances;
  std::vector<SbtRecord> records;
  std::vector<Ray> rays;
  for (std::uint32_t k = 0; k < kCount; ++k) {
    const float x = 10.0f * static_cast<float>((k * 37) % kCount);  // not in spatial order
    const mat4 rotated = translation(x, -5) * glm::rotate(mat4(1.0f), glm::half_pi<float>(), vec3(0, 1, 0)) *
                         glm::scale(mat4(1.0f), vec3(1, 2, 3));  // seen from +x, z in [-1,1], y in [-2,2]
    instances.push_back({rotated, &blas, 1000 + k, k % 2 ? 0x01u : 0x02u, k, 0});
    records.push_back(hitRecord(kTriangleHit, {.map = blas.primitiveMap(0), .tag = k}));
    rays.push_back({.origin = {x + 1, 1.5f, -4.5f}, .direction = {-1, 0, 0}, .tMax = 5});
  }
  Tlas tlas(quintet::test::testContext(), kCount);
  tlas.buildAndWait(instances);
  const SbtContents contents = contentsOf(records);
  for (const std::uint32_t mask : {1u, 2u, 3u, 0u}) {
    const auto hits = traceRays(tlas, contents, rays, {.mask = mask});
    for (std::uint32_t k = 0; k < kCount; ++k) {
      const bool seen = mask & instances[k].mask;
      ASSERT_NEAR(hits[k].t, seen ? 1.0f : -1.0f, 1e-3f) << k << " mask " << mask;
      if (!seen) continue;
      EXPECT_EQ(hits[k].custom, 1000 + k);
      EXPECT_EQ(hits[k].tag, k);
    }
  }
}

TEST(RtInstances, SkipsInactiveInstances) {
  const Blas blas = buildQuad();
  const BlasInput nothing;
  const Blas empty = std::move(BlasBuilder(quintet::test::testContext()).build({&nothing, 1})[0]);
  mat4 nan = translation(0, -1);
  nan[3][0] = std::numeric_limits<float>::quiet_NaN();
  const std::vector<InstanceInput> instances{{.worldFromObject = nan, .blas = &blas},
                                             {.worldFromObject = mat4(0.0f), .blas = &blas},
                                             {.worldFromObject = glm::scale(mat4(1.0f), vec3(1, 0, 1)), .blas = &blas},
                                             {.worldFromObject = translation(0, -1), .blas = &empty},
                                             {.worldFromObject = translation(0, -1), .blas = &blas, .mask = 0},
                                             {.worldFromObject = translation(0, -7), .blas = &blas, .customIndex = 9}};
  Tlas tlas(quintet::test::testContext(), 6);
  const SbtContents contents = contentsOf({hitRecord(kTriangleHit, {.map = blas.primitiveMap(0)})});
  for (const bool keepOrder : {false, true}) {
    tlas.keepInputOrder(keepOrder);
    tlas.buildAndWait(instances);
    const auto hits = traceRays(tlas, contents, {{.origin = {0.5f, -0.25f, 0}}});
    EXPECT_FLOAT_EQ(hits[0].t, 7.0f);
    EXPECT_EQ(hits[0].custom, 9u);
    tlas.buildAndWait(std::span(instances).first(5));
    EXPECT_LT(traceRays(tlas, contents, {{.origin = {0.5f, -0.25f, 0}}})[0].t, 0.0f);
  }
}

// Submits ten frames without waiting. Each rebuilds the TLAS and traces into its own buffer.
TEST(RtInstances, RebuildsWhileFramesAreInFlight) {
  const Blas blas = buildQuad();
  constexpr std::uint32_t kInstances = 200, kFrames = 10;
  Tlas tlas(quintet::test::testContext(), kInstances);
  testSet().setAccelerationStructure(tlas.handle());
  const Pipeline& pipeline = testPipeline();
  const ShaderBindingTable table(quintet::test::testContext(), pipeline,
                                 contentsOf({hitRecord(kTriangleHit, {.map = blas.primitiveMap(0)})}), "table");
  std::vector<Ray> rays;
  for (std::uint32_t k = 0; k < kInstances; ++k) rays.push_back({.origin = {3.0f * static_cast<float>(k), -0.5f, 0}});
  const gpu::Buffer rayBuffer = gpu::makeBufferOf(quintet::test::testContext(), rays, 0, "rays");
  std::vector<gpu::Buffer> hits;
  const auto depthOf = [](std::uint32_t frame, std::uint32_t k) {
    return 1.0f + static_cast<float>((frame * 7 + k) % 50);
  };
  for (std::uint32_t frame = 0; frame < kFrames; ++frame)
    hits.push_back(gpu::Buffer(quintet::test::testContext(), {.size = kInstances * sizeof(Hit), .name = "hits"}));

  for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
    std::vector<InstanceInput> instances;
    for (std::uint32_t k = 0; k < kInstances; ++k)
      instances.push_back({.worldFromObject = translation(3.0f * static_cast<float>(k), -depthOf(frame, k)),
                           .blas = &blas,
                           .customIndex = k});
    struct {
      VkDeviceAddress rays, hits;
      std::uint32_t count, flags, mask, recordOffset, recordStride, missIndex;
    } const launch{rayBuffer.address(), hits[frame].address(), kInstances, 0, 0xFF, 0, 1, 0};
    quintet::test::testContext().submit([&](gpu::Commands& commands) {
      tlas.build(commands, instances);
      trace(commands, pipeline, table, std::as_bytes(std::span(&launch, 1)), kInstances, 1);
    });
  }
  quintet::test::testContext().wait(quintet::test::testContext().submitted());
  for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
    const auto result = hits[frame].downloadAs<Hit>(kInstances);
    for (std::uint32_t k = 0; k < kInstances; ++k) {
      ASSERT_NEAR(result[k].t, depthOf(frame, k), 1e-3f) << "frame " << frame << " instance " << k;
      ASSERT_EQ(result[k].custom, k);
    }
  }
}

TEST(RtInstances, RejectsTooManyInstancesAndTooLargeFields) {
  const Blas blas = buildQuad();
  Tlas tlas(quintet::test::testContext(), 1);
  const std::vector<InstanceInput> two(2, InstanceInput{.blas = &blas});
  EXPECT_THROW(tlas.buildAndWait(two), UsageError);
  for (const InstanceInput& instance :
       {InstanceInput{.blas = &blas, .customIndex = 1u << 24}, InstanceInput{.blas = &blas, .mask = 256},
        InstanceInput{.blas = &blas, .recordOffset = 1u << 24}})
    EXPECT_THROW(tlas.buildAndWait({&instance, 1}), UsageError);
  EXPECT_THROW(Tlas(quintet::test::testContext(), ~0u), UsageError);
}

}  // namespace
}  // namespace quintet::rt::test
