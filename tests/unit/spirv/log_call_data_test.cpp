// SPDX-License-Identifier: Apache-2.0
// The stores of payloads around calls: which variable belongs to which marker, the order and the types of the fields, and
// that the module stays valid. tests/gpu/job/pixel_explainer_test.cpp shows that the device then logs the values.
#include "spirv/log_call_data.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "shader/shader_test_support.h"
#include "spirv/module.h"

namespace quintet::spirv {
using namespace shader;

namespace {

constexpr DataMarkers kMarkers{0xABCD0001u, 0xABCD0002u, 64};

// BEFORE and AFTER are the marking stores, as in quintet/explain.glsl.
constexpr const char* kCallHead = R"(#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
layout(buffer_reference, std430, buffer_reference_align = 4) buffer Log { uint used; uint words[]; };
layout(push_constant) uniform Block { Log log_; } block;
layout(set = 0, binding = 0) uniform accelerationStructureEXT topLevelAS;
uint begin() { return atomicAdd(block.log_.used, 65u); }
void mark(uint marker) { const uint at = begin(); if (at != 7u) block.log_.words[at] = marker; }
#define BEFORE mark(0xABCD0001u)
#define AFTER mark(0xABCD0002u)
)";

// A call with its markers, in one line.
std::string trace(int location) {
  return "BEFORE; traceRayEXT(topLevelAS, 0u, 255u, 0u, 1u, 0u, vec3(0), 0.1, vec3(0, 1, 0), 1e30, " +
         std::to_string(location) + "); AFTER;\n";
}

LoggedCalls logged(const std::string& declarations, const std::string& body, const DataMarkers& markers = kMarkers) {
  CompilerOptions options;
  Source source;
  source.stage = Stage::rayGeneration;
  source.name = "test.rgen";
  source.text = kCallHead + declarations + "\nvoid main() {\n" + body + "\n}\n";
  const Result result = Compiler(options).compile(source);
  EXPECT_TRUE(result.ok()) << all(result);
  return logCallData(result.spirv, markers, 1000);
}

std::vector<std::string> fieldsOf(const CallSite& site) {
  std::vector<std::string> result;
  for (const DataField& field : site.fields)
    result.push_back(field.type + " " + field.name + " at " + std::to_string(field.firstWord));
  return result;
}

// The constants that the module stores: call numbers.
std::vector<std::uint32_t> storedConstants(const std::vector<std::uint32_t>& words) {
  std::string why;
  const auto module = Module::read(words, &why);
  EXPECT_TRUE(module) << why;
  std::vector<std::uint32_t> result;
  for (const Instruction& instruction : module->instructions())
    if (instruction.op == spv::Op::OpStore)
      if (const auto value = module->constantBits(instruction.at(1))) result.push_back(*value);
  return result;
}

TEST(LogCallData, StoresTheNumberOfTheCallForEachMarker) {
  const LoggedCalls calls = logged(
      "layout(location = 0) rayPayloadEXT vec3 color;\nlayout(location = 1) rayPayloadEXT uint bits;\n"
      "layout(location = 2) callableDataEXT float data;\n",
      trace(1) + trace(0) + "BEFORE; executeCallableEXT(3u, 2); AFTER;\n" + trace(0));
  ASSERT_EQ(calls.sites.size(), 4u);
  EXPECT_EQ(calls.sites[0].variable, "bits");
  EXPECT_EQ(calls.sites[1].variable, "color");
  EXPECT_EQ(calls.sites[2].variable, "data");
  EXPECT_EQ(calls.sites[3].variable, "color");
  EXPECT_EQ(calls.sites[0].location.line, 17);
  EXPECT_EQ(calls.sites[2].location.line, 19);
  EXPECT_EQ(calls.sites[1].location.file, "test.rgen");
  EXPECT_THAT(storedConstants(calls.spirv), testing::ElementsAre(1000, 1000, 1001, 1001, 1002, 1002, 1003, 1003));
}

TEST(LogCallData, ListsMembersDownToVectors) {
  const LoggedCalls calls = logged(
      "struct Light { vec3 color; bool on; };\n"
      "struct Payload { float t; Light lights[2]; mat2x3 m; uint64_t wide; ivec2 cell; };\n"
      "layout(location = 0) rayPayloadEXT Payload payload;\n",
      "payload.t = 1.0;" + trace(0));
  ASSERT_EQ(calls.sites.size(), 1u);
  const CallSite& site = calls.sites[0];
  EXPECT_EQ(site.type, "Payload");
  EXPECT_TRUE(site.complete);
  EXPECT_THAT(fieldsOf(site),
              testing::ElementsAre(
                  "float payload.t at 0", "vec3 payload.lights[0].color at 1", "bool payload.lights[0].on at 4",
                  "vec3 payload.lights[1].color at 5", "bool payload.lights[1].on at 8", "vec3 payload.m[0] at 9",
                  "vec3 payload.m[1] at 12", "uint64_t payload.wide at 15", "ivec2 payload.cell at 17"));
  EXPECT_EQ(site.fields[2].kind, DataField::Kind::boolean);
  EXPECT_EQ(site.fields[7].width, 64u);
  EXPECT_EQ(site.fields[8].kind, DataField::Kind::signedInteger);
}

// Narrow numbers are widened to words. The module converts them, and stays valid.
TEST(LogCallData, WidensNarrowNumbers) {
  const LoggedCalls calls = logged(
      "#extension GL_EXT_shader_explicit_arithmetic_types : require\n"
      "struct Payload { float16_t h; f16vec3 v; int16_t i; u16vec2 u; int8_t b; float t; };\n"
      "layout(location = 0) rayPayloadEXT Payload payload;\n",
      "payload.i = int16_t(-2);" + trace(0));
  ASSERT_EQ(calls.sites.size(), 1u);
  EXPECT_TRUE(calls.sites[0].complete);
  EXPECT_EQ(calls.maxWords, 9u);
  EXPECT_THAT(fieldsOf(calls.sites[0]),
              testing::ElementsAre("float16_t payload.h at 0", "f16vec3 payload.v at 1", "int16_t payload.i at 4",
                                   "u16vec2 payload.u at 5", "int8_t payload.b at 7", "float payload.t at 8"));
  for (const DataField& field : calls.sites[0].fields) EXPECT_EQ(field.width, 32u) << field.name;
  std::string why;
  const auto module = Module::read(calls.spirv, &why);
  ASSERT_TRUE(module) << why;
  const auto count = [&](spv::Op op) { return std::ranges::count(module->instructions(), op, &Instruction::op); };
  EXPECT_EQ(count(spv::Op::OpFConvert), 2 * 4);  // before and after the call
  EXPECT_EQ(count(spv::Op::OpSConvert), 2 * 2);
  EXPECT_EQ(count(spv::Op::OpUConvert), 2 * 2);
}

TEST(LogCallData, LeavesOutWhatDoesNotFit) {
  const LoggedCalls calls =
      logged("layout(location = 0) rayPayloadEXT vec4 many[5];\n", trace(0), {kMarkers.before, kMarkers.after, 10});
  ASSERT_EQ(calls.sites.size(), 1u);
  EXPECT_FALSE(calls.sites[0].complete);
  EXPECT_EQ(calls.maxWords, 20u);
  EXPECT_THAT(fieldsOf(calls.sites[0]), testing::ElementsAre("vec4 many[0] at 0", "vec4 many[1] at 4"));
}

TEST(LogCallData, PairsCallsInFunctionsThatAreInlined) {
  const LoggedCalls calls = logged(
      "layout(location = 0) rayPayloadEXT vec3 color;\nlayout(location = 1) rayPayloadEXT float t;\n"
      "vec3 shoot() { " +
          trace(0) + "return color; }\n",
      "for (int i = 0; i < 3; ++i) { if (shoot().x > 0.5) { " + trace(1) + "} }\nshoot();");
  ASSERT_EQ(calls.sites.size(), 3u);
  EXPECT_EQ(calls.sites[0].variable, "color");
  EXPECT_EQ(calls.sites[1].variable, "t");
  EXPECT_EQ(calls.sites[2].variable, "color");
  EXPECT_THAT(storedConstants(calls.spirv), testing::ElementsAre(1000, 1000, 1001, 1001, 1002, 1002));
}

TEST(LogCallData, LeavesModulesWithoutMarkersUnchanged) {
  CompilerOptions options;
  Source source = computeSource("");
  const Result result = Compiler(options).compile(source);
  const LoggedCalls calls = logCallData(result.spirv, kMarkers, 0);
  EXPECT_EQ(calls.spirv, result.spirv);
  EXPECT_TRUE(calls.sites.empty());
}

}  // namespace
}  // namespace quintet::spirv
