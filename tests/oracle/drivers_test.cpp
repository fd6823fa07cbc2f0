// What drivers make of acceleration structures, without the workarounds of rt::BlasBuilder (suite BareDriver), and with
// them (suite Workarounds). Pipeline caches, too.
#include <limits>

#include "bare.h"
#include "checks.h"
#include "gpu/error.h"
#include "harness.h"
#include "probe.h"

namespace quintet::oracle {
namespace {

// ---- Build ranges.

// Triangles at x = 0, 4, 8, …
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

// Triangle 2 of 6 alone, by `firstVertex`. Applied twice it is triangle 4.
TEST(BareDriver, FirstVertexOfABuildRange) {
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

// What the library does instead: firstVertex 0, offsets in the address or in bytes of the range.
TEST(Workarounds, PrimitiveOffsetOfABuildRange) {
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

// ---- Inactive primitives: the x of their vertices (or of their minimum) is not a number.

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

TEST(BareDriver, InactivePrimitives) {
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

// The library drops them before the build and keeps a map.
TEST(Workarounds, InactivePrimitives) {
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

// An instance that refers to nothing is inactive; the others are met.
TEST(BareDriver, InactiveInstances) {
  const BareStructure blas({BareGeometry{.positions = rowOfTriangles(1), .primitiveCount = 1}});
  std::vector<VkAccelerationStructureInstanceKHR> instances;
  std::vector<ProbeRay> rays;
  for (std::uint32_t k = 0; k < kRow; ++k) {
    instances.push_back(bareInstance(inactive(k) ? 0 : blas.address()));
    instances.back().transform.matrix[0][3] = 4.0f * static_cast<float>(k);
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

// ---- Sizes.

TEST(BareDriver, CompactionSavesMemory) {
  const BareStructure blas({BareGeometry{.positions = rowOfTriangles(5000), .primitiveCount = 5000}}, true);
  Checks checks;
  checks.that(blas.compactedSize() > 0 && blas.compactedSize() <= blas.size(), "{} of {} bytes", blas.compactedSize(),
              blas.size());
  checks.quirkThat(blas.compactedSize() < blas.size(), "{} of {} bytes", blas.compactedSize(), blas.size());
  checks.done(kNoCompaction);
}

constexpr char kStoreIndex[] = "void main() { launch.outputs.at[launchIndex()].a = launchIndex(); }\n";

TEST(BareDriver, PipelineCacheHoldsThePipeline) {
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
}  // namespace quintet::oracle
