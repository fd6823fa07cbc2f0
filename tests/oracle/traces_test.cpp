// SPDX-License-Identifier: Apache-2.0
// Recursion up to the limit of the device, several scenes in one launch, and gl_RayTmaxEXT from candidate to candidate.
#include <algorithm>

#include "checks.h"
#include "harness.h"
#include "probe.h"

namespace quintet::oracle::traces_test {
namespace {

// ---- Recursion

struct Depth {
  std::uint32_t depth, pattern;
};
struct DepthResult {
  std::uint32_t sum, deepest, order;
};

constexpr char kDepthCommon[] = R"(
struct Input { uint depth; uint pattern; };
struct Output { uint sum; uint deepest; uint order; };
struct Payload { uint depth; uint sum; uint order; };
)";
// Bit d of the pattern means that the trace of depth d misses.
constexpr char kDepthRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT Payload result;
void main() {
  Input task = launch.inputs.at[launchIndex()];
  result = Payload(1u, 0u, 0u);
  float x = (task.pattern & 2u) != 0u ? 50.0 : 0.0;
  if (task.depth > 0u) traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, vec3(x, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 0);
  launch.outputs.at[launchIndex()].sum = result.sum;
  launch.outputs.at[launchIndex()].order = result.order;
}
)";
// Traces recursively and adds its own depth, kind and payload to the result.
std::string deeperStage(std::uint32_t kind) {
  return fmt::format(R"(
layout(location = 0) rayPayloadInEXT Payload incoming;
layout(location = 1) rayPayloadEXT Payload inner;
void main() {{
  Input task = launch.inputs.at[launchIndex()];
  uint depth = incoming.depth, kept = depth * depth + {0}u;
  atomicMax(launch.outputs.at[launchIndex()].deepest, depth);
  inner = Payload(depth + 1u, 0u, 0u);
  float x = (task.pattern >> (depth + 1u) & 1u) != 0u ? 50.0 : 0.0;
  if (depth < task.depth) traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, vec3(x, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 1);
  incoming.sum = inner.sum + kept;
  incoming.order = inner.order * 31u + depth + {0}u;
}}
)",
                     kind);
}

TEST(Traces, SupportsRecursionUpToTheLimit) {
  const std::uint32_t limit = test::testContext().info().limits.maxRecursionDepth, deepest = std::min(31u, limit);
  const Program program({.common = kDepthCommon,
                         .rayGeneration = kDepthRayGeneration,
                         .miss = {deeperStage(5)},
                         .hit = {{.closestHit = deeperStage(0)}},
                         .recursion = deepest});
  Scene scene;
  scene.add(scene.addBlas({triangleAt(0, 0, 0)}));
  std::vector<Depth> inputs;
  for (std::uint32_t depth = 0; depth <= deepest; ++depth)
    for (const std::uint32_t pattern : {0u, 0xFFFFFFFFu, 0x55555555u, 0xF0F0CCAAu, depth * 2654435761u})
      inputs.push_back({depth, pattern});
  const auto results = run<DepthResult>(program, scene, inputs);
  Checks checks;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const auto [depth, pattern] = inputs[k];
    std::uint32_t sum = 0, order = 0;
    for (std::uint32_t d = depth; d >= 1; --d) {
      const std::uint32_t kind = (pattern >> (d & 31) & 1) ? 5 : 0;
      sum += d * d + kind;
      order = order * 31 + d + kind;
    }
    checks.equal(results[k].deepest, depth, "depth {}, pattern {:#x}: deepest", depth, pattern);
    checks.equal(results[k].sum, sum, "depth {}, pattern {:#x}: sum", depth, pattern);
    checks.equal(results[k].order, order, "depth {}, pattern {:#x}: way back", depth, pattern);
  }
  checks.that(limit >= 1, "the device's limit is {}", limit);
  checks.done();
}

// ---- Several TLAS, selected by each invocation, with different masks

constexpr char kDivergentCommon[] = R"(
struct Input { uint scene; uint mask; };
struct Output { uint custom; };
)";
constexpr char kDivergentRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT uint custom;
void main() {
  Input ray = launch.inputs.at[launchIndex()];
  custom = 0u;
  traceRayEXT(accelerationStructureEXT(launch.address[ray.scene]), 0u, ray.mask, 0u, 0u, 0u, vec3(0.0, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 0);
  launch.outputs.at[launchIndex()].custom = custom;
}
)";

TEST(Traces, SelectsTheSceneInEachInvocation) {
  const Program program(
      {.common = kDivergentCommon,
       .rayGeneration = kDivergentRayGeneration,
       .miss = {"layout(location = 0) rayPayloadInEXT uint custom;\nvoid main() { custom = 999u; }\n"},
       .hit = {{.closestHit = "layout(location = 0) rayPayloadInEXT uint custom;\nvoid main() { custom = "
                              "gl_InstanceCustomIndexEXT; }\n"}}});
  // Scene s has s layers, with the nearest on top. Layer k has the mask 1 << k.
  std::vector<Scene> scenes(4);
  LaunchOptions options;
  for (std::uint32_t s = 0; s < 4; ++s) {
    const std::size_t blas = scenes[s].addBlas({triangleAt(0, 0, 0)});
    for (std::uint32_t k = 0; k < s; ++k)
      scenes[s].add(blas, {.worldFromObject = glm::translate(mat4(1.0f), vec3(0, 0, -static_cast<float>(k))),
                           .customIndex = 10 * s + k,
                           .mask = 1u << k});
    options.addresses[s] = scenes[s].address();
  }
  struct Choice {
    std::uint32_t scene, mask;
  };
  std::vector<Choice> inputs;
  for (std::uint32_t k = 0; k < 512; ++k) inputs.push_back({k % 4, 1 + k / 4 % 7});
  const auto results = run<std::uint32_t>(program, scenes[0], inputs, options);
  Checks checks;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const auto [scene, mask] = inputs[k];
    std::uint32_t expected = 999;
    for (std::uint32_t layer = scene; layer-- > 0;)
      if (mask >> layer & 1) expected = 10 * scene + layer;
    checks.equal(results[k], expected, "scene {}, mask {:#x}", scene, mask);
  }
  checks.done();
}

// ---- gl_RayTmaxEXT is the traced tmax, then t of the nearest accepted candidate

constexpr std::uint32_t kEvents = 32;
struct Event {
  std::uint32_t kind;
  float before;
  float t;
  std::uint32_t accepted;
};  // kind is 1 for intersection, 2 for any-hit
struct Log {
  std::uint32_t count;
  float closest, miss;
  Event events[kEvents];
};
constexpr char kLogCommon[] = R"(
struct Input { vec3 origin; float tMin; vec3 direction; float tMax; uint flags; uint mask; uint offset; uint stride; uint miss; };
struct Event { uint kind; float before; float t; uint accepted; };
struct Output { uint count; float closest; float miss; Event events[32]; };
void note(uint kind, float before, float t, uint accepted);
)";
constexpr char kLogFunction[] = R"(
void note(uint kind, float before, float t, uint accepted) {
  uint n = atomicAdd(launch.outputs.at[launchIndex()].count, 1u);
  if (n < 32u) launch.outputs.at[launchIndex()].events[n] = Event(kind, before, t, accepted);
}
)";
constexpr char kLogRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT uint nothing;
void main() {
  Input ray = launch.inputs.at[launchIndex()];
  traceRayEXT(tlas, ray.flags, ray.mask, 0u, 0u, 0u, ray.origin, ray.tMin, ray.direction, ray.tMax, 0);
}
)";
constexpr char kLogIntersection[] = R"(
hitAttributeEXT vec2 a;
void main() {
  float t = (-2.0 * float(gl_PrimitiveID) - gl_ObjectRayOriginEXT.z) / gl_ObjectRayDirectionEXT.z;
  float before = gl_RayTmaxEXT;
  a = vec2(0.0);
  bool accepted = reportIntersectionEXT(t, 1u);
  note(1u, before, t, accepted ? 1u : 0u);
}
)";
// Ignores every third candidate.
constexpr char kLogAnyHit[] = R"(
void main() {
  bool ignored = gl_PrimitiveID % 3 == 1;
  note(2u, gl_RayTmaxEXT, gl_HitTEXT, ignored ? 0u : 1u);
  if (ignored) ignoreIntersectionEXT;
}
)";

TEST(Traces, LowersTmaxToTheNearestHit) {
  const std::string function = kLogFunction;
  const Program program(
      {.common = kLogCommon,
       .rayGeneration = kLogRayGeneration,
       .miss = {"void main() { launch.outputs.at[launchIndex()].miss = gl_RayTmaxEXT; }\n"},
       .hit = {{.closestHit = "void main() { launch.outputs.at[launchIndex()].closest = gl_RayTmaxEXT; }\n",
                .anyHit = function + kLogAnyHit,
                .intersection = function + kLogIntersection}}});
  Scene scene;
  Boxes boxes{.opaque = false, .singleAnyHit = true};
  for (std::uint32_t k = 0; k < 9; ++k)
    boxes.boxes.push_back(boxAt({0, 0, -2.0f * static_cast<float>(k)}, 3));  // they overlap
  scene.add(scene.addBlas({boxes}));
  std::vector<ProbeRay> rays;
  for (const bool below : {false, true})
    for (const float tMax : {1000.0f, 12.0f, 6.5f, 4.5f, 1.0f})
      for (const float x : {0.0f, 100.0f})
        rays.push_back(
            {.origin = {x, 0, below ? -20.0f : 4.0f}, .direction = {0, 0, below ? 1.0f : -1.0f}, .tMax = tMax});
  const auto logs = run<Log>(program, scene, rays);
  Checks checks;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const Log& log = logs[k];
    float nearest = rays[k].tMax;
    bool hit = false;
    checks.that(log.count <= kEvents, "ray {}: {} events", k, log.count);
    for (std::uint32_t e = 0; e < std::min(log.count, kEvents); ++e) {
      const Event& event = log.events[e];
      // The event of an any-hit call precedes that of the reporting intersection shader; its tmax is the candidate's t.
      if (event.kind == 2) {
        checks.equal(event.before, event.t, "ray {}, event {}: any-hit sees the candidate's t", k, e);
        checks.that(event.t <= nearest, "ray {}, event {}: any-hit of t {} beyond {}", k, e, event.t, nearest);
        continue;
      }
      checks.equal(event.before, nearest, "ray {}, event {}: tmax in the intersection shader", k, e);
      const std::uint32_t layer =
          static_cast<std::uint32_t>(std::lround((rays[k].origin.z + rays[k].direction.z * event.t) / -2.0f));
      const bool accepted = event.t <= nearest && layer % 3 != 1;
      checks.equal(event.accepted, accepted ? 1u : 0u, "ray {}, event {}: accepted", k, e);
      if (event.accepted) nearest = event.t, hit = true;
    }
    checks.equal(log.closest, hit ? nearest : 0.0f, "ray {}: tmax in the closest-hit shader", k);
    checks.equal(log.miss, hit ? 0.0f : rays[k].tMax, "ray {}: tmax in the miss shader", k);
    const bool below = rays[k].direction.z > 0, aside = rays[k].origin.x > 0;
    checks.equal(hit, !aside && rays[k].tMax >= 4, "ray {} hits", k);
    if (hit) checks.equal(nearest, 4.0f, "ray {}: nearest, from {}", k, below ? "below" : "above");
  }
  checks.done();
}

}  // namespace
}  // namespace quintet::oracle::traces_test
