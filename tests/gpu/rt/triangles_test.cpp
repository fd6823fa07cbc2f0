// SPDX-License-Identifier: Apache-2.0
// Triangles: known rays, comparison with brute force, inactive primitives, several geometries and builds.
#include "base/error.h"
#include "rt_test_support.h"

namespace quintet::rt::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(RtTriangles, HitsAQuad) {
  const Mesh mesh = quad(-3);
  SingleBlas scene({.geometries = {mesh.geometry()}, .options = {.name = "quad"}});
  const std::vector<Ray> rays{
      {.origin = {0.5f, -0.5f, 0}},                           // below the diagonal, triangle 0
      {.origin = {-0.5f, 0.5f, 0}},                           // above the diagonal, triangle 1
      {.origin = {1.5f, 0, 0}},                               // beside the quad
      {.origin = {0.5f, -0.5f, 0}, .tMax = 2.9f},             // too short
      {.origin = {0.5f, -0.5f, 0}, .tMin = 3.1f},             // starts behind
      {.origin = {0.5f, -0.5f, -6}, .direction = {0, 0, 2}},  // from the back, direction of length 2
  };
  const std::vector<Hit> hits = scene.trace(rays);
  EXPECT_FLOAT_EQ(hits[0].t, 3.0f);
  EXPECT_EQ(hits[0].primitive, 0u);
  EXPECT_EQ(hits[0].kind, 0xFEu);  // front face: counterclockwise as seen by the ray
  EXPECT_NEAR(hits[0].u, 0.5f, 1e-6f);
  EXPECT_NEAR(hits[0].v, 0.25f, 1e-6f);
  EXPECT_FLOAT_EQ(hits[1].t, 3.0f);
  EXPECT_EQ(hits[1].primitive, 1u);
  for (const std::size_t miss : {2, 3, 4}) EXPECT_EQ(hits[miss].t, -1.0f) << miss;
  EXPECT_FLOAT_EQ(hits[5].t, 1.5f);
  EXPECT_EQ(hits[5].kind, 0xFFu);
}

TEST(RtTriangles, MatchesBruteForceForRandomMeshes) {
  for (const std::size_t count : {1u, 2u, 3u, 7u, 501u, 2000u}) {
    const Mesh mesh = randomMesh(count, static_cast<std::uint32_t>(count), count < 10 ? 1.5f : 0.2f);
    SingleBlas scene({.geometries = {mesh.geometry()}, .options = {.name = "random"}});
    const std::vector<Ray> rays = randomRays(3000, 7);
    expectSameHits(scene.trace(rays), mesh, rays);
  }
}

TEST(RtTriangles, GivesTheSameHitsInInputOrder) {
  const Mesh mesh = randomMesh(600, 3, 0.3f);
  BlasInput input{.geometries = {mesh.geometry()}, .options = {.keepInputOrder = true, .name = "unordered"}};
  SingleBlas scene(input);
  EXPECT_EQ(scene.blas.primitiveMap(0), 0u);
  const std::vector<Ray> rays = randomRays(2000, 8);
  expectSameHits(scene.trace(rays), mesh, rays);
}

TEST(RtTriangles, SkipsNonFinitePrimitivesAndKeepsIds) {
  Mesh mesh = randomMesh(400, 11, 0.4f);
  for (const std::size_t k : {0u, 5u, 399u}) mesh.positions[mesh.triangles[k][k % 3]].y = k == 5 ? kInfinity : kNan;
  mesh.triangles[7] = uvec3(21, 21, 21);  // degenerate, but active
  SingleBlas scene({.geometries = {mesh.geometry()}, .options = {.name = "holes"}});
  EXPECT_EQ(scene.blas.inactiveCount(), 3u);
  EXPECT_TRUE(isFinite(scene.blas.bounds().min) && isFinite(scene.blas.bounds().max));
  const std::vector<Ray> rays = randomRays(3000, 12);
  Mesh finite = mesh;
  for (vec3& p : finite.positions)
    if (!isFinite(p)) p = vec3(1e6f);
  for (const std::size_t k : {0u, 5u, 399u}) finite.triangles[k] = uvec3(0, 0, 0);
  expectSameHits(scene.trace(rays), finite, rays);
}

TEST(RtTriangles, SupportsGeometriesWithoutActivePrimitives) {
  Mesh none, inactive = quad(-1);
  for (vec3& p : inactive.positions) p.x = kNan;
  for (const BlasInput& input : {BlasInput{}, BlasInput{.geometries = {none.geometry()}, .options = {}},
                                 BlasInput{.geometries = {inactive.geometry(), none.geometry()}, .options = {}}}) {
    SingleBlas scene(input);
    EXPECT_TRUE(scene.blas.bounds().empty());
    EXPECT_EQ(scene.trace({Ray{}})[0].t, -1.0f);
  }
}

// Quads behind each other, one per geometry, two ray types, and an empty geometry in between.
TEST(RtTriangles, SelectsRecordsByGeometryAndRayType) {
  constexpr std::uint32_t kGeometries = 9, kRayTypes = 2;
  std::vector<Mesh> meshes;
  for (std::uint32_t g = 0; g < kGeometries; ++g) {
    Mesh mesh = quad(-1.0f - static_cast<float>(g));
    for (vec3& p : mesh.positions) p.x += 3.0f * static_cast<float>(g);
    if (g == 4) mesh.triangles.clear();
    meshes.push_back(std::move(mesh));
  }
  BlasInput input;
  for (const Mesh& mesh : meshes) input.geometries.push_back(mesh.geometry());
  SingleBlas scene(input);
  std::vector<SbtRecord> records(2,
                                 SbtRecord{SbtRecord::kUnusedGroup, {}});  // before the record offset of the instance
  for (std::uint32_t g = 0; g < kGeometries; ++g)
    for (std::uint32_t type = 0; type < kRayTypes; ++type)
      records.push_back(hitRecord(kTriangleHit, {.map = scene.blas.primitiveMap(g), .tag = 100 * type + g}));
  const SbtContents contents = contentsOf(records, {7, 8, 9});
  const InstanceInput instance{.blas = &scene.blas, .customIndex = 0xABCDEF, .recordOffset = 2};
  scene.tlas.buildAndWait({&instance, 1});

  std::vector<Ray> rays;
  for (std::uint32_t g = 0; g < kGeometries; ++g)
    rays.push_back({.origin = {3.0f * static_cast<float>(g) + 0.5f, -0.5f, 0}});
  for (std::uint32_t type = 0; type < kRayTypes; ++type) {
    const auto hits =
        traceRays(scene.tlas, contents, rays, {.recordOffset = type, .recordStride = kRayTypes, .missIndex = type + 1});
    for (std::uint32_t g = 0; g < kGeometries; ++g) {
      if (g == 4) {
        EXPECT_EQ(hits[g].t, -1.0f);
        EXPECT_EQ(hits[g].tag, 8 + type);
        continue;
      }
      EXPECT_FLOAT_EQ(hits[g].t, 1.0f + static_cast<float>(g));
      EXPECT_EQ(hits[g].geometry, g);
      EXPECT_EQ(hits[g].tag, 100 * type + g);
      EXPECT_EQ(hits[g].custom, 0xABCDEFu);
      EXPECT_EQ(hits[g].primitive, 0u);
    }
  }
}

TEST(RtTriangles, KeepsPrimitivesOfSeveralGeometries) {
  const Mesh mesh = randomMesh(1501, 21, 0.2f);
  const std::span all(mesh.triangles);
  BlasInput input;  // three geometries with shared positions
  for (const std::span part : {all.subspan(0, 400), all.subspan(400, 1000), all.subspan(1400, 101)})
    input.geometries.push_back({.positions = mesh.positions, .triangles = part});
  SingleBlas scene(input);
  const std::vector<Ray> rays = randomRays(3000, 22);
  std::vector<Hit> hits = scene.trace(rays);
  const std::uint32_t first[] = {0, 400, 1400};
  for (Hit& hit : hits) hit.primitive += first[hit.geometry];
  expectSameHits(hits, mesh, rays);
}

TEST(RtTriangles, BuildsManyStructuresWithASmallBudget) {
  std::vector<Mesh> meshes;
  std::vector<BlasInput> inputs;
  for (std::uint32_t k = 0; k < 40; ++k) meshes.push_back(randomMesh(50 + 10 * k, k, 0.5f));
  for (const Mesh& mesh : meshes) inputs.push_back({.geometries = {mesh.geometry()}, .options = {.name = "many"}});
  gpu::Context& context = quintet::test::testContext();
  BuildStatistics statistics;
  const std::vector<Blas> structures = BlasBuilder(context, 1024).build(inputs, &statistics);
  ASSERT_EQ(structures.size(), inputs.size());
  EXPECT_GE(statistics.batchCount, 2u);
  EXPECT_EQ(statistics.primitiveCount, 40u * 50 + 10 * (39 * 40 / 2));
  EXPECT_GT(statistics.bytes, 0u);
  const std::vector<Ray> rays = randomRays(500, 5);
  Tlas tlas(context, 1);
  for (const std::size_t k : {0u, 17u, 39u}) {
    const InstanceInput instance{.blas = &structures[k]};
    tlas.buildAndWait({&instance, 1});
    const SbtContents contents = contentsOf({hitRecord(kTriangleHit, {.map = structures[k].primitiveMap(0)})});
    expectSameHits(traceRays(tlas, contents, rays), meshes[k], rays);
  }
}

TEST(RtTriangles, CompactsWithoutChangingHits) {
  const Mesh mesh = randomMesh(3000, 31, 0.1f);
  const bool gains = !quintet::test::testContext().info().quirks.noCompaction;
  const std::vector<Ray> rays = randomRays(2000, 32);
  for (const bool compact : {true, false}) {
    SingleBlas scene({.geometries = {mesh.geometry()}, .options = {.compact = compact, .name = "compact"}});
    EXPECT_EQ(scene.blas.size() < scene.blas.builtSize(), compact && gains);
    expectSameHits(scene.trace(rays), mesh, rays);
  }
}

TEST(RtTriangles, RejectsMixedKinds) {
  const Mesh mesh = quad(0);
  const Bounds3 box{vec3(0), vec3(1)};
  const BlasInput input{.geometries = {mesh.geometry(), {.kind = GeometryKind::boxes, .boxes = {&box, 1}}},
                        .options = {}};
  EXPECT_THROW(BlasBuilder(quintet::test::testContext()).build({&input, 1}), UsageError);
}

}  // namespace
}  // namespace quintet::rt::test
