// What drivers themselves do, without the workarounds of the library (suite BareDriver), and the same with them
// (suite Workarounds).
#include <limits>

#include "bare.h"
#include "checks.h"
#include "child.h"
#include "gpu/error.h"
#include "harness.h"
#include "probe.h"

namespace quintet::oracle {
namespace {

// ---- Two hit groups share an intersection stage; their any-hit shaders differ.

constexpr char kGroupCommon[] = "struct Input { float x; }; struct Output { uint end; };\n";
constexpr char kGroupRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT uint result;
void main() {
  result = 0u;
  traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, vec3(launch.inputs.at[launchIndex()].x, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 0);
  launch.outputs.at[launchIndex()].end = result;
}
)";
constexpr char kGroupMiss[] = "layout(location = 0) rayPayloadInEXT uint result;\nvoid main() { result = 2u; }\n";
constexpr char kGroupHit[] = "layout(location = 0) rayPayloadInEXT uint result;\nvoid main() { result = 1u; }\n";
constexpr char kGroupIntersection[] =
    "hitAttributeEXT vec2 a;\nvoid main() { a = vec2(0.0); reportIntersectionEXT(gl_RayTminEXT + 1.0, 0u); }\n";
constexpr char kIgnoreAll[] = "void main() { ignoreIntersectionEXT; }\n";
constexpr char kAcceptAll[] = "void main() {}\n";

// Two boxes, at x = 0 with record 0 and at x = 10 with record 1.
Scene twoBoxes() {
  Scene scene;
  const std::size_t blas = scene.addBlas({Boxes{{boxAt({0, 0, 0})}, false}});
  scene.add(blas);
  scene.add(blas, {.worldFromObject = glm::translate(mat4(1.0f), vec3(10, 0, 0)), .recordOffset = 1});
  return scene;
}

std::vector<std::uint32_t> traceSharedStage(bool firstIgnores) {
  const auto stage = [](VkShaderStageFlagBits bit, shader::Stage kind, const char* text) {
    return BareStage{bit, compileStage(kind, kGroupCommon, text)};
  };
  const std::vector<BareStage> stages = {
      stage(VK_SHADER_STAGE_RAYGEN_BIT_KHR, shader::Stage::rayGeneration, kGroupRayGeneration),
      stage(VK_SHADER_STAGE_MISS_BIT_KHR, shader::Stage::miss, kGroupMiss),
      stage(VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, shader::Stage::closestHit, kGroupHit),
      stage(VK_SHADER_STAGE_INTERSECTION_BIT_KHR, shader::Stage::intersection, kGroupIntersection),
      stage(VK_SHADER_STAGE_ANY_HIT_BIT_KHR, shader::Stage::anyHit, kIgnoreAll),
      stage(VK_SHADER_STAGE_ANY_HIT_BIT_KHR, shader::Stage::anyHit, kAcceptAll)};
  const std::uint32_t first = firstIgnores ? 4 : 5, second = firstIgnores ? 5 : 4;
  const BarePipeline pipeline(stages, {{.general = 0},
                                       {.general = 1},
                                       {.closestHit = 2, .anyHit = first, .intersection = 3},
                                       {.closestHit = 2, .anyHit = second, .intersection = 3}});
  rt::SbtContents contents;
  contents.miss = {{1, {}}};
  contents.hit = {{2, {}}, {3, {}}};
  const BareTable table(contents, pipeline.groupHandles(4));
  const Scene scene = twoBoxes();
  const float inputs[] = {0, 10};
  const auto bytes =
      bareTrace(pipeline.handle(), table.regions, scene.handle(), std::as_bytes(std::span(inputs)), 2, 4);
  std::vector<std::uint32_t> ends(2);
  std::memcpy(ends.data(), bytes.data(), 8);
  return ends;
}

TEST(BareDriver, GroupsThatShareAnIntersectionStage) {
  Checks checks;
  for (const bool firstIgnores : {true, false}) {
    const auto ends = traceSharedStage(firstIgnores);
    const std::uint32_t first = firstIgnores ? kMissed : kHit, second = firstIgnores ? kHit : kMissed;
    checks.equal(ends[0], first, "first group, it ignores: {}", firstIgnores);
    checks.quirk(ends[1], second, first, "second group, first ignores: {}", firstIgnores);
  }
  checks.done(kSharedAnyHit);
}

// rt::Pipeline makes an entry of its own for each pair of intersection and any-hit shader.
TEST(Workarounds, GroupsThatShareAnIntersectionStage) {
  Checks checks;
  const Scene scene = twoBoxes();
  for (const bool firstIgnores : {true, false}) {
    const HitGroupText ignores{.closestHit = kGroupHit, .anyHit = kIgnoreAll, .intersection = kGroupIntersection};
    const HitGroupText accepts{.closestHit = kGroupHit, .anyHit = kAcceptAll, .intersection = kGroupIntersection};
    const Program program({.common = kGroupCommon,
                           .rayGeneration = kGroupRayGeneration,
                           .miss = {kGroupMiss},
                           .hit = {firstIgnores ? ignores : accepts, firstIgnores ? accepts : ignores}});
    const auto ends = run<std::uint32_t>(program, scene, std::vector<float>{0, 10});
    checks.equal(ends[0], firstIgnores ? kMissed : kHit, "first group, it ignores: {}", firstIgnores);
    checks.equal(ends[1], firstIgnores ? kHit : kMissed, "second group, first ignores: {}", firstIgnores);
  }
  checks.done();
}

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

TEST(BareDriver, PipelineCacheHoldsThePipeline) {
  const VolkDeviceTable& vk = test::testContext().vk();
  const VkDevice device = test::testContext().device();
  VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  VkPipelineCache cache = VK_NULL_HANDLE;
  gpu::check(vk.vkCreatePipelineCache(device, &info, nullptr, &cache), "create a cache");
  const std::vector<BareStage> stages = {
      {VK_SHADER_STAGE_RAYGEN_BIT_KHR, compileStage(shader::Stage::rayGeneration, kGroupCommon, kGroupRayGeneration)}};
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

// ---- Pipeline libraries.

// Hit and miss groups from a library; the ray generation stage in the pipeline, or in a library too.
void traceWithLibraries(bool rayGenerationToo) {
  const auto compiled = [](VkShaderStageFlagBits bit, shader::Stage kind, const char* text) {
    return BareStage{bit, compileStage(kind, kGroupCommon, text)};
  };
  const BareStage rayGeneration =
      compiled(VK_SHADER_STAGE_RAYGEN_BIT_KHR, shader::Stage::rayGeneration, kGroupRayGeneration);
  const std::vector<BareStage> others = {
      compiled(VK_SHADER_STAGE_MISS_BIT_KHR, shader::Stage::miss, kGroupMiss),
      compiled(VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, shader::Stage::closestHit, kGroupHit),
      compiled(VK_SHADER_STAGE_INTERSECTION_BIT_KHR, shader::Stage::intersection, kGroupIntersection)};
  const BarePipeline first({rayGeneration}, {{.general = 0}}, VK_PIPELINE_CREATE_LIBRARY_BIT_KHR);
  const BarePipeline rest(others, {{.general = 0}, {.closestHit = 1, .intersection = 2}},
                          VK_PIPELINE_CREATE_LIBRARY_BIT_KHR);
  std::optional<BarePipeline> pipeline;
  if (rayGenerationToo)
    pipeline.emplace(std::vector<BareStage>{}, std::vector<BareGroup>{}, 0u,
                     std::vector<VkPipeline>{first.handle(), rest.handle()});
  else
    pipeline.emplace(std::vector<BareStage>{rayGeneration}, std::vector<BareGroup>{{.general = 0}}, 0u,
                     std::vector<VkPipeline>{rest.handle()});
  rt::SbtContents contents;
  contents.miss = {{1, {}}};
  contents.hit = {{2, {}}, {2, {}}};
  const BareTable table(contents, pipeline->groupHandles(3));
  const Scene scene = twoBoxes();
  const float inputs[] = {0, 10, 20};
  const auto bytes =
      bareTrace(pipeline->handle(), table.regions, scene.handle(), std::as_bytes(std::span(inputs)), 3, 4);
  std::uint32_t ends[3];
  std::memcpy(ends, bytes.data(), sizeof ends);
  Checks checks;
  for (int k = 0; k < 3; ++k) checks.equal(ends[k], k < 2 ? kHit : kMissed, "ray {}", k);
  checks.done();
}

TEST(BareDriver, DISABLED_EveryStageFromLibraries) { traceWithLibraries(true); }
TEST(Workarounds, RayGenerationStageBesideLibraries) { traceWithLibraries(false); }

TEST(BareDriver, EveryStageFromLibraries) {
  const ChildEnd end = runInChild("BareDriver.DISABLED_EveryStageFromLibraries");
  Checks checks;
  checks.quirkThat(end == ChildEnd::passed, "the process {}", end == ChildEnd::crashed ? "crashed" : "failed");
  checks.done(kLibrariesCrash);
}

}  // namespace
}  // namespace quintet::oracle
