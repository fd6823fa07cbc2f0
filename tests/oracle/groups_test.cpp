// SPDX-License-Identifier: Apache-2.0
// Hit groups and pipelines without the workarounds of rt::Pipeline (suite BareDriver) and with them (suite
// Workarounds).
#include <optional>

#include "bare.h"
#include "checks.h"
#include "child.h"
#include "probe.h"

namespace quintet::oracle::groups_test {
namespace {

// ---- Two hit groups with the same intersection stage and different any-hit shaders

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

// Two boxes: at x = 0 with record 0, and at x = 10 with record 1.
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

TEST(BareDriver, RunsTheAnyHitShaderOfEachGroup) {
  Checks checks;
  for (const bool firstIgnores : {true, false}) {
    const auto ends = traceSharedStage(firstIgnores);
    const std::uint32_t first = firstIgnores ? kMissed : kHit, second = firstIgnores ? kHit : kMissed;
    checks.equal(ends[0], first, "first group, ignores: {}", firstIgnores);
    checks.quirk(ends[1], second, first, "second group, first ignores: {}", firstIgnores);
  }
  checks.done(kSharedAnyHit);
}

// rt::Pipeline creates a separate stage entry for each pair of intersection and any-hit shader.
TEST(Workarounds, RunsTheAnyHitShaderOfEachGroup) {
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
    checks.equal(ends[0], firstIgnores ? kMissed : kHit, "first group, ignores: {}", firstIgnores);
    checks.equal(ends[1], firstIgnores ? kHit : kMissed, "second group, first ignores: {}", firstIgnores);
  }
  checks.done();
}

// ---- Pipeline libraries

// Hit and miss groups are in a library, the ray generation stage in the pipeline or in a library.
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

TEST(BareDriver, DISABLED_SupportsEveryStageInLibraries) { traceWithLibraries(true); }
TEST(Workarounds, SupportsLibrariesExceptForRayGeneration) { traceWithLibraries(false); }

TEST(BareDriver, SupportsEveryStageInLibraries) {
  const ChildEnd end = runInChild("BareDriver.DISABLED_SupportsEveryStageInLibraries");
  Checks checks;
  checks.quirkThat(end == ChildEnd::passed, "the process {}", end == ChildEnd::crashed ? "crashed" : "failed");
  checks.done(kLibrariesCrash);
}

}  // namespace
}  // namespace quintet::oracle::groups_test
