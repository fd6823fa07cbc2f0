// SPDX-License-Identifier: Apache-2.0
// Intersection shaders: the result of reportIntersectionEXT, gl_RayTmaxEXT and the attributes before and after it.
#include "checks.h"
#include "probe.h"

namespace quintet::oracle::intersection_test {
namespace {

// Reports that the intersection shader makes in this order.
constexpr std::uint32_t kReports = 6;
struct Script {
  float tMin = 0, tMax = 100;
  std::uint32_t flags = 0;
  float t[kReports] = {};
  std::uint32_t ignore[kReports] = {};  // action of the any-hit shader: 1 ignores, 2 terminates
};
struct Result {
  std::uint32_t returned[kReports];  // 1 for false, 2 for true, 0 if not reached
  float tMaxBefore[kReports], tMaxAfter[kReports];
  float t;
  std::uint32_t kind, end;
  vec2 attributes;
};

constexpr char kCommon[] = R"(
struct Input { float tMin; float tMax; uint flags; float t[6]; uint ignored[6]; };
struct Output { uint returned[6]; float tMaxBefore[6]; float tMaxAfter[6]; float t; uint kind; uint end; vec2 attributes; };
)";
constexpr char kRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT uint nothing;
void main() {
  Input script = launch.inputs.at[launchIndex()];
  traceRayEXT(tlas, script.flags, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 9.0), script.tMin, vec3(0.0, 0.0, -1.0), script.tMax, 0);
}
)";
constexpr char kMiss[] = "void main() { launch.outputs.at[launchIndex()].end = 2u; }\n";
constexpr char kIntersection[] = R"(
hitAttributeEXT vec2 attributes;
void main() {
  uint i = launchIndex();
  for (uint k = 0u; k < 6u; ++k) {
    float t = launch.inputs.at[i].t[k];
    if (t < 0.0) break;
    launch.outputs.at[i].tMaxBefore[k] = gl_RayTmaxEXT;
    attributes = vec2(t, float(k));
    bool accepted = reportIntersectionEXT(t, k);
    launch.outputs.at[i].returned[k] = accepted ? 2u : 1u;
    launch.outputs.at[i].tMaxAfter[k] = gl_RayTmaxEXT;
  }
}
)";
// Workaround: tracks the nearest accepted t and reports only smaller values.
constexpr char kTrackingIntersection[] = R"(
hitAttributeEXT vec2 attributes;
void main() {
  uint i = launchIndex();
  float nearest = gl_RayTmaxEXT;
  for (uint k = 0u; k < 6u; ++k) {
    float t = launch.inputs.at[i].t[k];
    if (t < 0.0) break;
    launch.outputs.at[i].tMaxBefore[k] = nearest;
    bool accepted = false;
    if (t >= gl_RayTminEXT && t <= nearest) {
      attributes = vec2(t, float(k));
      accepted = reportIntersectionEXT(t, k);
    }
    if (accepted) nearest = t;
    launch.outputs.at[i].returned[k] = accepted ? 2u : 1u;
    launch.outputs.at[i].tMaxAfter[k] = nearest;
  }
}
)";
constexpr char kAnyHit[] = R"(
void main() {
  uint action = launch.inputs.at[launchIndex()].ignored[gl_HitKindEXT];
  if (action == 1u) ignoreIntersectionEXT;
  if (action == 2u) terminateRayEXT;
}
)";
constexpr char kClosestHit[] = R"(
hitAttributeEXT vec2 attributes;
void main() {
  uint i = launchIndex();
  launch.outputs.at[i].t = gl_HitTEXT;
  launch.outputs.at[i].kind = gl_HitKindEXT;
  launch.outputs.at[i].end = 1u;
  launch.outputs.at[i].attributes = attributes;
}
)";

std::vector<Script> scripts() {
  const Script all[] = {
      {.t = {5, -1}},                                     // in range
      {.tMin = 2, .tMax = 8, .t = {1, 9, 2, -1}},         // below tmin, above tmax, equal to tmin
      {.tMin = 2, .tMax = 8, .t = {1.999f, 8.001f, -1}},  // both outside, a miss
      {.t = {0, -1}},                                     // t = tmin = 0
      {.t = {5, 6, 4, 4.5f, 3, -1}},                      // later ones must be nearer
      {.t = {5, -1}, .ignore = {1}},                      // ignored
      {.t = {5, 4, 6, -1}, .ignore = {0, 1, 0}},          // accepted, ignored, beyond the accepted one
      {.t = {5, 7, 9, 8, -1}, .ignore = {1, 1, 0, 0}},    // ignored candidates do not shorten the ray
      {.t = {5, 4, 3, -1}, .ignore = {0, 2, 0}},          // terminated: the report does not return
      {.t = {5, 4, -1}, .ignore = {2, 0}},
      {.flags = kOpaque, .t = {5, 6, 4, -1}, .ignore = {1, 1, 1}},  // opaque: the any-hit shader is not called
      {.flags = kTerminateOnFirstHit, .t = {5, 4, -1}},             // terminates on the first hit
      {.flags = kOpaque | kTerminateOnFirstHit, .t = {5, 4, -1}},
      {.flags = kTerminateOnFirstHit, .t = {5, 4, 3, -1}, .ignore = {1, 0, 0}},  // the first candidate is ignored
      {.t = {-1}},                                                               // no report, a miss
      {.tMax = 6, .t = {5.5f, 5.25f, 5.75f, 5, 5.125f, 1}},
  };
  return {std::begin(all), std::end(all)};
}

// Applies the rules of GLSL_EXT_ray_tracing.
Result expectedOf(const Script& script) {
  Result r{};
  r.end = 2;
  float tMax = script.tMax;
  for (std::uint32_t k = 0; k < kReports && script.t[k] >= 0; ++k) {
    r.tMaxBefore[k] = tMax;
    const bool inRange = script.t[k] >= script.tMin && script.t[k] <= tMax;
    const bool opaque = script.flags & kOpaque;
    const std::uint32_t action = opaque ? 0 : script.ignore[k];
    if (inRange && action != 1) {
      tMax = script.t[k];
      r.t = tMax, r.kind = k, r.end = 1, r.attributes = {tMax, k};
      if (action == 2 || (script.flags & kTerminateOnFirstHit)) return r;
    }
    r.returned[k] = inRange && action != 1 ? 2 : 1;
    r.tMaxAfter[k] = tMax;
  }
  return r;
}

std::vector<Result> runScripts(const std::vector<Script>& inputs, const char* intersection = kIntersection) {
  const Program program({.common = kCommon,
                         .rayGeneration = kRayGeneration,
                         .miss = {kMiss},
                         .hit = {{.closestHit = kClosestHit, .anyHit = kAnyHit, .intersection = intersection}}});
  Scene scene;
  scene.add(scene.addBlas({Boxes{{boxAt({0, 0, 0}, 10)}, false, true}}));
  return run<Result>(program, scene, inputs);
}

TEST(Intersection, ReturnsWhetherReportsAreAccepted) {
  const auto inputs = scripts();
  const auto results = runScripts(inputs);
  Checks checks;
  for (std::size_t s = 0; s < inputs.size(); ++s) {
    const Result expected = expectedOf(inputs[s]);
    const Result& r = results[s];
    for (std::uint32_t k = 0; k < kReports; ++k) {
      // No specification defines whether a report returns if it ends the traversal by the ray flag. If it returns, it
      // is accepted and later ones are not.
      const bool ended = (inputs[s].flags & kTerminateOnFirstHit) && k >= expected.kind;
      if (ended)
        checks.that(r.returned[k] == 0 || r.returned[k] == (k == expected.kind ? 2 : 1), "script {}, report {}", s, k);
      else
        checks.equal(r.returned[k], expected.returned[k], "script {}, report {}", s, k);
    }
    checks.equal(r.end, expected.end, "script {}: end", s);
    if (expected.end != 1) continue;
    checks.equal(r.t, expected.t, "script {}: t", s);
    checks.equal(r.kind, expected.kind, "script {}: hit kind", s);
  }
  checks.done();
}

TEST(Intersection, LowersTmaxToTheNearestAcceptedReport) {
  const auto inputs = scripts();
  const auto results = runScripts(inputs);
  Checks checks;
  for (std::size_t s = 0; s < inputs.size(); ++s) {
    const Result expected = expectedOf(inputs[s]);
    if (inputs[s].flags & kTerminateOnFirstHit) continue;
    for (std::uint32_t k = 0; k < kReports && expected.returned[k] != 0; ++k) {
      const float traced = inputs[s].tMax;
      checks.quirk(results[s].tMaxBefore[k], expected.tMaxBefore[k], traced, "script {}, before report {}", s, k);
      checks.quirk(results[s].tMaxAfter[k], expected.tMaxAfter[k], traced, "script {}, after report {}", s, k);
    }
  }
  checks.done(kTmaxNotLowered);
}

TEST(Intersection, SupportsShadersThatTrackTmax) {
  const auto inputs = scripts();
  const auto results = runScripts(inputs, kTrackingIntersection);
  Checks checks;
  for (std::size_t s = 0; s < inputs.size(); ++s) {
    const Result expected = expectedOf(inputs[s]);
    const Result& r = results[s];
    checks.equal(r.end, expected.end, "script {}: end", s);
    if (expected.end == 1) checks.equal(r.t, expected.t, "script {}: t", s);
    if (inputs[s].flags & kTerminateOnFirstHit) continue;
    for (std::uint32_t k = 0; k < kReports; ++k) {
      checks.equal(r.returned[k], expected.returned[k], "script {}, report {}", s, k);
      if (expected.returned[k] == 0) continue;
      checks.equal(r.tMaxBefore[k], expected.tMaxBefore[k], "script {}, before report {}", s, k);
      checks.equal(r.tMaxAfter[k], expected.tMaxAfter[k], "script {}, after report {}", s, k);
    }
  }
  checks.done();
}

TEST(Intersection, KeepsAttributesOfTheCommittedReport) {
  const auto inputs = scripts();
  const auto results = runScripts(inputs);
  Checks checks;
  for (std::size_t s = 0; s < inputs.size(); ++s) {
    const Result expected = expectedOf(inputs[s]);
    if (expected.end != 1) continue;
    bool someReport = false;
    for (std::uint32_t k = 0; k < kReports; ++k) someReport |= results[s].attributes == vec2(inputs[s].t[k], k);
    checks.that(someReport, "script {}: the attributes are those of some report", s);
    checks.quirkThat(results[s].attributes == expected.attributes, "script {}: attributes", s);
  }
  checks.done(kLooseAttributes);
}

}  // namespace
}  // namespace quintet::oracle::intersection_test
