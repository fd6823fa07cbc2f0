// SPDX-License-Identifier: Apache-2.0
// Which programs trace by ray queries.
#include "program/inline_traces.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "program/compile.h"
#include "program/load.h"
#include "program/program_test_support.h"
#include "spirv/module.h"

namespace quintet::program {
namespace {

using Defines = std::vector<std::pair<std::string, std::string>>;

const Defines kOpaque{{"QUINTET_NO_SEEDS", "1"}, {kInlineTraces, "1"}};
const Defines kAlpha{{kInlineTraces, "1"}};

bool isInline(const Program& program, const Defines& defines, Instrumentation instrumentation = Instrumentation::none) {
  const Defines result = definesOfStages(program, defines, instrumentation);
  return std::ranges::any_of(result, [](const auto& define) { return define.first == kInlineTraces; });
}

std::ptrdiff_t countOf(const CompiledProgram& compiled, spv::Op op) {
  const auto module = spirv::Module::read(compiled.stages.front().spirv);
  if (!module) return -1;
  return std::ranges::count(module->instructions(), op, &spirv::Instruction::op);
}

TEST(InlineTraces, ReplaceTheShadersOfTheLibrary) {
  for (const char* name : {"<programs/pathtracer>", "<programs/naive>", "<programs/ao>", "<programs/normals>"})
    EXPECT_TRUE(isInline(loadProgram(name), kOpaque)) << name;
  EXPECT_TRUE(isInline(loadProgram("<programs/pathtracer>"), kAlpha));
  EXPECT_TRUE(isInline(loadProgram("<programs/naive>"), kAlpha));
}

TEST(InlineTraces, RequireThatTheDeviceAndTheScenePermitThem) {
  EXPECT_FALSE(isInline(loadProgram("<programs/pathtracer>"), {{"QUINTET_NO_SEEDS", "1"}}));
}

TEST(InlineTraces, KeepOtherDefinitions) {
  const Program program = loadProgram("<programs/pathtracer>");
  EXPECT_EQ(definesOfStages(program, kOpaque, Instrumentation::checks), (Defines{{"QUINTET_NO_SEEDS", "1"}}));
}

// The shadow rays of `ao` test alpha at random. Without a hit group for alpha, all triangles are opaque.
TEST(InlineTraces, TestAlphaAsTheProgramDoes) {
  EXPECT_FALSE(isInline(loadProgram("<programs/ao>"), kAlpha));
  Program program = loadProgram("<programs/pathtracer>");
  program.hitGroups[0].material = {"glass"};
  EXPECT_FALSE(isInline(program, kAlpha));
  Program opaque = loadProgram("<programs/pathtracer>");
  opaque.hitGroups.resize(1);
  EXPECT_FALSE(isInline(opaque, kAlpha));
  EXPECT_TRUE(isInline(opaque, kOpaque));
}

TEST(InlineTraces, DoNotReplaceOtherShaders) {
  Program hits = loadProgram("<programs/pathtracer>");
  hits.hitGroups[1].shaders["radiance"].closestHit = "own.rchit";
  EXPECT_FALSE(isInline(hits, kOpaque));
  Program sky = loadProgram("<programs/pathtracer>");
  sky.rays[0].miss = "sky.rmiss";
  EXPECT_FALSE(isInline(sky, kOpaque));
  Program shadow = loadProgram("<programs/pathtracer>");
  shadow.rays[1].miss = "shadow.rmiss";
  EXPECT_FALSE(isInline(shadow, kOpaque));
  Program leaves = loadProgram("<programs/pathtracer>");
  leaves.hitGroups[1].shaders["radiance"].anyHit = "leaf.rahit";
  EXPECT_FALSE(isInline(leaves, kAlpha));
  EXPECT_FALSE(isInline(leaves, kOpaque));  // it runs for instances that are forced not to be opaque
  Program forAll = loadProgram("<programs/pathtracer>");
  forAll.anyHitForAll = true;
  EXPECT_FALSE(isInline(forAll, kOpaque));
  Program photons = loadProgram("<programs/pathtracer>");
  photons.rays.push_back({.name = "photon", .miss = "<quintet/stages/radiance.rmiss>"});
  EXPECT_FALSE(isInline(photons, kOpaque));
  Program boxes = loadProgram("<programs/pathtracer>");
  std::erase_if(boxes.hitGroups,
                [](const HitGroup& group) { return group.shaders.at("radiance").intersection.empty(); });
  EXPECT_FALSE(isInline(boxes, kOpaque));
  Program users = loadProgram("<programs/pathtracer>");
  users.origin = "programs/pathtracer";  // the check must see its calls
  EXPECT_FALSE(isInline(users, kOpaque));
}

TEST(InlineTraces, AreNotUsedIfCallsAreObserved) {
  for (const Instrumentation instrumentation :
       {Instrumentation::recursion, Instrumentation::checks, Instrumentation::explain})
    EXPECT_FALSE(isInline(loadProgram("<programs/pathtracer>"), kOpaque, instrumentation));
}

TEST(InlineTraces, LeaveNoCallInTheRayGenerationShader) {
  Defines defines = kOpaque;
  defines.emplace_back("QUINTET_NO_PROCEDURALS", "1");
  defines.emplace_back("QUINTET_NO_TRANSMITTANCE", "1");
  const CompiledProgram queries = compile(loadProgram("<programs/ao>"), compiler(), defines);
  ASSERT_TRUE(queries.ok);
  EXPECT_EQ(countOf(queries, spv::Op::OpTraceRayKHR), 0);
  EXPECT_EQ(countOf(queries, spv::Op::OpRayQueryInitializeKHR), 2);
  std::erase_if(defines, [](const auto& define) { return define.first == kInlineTraces; });
  const CompiledProgram calls = compile(loadProgram("<programs/ao>"), compiler(), defines);
  ASSERT_TRUE(calls.ok);
  EXPECT_EQ(countOf(calls, spv::Op::OpTraceRayKHR), 2);
  EXPECT_EQ(countOf(calls, spv::Op::OpRayQueryInitializeKHR), 0);
}

}  // namespace
}  // namespace quintet::program
