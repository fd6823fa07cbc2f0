// SPDX-License-Identifier: Apache-2.0
// Facts of a stage: arguments, accesses by member, control flow. Malformed modules are safe.
#include "spirv/stage_facts.h"

#include <random>

#include "shader/shader_test_support.h"
#include "spirv/glsl_declaration.h"

namespace quintet::spirv {
using namespace shader;

namespace {

std::vector<std::uint32_t> compileStage(Stage stage, const std::string& text) {
  CompilerOptions options;
  options.debugInfo = true;
  Source source;
  source.stage = stage;
  source.name = "test.glsl";
  source.text = "#version 460\n#extension GL_EXT_ray_tracing : require\n" + text;
  Result result = Compiler(options).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  return std::move(result.spirv);
}

StageFacts factsOf(Stage stage, const std::string& text) {
  return StageFacts(std::move(*Module::read(compileStage(stage, text))));
}

constexpr const char* kHit = R"(struct Payload { vec3 color; float t; uint seed; };
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 2) rayPayloadEXT Payload inner;
layout(location = 1) callableDataEXT vec4 data;
hitAttributeEXT vec2 attribs;
void change(inout Payload p) { p.color *= 2.0; }
void main() {
  const int primitive = gl_PrimitiveID;
  inner = payload;
  for (int i = 0; i < 3; ++i) {
    traceRayEXT(tlas, i == 0 ? 1u : 5u, 0xFFu, 0u, 1u, payload.seed, vec3(0), 0.0, vec3(1), 1.0, 2);
    if (inner.t < 0.0) break;
  }
  change(payload);
  executeCallableEXT(uint(gl_InstanceID), 1);
  if (attribs.x > 0.5) payload.t = data.x;
}
)";

TEST(StageFacts, FindsArgumentsAndVariables) {
  const StageFacts facts = factsOf(Stage::closestHit, kHit);
  ASSERT_EQ(facts.traces().size(), 1u);
  const TraceFacts& trace = facts.traces()[0];
  EXPECT_EQ(trace.flags.values, (std::vector<std::uint32_t>{1, 5}));
  EXPECT_TRUE(trace.flags.mustHave(1));
  EXPECT_FALSE(trace.flags.mustHave(4));
  EXPECT_TRUE(trace.flags.mayHave(4));
  EXPECT_FALSE(trace.flags.mayHave(2));
  EXPECT_FALSE(trace.miss.known);
  EXPECT_TRUE(trace.inLoop);
  ASSERT_EQ(facts.calls().size(), 1u);
  EXPECT_FALSE(facts.calls()[0].index.known);
  const SharedVariable* inner = facts.variable(trace.payload);
  ASSERT_TRUE(inner);
  EXPECT_EQ(inner->location, 2);
  EXPECT_EQ(inner->declaration.line, 6);
  EXPECT_EQ(inner->declaration.column, 44);
}

TEST(StageFacts, OrdersVariablesByLocation) {
  const StageFacts facts = factsOf(Stage::callable,
                                   "layout(location = 1) callableDataInEXT float result;\n"
                                   "layout(location = 0) callableDataInEXT vec3 position;\n"
                                   "void main() { result = position.x; }\n");
  ASSERT_EQ(facts.variables().size(), 2u);
  EXPECT_EQ(facts.variables()[0].name, "position");
  EXPECT_EQ(facts.incoming(spv::StorageClass::IncomingCallableDataKHR), &facts.variables()[0]);
}

TEST(StageFacts, FindsAccessesByMember) {
  const StageFacts facts = factsOf(Stage::closestHit, kHit);
  const Id payload = facts.incoming(spv::StorageClass::IncomingRayPayloadKHR)->id;
  constexpr std::uint32_t kColor = 0, kT = 3, kSeed = 4;  // leaves; the color has three
  EXPECT_EQ(facts.leaves(payload).count(), 5u);
  EXPECT_TRUE(facts.writesAlways(payload, kColor));  // through the inout parameter
  EXPECT_TRUE(facts.writes(payload, kT));
  EXPECT_FALSE(facts.writesAlways(payload, kT));  // if
  EXPECT_FALSE(facts.writes(payload, kSeed));     // put back unchanged
  EXPECT_TRUE(facts.readsBeforeWriting(payload, kColor));
  EXPECT_TRUE(facts.readsBeforeWriting(payload, kSeed));
  const TraceFacts& trace = facts.traces()[0];
  EXPECT_TRUE(facts.writtenBefore(trace.payload, kT, trace.instruction));
  EXPECT_EQ(facts.unguardedReads(trace.instruction, trace.payload, kT).size(), 1u);
  EXPECT_TRUE(facts.unguardedReads(trace.instruction, trace.payload, kColor).empty());
}

TEST(StageFacts, FindsBuiltInsReadAfterATrace) {
  const StageFacts facts = factsOf(Stage::closestHit, kHit);
  int found = 0;
  for (const BuiltInRead& read : facts.builtIns()) {
    if (read.builtIn != spv::BuiltIn::InstanceId) continue;
    EXPECT_TRUE(read.afterTrace);
    ++found;
  }
  EXPECT_EQ(found, 1);
}

TEST(StageFacts, AcceptsAnyModuleSafely) {
  const std::vector<std::uint32_t> good = compileStage(Stage::closestHit, kHit);
  std::mt19937 random(11);
  const auto pick = [&](std::size_t below) { return static_cast<std::size_t>(random() % below); };
  std::size_t sum = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::uint32_t> words = good;
    for (std::size_t k = 1 + pick(5); k > 0; --k) {
      std::uint32_t& word = words[pick(words.size())];
      word = pick(3) == 0   ? static_cast<std::uint32_t>(pick(words[3] + 2))
             : pick(2) == 0 ? words[pick(words.size())]
                            : word ^ (1u << pick(32));
    }
    auto module = Module::read(std::move(words));
    if (!module) continue;
    const StageFacts facts(std::move(*module));
    for (const SharedVariable& variable : facts.variables()) {
      for (std::uint32_t leaf = 0; leaf < std::min(facts.leaves(variable.id).count(), 8u); ++leaf) {
        sum += facts.writesAlways(variable.id, leaf) + facts.readsBeforeWriting(variable.id, leaf);
        sum += facts.inputReads(variable.id, leaf).size();
        for (const TraceFacts& trace : facts.traces())
          sum += facts.unguardedReads(trace.instruction, variable.id, leaf).size() +
                 facts.writtenBefore(variable.id, leaf, trace.instruction);
      }
    }
    sum += facts.frameBytes() > 0;
  }
  EXPECT_GT(sum, 1000u);
}

TEST(GlslDeclaration, FindsDeclarationsInSource) {
  const auto found = findDeclaration(
      "// rayPayloadInEXT P a;\n/* layout(location = 1)\n rayPayloadInEXT P a; */ layout(location = 7) "
      "rayPayloadInEXT\n P a[3];",
      "rayPayloadInEXT", "a");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->line, 4);
  EXPECT_EQ(found->column, 4);
  EXPECT_EQ(found->location, 7);
  EXPECT_FALSE(findDeclaration("rayPayloadInEXT P ab;", "rayPayloadInEXT", "a"));
  EXPECT_FALSE(findDeclaration("rayPayloadInEXT P a", "rayPayloadInEXT", "a"));
  EXPECT_EQ(findDeclaration("layout(location = kHere) rayPayloadEXT B { vec3 x; } b;", "rayPayloadEXT", "b")->location,
            std::nullopt);
  const auto mapped =
      findDeclaration("x\n#line 40 \"user.rt.glsl\"\ny\nlayout(location=0) rayPayloadEXT P a;", "rayPayloadEXT", "a");
  ASSERT_TRUE(mapped);
  EXPECT_EQ(mapped->file, "user.rt.glsl");
  EXPECT_EQ(mapped->line, 41);
}

}  // namespace
}  // namespace quintet::spirv
