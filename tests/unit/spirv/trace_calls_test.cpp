// SPDX-License-Identifier: Apache-2.0
// Calls around traces: the module stays valid, and each trace gets them. tests/gpu/job/heat_test.cpp shows what they count.
#include "spirv/trace_calls.h"

#include "base/error.h"
#include "program/instrument.h"
#include "rewrite_test_support.h"
#include "shader/optimizer.h"
#include "shader/shader_test_support.h"
#include "spirv/module.h"

namespace quintet::spirv {
using namespace shader;

namespace {

Words compileStage(Stage stage, const std::string& text, bool heat) {
  Source source;
  source.stage = stage;
  source.name = "test" + std::string(stageExtension(stage));
  source.text = "#version 460\n#extension GL_EXT_ray_tracing : require\n" + text;
  if (heat) source.text = program::probedStage(source.text, stage, {.prints = false, .heat = true}, false);
  source.optimize = false;
  const Result result = Compiler({}).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  return result.spirv;
}

constexpr const char* kTraces = R"(
layout(set = 0, binding = 0) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 inner;
void shoot(uint flags) { traceRayEXT(topLevelAS, flags, 255u, 0u, 1u, 0u, vec3(0), 0.1, vec3(0, 1, 0), 1e30, 1); }
void main() {
  shoot(0u);
  for (int i = 0; i < int(color.x); ++i)
    traceRayEXT(topLevelAS, 8u, 255u, 0u, 1u, 0u, vec3(0), 0.1, vec3(0, 1, 0), 1e30, 1);
}
)";

TEST(TraceCalls, AreAroundEachTrace) {
  const Words words = compileStage(Stage::closestHit, kTraces, true);
  const Words changed = addTraceCalls(words);
  EXPECT_EQ(errorsOf(changed), "");
  // Two per trace, less the call of heatKeep_.
  EXPECT_EQ(count(changed, spv::Op::OpFunctionCall), count(words, spv::Op::OpFunctionCall) + 2 * 2 - 1);
  const auto module = Module::read(changed);
  const auto& instructions = module->instructions();
  for (std::size_t i = 1; i + 1 < instructions.size(); ++i) {
    if (instructions[i].op != spv::Op::OpTraceRayKHR) continue;
    EXPECT_EQ(instructions[i - 1].at(0), module->functionNamed("heatTraceBegin_"));
    EXPECT_EQ(instructions[i - 1].at(1), instructions[i].at(1)) << "flags";
    EXPECT_EQ(instructions[i - 1].at(2), instructions[i].at(2)) << "mask";
    EXPECT_EQ(instructions[i + 1].at(0), module->functionNamed("heatTraceEnd_"));
  }
  EXPECT_EQ(errorsOf(optimize(changed)), "");
}

TEST(TraceCalls, AreNotInStagesThatDoNotTrace) {
  const Words changed = addTraceCalls(compileStage(Stage::anyHit, "void main() {}\n", true));
  EXPECT_EQ(errorsOf(changed), "");
  const Words optimized = optimize(changed);
  EXPECT_EQ(errorsOf(optimized), "");
  EXPECT_EQ(count(optimized, spv::Op::OpFunctionCall), 0u);
}

TEST(TraceCalls, RequireTheFunctions) {
  EXPECT_THROW(addTraceCalls(compileStage(Stage::closestHit, kTraces, false)), Error);
  EXPECT_THROW(addTraceCalls({1, 2, 3}), Error);
}

}  // namespace
}  // namespace quintet::spirv
