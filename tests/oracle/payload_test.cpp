// SPDX-License-Identifier: Apache-2.0
// Payloads and callable data: sizes from 4 to 256 bytes, several locations, nested traces and calls.
#include <iterator>

#include "checks.h"
#include "program.h"

namespace quintet::oracle::payload_test {
namespace {

// One payload of each size, at unordered locations with gaps.
struct Slot {
  std::uint32_t words, location;
};
constexpr Slot kSlots[] = {{1, 0}, {2, 9}, {3, 4}, {5, 1}, {8, 30}, {16, 2}, {33, 17}, {64, 3}};
constexpr std::uint32_t kSlotCount = std::size(kSlots), kMaxWords = 64;

struct Payload {
  std::uint32_t words[kMaxWords];
};
struct Aim {
  float x;
  std::uint32_t seed;
};

constexpr char kCommon[] = R"(
struct Input { float x; uint seed; };
struct Output { uint words[64]; };
)";

std::string declare(const char* qualifier, std::uint32_t location, std::uint32_t words) {
  return fmt::format("struct Payload{0} {{ uint w[{0}]; }};\nlayout(location = {1}) {2} Payload{0} payload{0};\n",
                     words, location, qualifier);
}

// Fills a payload of each size, traces with its own hit and miss record, and stores the result. Payloads at other
// locations, which are filled before the first trace, must not change.
std::string rayGeneration() {
  std::string text, fill, trace, write;
  for (std::uint32_t k = 0; k < kSlotCount; ++k) {
    const auto [words, location] = kSlots[k];
    text += declare("rayPayloadEXT", location, words);
    fill += fmt::format("  for (uint k = 0u; k < {0}u; ++k) payload{0}.w[k] = aim.seed + {0}u * 1000u + k;\n", words);
    trace += fmt::format(
        "  traceRayEXT(tlas, 0u, 0xFFu, {0}u, 0u, {0}u, vec3(aim.x, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, "
        "{1});\n",
        k, location);
    write += fmt::format(
        "  for (uint k = 0u; k < {1}u; ++k) launch.outputs.at[launchIndex() * {2}u + {0}u].words[k] = "
        "payload{1}.w[k];\n",
        k, words, kSlotCount);
  }
  return text + "void main() {\n  Input aim = launch.inputs.at[launchIndex()];\n" + fill + trace + write + "}\n";
}
std::string stage(std::uint32_t words, const std::string& value) {
  // The location of an incoming payload is irrelevant.
  return declare("rayPayloadInEXT", words % 7, words) +
         fmt::format("void main() {{\n  for (uint k = 0u; k < {0}u; ++k) payload{0}.w[k] = {1};\n}}\n", words, value);
}

TEST(Payloads, SupportsFourTo256BytesAtManyLocations) {
  ProgramText text{.common = kCommon, .rayGeneration = rayGeneration(), .miss = {}, .hit = {}};
  for (const Slot& slot : kSlots) {
    const std::string payload = fmt::format("payload{}.w[k]", slot.words);
    text.miss.push_back(stage(slot.words, "~" + payload));
    text.hit.push_back(
        {.closestHit = stage(slot.words, payload + " * 3u + k"), .anyHit = stage(slot.words, payload + " + 17u")});
  }
  const Program program(text);
  Scene scene;
  Triangles triangle = triangleAt(0, 0, 0, 1, false);
  triangle.singleAnyHit = true;
  scene.add(scene.addBlas({triangle}));
  std::vector<Aim> rays;
  for (std::uint32_t k = 0; k < 40; ++k) rays.push_back({k % 3 ? 0.0f : 50.0f, k * 77});
  const auto results = run<Payload>(program, scene, rays, {.outputs = rays.size() * kSlotCount});
  Checks checks;
  for (std::size_t r = 0; r < rays.size(); ++r)
    for (std::uint32_t s = 0; s < kSlotCount; ++s)
      for (std::uint32_t k = 0; k < kSlots[s].words; ++k) {
        const std::uint32_t filled = rays[r].seed + kSlots[s].words * 1000 + k;
        const std::uint32_t expected = r % 3 ? (filled + 17) * 3 + k : ~filled;
        checks.equal(results[r * kSlotCount + s].words[k], expected, "ray {}: word {} of {}", r, k, kSlots[s].words);
      }
  checks.done();
}

// ---- Nested traces with their own payloads keep the locals and the payload of the outer stage

constexpr char kNestedRayGeneration[] = R"(
layout(location = 3) rayPayloadEXT uvec4 outer;
void main() {
  Input aim = launch.inputs.at[launchIndex()];
  outer = uvec4(aim.seed, 1u, 2u, 3u);
  traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, vec3(aim.x, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 3);
  for (uint k = 0u; k < 4u; ++k) launch.outputs.at[launchIndex()].words[k] = outer[k];
}
)";
// Traces twice with different payloads and uses its incoming payload in between.
std::string nestingStage(std::uint32_t tag) {
  return fmt::format(R"(
layout(location = 0) rayPayloadInEXT uvec4 incoming;
layout(location = 1) rayPayloadEXT vec3 first;
layout(location = 2) rayPayloadEXT uint second;
void main() {{
  uint kept = incoming.x * 5u + {0}u;
  incoming.y += 10u;
  first = vec3(float(incoming.x), 0.5, -1.0);
  second = 4u;
  traceRayEXT(tlas, 0u, 0xFFu, 1u, 0u, 1u, vec3(0.0, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 1);
  second += uint(first.y * 2.0);
  traceRayEXT(tlas, 0u, 0xFFu, 2u, 0u, 2u, vec3(50.0, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 2);
  incoming.z = kept + uint(first.x);
  incoming.w = second * 1000u + {0}u;
}}
)",
                     tag);
}

TEST(Payloads, KeepsStateOfTheOuterStageInNestedTraces) {
  const std::string first =
      "layout(location = 5) rayPayloadInEXT vec3 p;\nvoid main() { p = vec3(p.x + 1.0, 3.0, p.z); }\n";
  const std::string second = "layout(location = 6) rayPayloadInEXT uint p;\nvoid main() { p = p * 2u + 1u; }\n";
  const Program program({.common = kCommon,
                         .rayGeneration = kNestedRayGeneration,
                         .miss = {nestingStage(9), "void main() {}", second},
                         .hit = {{.closestHit = nestingStage(8)}, {.closestHit = first}, {}},
                         .recursion = 2});
  Scene scene;
  scene.add(scene.addBlas({triangleAt(0, 0, 0)}));
  std::vector<Aim> rays;
  for (std::uint32_t k = 0; k < 30; ++k) rays.push_back({k % 2 ? 0.0f : 50.0f, k * 31});
  const auto results = run<Payload>(program, scene, rays);
  Checks checks;
  for (std::uint32_t k = 0; k < rays.size(); ++k) {
    const std::uint32_t seed = rays[k].seed, tag = k % 2 ? 8 : 9;
    const std::uint32_t expected[] = {seed, 11, seed * 5 + tag + seed + 1, ((4 + 6) * 2 + 1) * 1000 + tag};
    for (std::uint32_t w = 0; w < 4; ++w) checks.equal(results[k].words[w], expected[w], "ray {}: word {}", k, w);
  }
  checks.done();
}

// ---- Callable shaders

constexpr char kCallableRayGeneration[] = R"(
layout(location = 0) callableDataEXT uint small;
layout(location = 7) callableDataEXT vec4 vectors[3];
layout(location = 1) rayPayloadEXT uvec2 payload;
void main() {
  Input aim = launch.inputs.at[launchIndex()];
  uint i = launchIndex();
  small = aim.seed;
  for (uint k = 0u; k < 3u; ++k) vectors[k] = vec4(float(aim.seed), float(k), 0.0, 0.0);
  executeCallableEXT(aim.seed % 3u, 0);              // differs between neighbors
  executeCallableEXT(3u, 7);
  payload = uvec2(aim.seed, 0u);
  traceRayEXT(tlas, 0u, 0xFFu, 0u, 0u, 0u, vec3(aim.x, 0.0, 3.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 1);
  launch.outputs.at[i].words[0] = small;
  for (uint k = 0u; k < 3u; ++k) launch.outputs.at[i].words[1u + k] = uint(vectors[k].z);
  launch.outputs.at[i].words[4] = payload.x;
  launch.outputs.at[i].words[5] = payload.y;
}
)";
std::string addingCallable(std::uint32_t number) {
  return fmt::format("layout(location = 2) callableDataInEXT uint data;\nvoid main() {{ data = data * 10u + {}u; }}\n",
                     number);
}
// Calls other callables with its own data and then uses its own locals.
constexpr char kVectorCallable[] = R"(
layout(location = 0) callableDataInEXT vec4 vectors[3];
layout(location = 1) callableDataEXT uint inner;
void main() {
  for (uint k = 0u; k < 3u; ++k) {
    inner = uint(vectors[k].x) + k;
    executeCallableEXT(4u, 1);
    vectors[k].z = float(inner) + vectors[k].y;
  }
}
)";
constexpr char kNestedCallable[] = R"(
layout(location = 3) callableDataInEXT uint data;
layout(location = 0) callableDataEXT uint deepest;
void main() {
  uint kept = data;
  deepest = data;
  executeCallableEXT(data % 3u, 0);
  data = kept + deepest;
}
)";
std::string callingStage(std::uint32_t number) {
  return fmt::format(R"(
layout(location = 0) rayPayloadInEXT uvec2 payload;
layout(location = 4) callableDataEXT uint data;
void main() {{
  data = payload.x;
  executeCallableEXT({}u, 4);
  payload.y = data;
}}
)",
                     number);
}

std::uint32_t nestedCall(std::uint32_t data) { return data + data * 10 + data % 3; }

TEST(Callables, AreCallableFromEveryAllowedStage) {
  const Program program(
      {.common = kCommon,
       .rayGeneration = kCallableRayGeneration,
       .miss = {callingStage(4)},
       .hit = {{.closestHit = callingStage(2)}},
       .callable = {addingCallable(0), addingCallable(1), addingCallable(2), kVectorCallable, kNestedCallable}});
  Scene scene;
  scene.add(scene.addBlas({triangleAt(0, 0, 0)}));
  std::vector<Aim> rays;
  for (std::uint32_t k = 0; k < 100; ++k) rays.push_back({k % 2 ? 0.0f : 50.0f, k * 13 + k / 7});
  const auto results = run<Payload>(program, scene, rays);
  Checks checks;
  for (std::uint32_t k = 0; k < rays.size(); ++k) {
    const std::uint32_t seed = rays[k].seed, *words = results[k].words;
    checks.equal(words[0], seed * 10 + seed % 3, "invocation {}: called by an index that varies", k);
    for (std::uint32_t v = 0; v < 3; ++v)
      checks.equal(words[1 + v], nestedCall(seed + v) + v, "invocation {}: vector {}", k, v);
    checks.equal(words[4], seed, "invocation {}: payload", k);
    checks.equal(words[5], k % 2 ? seed * 10 + 2 : nestedCall(seed), "invocation {}: called from {}", k,
                 k % 2 ? "closest-hit" : "miss");
  }
  checks.done();
}

}  // namespace
}  // namespace quintet::oracle::payload_test
