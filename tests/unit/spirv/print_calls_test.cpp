// SPDX-License-Identifier: Apache-2.0
// Calls of debugPrintfEXT in modules: their formats and arguments, and the module with the functions of the log in their
// stead. tests/gpu/job shows that these print what the calls say.
#include "spirv/print_calls.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "program/instrument.h"
#include "rewrite_test_support.h"
#include "shader/optimizer.h"
#include "shader/shader_test_support.h"

namespace quintet::spirv {
using namespace shader;

namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using Kind = PrintArgument::Kind;

constexpr const char* kPrintHead = R"(#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_debug_printf : require
#extension GL_EXT_shader_explicit_arithmetic_types : require
layout(location = 0) rayPayloadInEXT vec4 payload;
)";

Source sourceOf(const std::string& text, bool printing) {
  Source source;
  source.stage = Stage::miss;
  source.name = "test.rmiss";
  source.text = printing ? program::probedStage(kPrintHead + text, Stage::miss, {.prints = true, .heat = false}, false)
                         : kPrintHead + text;
  source.optimize = !printing;
  return source;
}

Words compileText(const std::string& text, bool printing) {
  const Result result = Compiler({}).compile(sourceOf(text, printing));
  EXPECT_TRUE(result.ok()) << all(result);
  return result.spirv;
}
Words compileMain(const std::string& body, bool printing) {
  return compileText("void main() {\n" + body + "\n}\n", printing);
}

std::vector<PrintCall> callsOf(const Words& words) {
  std::string why;
  const auto module = Module::read(words, &why);
  EXPECT_TRUE(module) << why;
  return module ? findPrintCalls(*module) : std::vector<PrintCall>();
}

// One argument of every type that can be printed.
constexpr const char* kAllTypes = R"(
  float16_t half_ = float16_t(payload.x);
  double double_ = double(payload.x);
  debugPrintfEXT("%d %u %f %d", int(payload.x), uint(payload.x), payload.x, payload.x > 0.0);
  debugPrintfEXT("%ld %lu %f %f", int64_t(payload.x), uint64_t(payload.x), double_, half_);
  debugPrintfEXT("%d %u %d %u", int8_t(payload.x), uint8_t(payload.x), int16_t(payload.x), uint16_t(payload.x));
  debugPrintfEXT("%v4f %v3d %v2u %v2d", payload, ivec3(payload.xyz), uvec2(payload.xy), greaterThan(payload.xy, vec2(0)));
  debugPrintfEXT("%v2lu %v3f", u64vec2(payload.xy), dvec3(payload.xyz));
)";

TEST(PrintCalls, KnowsFormatsAndTypes) {
  const std::vector<PrintCall> calls = callsOf(compileMain(kAllTypes, false));
  ASSERT_EQ(calls.size(), 5u);
  EXPECT_EQ(calls[0].format, "%d %u %f %d");
  const auto names = [](const PrintCall& call) {
    std::vector<std::string> result;
    for (const PrintArgument& argument : call.arguments) result.push_back(argument.typeName);
    return result;
  };
  EXPECT_THAT(names(calls[0]), ElementsAre("int", "uint", "float", "bool"));
  EXPECT_THAT(names(calls[3]), ElementsAre("vec4", "ivec3", "uvec2", "bvec2"));
  EXPECT_THAT(calls[1].arguments, ElementsAre(Field(&PrintArgument::bits, 64u), Field(&PrintArgument::bits, 64u),
                                              Field(&PrintArgument::bits, 64u), Field(&PrintArgument::bits, 16u)));
  for (const PrintCall& call : calls) EXPECT_NO_THROW(PrintFormat(call.format, call.arguments)) << call.format;
}

TEST(PrintCalls, KnowsEscapeSequences) {
  const std::vector<PrintCall> calls = callsOf(compileMain(R"(debugPrintfEXT("a\tb\n");)", false));
  ASSERT_EQ(calls.size(), 1u);
  EXPECT_EQ(calls[0].format, "a\tb\n");
}

TEST(PrintCalls, MatricesCannotBePrinted) {
  const std::vector<PrintCall> calls = callsOf(compileMain(R"(debugPrintfEXT("%f", mat3(payload.x));)", false));
  ASSERT_EQ(calls.size(), 1u);
  EXPECT_THAT(calls[0].arguments, ElementsAre(Field(&PrintArgument::kind, Kind::other)));
  EXPECT_EQ(calls[0].arguments[0].typeName, "mat3");
}

TEST(PrintCalls, AreFoundInFunctionsMacrosAndLoops) {
  const std::string text = R"(
    #define SHOW(x) debugPrintfEXT("macro %f", x)
    void show(float x) { debugPrintfEXT("function %f", x); }
    void main() {
      show(payload.x);
      SHOW(payload.y);
      for (int i = 0; i < int(payload.z); ++i) debugPrintfEXT("loop %d", i);
    })";
  EXPECT_EQ(callsOf(compileText(text, true)).size(), 3u);
}

TEST(PrintCalls, AreReplacedByCallsOfTheLog) {
  const Words words = compileMain(kAllTypes, true);
  ASSERT_EQ(errorsOf(words), "");
  const Words replaced = replacePrintCalls(words, 40);
  EXPECT_EQ(errorsOf(replaced), "");
  EXPECT_TRUE(callsOf(replaced).empty());
  // One begin per call and one call per word: 4, 7, 4, 11, 10 words. Less the call of printKeep_.
  EXPECT_EQ(count(replaced, spv::Op::OpFunctionCall), count(words, spv::Op::OpFunctionCall) + 5 + 36 - 1);
  const Words optimized = optimize(replaced);
  EXPECT_EQ(errorsOf(optimized), "");
  EXPECT_EQ(count(optimized, spv::Op::OpFunctionCall), 0u);
  EXPECT_GT(count(optimized, spv::Op::OpAtomicIAdd), 0u);
}

TEST(PrintCalls, WithoutPrintsTheLogDisappears) {
  const Words optimized = optimize(replacePrintCalls(compileMain("payload.x = 1.0;", true), 0));
  EXPECT_EQ(errorsOf(optimized), "");
  EXPECT_EQ(count(optimized, spv::Op::OpAtomicIAdd), 0u);
}

TEST(PrintCalls, TheFunctionsAreRequired) {
  EXPECT_THROW(replacePrintCalls(compileMain(R"(debugPrintfEXT("a");)", false), 0), Error);
  EXPECT_THROW(replacePrintCalls({1, 2, 3}, 0), Error);
}

TEST(PrintCalls, ImportShowsThatThereCanBeSome) {
  EXPECT_TRUE(importsDebugPrintf(compileMain(R"(debugPrintfEXT("a");)", false)));
  EXPECT_FALSE(importsDebugPrintf(compileMain("payload.x = sin(payload.y);", false)));
  EXPECT_FALSE(importsDebugPrintf({}));
}

TEST(WithoutDebugInfo, RemovesPrints) {
  const Words words = withoutDebugInfo(compileMain(R"(payload.x = 1.0; debugPrintfEXT("x = %f", payload.y);)", false));
  EXPECT_EQ(errorsOf(words), "");
  EXPECT_FALSE(importsDebugPrintf(words));
  EXPECT_EQ(count(words, spv::Op::OpExtInst), 0u);
  EXPECT_EQ(count(words, spv::Op::OpExtension), count(compileMain("payload.x = 1.0;", false), spv::Op::OpExtension));
}

TEST(WithoutDebugInfo, KeepsMathFunctions) {
  EXPECT_EQ(count(withoutDebugInfo(compileMain("payload.x = sin(payload.y);", false)), spv::Op::OpExtInst), 1u);
}

}  // namespace
}  // namespace quintet::spirv
