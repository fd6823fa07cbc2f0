// SPDX-License-Identifier: Apache-2.0
// Raw SPIR-V modules: which rules run, locations with and without lines, records, and malformed modules.
#include <gmock/gmock.h>

#include <cstring>

#include "check/modules/stage_groups.h"
#include "modules_test_support.h"
#include "spirv/plain_lines.h"
#include "spirv/shader_record.h"

namespace quintet::check {
namespace {

using shader::Stage;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, text.npos) << from;
  text.replace(at, from.size(), to);
}

InstanceRecords instanceOf(std::uint32_t offset, std::uint32_t first, std::uint32_t count) {
  InstanceRecords instance;
  instance.facts.name = "ball";
  instance.facts.firstGeometry = first;
  instance.facts.geometryCount = count;
  instance.recordOffset = offset;
  return instance;
}

TEST(ModuleCheck, AcceptsACleanPipeline) { EXPECT_THAT(cleanPipeline().check(), IsEmpty()); }

TEST(ModuleCheck, ReportsPayloadTypesAtTheLineOfTheTrace) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rmiss"), "vec4 color;", "vec3 color;");
  replace(p.text("a.rmiss"), "vec4(0.5)", "vec3(0.5)");
  EXPECT_THAT(p.check(), Contains("Q101 a.rgen:7"));
}

// A ray generation shader with a second trace, with records and a payload of its own.
std::string twoTraces(const std::string& flags) {
  return R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba8) uniform image2D result;
layout(location = 0) rayPayloadEXT vec4 color;
layout(location = 1) rayPayloadEXT float visible;
void main() {
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 2, 0, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);
  visible = 0.0;
  traceRayEXT(tlas, )" +
         flags +
         R"(, 0xFF, 1, 2, 1, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 1);
  imageStore(result, ivec2(gl_LaunchIDEXT.xy), color * visible);
}
)";
}

// A trace whose hits run no closest-hit shader has a payload of its own type. Which group it hits is unknown.
TEST(ModuleCheck, AcceptsPayloadsThatOnlyOneOfSeveralTracesShares) {
  RawPipeline p = cleanPipeline();
  p.text("a.rgen") = twoTraces("gl_RayFlagsTerminateOnFirstHitEXT");
  p.stages.push_back({"s.rmiss",
                      "layout(location = 1) rayPayloadInEXT float visible;\nvoid main() { visible = 1.0; }\n",
                      Stage::miss});
  p.groups.misses.push_back({{}, "s.rmiss", {}, 0});
  program::HitGroup empty;
  empty.shaders.try_emplace("");
  p.groups.hitGroups.push_back(empty);
  for (const bool known : {true, false}) {
    p.groups.tablesKnown = known;
    EXPECT_THAT(p.check(), IsEmpty()) << known;
  }
  replace(p.text("s.rmiss"), "float visible", "double visible");  // no trace sends it
  replace(p.text("s.rmiss"), "visible = 1.0", "visible = 1.0LF");
  for (const bool known : {true, false}) {
    p.groups.tablesKnown = known;
    EXPECT_THAT(p.check(), Contains("Q101 a.rgen:10")) << known;
  }
}

TEST(ModuleCheck, NamesTheIdIfThereAreNoLines) {
  RawPipeline p = cleanPipeline();
  p.lines = false;
  replace(p.text("a.rmiss"), "vec4 color;", "vec3 color;");
  replace(p.text("a.rmiss"), "vec4(0.5)", "vec3(0.5)");
  const std::vector<Diagnostic> found = p.diagnostics();
  ASSERT_THAT(found, testing::SizeIs(1));
  EXPECT_EQ(found[0].id + found[0].file, "Q101a.rgen");
  EXPECT_EQ(found[0].line, 0);
  EXPECT_THAT(found[0].text, AllOf(HasSubstr("SPIR-V id %"), HasSubstr("OpTraceRayKHR number 1")));
  EXPECT_THAT(found[0].text, testing::Not(HasSubstr("\x1f")));
}

TEST(ModuleCheck, DoesNotAssumeTheLibraryOfQuintet) {
  RawPipeline p = cleanPipeline();
  // A descriptor and push constants of its own, gl_InstanceID as an index, and structures with names of the library.
  p.text("a.rchit") = R"(layout(location = 0) rayPayloadInEXT vec4 color;
struct InstanceData { vec4 worldFromObject[3]; vec4 tint; };
layout(set = 3, binding = 9) buffer Instances { InstanceData at[]; } instances;
layout(push_constant) uniform Launch { uint firstSample; } launch;
void main() { color = instances.at[gl_InstanceID].tint * float(launch.firstSample); }
)";
  EXPECT_THAT(p.check(), IsEmpty());
}

TEST(ModuleCheck, ReportsMembersThatAShaderDoesNotWrite) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rmiss"), "color = vec4(0.5);", "color.x = 0.5;");
  EXPECT_THAT(p.check(), Contains("Q104 a.rgen:7"));
}

TEST(ModuleCheck, AcceptsMembersThatOneOfSeveralUnknownHitGroupsWrites) {
  RawPipeline p = cleanPipeline();
  p.stages.push_back({"b.rchit", "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color.x = 1.0; }\n",
                      Stage::closestHit});
  program::HitGroup other;
  other.shaders[""].closestHit = "b.rchit";
  p.groups.hitGroups.push_back(other);
  EXPECT_THAT(p.check(), IsEmpty());  // which of the two is hit is unknown
  p.groups.geometries.resize(1);
  p.groups.instances = {instanceOf(1, 0, 1)};
  EXPECT_THAT(p.check(), Contains("Q104 a.rgen:7"));  // the second one
}

TEST(ModuleCheck, ReportsIndicesBeyondTheTable) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rgen"), "0xFF, 0, 1, 0,", "0xFF, 0, 1, 1,");
  EXPECT_THAT(p.check(), ElementsAre("Q502 a.rgen:7"));
  p.groups.tablesKnown = false;  // the miss shader can be record 1
  EXPECT_THAT(p.check(), IsEmpty());
}

// ~0 is the usual mask of HLSL; other bits above the low 8 are a mistake.
TEST(ModuleCheck, AcceptsAMaskOfAllBits) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rgen"), "0xFF, 0, 1, 0,", "~0u, 0, 1, 0,");
  EXPECT_THAT(p.check(), IsEmpty());
  replace(p.text("a.rgen"), "~0u, 0, 1, 0,", "0x100u, 0, 1, 0,");
  EXPECT_THAT(p.check(), ElementsAre("Q505 a.rgen:7"));
}

// The types of HLSL and GLSL differ in structures around single values only.
TEST(ModuleCheck, AcceptsStructuresAroundSingleValues) {
  RawPipeline p = cleanPipeline();
  p.text("a.rmiss") =
      "struct P { vec4 color; };\nlayout(location = 0) rayPayloadInEXT P p;\nvoid main() { p.color = vec4(0.5); }\n";
  replace(p.text("a.rchit"), "hitAttributeEXT vec2 b;\n", "struct A { vec2 b; };\nhitAttributeEXT A a;\n");
  replace(p.text("a.rchit"), "vec4(b, 0, 1)", "vec4(a.b, 0, 1)");
  EXPECT_THAT(p.check(), IsEmpty());
  replace(p.text("a.rmiss"), "vec4 color;", "vec3 color;");
  replace(p.text("a.rmiss"), "vec4(0.5)", "vec3(0.5)");
  EXPECT_THAT(p.check(), Contains("Q101 a.rgen:7"));
  replace(p.text("a.rchit"), "struct A { vec2 b; };", "struct A { vec2 b; float c; };");
  EXPECT_THAT(p.check(), Contains("Q202 a.rchit:5"));
}

TEST(ModuleCheck, ReportsRecordsBeyondTheTable) {
  RawPipeline p = cleanPipeline();
  p.groups.geometries.resize(2);
  p.groups.instances = {instanceOf(0, 0, 1)};
  EXPECT_THAT(p.check(), IsEmpty());
  p.groups.instances = {instanceOf(0, 0, 2)};  // geometry 1 uses record 1
  EXPECT_THAT(p.check(), ElementsAre("Q515 a.rgen:7"));
}

TEST(ModuleCheck, ReportsGeometryOfADifferentKind) {
  RawPipeline p = cleanPipeline();
  p.groups.geometries.resize(1);
  p.groups.geometries[0].kind = program::GeometryKind::custom;
  p.groups.instances = {instanceOf(0, 0, 1)};
  EXPECT_THAT(p.check(), ElementsAre("Q609 a.rgen:7"));
}

TEST(ModuleCheck, ReportsAnyHitShadersThatFlagsExclude) {
  RawPipeline p = cleanPipeline();
  p.stages.push_back({"a.rahit", "void main() { ignoreIntersectionEXT; }\n", Stage::anyHit});
  p.groups.hitGroups[0].shaders[""].anyHit = "a.rahit";
  replace(p.text("a.rgen"), "gl_RayFlagsNoneEXT", "gl_RayFlagsOpaqueEXT");
  EXPECT_THAT(p.check(), ElementsAre(testing::StartsWith("Q610 a.rahit")));
}

TEST(ModuleCheck, ReportsRecursionBeyondTheDeclaredDepth) {
  RawPipeline p = cleanPipeline();
  p.text("a.rchit") = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadInEXT vec4 color;
layout(location = 1) rayPayloadEXT vec4 inner;
void main() {
  inner = vec4(0);
  traceRayEXT(tlas, gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, 0, 1, 0, vec3(1), 0.001, vec3(0, 0, 1), 100.0, 1);
  color = inner;
}
)";
  EXPECT_THAT(p.check(), Contains("Q402 a.rchit:8"));
  p.groups.declaredRecursion = 2;
  EXPECT_THAT(p.check(), IsEmpty());
  p.groups.declaredRecursion.reset();  // the description does not say it
  EXPECT_THAT(p.check(), IsEmpty());
}

TEST(ModuleCheck, AppliesSpecializationConstants) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rgen"), "void main() {", "layout(constant_id = 3) const uint kMiss = 0u;\nvoid main() {");
  replace(p.text("a.rgen"), "0xFF, 0, 1, 0,", "0xFF, 0, 1, kMiss,");
  EXPECT_THAT(p.check(), IsEmpty());  // unknown
  p.values.emplace();
  EXPECT_THAT(p.check(), IsEmpty());  // the default
  (*p.values)[3] = {1};
  EXPECT_THAT(p.check(), ElementsAre("Q502 a.rgen:8"));
}

TEST(ModuleCheck, FindsGroupsOfStagesAlone) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rmiss"), "vec4 color;", "vec3 color;");
  replace(p.text("a.rmiss"), "vec4(0.5)", "vec3(0.5)");
  const std::vector<ModuleStage> modules = p.modules();
  const PipelineGroups groups = groupsOfStages(modules);
  EXPECT_FALSE(groups.tablesKnown);
  const CheckResult result = checkModules(groups, modules, {});
  ASSERT_THAT(result.diagnostics, testing::SizeIs(1));
  EXPECT_EQ(result.diagnostics[0].id, "Q101");
  EXPECT_THAT(result.chain, ElementsAre("a.rgen", testing::_));
}

// A member that a miss leaves, in a condition that the miss decides.
TEST(ModuleCheck, AcceptsMembersBehindLogicalOperators) {
  RawPipeline p = cleanPipeline();
  const std::string head =
      "layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;\n"
      "layout(set = 0, binding = 1, rgba8) uniform image2D result;\n"
      "layout(location = 0) rayPayloadEXT vec4 color;\nvoid main() {\n"
      "  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);\n";
  const auto stored = [&](const std::string& condition) {
    return head + "  imageStore(result, ivec2(gl_LaunchIDEXT.xy), vec4(" + condition + " ? 1.0 : 0.0));\n}\n";
  };
  p.text("a.rmiss") = "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color.w = -1.0; }\n";
  for (const char* condition : {"color.w < 0.0 || color.x > 0.5", "color.w > 0.0 && color.x > 0.5"}) {
    p.text("a.rgen") = stored(condition);
    EXPECT_THAT(p.check(), IsEmpty()) << condition;
  }
  for (const char* condition : {"gl_LaunchIDEXT.x > 5u || color.x > 0.5", "color.x > 0.2 && color.x < 0.5"}) {
    p.text("a.rgen") = stored(condition);
    EXPECT_THAT(p.check(), ElementsAre("Q104 a.rgen:7")) << condition;
  }
}

// Without groups: an any-hit shader of shadow rays is in a different hit group than the closest-hit shader, a trace with a
// different record can run no shader, and a miss shader can receive nothing.
TEST(ModuleCheck, DoesNotAssumeTheGroupsOfStagesAlone) {
  RawPipeline p = cleanPipeline();
  p.text("a.rgen") = twoTraces("gl_RayFlagsNoneEXT");
  replace(p.text("a.rgen"), "visible = 0.0", "visible = 1.0");
  const auto found = [&] {
    const std::vector<ModuleStage> modules = p.modules();
    std::vector<std::string> ids;
    for (const Diagnostic& d : checkModules(groupsOfStages(modules), modules, {}).diagnostics) ids.push_back(d.id);
    return ids;
  };
  EXPECT_THAT(found(), IsEmpty());  // records 1 without shaders
  p.stages.push_back({"s.rmiss", "void main() {}\n", Stage::miss});
  p.stages.push_back({"s.rahit",
                      "layout(location = 1) rayPayloadInEXT float visible;\nhitAttributeEXT vec2 b;\n"
                      "void main() { if (b.x > 0.5) ignoreIntersectionEXT; visible *= 0.5; }\n",
                      Stage::anyHit});
  EXPECT_THAT(found(), IsEmpty());
  replace(p.text("s.rahit"), "float visible", "vec3 visible");  // no trace sends it
  EXPECT_THAT(found(), Contains("Q101"));
}

// A constant point is an origin only if a trace starts there.
TEST(ModuleCheck, AcceptsOffsetsOfPositionsFromAConstantOrigin) {
  RawPipeline p = cleanPipeline();
  const auto shadowFrom = [&](const std::string& origin) {
    p.text("a.rgen") = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba8) uniform image2D result;
layout(location = 0) rayPayloadEXT vec4 color;
void main() {
  vec3 d = normalize(vec3(gl_LaunchIDEXT.xy, 100.0));
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(0), 0.001, d, 100.0, 0);
  vec3 p = )" + origin +
                       R"( + color.w * d;
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, p, 0.0, vec3(0, 1, 0), 100.0, 0);
  imageStore(result, ivec2(gl_LaunchIDEXT.xy), color);
}
)";
    return p.check();
  };
  EXPECT_THAT(shadowFrom("vec3(0, 0.01, 0)"), IsEmpty());
  EXPECT_THAT(shadowFrom("vec3(gl_LaunchIDEXT)"), ElementsAre("Q705 a.rgen:10"));
}

TEST(ModuleCheck, KeepsOneOfSeveralEntryPoints) {
  // A second entry point with a function of its own, as in libraries of HLSL.
  const std::vector<std::uint32_t> words = compileRaw(Stage::miss, cleanPipeline().text("a.rmiss"), "a.rmiss");
  std::vector<std::uint32_t> twice(words.begin(), words.begin() + 5);
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    const std::size_t count = words[at] >> 16;
    const std::size_t copies = (words[at] & 0xFFFFu) == static_cast<std::uint32_t>(spv::Op::OpEntryPoint) ? 2 : 1;
    for (std::size_t k = 0; k < copies; ++k) {
      twice.insert(twice.end(), words.begin() + static_cast<std::ptrdiff_t>(at),
                   words.begin() + static_cast<std::ptrdiff_t>(at + count));
      if (k == 1) twice[twice.size() - count + 3] = 0x00626173;  // "sab"
    }
  }
  std::string why;
  const auto summary = summarize(twice, why);
  ASSERT_TRUE(summary) << why;
  ASSERT_EQ(summary->entryPoints.size(), 2u);
  EXPECT_EQ(summary->entryPoints[0].name, "main");
  const auto one = spirv::withEntryPoint(twice, summary->entryPoints[0]);
  const auto left = summarize(one, why);
  ASSERT_TRUE(left);
  ASSERT_EQ(left->entryPoints.size(), 1u);
  EXPECT_EQ(left->entryPoints[0].name, "main");
}

TEST(ModuleCheck, ReportsWhatCannotBeAnalyzedAsAProblem) {
  std::vector<std::uint32_t> words = compileRaw(Stage::miss, cleanPipeline().text("a.rmiss"), "a.rmiss");
  std::string why;
  const auto summary = summarize(words, why);
  ASSERT_TRUE(summary);
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16)
    if ((words[at] & 0xFFFFu) == static_cast<std::uint32_t>(spv::Op::OpCapability)) words[at + 1] = 65000;
  const ModuleStage stage = stageModule("a.rmiss", words, summary->entryPoints.front(), {});
  EXPECT_THAT(stage.problem, HasSubstr("requires one of these capabilities"));  // unknown ones are removed
  RawPipeline p = cleanPipeline();
  std::vector<ModuleStage> modules = p.modules();
  modules[1] = stage;
  EXPECT_THAT(checkModules(p.groups, modules, {}).diagnostics, IsEmpty());
}

// NonSemantic.Shader.DebugInfo.100 in place of OpLine: the instructions that glslang -gVS and DXC write.
TEST(ModuleCheck, ConvertsDebugInfoToLines) {
  const auto op = [](spv::Op code, std::vector<std::uint32_t> operands) {
    operands.insert(operands.begin(),
                    static_cast<std::uint32_t>((operands.size() + 1) << 16) | static_cast<std::uint32_t>(code));
    return operands;
  };
  std::vector<std::uint32_t> words{spv::MagicNumber, 0x00010600, 0, 40, 0};
  const auto add = [&](spv::Op code, std::vector<std::uint32_t> operands) {
    const auto encoded = op(code, std::move(operands));
    words.insert(words.end(), encoded.begin(), encoded.end());
  };
  const auto text = [](const std::string& value) {
    std::vector<std::uint32_t> literal(value.size() / 4 + 1);
    std::memcpy(literal.data(), value.data(), value.size());
    return literal;
  };
  const auto with = [](std::vector<std::uint32_t> head, const std::vector<std::uint32_t>& tail) {
    head.insert(head.end(), tail.begin(), tail.end());
    return head;
  };
  using spv::Op;
  add(Op::OpExtInstImport, with({1}, text("NonSemantic.Shader.DebugInfo.100")));
  add(Op::OpMemoryModel, {0, 1});
  add(Op::OpEntryPoint, with({5317, 20}, text("main")));
  add(Op::OpString, with({2}, text("a.hlsl")));
  add(Op::OpString, with({3}, text("float4 color;")));
  add(Op::OpTypeVoid, {4});
  add(Op::OpTypeInt, {5, 32, 0});
  add(Op::OpConstant, {5, 6, 17});
  add(Op::OpTypeFloat, {7, 32});
  add(Op::OpTypePointer, {8, 5342, 7});
  add(Op::OpConstant, {7, 9, 0});
  add(Op::OpVariable, {8, 10, 5342});
  add(Op::OpExtInst, {4, 11, 1, 35, 2, 3});                         // DebugSource
  add(Op::OpExtInst, {4, 12, 1, 18, 2, 4, 11, 6, 6, 4, 2, 10, 6});  // DebugGlobalVariable
  add(Op::OpTypeFunction, {13, 4});
  add(Op::OpFunction, {4, 20, 0, 13});
  add(Op::OpLabel, {21});
  add(Op::OpExtInst, {4, 22, 1, 103, 11, 6, 6, 6, 6});  // DebugLine
  add(Op::OpStore, {10, 9});
  add(Op::OpReturn, {});
  add(Op::OpFunctionEnd, {});
  const auto module = spirv::Module::read(spirv::withPlainLines(words));
  ASSERT_TRUE(module);
  EXPECT_EQ(module->source("a.hlsl"), "float4 color;");
  EXPECT_EQ(module->declaration(10).line, 17);
  for (const spirv::Instruction& i : module->instructions()) {
    EXPECT_NE(i.op, Op::OpExtInst);
    if (i.op != Op::OpStore) continue;
    EXPECT_EQ(locationText(module->location(i).file, module->location(i).line, 0), "a.hlsl:17");
  }
  const auto direct = spirv::Module::read(words);  // the reader understands both
  ASSERT_TRUE(direct);
  EXPECT_EQ(direct->source("a.hlsl"), "float4 color;");
  EXPECT_EQ(direct->declaration(10).line, 17);
}

TEST(ModuleCheck, RejectsFilesThatAreNoSpirv) {
  EXPECT_THROW(moduleWords("a.spv", {}), FileError);
  const std::string text = "#version 460\n";
  EXPECT_THROW(moduleWords("a.spv", std::as_bytes(std::span(text))), FileError);
}

TEST(ShaderRecord, HasTheEndOfItsLastMember) {
  const auto bytesOf = [](const std::string& block) {
    const auto words = compileRaw(Stage::callable,
                                  "#extension GL_EXT_scalar_block_layout : require\n"
                                  "layout(location = 0) callableDataInEXT vec4 c;\n" +
                                      block + "void main() { c = vec4(record.last); }\n",
                                  "a.rcall");
    const auto module = spirv::Module::read(words);
    return module ? spirv::shaderRecordBytes(*module) : 0u;
  };
  EXPECT_EQ(bytesOf("layout(shaderRecordEXT, std430) buffer R { vec3 a; float b; vec4 last; } record;\n"), 32u);
  EXPECT_EQ(bytesOf("layout(shaderRecordEXT, scalar) buffer R { float a; mat3 m; float last; } record;\n"), 44u);
}

}  // namespace
}  // namespace quintet::check
