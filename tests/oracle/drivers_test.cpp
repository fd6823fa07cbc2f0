// SPDX-License-Identifier: Apache-2.0
// Acceleration structures and pipeline caches of drivers without the workarounds of rt::BlasBuilder (suite BareDriver)
// and with them (suite Workarounds).
#include <algorithm>
#include <limits>
#include <random>

#include "bare.h"
#include "checks.h"
#include "child.h"
#include "gpu/error.h"
#include "harness.h"
#include "probe.h"

namespace quintet::oracle::drivers_test {
namespace {

// ---- Build ranges

// Returns triangles at x = 0, 4, 8, …
std::vector<vec3> rowOfTriangles(std::uint32_t count) {
  std::vector<vec3> positions;
  for (std::uint32_t k = 0; k < count; ++k)
    for (const vec3& p : triangleAt(4.0f * static_cast<float>(k), 0, 0).positions) positions.push_back(p);
  return positions;
}

std::vector<ProbeHit> traceRow(VkDeviceAddress blas, std::uint32_t count, std::uint32_t group = kProbeTriangles) {
  const BareStructure tlas({bareInstance(blas, group)});
  std::vector<ProbeRay> rays;
  for (std::uint32_t k = 0; k < count; ++k) rays.push_back({.origin = {4.0f * static_cast<float>(k), 0, 2}});
  return traceProbe(tlas.handle(), rays);
}

// Selects triangle 2 of 6 with `firstVertex`. If it is applied twice, the result is triangle 4.
TEST(BareDriver, AppliesFirstVertexOnce) {
  Checks checks;
  for (const bool indexed : {false, true}) {
    BareGeometry geometry{.positions = rowOfTriangles(6), .primitiveCount = 1, .firstVertex = 6};
    if (indexed) geometry.indices = {0, 1, 2};
    const BareStructure blas({geometry});
    const auto hits = traceRow(blas.address(), 6);
    for (std::uint32_t k = 0; k < 6; ++k) {
      const std::uint32_t right = k == 2 ? kHit : kMissed, twice = k == 4 ? kHit : kMissed;
      checks.quirk(hits[k].end, right, twice, "{}, triangle {}", indexed ? "indexed" : "not indexed", k);
    }
  }
  checks.done(kFirstVertexTwice);
}

// The library uses firstVertex 0, and offsets in the address or the primitiveOffset of the range.
TEST(Workarounds, AppliesPrimitiveOffsets) {
  Checks checks;
  for (const bool indexed : {false, true}) {
    BareGeometry geometry{.positions = rowOfTriangles(6), .primitiveCount = 1};
    geometry.primitiveOffset = indexed ? 2 * 12 : 6 * sizeof(vec3);
    if (indexed)
      for (std::uint32_t k = 0; k < 18; ++k) geometry.indices.push_back(k);
    const BareStructure blas({geometry});
    const auto hits = traceRow(blas.address(), 6);
    for (std::uint32_t k = 0; k < 6; ++k)
      checks.equal(hits[k].end, k == 2 ? kHit : kMissed, "{}, triangle {}", indexed ? "indexed" : "not indexed", k);
  }
  checks.done();
}

// ---- Inactive primitives: x of their vertices (or of their minimum) is NaN

constexpr std::uint32_t kRow = 16;
constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();
bool inactive(std::uint32_t k) { return k % 5 == 1; }

std::vector<vec3> rowWithHoles() {
  std::vector<vec3> positions = rowOfTriangles(kRow);
  for (std::uint32_t k = 0; k < positions.size(); ++k)
    if (inactive(k / 3)) positions[k] = vec3(kNotANumber);
  return positions;
}
std::vector<Bounds3> boxesWithHoles() {
  std::vector<Bounds3> boxes;
  for (std::uint32_t k = 0; k < kRow; ++k) {
    boxes.push_back(boxAt({3.0f * static_cast<float>(k), 0, 0}));
    if (inactive(k)) boxes.back() = {vec3(kNotANumber), vec3(kNotANumber)};
  }
  return boxes;
}

TEST(BareDriver, KeepsPrimitivesNextToInactiveOnes) {
  Checks checks;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t k = 0; k < 3 * kRow; ++k) indices.push_back(k);
  const BareStructure triangles(
      {BareGeometry{.positions = rowWithHoles(), .indices = indices, .primitiveCount = kRow}});
  const auto hits = traceRow(triangles.address(), kRow);
  for (std::uint32_t k = 0; k < kRow; ++k) {
    if (inactive(k))
      checks.equal(hits[k].end, kMissed, "inactive triangle {}", k);
    else
      checks.quirkThat(hits[k].end == kHit && hits[k].primitive == k, "triangle {}", k);
  }
  const BareStructure boxes({BareGeometry{.boxes = boxesWithHoles(), .primitiveCount = kRow}});
  const BareStructure tlas({bareInstance(boxes.address(), kProbeBoxes)});
  std::vector<ProbeRay> rays;
  for (std::uint32_t k = 0; k < kRow; ++k) rays.push_back({.origin = {3.0f * static_cast<float>(k), 0, 2}});
  const auto boxHits = traceProbe(tlas.handle(), rays);
  for (std::uint32_t k = 0; k < kRow; ++k) {
    if (inactive(k))
      checks.equal(boxHits[k].end, kMissed, "inactive box {}", k);
    else
      checks.quirkThat(boxHits[k].end == kHit && boxHits[k].primitive == k, "box {}", k);
  }
  checks.done(kInactiveTakesOthers);
}

// The library removes inactive primitives before the build and keeps a map.
TEST(Workarounds, KeepsPrimitivesNextToInactiveOnes) {
  Scene scene;
  Triangles triangles{.positions = rowWithHoles()};
  for (std::uint32_t k = 0; k < kRow; ++k) triangles.indices.push_back(uvec3(3 * k, 3 * k + 1, 3 * k + 2));
  scene.add(scene.addBlas({triangles}));
  std::vector<ProbeRay> rays;
  for (std::uint32_t k = 0; k < kRow; ++k) rays.push_back({.origin = {4.0f * static_cast<float>(k), 0, 2}});
  const auto hits = traceProbe(scene, rays);
  Checks checks;
  for (std::uint32_t k = 0, active = 0; k < kRow; ++k) {
    checks.equal(hits[k].end, inactive(k) ? kMissed : kHit, "triangle {}", k);
    if (!inactive(k)) checks.equal(hits[k].primitive, active++, "triangle {}: position in the build", k);
  }
  checks.done();
}

// An instance without a BLAS is inactive and does not affect others. No ray hits one whose mask is 0.
enum class Hidden { withoutBlas, withoutMask };
void traceNextToHidden(Hidden hidden) {
  const BareStructure blas({BareGeometry{.positions = rowOfTriangles(1), .primitiveCount = 1}});
  std::vector<VkAccelerationStructureInstanceKHR> instances;
  std::vector<ProbeRay> rays;
  for (std::uint32_t k = 0; k < kRow; ++k) {
    instances.push_back(bareInstance(inactive(k) && hidden == Hidden::withoutBlas ? 0 : blas.address()));
    instances.back().transform.matrix[0][3] = 4.0f * static_cast<float>(k);
    if (inactive(k) && hidden == Hidden::withoutMask) instances.back().mask = 0;
    rays.push_back({.origin = {4.0f * static_cast<float>(k), 0, 2}});
  }
  const BareStructure tlas(instances);
  const auto hits = traceProbe(tlas.handle(), rays);
  Checks checks;
  for (std::uint32_t k = 0; k < kRow; ++k) {
    checks.equal(hits[k].end, inactive(k) ? kMissed : kHit, "instance {}", k);
    if (!inactive(k)) checks.equal(hits[k].instance, k, "instance {}", k);
  }
  checks.done();
}

TEST(BareDriver, DISABLED_KeepsInstancesNextToInactiveOnes) { traceNextToHidden(Hidden::withoutBlas); }
TEST(BareDriver, DISABLED_KeepsInstancesNextToThoseWithoutMask) { traceNextToHidden(Hidden::withoutMask); }

// Some drivers crash.
TEST(BareDriver, KeepsInstancesNextToHiddenOnes) {
  Checks checks;
  for (const char* test : {"BareDriver.DISABLED_KeepsInstancesNextToInactiveOnes",
                           "BareDriver.DISABLED_KeepsInstancesNextToThoseWithoutMask"}) {
    const ChildEnd end = runInChild(test);
    checks.quirkThat(end == ChildEnd::passed, "{}: the process {}", test,
                     end == ChildEnd::crashed ? "crashed" : "failed");
  }
  checks.done(kHiddenInstancesCrash);
}

// ---- Order of primitives. All boxes are on one ray, and the any-hit shader ignores them, so each is a candidate. The
// traversal visits the nearer child of each node first, so the order of the candidates shows which boxes share a node.

constexpr std::uint32_t kMostBoxes = 12, kRoom = 64;
struct Order {
  std::uint32_t count;
  std::uint32_t primitives[kRoom];
};
constexpr char kOrderCommon[] = "struct Input { float z; }; struct Output { uint count; uint primitives[64]; };\n";
constexpr char kOrderRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT uint nothing;
void main() { traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 200.0), 0.0, vec3(0.0, 0.0, -1.0), 1000.0, 0); }
)";
constexpr char kOrderIntersection[] = R"(
void main() {
  uint n = atomicAdd(launch.outputs.at[launchIndex()].count, 1u);
  if (n < 64u) launch.outputs.at[launchIndex()].primitives[n] = gl_PrimitiveID;
}
)";

// Computes the order of the candidates for a tree that halves the range [first, last], from their distances.
void meetHalves(const std::vector<float>& distances, std::size_t first, std::size_t last,
                std::vector<std::uint32_t>& order) {
  if (first == last) return order.push_back(static_cast<std::uint32_t>(first));
  const std::size_t middle = (first + last) / 2;  // last index of the left half
  const auto at = distances.begin();
  const bool leftFirst =
      *std::min_element(at + first, at + middle + 1) < *std::min_element(at + middle + 1, at + last + 1);
  if (leftFirst) meetHalves(distances, first, middle, order);
  meetHalves(distances, middle + 1, last, order);
  if (!leftFirst) meetHalves(distances, first, middle, order);
}

TEST(BareDriver, SortsPrimitives) {
  const Program program({.common = kOrderCommon,
                         .rayGeneration = kOrderRayGeneration,
                         .miss = {"void main() {}"},
                         .hit = {{.intersection = kOrderIntersection}}});
  std::mt19937 random(11);
  std::size_t asHalved = 0, cases = 0;
  Checks checks;
  for (std::uint32_t n = 3; n <= kMostBoxes; ++n)
    for (int repeat = 0; repeat < 4; ++repeat, ++cases) {
      std::vector<float> distances(n);
      for (std::uint32_t k = 0; k < n; ++k) distances[k] = static_cast<float>(10 * k);
      std::ranges::shuffle(distances, random);
      BareGeometry boxes{.primitiveCount = n};
      for (const float distance : distances) boxes.boxes.push_back({{-1, -1, 98 - distance}, {1, 1, 100 - distance}});
      const BareStructure blas({boxes}), tlas({bareInstance(blas.address())});
      const Order order = run<Order>(program, tlas.handle(), std::vector<float>{0})[0];
      std::vector<std::uint32_t> met(order.primitives, order.primitives + std::min(order.count, kRoom)), halves;
      meetHalves(distances, 0, n - 1, halves);
      asHalved += met == halves;
      for (std::uint32_t k = 0; k < n; ++k)
        checks.that(std::ranges::count(met, k) >= 1, "{} boxes: box {} is a candidate", n, k);
    }
  checks.quirkThat(asHalved < cases, "{} of {} orders are those of a tree that halves the input", asHalved, cases);
  checks.done(kKeepsOrder);
}

// ---- Sizes

TEST(BareDriver, SavesMemoryByCompaction) {
  const BareStructure blas({BareGeometry{.positions = rowOfTriangles(5000), .primitiveCount = 5000}}, true);
  Checks checks;
  checks.that(blas.compactedSize() > 0 && blas.compactedSize() <= blas.size(), "{} of {} bytes", blas.compactedSize(),
              blas.size());
  checks.quirkThat(blas.compactedSize() < blas.size(), "{} of {} bytes", blas.compactedSize(), blas.size());
  checks.done(kNoCompaction);
}

constexpr char kStoreIndex[] = "void main() { launch.outputs.at[launchIndex()].a = launchIndex(); }\n";

TEST(BareDriver, StoresPipelinesInThePipelineCache) {
  const VolkDeviceTable& vk = test::testContext().vk();
  const VkDevice device = test::testContext().device();
  VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  VkPipelineCache cache = VK_NULL_HANDLE;
  gpu::check(vk.vkCreatePipelineCache(device, &info, nullptr, &cache), "create a cache");
  const std::vector<BareStage> stages = {
      {VK_SHADER_STAGE_RAYGEN_BIT_KHR,
       compileStage(shader::Stage::rayGeneration, "struct Input { uint a; }; struct Output { uint a; };",
                    kStoreIndex)}};
  std::size_t size = 0;
  {
    const BarePipeline pipeline(stages, {{.general = 0}}, 0, {}, cache);
    gpu::check(vk.vkGetPipelineCacheData(device, cache, &size, nullptr), "ask for its size");
  }
  vk.vkDestroyPipelineCache(device, cache, nullptr);
  Checks checks;
  constexpr std::size_t kHeader = 32;  // VkPipelineCacheHeaderVersionOne
  checks.that(size >= kHeader, "{} bytes", size);
  checks.quirkThat(size > kHeader, "{} bytes", size);
  checks.done(kEmptyPipelineCache);
}

}  // namespace
}  // namespace quintet::oracle::drivers_test
