// SPDX-License-Identifier: Apache-2.0
// Leaves of types, and the accesses of a stage by leaf.
#include "spirv/leaves.h"

#include <gmock/gmock.h>

#include "shader/shader_test_support.h"
#include "spirv/stage_facts.h"

namespace quintet::spirv {
using namespace shader;

namespace {

using testing::ElementsAre;

StageFacts factsOf(const std::string& text) {
  CompilerOptions options;
  options.debugInfo = true;
  Source source;
  source.stage = Stage::closestHit;
  source.name = "test.glsl";
  source.text = R"(#version 460
#extension GL_EXT_ray_tracing : require
struct Light { vec3 color; float power[2]; };
struct Payload { Light light; vec4 v; bool hit; };
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT Payload inner;
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
void trace() { traceRayEXT(tlas, 0u, 0xFFu, 0u, 1u, 0u, vec3(0), 0.0, vec3(1), 1.0, 1); }
)" + text;
  Result result = Compiler(options).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  return StageFacts(std::move(*Module::read(std::move(result.spirv))));
}

// Leaves of Payload: light.color 0 to 2, light.power 3 and 4, v 5 to 8, hit 9.
std::vector<std::uint32_t> written(const StageFacts& facts, bool always) {
  const SharedVariable* payload = facts.incoming(spv::StorageClass::IncomingRayPayloadKHR);
  std::vector<std::uint32_t> result;
  if (!payload) return result;
  for (std::uint32_t leaf = 0; leaf < facts.leaves(payload->id).count(); ++leaf)
    if (always ? facts.writesAlways(payload->id, leaf) : facts.writes(payload->id, leaf)) result.push_back(leaf);
  return result;
}

std::vector<std::uint32_t> readFirst(const StageFacts& facts) {
  const SharedVariable* payload = facts.incoming(spv::StorageClass::IncomingRayPayloadKHR);
  std::vector<std::uint32_t> result;
  if (!payload) return result;
  for (std::uint32_t leaf = 0; leaf < facts.leaves(payload->id).count(); ++leaf)
    if (facts.readsBeforeWriting(payload->id, leaf)) result.push_back(leaf);
  return result;
}

Types typesWithPayload() {
  Types types;
  Type number;
  number.kind = Type::Kind::floating, number.width = 32;
  types.add(1, number);
  Type vector;
  vector.kind = Type::Kind::vector, vector.element = 1, vector.count = 3;
  types.add(2, vector);
  Type array;
  array.kind = Type::Kind::array, array.element = 1, array.count = 2;
  types.add(3, array);
  Type light;
  light.kind = Type::Kind::structure, light.members = {2, 3};
  types.add(4, light);
  types.setMemberName(4, 0, "color");
  types.setMemberName(4, 1, "power");
  Type payload;
  payload.kind = Type::Kind::structure, payload.members = {4, 1};
  types.add(5, payload);
  types.setMemberName(5, 0, "light");
  types.setMemberName(5, 1, "t");
  return types;
}

TEST(Leaves, NumbersPartsInOrder) {
  const Types types = typesWithPayload();
  const Leaves leaves(types, 5);
  EXPECT_EQ(leaves.count(), 6u);
  EXPECT_THAT(leaves.path(4), ElementsAre(0, 1, 1));
  EXPECT_EQ(leaves.range(Path{0}), (LeafRange{0, 5, true}));
  EXPECT_EQ(leaves.range(Path{0, 1, 1}), (LeafRange{4, 5, true}));
  EXPECT_EQ(leaves.range(Path{1, 7}), (LeafRange{5, 6, true}));  // into a leaf
  const std::vector<std::optional<std::uint32_t>> dynamic{0, 1, std::nullopt};
  EXPECT_EQ(leaves.range(dynamic), (LeafRange{3, 5, false}));
  EXPECT_EQ(leaves.member(4), (LeafRange{0, 5, true}));
}

TEST(Leaves, NamesTheSmallestParts) {
  const Types types = typesWithPayload();
  const Leaves leaves(types, 5);
  EXPECT_THAT(leaves.names({0, 1, 2}), ElementsAre(".light.color"));
  EXPECT_THAT(leaves.names({0, 2, 4}), ElementsAre(".light.color.xz", ".light.power[1]"));
  EXPECT_THAT(leaves.names({0, 1, 2, 3, 4, 5}), ElementsAre(".light", ".t"));
  EXPECT_THAT(Leaves(types, 2).names({0, 1, 2}), ElementsAre(""));
  EXPECT_THAT(Leaves(types, 2).names({1}), ElementsAre(".y"));
  EXPECT_THAT(Leaves(types, 3).names({1}), ElementsAre("[1]"));
}

TEST(Leaves, AreCoarserForLargeTypes) {
  Types types = typesWithPayload();
  Type array;
  array.kind = Type::Kind::array, array.element = 4, array.count = 16;
  types.add(6, array);  // 16 * 5 leaves
  Type large;
  large.kind = Type::Kind::structure, large.members = {6, 6, 6, 6};
  types.add(7, large);
  EXPECT_EQ(Leaves(types, 6).count(), 80u);
  EXPECT_EQ(Leaves(types, 7).count(), 192u);  // 3 for each light
  large.members.assign(40, 6);
  types.add(8, large);
  EXPECT_EQ(Leaves(types, 8).count(), 40u);
  EXPECT_EQ(Leaves(types, 99).count(), 1u);  // unknown
}

TEST(StageFactsByLeaf, FollowsPartsOfStoredValues) {
  EXPECT_THAT(written(factsOf("void main() { payload.light.color = vec3(1); }"), true), ElementsAre(0, 1, 2));
  EXPECT_THAT(written(factsOf("void main() { payload.v.xw = vec2(1); }"), true), ElementsAre(5, 8));
  EXPECT_THAT(written(factsOf("void main() { payload.light.power[1] = 1.0; }"), true), ElementsAre(4));
  EXPECT_THAT(written(factsOf("void main() { payload.light.power[gl_PrimitiveID & 1] = 1.0; }"), true),
              ElementsAre(3, 4));
  EXPECT_THAT(written(factsOf("void main() { if (gl_PrimitiveID > 0) payload.hit = true; payload.v.y = 1.0; }"), true),
              ElementsAre(6));
}

// What a store puts back is neither read nor written.
TEST(StageFactsByLeaf, IgnoresPartsThatAreStoredUnchanged) {
  const StageFacts helper =
      factsOf("void change(inout Payload p) { p.light.color.y = 2.0; p.v *= 2.0; }\nvoid main() { change(payload); }");
  EXPECT_THAT(written(helper, false), ElementsAre(1, 5, 6, 7, 8));
  EXPECT_THAT(readFirst(helper), ElementsAre(5, 6, 7, 8));
  const StageFacts nested =
      factsOf("void change(inout Light l) { l.power[0] = 2.0; }\nvoid main() { change(payload.light); }");
  EXPECT_THAT(written(nested, false), ElementsAre(3));
  EXPECT_THAT(readFirst(nested), ElementsAre());
  const StageFacts moved = factsOf("void main() { payload.light.color = payload.v.xyz; }");
  EXPECT_THAT(written(moved, false), ElementsAre(0, 1, 2));
  EXPECT_THAT(readFirst(moved), ElementsAre(5, 6, 7));
}

TEST(StageFactsByLeaf, FindsReadsThatSeeATrace) {
  const StageFacts facts = factsOf(
      "void main() {\n  inner.v = vec4(gl_HitTEXT);\n  trace();\n  vec4 v = inner.v;\n"
      "  payload.v = v.w > 0.0 ? v.xyzz : vec4(0.0);\n  payload.hit = inner.hit;\n}");
  const TraceFacts& trace = facts.traces()[0];
  const auto unguarded = [&](std::uint32_t leaf) {
    return facts.unguardedReads(trace.instruction, trace.payload, leaf).size();
  };
  EXPECT_EQ(unguarded(5), 0u);  // chosen by w
  EXPECT_EQ(unguarded(8), 1u);  // the condition
  EXPECT_EQ(unguarded(9), 1u);
  EXPECT_EQ(unguarded(0), 0u);  // not read
  EXPECT_TRUE(facts.writtenBefore(trace.payload, 5, trace.instruction));
  EXPECT_FALSE(facts.writtenBefore(trace.payload, 9, trace.instruction));
}

TEST(StageFactsByLeaf, FindsInputsThatHaveAnEffect) {
  const StageFacts facts = factsOf(
      "void main() {\n  if (payload.hit) payload.v.x = payload.v.y;\n  payload.light.power[0] += 1.0;\n"
      "  float unused = payload.v.w;\n}");
  const Id payload = facts.incoming(spv::StorageClass::IncomingRayPayloadKHR)->id;
  EXPECT_EQ(facts.inputReads(payload, 9).size(), 1u);
  EXPECT_EQ(facts.inputReads(payload, 3).size(), 1u);
  EXPECT_EQ(facts.inputReads(payload, 6).size(), 0u);  // guarded by `hit`
  EXPECT_EQ(facts.inputReads(payload, 8).size(), 0u);  // without an effect
}

TEST(StageFactsByLeaf, FindsStoredValues) {
  const StageFacts facts =
      factsOf("void main() { payload.light = Light(vec3(1.0, 2.0, gl_HitTEXT), float[2](3.0, 4.0)); }");
  const Id payload = facts.incoming(spv::StorageClass::IncomingRayPayloadKHR)->id;
  const auto stored = [&](std::uint32_t leaf) {
    for (const AccessFacts& a : facts.accesses())
      if (a.writes && a.variable == payload && a.leaves.covers(leaf))
        return facts.module().constantFloat(facts.storedValue(a, leaf).id).value_or(-1.0);
    return -2.0;
  };
  EXPECT_EQ(stored(1), 2.0);
  EXPECT_EQ(stored(2), -1.0);  // not constant
  EXPECT_EQ(stored(4), 4.0);
  EXPECT_EQ(stored(5), -2.0);  // not written
}

}  // namespace
}  // namespace quintet::spirv
