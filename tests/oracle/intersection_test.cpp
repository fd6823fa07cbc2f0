// Intersection shaders: what reportIntersectionEXT returns, gl_RayTmaxEXT around it, and local arrays across it.
#include "checks.h"
#include "probe.h"

namespace quintet::oracle {
namespace {

// A list of reports that the intersection shader makes one after the other.
constexpr std::uint32_t kReports = 6;
struct Script {
  float tMin = 0, tMax = 100;
  std::uint32_t flags = 0;
  float t[kReports] = {};
  std::uint32_t ignore[kReports] = {};  // by the any-hit shader: 1 ignores, 2 terminates
};
struct Result {
  std::uint32_t returned[kReports];  // 1 false, 2 true, 0 not reached
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
      {.tMin = 2, .tMax = 8, .t = {1, 9, 2, -1}},         // before tmin, beyond tmax, on tmin
      {.tMin = 2, .tMax = 8, .t = {1.999f, 8.001f, -1}},  // both outside: a miss
      {.t = {0, -1}},                                     // t = tmin = 0
      {.t = {5, 6, 4, 4.5f, 3, -1}},                      // later ones must be nearer
      {.t = {5, -1}, .ignore = {1}},                      // ignored
      {.t = {5, 4, 6, -1}, .ignore = {0, 1, 0}},          // accepted, ignored, beyond the accepted one
      {.t = {5, 7, 9, 8, -1}, .ignore = {1, 1, 0, 0}},    // an ignored one does not shorten the ray
      {.t = {5, 4, 3, -1}, .ignore = {0, 2, 0}},          // terminated: never comes back
      {.t = {5, 4, -1}, .ignore = {2, 0}},
      {.flags = kOpaque, .t = {5, 6, 4, -1}, .ignore = {1, 1, 1}},  // opaque: the any-hit shader is not asked
      {.flags = kTerminateOnFirstHit, .t = {5, 4, -1}},             // terminate on the first hit: never comes back
      {.flags = kOpaque | kTerminateOnFirstHit, .t = {5, 4, -1}},
      {.flags = kTerminateOnFirstHit, .t = {5, 4, 3, -1}, .ignore = {1, 0, 0}},  // the first one does not count
      {.t = {-1}},                                                               // no report: a miss
      {.tMax = 6, .t = {5.5f, 5.25f, 5.75f, 5, 5.125f, 1}},
  };
  return {std::begin(all), std::end(all)};
}

// By the rules of GLSL_EXT_ray_tracing; the state after all of them in `r`.
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

std::vector<Result> runScripts(const std::vector<Script>& inputs) {
  static std::unique_ptr<Program> program;
  if (!program) {
    program = std::make_unique<Program>(
        ProgramText{.common = kCommon,
                    .rayGeneration = kRayGeneration,
                    .miss = {kMiss},
                    .hit = {{.closestHit = kClosestHit, .anyHit = kAnyHit, .intersection = kIntersection}}});
    atEnd([] { program.reset(); });
  }
  Scene scene;
  scene.add(scene.addBlas({Boxes{{boxAt({0, 0, 0}, 10)}, false, true}}));
  return run<Result>(*program, scene, inputs);
}

TEST(Intersection, ReportsTellWhetherTheyCount) {
  const auto inputs = scripts();
  const auto results = runScripts(inputs);
  Checks checks;
  for (std::size_t s = 0; s < inputs.size(); ++s) {
    const Result expected = expectedOf(inputs[s]);
    const Result& r = results[s];
    for (std::uint32_t k = 0; k < kReports; ++k) {
      // No specification says whether a report that ends the search by the ray's flag comes back. If it does, it has
      // counted, and no later one does.
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

TEST(Intersection, TmaxIsTheNearestAcceptedReport) {
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

TEST(Intersection, AttributesAreThoseOfTheCommittedReport) {
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

// Local arrays with dynamic indices, in use across reports, while the any-hit shader has such an array too.
struct Stack {
  std::uint32_t seed = 0, accept = 0;
};
struct StackResult {
  std::uint32_t wrong, anyHitWrong, anyHits, reports;
};
constexpr char kStackCommon[] = R"(
struct Input { uint seed; uint accepted; };
struct Output { uint wrong; uint anyHitWrong; uint anyHits; uint reports; };
)";
constexpr char kStackRayGeneration[] = R"(
layout(location = 0) rayPayloadEXT uint nothing;
void main() { traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 9.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 0); }
)";
constexpr char kStackIntersection[] = R"(
hitAttributeEXT vec2 attributes;
void main() {
  uint i = launchIndex(), seed = launch.inputs.at[i].seed, wrong = 0u;
  uint stack[16];
  for (uint k = 0u; k < 16u; ++k) stack[(k * 5u + seed) & 15u] = seed * 100u + k;
  attributes = vec2(0.0);
  for (uint r = 0u; r < 4u; ++r) {
    reportIntersectionEXT(8.0 - float(r), r);
    launch.outputs.at[i].reports++;
    for (uint k = 0u; k < 16u; ++k) wrong += stack[(k * 5u + seed) & 15u] == seed * 100u + k ? 0u : 1u;
  }
  launch.outputs.at[i].wrong = wrong;
}
)";
// The workaround: the same values in vectors, reached by constant indices.
constexpr char kVectorIntersection[] = R"(
hitAttributeEXT vec2 attributes;
uvec4 a, b, c, d;
uint at(uint i) {
  uvec4 v = i < 4u ? a : i < 8u ? b : i < 12u ? c : d;
  uint k = i & 3u;
  return k == 0u ? v.x : k == 1u ? v.y : k == 2u ? v.z : v.w;
}
void main() {
  uint i = launchIndex(), seed = launch.inputs.at[i].seed, wrong = 0u;
  uvec4 step = uvec4(0u, 1u, 2u, 3u) + seed * 100u;
  a = step; b = step + 4u; c = step + 8u; d = step + 12u;
  attributes = vec2(0.0);
  for (uint r = 0u; r < 4u; ++r) {
    reportIntersectionEXT(8.0 - float(r), r);
    launch.outputs.at[i].reports++;
    for (uint k = 0u; k < 16u; ++k) wrong += at((k * 5u + seed) & 15u) == seed * 100u + ((k * 5u + seed) & 15u) ? 0u : 1u;
  }
  launch.outputs.at[i].wrong = wrong;
}
)";
constexpr char kStackAnyHit[] = R"(
void main() {
  uint i = launchIndex(), seed = launch.inputs.at[i].seed, wrong = 0u;
  uint other[16];
  for (uint k = 0u; k < 16u; ++k) other[(k * 3u + seed) & 15u] = 7000u + k;
  for (uint k = 0u; k < 16u; ++k) wrong += other[(k * 3u + seed) & 15u] == 7000u + k ? 0u : 1u;
  launch.outputs.at[i].anyHitWrong += wrong;
  launch.outputs.at[i].anyHits++;
  if ((launch.inputs.at[i].accepted >> gl_HitKindEXT & 1u) == 0u) ignoreIntersectionEXT;
}
)";

void checkStacks(const char* intersection, const KnownQuirk* quirk) {
  const Program program({.common = kStackCommon,
                         .rayGeneration = kStackRayGeneration,
                         .miss = {"void main() {}"},
                         .hit = {{.anyHit = kStackAnyHit, .intersection = intersection}}});
  Scene scene;
  scene.add(scene.addBlas({Boxes{{boxAt({0, 0, 0}, 10)}, false, true}}));
  std::vector<Stack> inputs;
  for (std::uint32_t k = 0; k < 64; ++k) inputs.push_back({k * 7, k & 15});
  const auto results = run<StackResult>(program, scene, inputs);
  Checks checks;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const StackResult& r = results[k];
    checks.equal(uvec2(r.reports, r.anyHits), uvec2(4, 4), "ray {}: reports and any-hit calls", k);
    checks.equal(r.anyHitWrong, 0u, "ray {}: array of the any-hit shader", k);
    if (quirk)
      checks.quirkThat(r.wrong == 0, "ray {}: {} values of the intersection shader's array", k, r.wrong);
    else
      checks.equal(r.wrong, 0u, "ray {}: values of the intersection shader", k);
  }
  quirk ? checks.done(*quirk) : checks.done();
}

TEST(Intersection, LocalArraysOutliveReports) { checkStacks(kStackIntersection, &kSharedArrays); }
TEST(Intersection, LocalVectorsOutliveReports) { checkStacks(kVectorIntersection, nullptr); }

}  // namespace
}  // namespace quintet::oracle
