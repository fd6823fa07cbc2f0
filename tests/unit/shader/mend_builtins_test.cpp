// The mend for built-ins that change in a nested trace: which loads it moves, and that the module stays sound.
// tests/gpu/shader shows that the device then computes what the specification says.
#include "shader/mend_builtins.h"

#include <random>

#include "shader/spirv_flow.h"
#include "shader_test_support.h"

namespace quintet::shader {
namespace {

constexpr const char* kHead = R"(#version 460
#extension GL_EXT_ray_tracing : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 inner;
void shoot() { traceRayEXT(topLevelAS, 0u, 255u, 0u, 1u, 0u, gl_WorldRayOriginEXT, 0.1, vec3(0, 1, 0), 1e30, 1); }
void main() {
)";

std::vector<std::uint32_t> compileMain(const std::string& body, bool debugInfo = true) {
  CompilerOptions options;
  options.debugInfo = debugInfo;
  Source source;
  source.stage = Stage::closestHit;
  source.name = "test.rchit";
  source.text = kHead + body + "\n}\n";
  Result result = Compiler(options).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  return result.spirv;
}

// Loads of built-ins that change, by whether they may run after a trace.
struct Loads {
  int before = 0, after = 0;
};

Loads loadsOf(const std::vector<std::uint32_t>& words) {
  std::string why;
  const auto module = SpirvModule::read(words, &why);
  EXPECT_TRUE(module) << why;
  Loads loads;
  if (!module) return loads;
  std::vector<std::size_t> traces;
  for (std::size_t i = 0; i < module->instructions().size(); ++i)
    if (module->instructions()[i].op == spv::Op::OpTraceRayKHR) traces.push_back(i);
  for (std::size_t i = 0; i < module->instructions().size(); ++i) {
    const SpirvInstruction& instruction = module->instructions()[i];
    if (instruction.op != spv::Op::OpLoad) continue;
    const SpirvVariable* variable = module->variable(module->access(instruction.at(0)).variable);
    if (!variable || !variable->builtIn || !changesInNestedTrace(*variable->builtIn)) continue;
    const bool after = std::ranges::any_of(traces, [&](std::size_t t) { return mayRunAfter(*module, i, t); });
    (after ? loads.after : loads.before)++;
  }
  return loads;
}

TEST(MendBuiltIns, MovesLoadsBeforeTheTrace) {
  for (const bool debugInfo : {true, false}) {
    const auto words =
        compileMain("shoot(); color = inner * float(gl_PrimitiveID + gl_InstanceCustomIndexEXT);", debugInfo);
    EXPECT_EQ(loadsOf(words).after, 2);
    const auto mended = mendNestedBuiltIns(words);
    EXPECT_EQ(loadsOf(mended).after, 0);
    EXPECT_EQ(loadsOf(mended).before, 2);
  }
}

TEST(MendBuiltIns, PartsOfAMatrix) {
  const auto mended =
      mendNestedBuiltIns(compileMain("shoot(); color = inner * gl_ObjectToWorldEXT[3] + gl_WorldToObjectEXT[1].y;"));
  EXPECT_EQ(loadsOf(mended).after, 0);
  EXPECT_EQ(loadsOf(mended).before, 2);
}

TEST(MendBuiltIns, LoadsInALoopWithATrace) {
  const auto words =
      compileMain("for (int i = 0; i < gl_PrimitiveID; ++i) { color += inner * float(gl_GeometryIndexEXT); shoot(); }");
  EXPECT_GT(loadsOf(words).after, 0);
  EXPECT_EQ(loadsOf(mendNestedBuiltIns(words)).after, 0);
}

TEST(MendBuiltIns, ComputedIndexStays) {
  const auto words = compileMain("shoot(); color = gl_ObjectToWorldEXT[int(inner.x) & 3];");
  EXPECT_EQ(mendNestedBuiltIns(words), words);
}

TEST(MendBuiltIns, NothingToMend) {
  for (const char* body :
       {"color = vec3(gl_PrimitiveID);", "int p = gl_PrimitiveID; shoot(); color = inner * float(p);",
        "shoot(); color = inner * gl_HitTEXT * gl_WorldRayDirectionEXT;"}) {
    const auto words = compileMain(body);
    EXPECT_EQ(mendNestedBuiltIns(words), words) << body;
  }
}

TEST(MendBuiltIns, BrokenWordsComeBackAsTheyAre) {
  const auto words = compileMain("shoot(); color = inner * float(gl_PrimitiveID);");
  EXPECT_TRUE(mendNestedBuiltIns({}).empty());
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    auto broken = words;
    for (int k = 0; k < 3; ++k) broken[random() % broken.size()] = static_cast<std::uint32_t>(random());
    const bool readable = SpirvModule::read(broken).has_value();
    const auto mended = mendNestedBuiltIns(broken);
    EXPECT_TRUE(readable || mended == broken);
  }
}

}  // namespace
}  // namespace quintet::shader
