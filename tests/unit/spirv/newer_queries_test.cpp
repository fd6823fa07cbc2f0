// SPDX-License-Identifier: Apache-2.0
// Instructions of position fetch, clusters, spheres and linear swept spheres: a module with them is valid after the rewrite, and each
// value has the type that it had.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include <spirv-tools/libspirv.hpp>

#include "rewrite_test_support.h"
#include "spirv/newer_queries.h"

namespace quintet::spirv {
namespace {

struct Query {
  std::uint32_t op;
  std::string type;
  spv::Op expected;  // one of the instructions that replace it
};
void PrintTo(const Query& query, std::ostream* out) { *out << query.op; }

// The result of the query is stored. The assembler does not know the instruction: a matrix query stands for it.
Words moduleWith(const Query& query) {
  const bool ofRayQuery = query.op < 5432 ? query.op != 5346 : query.op > 5437;
  const std::string text =
      R"(OpCapability RayTracingKHR
OpCapability RayQueryKHR
OpCapability ShaderInvocationReorderNV
OpExtension "SPV_KHR_ray_tracing"
OpExtension "SPV_KHR_ray_query"
OpExtension "SPV_NV_shader_invocation_reorder"
OpMemoryModel Logical GLSL450
OpEntryPoint RayGenerationKHR %main "main" %hit %query %out
%void = OpTypeVoid
%function = OpTypeFunction %void
%bool = OpTypeBool
%uint = OpTypeInt 32 0
%float = OpTypeFloat 32
%vec3 = OpTypeVector %float 3
%u1 = OpConstant %uint 1
%u2 = OpConstant %uint 2
%u3 = OpConstant %uint 3
%floats = OpTypeArray %float %u2
%points = OpTypeArray %vec3 %u2
%vertices = OpTypeArray %vec3 %u3
%hitType = OpTypeHitObjectNV
%queryType = OpTypeRayQueryKHR
%hitPointer = OpTypePointer Private %hitType
%queryPointer = OpTypePointer Private %queryType
%outPointer = OpTypePointer Private %)" +
      query.type + R"(
%hit = OpVariable %hitPointer Private
%query = OpVariable %queryPointer Private
%out = OpVariable %outPointer Private
%main = OpFunction %void None %function
%start = OpLabel
OpHitObjectRecordEmptyNV %hit
)" +
      (ofRayQuery ? "%value = OpRayQueryGetIntersectionObjectToWorldKHR %" + query.type + " %query %u1"
                  : "%value = OpHitObjectGetObjectToWorldNV %" + query.type + " %hit") +
      "\nOpStore %out %value\nOpReturn\nOpFunctionEnd\n";
  spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_3);
  Words words;
  EXPECT_TRUE(tools.Assemble(text, &words)) << text;
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    const auto op = static_cast<spv::Op>(words[at] & 0xFFFFu);
    if (op == spv::Op::OpRayQueryGetIntersectionObjectToWorldKHR || op == spv::Op::OpHitObjectGetObjectToWorldNV)
      words[at] = words[at] >> 16 << 16 | query.op;
  }
  return words;
}

class NewerQueries : public testing::TestWithParam<Query> {};

TEST_P(NewerQueries, BecomeKnownOnesOfTheSameType) {
  const Words words = moduleWith(GetParam());
  ASSERT_NE(errorsOf(words), "");
  const Words known = withKnownQueries(words);
  EXPECT_EQ(errorsOf(known), "");
  EXPECT_GT(count(known, GetParam().expected), 0u);
}

INSTANTIATE_TEST_SUITE_P(All, NewerQueries,
                         testing::Values(Query{5340, "vertices", spv::Op::OpRayQueryGetIntersectionObjectRayOriginKHR},
                                         Query{5345, "uint", spv::Op::OpRayQueryGetIntersectionPrimitiveIndexKHR},
                                         Query{5346, "uint", spv::Op::OpHitObjectGetPrimitiveIndexNV},
                                         Query{5427, "vec3", spv::Op::OpRayQueryGetIntersectionObjectRayOriginKHR},
                                         Query{5428, "float", spv::Op::OpRayQueryGetIntersectionTKHR},
                                         Query{5429, "points", spv::Op::OpRayQueryGetIntersectionObjectRayOriginKHR},
                                         Query{5430, "floats", spv::Op::OpRayQueryGetIntersectionTKHR},
                                         Query{5431, "float", spv::Op::OpRayQueryGetIntersectionTKHR},
                                         Query{5432, "vec3", spv::Op::OpHitObjectGetObjectRayOriginNV},
                                         Query{5433, "float", spv::Op::OpHitObjectGetRayTMaxNV},
                                         Query{5434, "points", spv::Op::OpHitObjectGetObjectRayOriginNV},
                                         Query{5435, "floats", spv::Op::OpHitObjectGetRayTMaxNV},
                                         Query{5436, "bool", spv::Op::OpHitObjectGetRayTMaxNV},
                                         Query{5437, "bool", spv::Op::OpHitObjectGetRayTMaxNV},
                                         Query{5438, "bool", spv::Op::OpRayQueryGetIntersectionFrontFaceKHR},
                                         Query{5439, "bool", spv::Op::OpRayQueryGetIntersectionFrontFaceKHR}));

TEST(NewerQueries, UnknownFormsAndBrokenWordsAreCopied) {
  const Words tooShort{spv::MagicNumber, 0x10500, 0, 100, 0, 3u << 16 | 5346u, 1, 2};
  EXPECT_EQ(withKnownQueries(tooShort), tooShort);
  const Words noArray{spv::MagicNumber, 0x10500, 0, 100, 0, 4u << 16 | 5434u, 1, 2, 3};
  EXPECT_EQ(withKnownQueries(noArray), noArray);
  EXPECT_EQ(withKnownQueries(Words{1, 2}), (Words{1, 2}));
}

}  // namespace
}  // namespace quintet::spirv
