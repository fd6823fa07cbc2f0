// SPDX-License-Identifier: Apache-2.0
// The workaround for built-ins that a nested trace overwrites: which loads it replaces, and that the module stays
// valid. tests/gpu/shader shows that the device then computes what the specification requires.
#include "spirv/copy_builtins.h"

#include <random>

#include "shader/shader_test_support.h"
#include "spirv/value_flow.h"

namespace quintet::spirv {
using namespace shader;

namespace {

constexpr const char* kBuiltinHead = R"(#version 460
#extension GL_EXT_ray_tracing : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 inner;
void shoot() { traceRayEXT(topLevelAS, 0u, 255u, 0u, 1u, 0u, gl_WorldRayOriginEXT, 0.1, vec3(0, 1, 0), 1e30, 1); }
void main() {
)";

std::vector<std::uint32_t> compileClosestHit(const std::string& body, bool debugInfo = true) {
  CompilerOptions options;
  options.debugInfo = debugInfo;
  Source source;
  source.stage = Stage::closestHit;
  source.name = "test.rchit";
  source.text = kBuiltinHead + body + "\n}\n";
  Result result = Compiler(options).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  return result.spirv;
}

// Number of loads of overwritten built-ins that cannot and that can run after a trace.
struct Loads {
  int before = 0, after = 0;
};

Loads loadsOf(const std::vector<std::uint32_t>& words) {
  std::string why;
  const auto module = Module::read(words, &why);
  EXPECT_TRUE(module) << why;
  Loads loads;
  if (!module) return loads;
  std::vector<std::size_t> traces;
  for (std::size_t i = 0; i < module->instructions().size(); ++i)
    if (module->instructions()[i].op == spv::Op::OpTraceRayKHR) traces.push_back(i);
  for (std::size_t i = 0; i < module->instructions().size(); ++i) {
    const Instruction& instruction = module->instructions()[i];
    if (instruction.op != spv::Op::OpLoad) continue;
    const Variable* variable = module->variable(module->access(instruction.at(0)).variable);
    if (!variable || !variable->builtIn || !isOverwrittenByTrace(*variable->builtIn)) continue;
    const bool after = std::ranges::any_of(traces, [&](std::size_t t) { return canRunAfter(*module, i, t); });
    (after ? loads.after : loads.before)++;
  }
  return loads;
}

TEST(CopyBuiltIns, MovesLoadsBeforeTheTrace) {
  for (const bool debugInfo : {true, false}) {
    const auto words =
        compileClosestHit("shoot(); color = inner * float(gl_PrimitiveID + gl_InstanceCustomIndexEXT);", debugInfo);
    EXPECT_EQ(loadsOf(words).after, 2);
    const auto copied = copyBuiltIns(words);
    EXPECT_EQ(loadsOf(copied).after, 0);
    EXPECT_EQ(loadsOf(copied).before, 2);
  }
}

TEST(CopyBuiltIns, MovesPartsOfAMatrix) {
  const auto copied =
      copyBuiltIns(compileClosestHit("shoot(); color = inner * gl_ObjectToWorldEXT[3] + gl_WorldToObjectEXT[1].y;"));
  EXPECT_EQ(loadsOf(copied).after, 0);
  EXPECT_EQ(loadsOf(copied).before, 2);
}

TEST(CopyBuiltIns, MovesLoadsInALoopWithATrace) {
  const auto words = compileClosestHit(
      "for (int i = 0; i < gl_PrimitiveID; ++i) { color += inner * float(gl_GeometryIndexEXT); shoot(); }");
  EXPECT_GT(loadsOf(words).after, 0);
  EXPECT_EQ(loadsOf(copyBuiltIns(words)).after, 0);
}

TEST(CopyBuiltIns, KeepsLoadsWithAComputedIndex) {
  const auto words = compileClosestHit("shoot(); color = gl_ObjectToWorldEXT[int(inner.x) & 3];");
  EXPECT_EQ(copyBuiltIns(words), words);
}

TEST(CopyBuiltIns, KeepsModulesWithoutLoadsAfterATrace) {
  for (const char* body :
       {"color = vec3(gl_PrimitiveID);", "int p = gl_PrimitiveID; shoot(); color = inner * float(p);",
        "shoot(); color = inner * gl_HitTEXT * gl_WorldRayDirectionEXT;"}) {
    const auto words = compileClosestHit(body);
    EXPECT_EQ(copyBuiltIns(words), words) << body;
  }
}

TEST(CopyBuiltIns, ReturnsMalformedModulesUnchanged) {
  const auto words = compileClosestHit("shoot(); color = inner * float(gl_PrimitiveID);");
  EXPECT_TRUE(copyBuiltIns({}).empty());
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    auto broken = words;
    for (int k = 0; k < 3; ++k) broken[random() % broken.size()] = static_cast<std::uint32_t>(random());
    const bool readable = Module::read(broken).has_value();
    const auto copied = copyBuiltIns(broken);
    EXPECT_TRUE(readable || copied == broken);
  }
}

}  // namespace
}  // namespace quintet::spirv
