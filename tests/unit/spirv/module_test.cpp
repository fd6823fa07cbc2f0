// SPDX-License-Identifier: Apache-2.0
// Reads compiled shaders, analyzes their data flow and types, and rejects malformed modules safely.
#include "spirv/module.h"

#include <gmock/gmock.h>

#include <random>

#include "shader/shader_test_support.h"
#include "spirv/value_flow.h"

namespace quintet::spirv {
using namespace shader;

namespace {

using testing::HasSubstr;

Result compileText(Stage stage, const std::string& text, std::map<std::string, std::string> files = {}) {
  CompilerOptions options;
  options.debugInfo = true;
  Source source;
  source.stage = stage;
  source.name = "folder/test.glsl";
  source.text = "#version 460\n#extension GL_EXT_ray_tracing : require\n" + text;
  source.virtualFiles = std::move(files);
  Result result = Compiler(options).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  return result;
}

Module readText(Stage stage, const std::string& text, std::map<std::string, std::string> files = {}) {
  std::string why;
  auto module = Module::read(compileText(stage, text, std::move(files)).spirv, &why);
  EXPECT_TRUE(module) << why;
  return std::move(*module);
}

const Instruction* firstOf(const Module& module, spv::Op op) {
  const auto found = std::ranges::find(module.instructions(), op, &Instruction::op);
  return found == module.instructions().end() ? nullptr : &*found;
}

constexpr const char* kTracer = R"(struct RayPayload { vec3 color; bool hit; float d[3]; };
layout(set = 0, binding = 0) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT RayPayload payload;
layout(location = 1) rayPayloadEXT RayPayload inner;
bool trace(vec3 origin, uint flags) {
  traceRayEXT(topLevelAS, flags | gl_RayFlagsTerminateOnFirstHitEXT,
              0xFFu, 1u, 2u, payload.hit ? 1u : 3u, origin, 0.0, vec3(0, 1, 0), 1e30, 1);
  return inner.hit;
}
void main() {
  vec3 origin = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  while (trace(origin, gl_RayFlagsOpaqueEXT)) {
    payload.color += inner.color;
    origin = inner.color;
  }
  payload.d[gl_PrimitiveID % 3] = normalize(gl_WorldNormal()).x;
}
)";

std::string tracer() {
  std::string text = kTracer;
  text.replace(text.find("gl_WorldNormal()"), 16, "gl_ObjectRayDirectionEXT");
  return text;
}

TEST(Module, ReadsATrace) {
  const Module module = readText(Stage::closestHit, tracer());
  EXPECT_EQ(module.stage(), spv::ExecutionModel::ClosestHitKHR);
  ASSERT_TRUE(module.entry());
  const Instruction* trace = firstOf(module, spv::Op::OpTraceRayKHR);
  ASSERT_TRUE(trace);
  EXPECT_EQ(module.constantBits(trace->at(1)), 1u | 4u);  // folded through the function's parameter
  EXPECT_EQ(module.constantBits(trace->at(2)), 0xFFu);
  EXPECT_EQ(module.constantBits(trace->at(5)), std::nullopt);
  EXPECT_EQ(module.constantFloat(trace->at(7)), 0.0);
  const Variable* payload = module.variable(trace->at(10));
  ASSERT_TRUE(payload);
  EXPECT_EQ(payload->name, "inner");
  EXPECT_EQ(payload->storage, spv::StorageClass::RayPayloadKHR);
  EXPECT_EQ(module.types().describe(payload->type), "struct RayPayload { vec3 color; bool hit; float[3] d; }");
  EXPECT_EQ(module.types().get(payload->type).bytes, 12u + 4u + 12u);
}

// Every number is also the id of an instruction.
TEST(Module, NumbersOfConstantsAreNoOperands) {
  std::string text = "layout(location = 0) rayPayloadEXT uint p;\nvoid main() { uvec4 sum = uvec4(p);\n";
  for (int i = 1; i < 60; ++i) text += "  sum += uvec4(" + std::to_string(i) + "u, 2u, sum.zw);\n";
  const Module module = readText(Stage::rayGeneration, text + "  p = sum.x; }\n");
  std::size_t constants = 0;
  for (const Instruction& i : module.instructions()) {
    if (i.op != spv::Op::OpConstant) continue;
    ++constants;
    EXPECT_THAT(valueOperands(i), testing::IsEmpty()) << i.result;
    EXPECT_FALSE(dependsOn(module, i.result, [](const Instruction& other) { return other.op == spv::Op::OpLoad; }));
  }
  EXPECT_GE(constants, 50u);
}

TEST(Module, LocatesACallThatSpansLines) {
  const Module module = readText(Stage::closestHit, tracer());
  const SourceLocation location = module.location(*firstOf(module, spv::Op::OpTraceRayKHR), "traceRayEXT");
  EXPECT_EQ(location.file, "folder/test.glsl");
  EXPECT_EQ(location.line, 8);
  EXPECT_EQ(location.column, 3);
}

TEST(Module, LocatesInstructionsInIncludedFiles) {
  const Module module =
      readText(Stage::closestHit,
               "#include <lib/a.glsl>\nlayout(location = 0) rayPayloadInEXT float p;\nvoid main() { f(p); }\n",
               {{"lib/a.glsl", "void f(inout float x) {\n  x = gl_HitTEXT;\n}\n"}});
  const Instruction* store = firstOf(module, spv::Op::OpStore);
  ASSERT_TRUE(store);
  std::string files;
  for (const Instruction& instruction : module.instructions())
    if (instruction.op == spv::Op::OpLoad)
      files = module.location(instruction, "gl_HitTEXT").file + ":" +
              std::to_string(module.location(instruction, "gl_HitTEXT").line);
  EXPECT_EQ(files, "<lib/a.glsl>:2");
  EXPECT_NE(module.source("<lib/a.glsl>").find("gl_HitTEXT"), std::string_view::npos);
}

TEST(Module, FollowsLineDirectives) {
  const Module module =
      readText(Stage::closestHit,
               "#extension GL_GOOGLE_cpp_style_line_directive : require\nlayout(location = 0) rayPayloadInEXT float "
               "p;\n#line 100 \"user.rt.glsl\"\nvoid main() {\n  p = gl_HitTEXT;\n}\n");
  const SourceLocation location = module.location(*firstOf(module, spv::Op::OpStore));
  EXPECT_EQ(location.file, "user.rt.glsl");
  EXPECT_EQ(location.line, 101);
}

TEST(Module, FollowsAccessChains) {
  const Module module = readText(Stage::closestHit, tracer());
  bool dynamic = false, color = false;
  for (const Instruction& instruction : module.instructions()) {
    if (instruction.op != spv::Op::OpStore) continue;
    const Access access = module.access(instruction.at(0));
    const Variable* variable = module.variable(access.variable);
    ASSERT_TRUE(variable);
    EXPECT_EQ(variable->name, "payload");
    ASSERT_FALSE(access.indices.empty());
    if (access.indices[0] == 0u) color = true;
    if (access.indices[0] == 2u) dynamic = access.indices.size() == 2 && !access.indices[1];
  }
  EXPECT_TRUE(color);
  EXPECT_TRUE(dynamic);
}

TEST(ValueFlow, FindsWhatAValueDependsOn) {
  const Module module = readText(Stage::closestHit, tracer());
  const Instruction* trace = firstOf(module, spv::Op::OpTraceRayKHR);
  const auto builtIn = [&](spv::BuiltIn which) {
    return [&module, which](const Instruction& i) { return loadsBuiltIn(module, i, which); };
  };
  EXPECT_TRUE(dependsOn(module, trace->at(6), builtIn(spv::BuiltIn::WorldRayOriginKHR)));
  EXPECT_TRUE(dependsOn(module, trace->at(6), builtIn(spv::BuiltIn::RayTmaxKHR)));
  EXPECT_FALSE(dependsOn(module, trace->at(6), builtIn(spv::BuiltIn::PrimitiveId)));
  EXPECT_FALSE(dependsOn(module, trace->at(5), builtIn(spv::BuiltIn::WorldRayOriginKHR)));
}

TEST(ValueFlow, FindsWhatDependsOnAValue) {
  const Module module = readText(Stage::closestHit, tracer());
  const Instruction* normalize = nullptr;
  for (const Instruction& i : module.instructions())
    if (isExtended(module, i, 69)) normalize = &i;
  ASSERT_TRUE(normalize);
  EXPECT_TRUE(findInUses(module, normalize->result, [](const Instruction& i) { return i.op == spv::Op::OpStore; }));
  EXPECT_FALSE(
      findInUses(module, normalize->result, [](const Instruction& i) { return i.op == spv::Op::OpTraceRayKHR; }));
}

TEST(ValueFlow, DecidesWhatCanRunAfterWhat) {
  const Module module = readText(Stage::closestHit, tracer());
  const auto indexOf = [&](const Instruction* i) { return static_cast<std::size_t>(i - module.instructions().data()); };
  const std::size_t trace = indexOf(firstOf(module, spv::Op::OpTraceRayKHR));
  std::size_t before = 0, after = 0;
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    if (loadsBuiltIn(module, module.instructions()[i], spv::BuiltIn::WorldRayOriginKHR)) before = i;
    if (loadsBuiltIn(module, module.instructions()[i], spv::BuiltIn::PrimitiveId)) after = i;
  }
  EXPECT_TRUE(canRunAfter(module, trace, before));
  EXPECT_FALSE(canRunAfter(module, before, trace));
  EXPECT_TRUE(canRunAfter(module, after, trace));
  EXPECT_TRUE(canRunAfter(module, trace, trace));  // it is in a loop
}

std::optional<std::string> difference(const std::string& a, const std::string& b) {
  const auto module = [](const std::string& type) {
    return readText(Stage::closestHit, type +
                                           "\nlayout(location = 0) rayPayloadInEXT P payload;\nlayout(location = 1) "
                                           "rayPayloadEXT P other;\nvoid main() { payload = other; }\n");
  };
  const Module left = module(a), right = module(b);
  return differenceOf(left.types(), left.variables()[0].type, right.types(), right.variables()[0].type);
}

TEST(Type, DescribesDifferences) {
  EXPECT_EQ(difference("struct P { vec3 a; uint b; };", "struct P { vec3 c; uint b; };"), std::nullopt);
  EXPECT_EQ(difference("struct P { vec3 a; vec3 color; };", "struct P { vec3 a; vec4 color; };"),
            "member 1 'color': vec3 vs vec4");
  EXPECT_EQ(difference("struct P { uint a; };", "struct P { int a; };"), "member 0 'a': uint vs int");
  EXPECT_EQ(difference("struct P { float a; };", "struct P { float a; float b; };"),
            "1 member vs 2 ('b' exists only in the second)");
  EXPECT_EQ(difference("struct P { vec3 a; vec3 b; };", "struct P { vec3 b; vec3 a; };"),
            "same members in a different order: member 0 is 'a' vs 'b'");
  EXPECT_EQ(difference("struct I { float x; };\nstruct P { I a[2]; };", "struct I { int x; };\nstruct P { I a[2]; };"),
            "member 0 'a': elements: member 0 'x': float vs int");
  EXPECT_EQ(difference("struct P { mat4x3 a; float b[2]; };", "struct P { mat4x3 a; float b[3]; };"),
            "member 1 'b': float[2] vs float[3]");
  EXPECT_EQ(difference("struct P { mat3 a; };", "struct P { mat3x4 a; };"), "member 0 'a': mat3 vs mat3x4");
  EXPECT_EQ(difference("#define P vec3", "#define P vec4"), "vec3 vs vec4");
  EXPECT_EQ(difference("struct P { ivec2 a; bvec3 b; };", "struct P { ivec2 a; uvec3 b; };"),
            "member 1 'b': bvec3 vs uvec3");
}

TEST(Module, RemovesDebugInfo) {
  const Result result = compileText(Stage::closestHit, tracer());
  const std::vector<std::uint32_t> bare = withoutDebugInfo(result.spirv);
  EXPECT_LT(bare.size() * 3, result.spirv.size() * 2);
  const auto module = Module::read(bare);
  ASSERT_TRUE(module);
  EXPECT_TRUE(module->sources().empty());
  EXPECT_EQ(module->location(*firstOf(*module, spv::Op::OpTraceRayKHR)).line, 0);
  EXPECT_EQ(module->constantBits(firstOf(*module, spv::Op::OpTraceRayKHR)->at(1)), 5u);
}

// Calls all accessors on all instructions.
void useAll(const Module& module) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const Instruction& instruction = module.instructions()[i];
    sum += module.location(instruction, "x").file.size();
    sum += module.access(instruction.at(0)).indices.size() + module.access(instruction.result).indices.size();
    for (const Id id : {instruction.result, instruction.type, instruction.at(0), instruction.at(5)}) {
      sum += module.types().nameOf(id).size() + module.types().describe(id).size() + module.name(id).size() +
             module.isConstant(id);
      sum += module.constantFloat(id) ? 1 : 0;
      sum += differenceOf(module.types(), id, module.types(), instruction.at(1)) ? 1 : 0;
    }
    if (i % 16 == 0) {
      sum += dependsOn(module, instruction.result,
                       [&](const Instruction& x) { return loadsBuiltIn(module, x, spv::BuiltIn::PrimitiveId); });
      sum += findInUses(module, instruction.result, [](const Instruction& x) { return x.op == spv::Op::OpStore; }) !=
             nullptr;
      sum += canRunAfter(module, i, i / 2);
    }
  }
  for (const Variable& variable : module.variables()) sum += variable.name.size();
  EXPECT_GT(sum + 1, 0u);
}

TEST(Module, ReadsAnyWordsSafely) {
  std::vector<std::uint32_t> good = compileText(Stage::closestHit, tracer()).spirv;
  std::mt19937 random(7);
  const auto pick = [&](std::size_t below) { return static_cast<std::size_t>(random() % below); };
  int readable = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::uint32_t> words = good;
    for (std::size_t k = 1 + pick(4); k > 0; --k) {
      std::uint32_t& word = words[pick(words.size())];
      switch (pick(4)) {
        case 0: word = static_cast<std::uint32_t>(random()); break;
        case 1: word ^= 1u << pick(32); break;
        case 2: word = static_cast<std::uint32_t>(pick(words[3] + 2)); break;
        default: word = words[pick(words.size())]; break;
      }
    }
    if (pick(8) == 0) words.resize(pick(words.size() + 1));
    std::string why;
    const auto module = Module::read(std::move(words), &why);
    if (module)
      useAll(*module), ++readable;
    else
      EXPECT_FALSE(why.empty());
  }
  EXPECT_GT(readable, 300);
  for (std::size_t size = 0; size < 200; ++size) Module::read(std::vector<std::uint32_t>(size, 0x00010000u));
}

// Rules visit each component of a vector, so a module must not state billions of them.
TEST(Module, RejectsVectorsThatShadersCannotHave) {
  std::vector<std::uint32_t> words = compileText(Stage::closestHit, tracer()).spirv;
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16)
    if ((words[at] & 0xFFFF) == static_cast<std::uint32_t>(spv::Op::OpTypeVector)) {
      words[at + 3] = 0xFFFFFFFF;
      break;
    }
  std::string why;
  EXPECT_FALSE(Module::read(std::move(words), &why));
  EXPECT_THAT(why, HasSubstr("4294967295"));
}

TEST(Module, ReadsAStructureWithABufferReference) {
  const Module module = readText(Stage::miss, R"(#extension GL_EXT_buffer_reference : require
layout(buffer_reference) buffer Colors { vec4 at[4]; };
layout(push_constant) uniform Push { uint first; Colors colors; } push;
layout(location = 0) rayPayloadInEXT vec4 color;
void main() { color = push.colors.at[push.first]; }
)");
  const auto push = std::ranges::find(module.variables(), spv::StorageClass::PushConstant, &Variable::storage);
  ASSERT_NE(push, module.variables().end());
  const Type& block = module.types().get(push->type);
  ASSERT_EQ(block.members.size(), 2u);
  const Type& reference = module.types().get(block.members[1]);
  EXPECT_EQ(reference.kind, Type::Kind::pointer);
  EXPECT_EQ(reference.bytes, 8u);
  EXPECT_EQ(module.types().get(reference.element).name, "Colors");
}

}  // namespace
}  // namespace quintet::spirv
