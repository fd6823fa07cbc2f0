// SPDX-License-Identifier: Apache-2.0
// Refits of moved vertices.
#include "base/error.h"
#include "rt/blas_refit.h"
#include "rt_test_support.h"

namespace quintet::rt::test {
namespace {

TEST(RtRefit, MovesTriangles) {
  Mesh mesh = randomMesh(500, 41, 0.3f);
  BlasInput input{.geometries = {mesh.geometry()}, .options = {.allowUpdate = true, .name = "moving"}};
  SingleBlas scene(input);
  const std::vector<Ray> rays = randomRays(1500, 42);
  expectSameHits(scene.trace(rays), mesh, rays);
  BlasBuilder builder(quintet::test::testContext());
  for (int step = 1; step <= 3; ++step) {
    for (vec3& p : mesh.positions) p = vec3(p.y, 1.0f - p.x, p.z * 0.9f);
    input.geometries = {mesh.geometry()};
    builder.refit(scene.blas, input);
    scene.buildTlas();
    expectSameHits(scene.trace(rays), mesh, rays);
  }
  EXPECT_LE(scene.blas.bounds().max.z, 0.9f);
}

TEST(RtRefit, SkipsInactivePrimitives) {
  Mesh mesh = randomMesh(60, 43, 0.8f);
  mesh.positions[9].x = std::numeric_limits<float>::quiet_NaN();  // triangle 3
  BlasInput input{.geometries = {mesh.geometry()}, .options = {.allowUpdate = true, .name = "holes"}};
  SingleBlas scene(input);
  mesh.positions[9].x = 0.5f;
  for (vec3& p : mesh.positions) p.z += 0.1f;
  input.geometries = {mesh.geometry()};
  BlasBuilder(quintet::test::testContext()).refit(scene.blas, input);
  scene.buildTlas();
  Mesh expected = mesh;
  expected.triangles[3] = uvec3(0);
  const std::vector<Ray> rays = randomRays(1500, 44);
  expectSameHits(scene.trace(rays), expected, rays);
}

TEST(RtRefit, RejectsDifferentCountsAndNonFiniteVertices) {
  const Mesh mesh = randomMesh(10, 45), more = randomMesh(11, 45);
  BlasInput input{.geometries = {mesh.geometry()}, .options = {.allowUpdate = true, .name = "strict"}};
  SingleBlas scene(input);
  BlasBuilder builder(quintet::test::testContext());
  EXPECT_THROW(builder.refit(scene.blas, {.geometries = {more.geometry()}, .options = {}}), UsageError);
  EXPECT_THROW(builder.refit(scene.blas, {.geometries = {}, .options = {}}), UsageError);
  Mesh broken = mesh;
  broken.positions[4].y = std::numeric_limits<float>::infinity();
  EXPECT_THROW(builder.refit(scene.blas, {.geometries = {broken.geometry()}, .options = {}}), UsageError);
  input.options.allowUpdate = false;
  SingleBlas fixed(input);
  EXPECT_THROW(builder.refit(fixed.blas, input), UsageError);
}

// The device has moved the vertices; the host does not read them.
TEST(RtRefit, FollowsVerticesOnTheDevice) {
  gpu::Context& context = quintet::test::testContext();
  Mesh mesh = randomMesh(500, 46, 0.3f);
  constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
  gpu::Buffer positions = gpu::makeBufferOf(context, mesh.positions, kUsage, "positions");
  const gpu::Buffer triangles = gpu::makeBufferOf(context, mesh.triangles, kUsage, "triangles");
  BlasInput input{.geometries = {mesh.geometry()}, .options = {.allowUpdate = true, .name = "on the device"}};
  input.geometries[0].positionsAddress = positions.address();
  input.geometries[0].trianglesAddress = triangles.address();
  SingleBlas scene(input);
  const BlasRefit refit(context, scene.blas, input);
  const std::vector<Ray> rays = randomRays(1500, 47);
  for (int step = 1; step <= 2; ++step) {
    for (vec3& p : mesh.positions) p = vec3(p.y, 1.0f - p.x, p.z * 0.9f);
    positions.upload(std::as_bytes(std::span(mesh.positions)));
    context.submitAndWait([&](gpu::Commands& commands) { refit.record(commands); });
    scene.buildTlas();
    expectSameHits(scene.trace(rays), mesh, rays);
  }
  input.geometries.push_back(input.geometries[0]);
  EXPECT_THROW(BlasRefit(context, scene.blas, input), UsageError);
  input.geometries.pop_back();
  input.options.allowUpdate = false;
  SingleBlas fixed(input);
  EXPECT_THROW(BlasRefit(context, fixed.blas, input), UsageError);
}

}  // namespace
}  // namespace quintet::rt::test
