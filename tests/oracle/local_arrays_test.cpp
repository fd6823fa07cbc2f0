// SPDX-License-Identifier: Apache-2.0
// Dynamically indexed local arrays of an intersection shader across reports, while the any-hit shader uses such an
// array too.
#include "checks.h"
#include "program.h"

namespace quintet::oracle::local_arrays_test {
namespace {

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
    atomicAdd(launch.outputs.at[i].reports, 1u);
    for (uint k = 0u; k < 16u; ++k) wrong += stack[(k * 5u + seed) & 15u] == seed * 100u + k ? 0u : 1u;
  }
  launch.outputs.at[i].wrong = wrong;
}
)";
// Workaround: the same values in vectors with constant indices.
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
    atomicAdd(launch.outputs.at[i].reports, 1u);
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
  atomicAdd(launch.outputs.at[i].anyHitWrong, wrong);
  atomicAdd(launch.outputs.at[i].anyHits, 1u);
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

TEST(LocalArrays, KeepsArraysAcrossReports) { checkStacks(kStackIntersection, &kSharedArrays); }
TEST(LocalArrays, KeepsVectorsAcrossReports) { checkStacks(kVectorIntersection, nullptr); }

}  // namespace
}  // namespace quintet::oracle::local_arrays_test
