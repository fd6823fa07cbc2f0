// SPDX-License-Identifier: Apache-2.0
// Any-hit shaders: effects of ignoring and terminating, and the candidates that they receive.
#include "checks.h"
#include "probe.h"

namespace quintet::oracle::any_hit_test {
namespace {

// Action of the any-hit shader; it is the custom index of the instance.
enum Action : std::uint32_t {
  kAccept = 0,
  kIgnore = 1,
  kTerminate = 2,
  kIgnoreInFunction = 3,
  kTerminateInFunction = 4
};

struct Result {
  std::uint32_t before, after;              // counted in the payload, before and after the statement
  std::uint32_t bufferBefore, bufferAfter;  // counted in memory
  std::uint32_t closest, missed;
  float t;
  std::uint32_t custom;
};

constexpr char kCommon[] = R"(
struct Input { vec3 origin; float tMin; vec3 direction; float tMax; uint flags; uint mask; uint offset; uint stride; uint miss; };
struct Output { uint before; uint after; uint bufferBefore; uint bufferAfter; uint closest; uint missed; float t; uint custom; };
struct Payload { uint before; uint after; uint closest; uint missed; float t; uint custom; };
)";
constexpr char kRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT Payload result;
void main() {
  Input ray = launch.inputs.at[launchIndex()];
  result = Payload(0u, 0u, 0u, 0u, -1.0, 99u);
  traceRayEXT(tlas, ray.flags, 0xFFu, 0u, 0u, 0u, ray.origin, ray.tMin, ray.direction, ray.tMax, 0);
  uint i = launchIndex();
  launch.outputs.at[i].before = result.before;
  launch.outputs.at[i].after = result.after;
  launch.outputs.at[i].closest = result.closest;
  launch.outputs.at[i].missed = result.missed;
  launch.outputs.at[i].t = result.t;
  launch.outputs.at[i].custom = result.custom;
}
)";
constexpr char kAnyHit[] = R"(
layout(location = 0) rayPayloadInEXT Payload result;
void act(uint action) {
  if (action == 3u) ignoreIntersectionEXT;
  if (action == 4u) terminateRayEXT;
}
void main() {
  result.before++;
  atomicAdd(launch.outputs.at[launchIndex()].bufferBefore, 1u);
  if (gl_InstanceCustomIndexEXT == 1) ignoreIntersectionEXT;
  if (gl_InstanceCustomIndexEXT == 2) terminateRayEXT;
  act(gl_InstanceCustomIndexEXT);
  result.after++;
  atomicAdd(launch.outputs.at[launchIndex()].bufferAfter, 1u);
}
)";
constexpr char kClosestHit[] = R"(
layout(location = 0) rayPayloadInEXT Payload result;
void main() { result.closest++; result.t = gl_HitTEXT; result.custom = gl_InstanceCustomIndexEXT; }
)";
constexpr char kMiss[] = R"(
layout(location = 0) rayPayloadInEXT Payload result;
void main() { result.missed++; }
)";
constexpr char kIntersection[] = R"(
hitAttributeEXT vec2 attributes;
void main() {
  float t = (0.5 - gl_ObjectRayOriginEXT.z) / gl_ObjectRayDirectionEXT.z;
  attributes = vec2(0.0);
  reportIntersectionEXT(t, 3u);
}
)";

const Program& program() {
  static std::unique_ptr<Program> made;
  if (!made) {
    made = std::make_unique<Program>(
        ProgramText{.common = kCommon,
                    .rayGeneration = kRayGeneration,
                    .miss = {kMiss},
                    .hit = {{.closestHit = kClosestHit, .anyHit = kAnyHit},
                            {.closestHit = kClosestHit, .anyHit = kAnyHit, .intersection = kIntersection}}});
    atEnd([] { made.reset(); });
  }
  return *made;
}

// Columns at a distance of 4, each with layers of the given actions at z = 0, -2, -4, …
Scene columns(const std::vector<std::vector<Action>>& actions, bool boxes) {
  Scene scene;
  const std::size_t blas = boxes ? scene.addBlas({Boxes{{boxAt({0, 0, 0})}, false, true}}) : scene.addBlas({[] {
    Triangles t = triangleAt(0, 0, 0.5f, 1, false);
    t.singleAnyHit = true;
    return t;
  }()});
  for (std::size_t c = 0; c < actions.size(); ++c)
    for (std::size_t layer = 0; layer < actions[c].size(); ++layer)
      scene.add(blas, {.worldFromObject = glm::translate(
                           mat4(1.0f), vec3(4.0f * static_cast<float>(c), 0, -2.0f * static_cast<float>(layer))),
                       .customIndex = actions[c][layer],
                       .recordOffset = boxes});
  return scene;
}

// All columns of one, two and three layers.
std::vector<std::vector<Action>> allColumns() {
  constexpr Action all[] = {kAccept, kIgnore, kTerminate, kIgnoreInFunction, kTerminateInFunction};
  std::vector<std::vector<Action>> columns;
  for (const Action a : all) columns.push_back({a});
  for (const Action a : all)
    for (const Action b : all) columns.push_back({a, b});
  for (const Action a : all)
    for (const Action b : all)
      for (const Action c : all) columns.push_back({a, b, c});
  return columns;
}

bool ignores(Action a) { return a == kIgnore || a == kIgnoreInFunction; }
bool terminates(Action a) { return a == kTerminate || a == kTerminateInFunction; }

// Checks what holds for any order of the candidates, which is implementation-dependent.
void checkColumn(Checks& checks, const std::vector<Action>& column, const Result& r, std::uint32_t flags,
                 const std::string& what) {
  std::size_t accepting = 0, ending = 0, layers = column.size();
  for (const Action a : column) ending += terminates(a), accepting += a == kAccept;
  checks.equal(r.before, r.bufferBefore, "{}: writes before the statement stay in the payload", what);
  checks.equal(r.after, r.bufferAfter, "{}: counts after the statement", what);
  checks.that(r.after <= accepting, "{}: {} any-hit calls continued, {} layers accept", what, r.after, accepting);
  checks.that(r.before >= 1 && r.before <= layers, "{}: {} any-hit calls for {} layers", what, r.before, layers);
  const bool hit = accepting + ending > 0, skips = flags & kSkipClosestHit;
  checks.equal(r.missed, hit ? 0u : 1u, "{}: miss shader", what);
  checks.equal(r.closest, hit && !skips ? 1u : 0u, "{}: closest-hit shader", what);
  if (!hit) checks.equal(r.before, static_cast<std::uint32_t>(layers), "{}: all candidates were offered", what);
  if (r.closest != 1) return;
  const float layer = (r.t - 1.5f) / 2;
  const auto index = static_cast<std::size_t>(std::lround(layer));
  checks.near(layer, static_cast<float>(index), 1e-4f, "{}: t", what);
  if (index >= layers) return checks.that(false, "{}: layer {}", what, index);
  checks.equal(r.custom, static_cast<std::uint32_t>(column[index]), "{}: the hit's own custom index", what);
  checks.that(!ignores(column[index]), "{}: an ignored candidate was committed", what);
  if (ending == 0 && !(flags & kTerminateOnFirstHit))  // the hit is the nearest accepted layer
    for (std::size_t k = 0; k < index; ++k) checks.that(column[k] != kAccept, "{}: layer {} is nearer", what, k);
}

void checkColumns(bool boxes) {
  const auto all = allColumns();
  const Scene scene = columns(all, boxes);
  Checks checks;
  for (const std::uint32_t flags : {0u, std::uint32_t{kTerminateOnFirstHit}, std::uint32_t{kSkipClosestHit},
                                    kTerminateOnFirstHit | kSkipClosestHit}) {
    std::vector<ProbeRay> rays;
    for (std::size_t c = 0; c < all.size(); ++c)
      rays.push_back({.origin = {4.0f * static_cast<float>(c), 0, 2}, .flags = flags});
    const auto results = run<Result>(program(), scene, rays);
    for (std::size_t c = 0; c < all.size(); ++c)
      checkColumn(checks, all[c], results[c], flags, fmt::format("column {}, flags {:#x}", c, flags));
  }
  checks.done();
}

TEST(AnyHit, IgnoresAndTerminatesTriangles) { checkColumns(false); }
TEST(AnyHit, IgnoresAndTerminatesBoxes) { checkColumns(true); }

// With one layer all values are determined.
TEST(AnyHit, HandlesOneCandidateExactly) {
  struct Expected {
    Action action;
    std::uint32_t before, after, closest, missed;
  };
  const Expected expected[] = {{kAccept, 1, 1, 1, 0},
                               {kIgnore, 1, 0, 0, 1},
                               {kTerminate, 1, 0, 1, 0},
                               {kIgnoreInFunction, 1, 0, 0, 1},
                               {kTerminateInFunction, 1, 0, 1, 0}};
  std::vector<std::vector<Action>> column;
  std::vector<ProbeRay> rays;
  for (const Expected& e : expected) {
    rays.push_back({.origin = {4.0f * static_cast<float>(column.size()), 0, 2}});
    column.push_back({e.action});
  }
  Checks checks;
  for (const bool boxes : {false, true}) {
    const auto results = run<Result>(program(), columns(column, boxes), rays);
    for (std::size_t k = 0; k < results.size(); ++k) {
      const Expected& e = expected[k];
      const Result& r = results[k];
      checks.equal(uvec4(r.before, r.after, r.closest, r.missed), uvec4(e.before, e.after, e.closest, e.missed),
                   "action {}, boxes {}", static_cast<int>(e.action), boxes);
      checks.equal(uvec2(r.bufferBefore, r.bufferAfter), uvec2(e.before, e.after), "action {}, boxes {}: memory",
                   static_cast<int>(e.action), boxes);
      checks.near(r.t, e.closest ? 1.5f : -1.0f, 1e-5f, "action {}, boxes {}: t", static_cast<int>(e.action), boxes);
    }
  }
  checks.done();
}

}  // namespace
}  // namespace quintet::oracle::any_hit_test
