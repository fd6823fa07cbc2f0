// SPDX-License-Identifier: Apache-2.0
// Q703 and Q704: instances selected by gl_InstanceID, descriptor indices without nonuniformEXT.
#include <gmock/gmock.h>

#include "stage_test_support.h"

namespace quintet::check {
namespace {

using shader::Stage;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kAddressHead = R"(#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_nonuniform_qualifier : require
struct Payload { vec3 color; uint texture; };
layout(location = 0) rayPayloadInEXT Payload payload;
layout(buffer_reference, scalar) buffer Colors { vec3 at[]; };
layout(buffer_reference, scalar) buffer Indices { uint at[]; };
layout(push_constant, scalar) uniform P { Colors colors; Indices indices; uint sky; } push;
layout(set = 0, binding = 1) uniform sampler2D textures[];
)";

std::vector<std::string> closestHit(const std::string& body, const ProgramStageContext& program = {}) {
  return checkText(Stage::closestHit, kAddressHead + ("void main() {\n" + body + "\n}\n"), {}, program);
}

TEST(CheckInstanceIndices, ReportsArrayIndices) {
  EXPECT_THAT(closestHit("payload.color = push.colors.at[gl_InstanceID];"), ElementsAre("Q703:13"));
  EXPECT_THAT(closestHit("int i = 2 * gl_InstanceID + 1;\npayload.color = push.colors.at[i];"), ElementsAre("Q703:13"));
  EXPECT_THAT(closestHit("const vec3 palette[3] = vec3[](vec3(1), vec3(0.5), vec3(0));\n"
                         "payload.color = palette[gl_InstanceID % 3];"),
              ElementsAre("Q703:14"));
}

TEST(CheckInstanceIndices, ReportsComparisons) {
  EXPECT_THAT(closestHit("payload.color = gl_InstanceID == 2 ? vec3(1) : vec3(0);"), ElementsAre("Q703:13"));
}

TEST(CheckInstanceIndices, AcceptsOtherIndicesAndOrderedPrograms) {
  EXPECT_THAT(closestHit("payload.color = push.colors.at[gl_InstanceCustomIndexEXT];"), IsEmpty());
  EXPECT_THAT(closestHit("payload.color = vec3(float(gl_InstanceID) * 0.1);"), IsEmpty());
  ProgramStageContext ordered;
  ordered.keepsInstanceOrder = true;
  EXPECT_THAT(closestHit("payload.color = push.colors.at[gl_InstanceID];", ordered), IsEmpty());
}

TEST(CheckDescriptorIndices, ReportsBuiltInsPayloadsAndBuffers) {
  EXPECT_THAT(closestHit("payload.color = textureLod(textures[gl_InstanceCustomIndexEXT], vec2(0), 0.0).rgb;"),
              ElementsAre("Q704:13"));
  EXPECT_THAT(closestHit("payload.color = textureLod(textures[payload.texture], vec2(0), 0.0).rgb;"),
              ElementsAre("Q704:13"));
  EXPECT_THAT(
      closestHit(
          "uint i = push.indices.at[gl_PrimitiveID];\npayload.color = textureLod(textures[i + 1u], vec2(0), 0.0).rgb;"),
      ElementsAre("Q704:14"));
  EXPECT_THAT(checkText(Stage::rayGeneration,
                        "layout(set = 0, binding = 1) uniform sampler2D textures[4];\n"
                        "layout(set = 0, binding = 2, rgba8) uniform writeonly image2D result;\nvoid main() {\n"
                        "imageStore(result, ivec2(gl_LaunchIDEXT.xy), textureLod(textures[gl_LaunchIDEXT.x & 3u], "
                        "vec2(0), 0.0)); }"),
              ElementsAre("Q704:6"));
}

TEST(CheckDescriptorIndices, ReportsIndicesThatABranchChooses) {
  EXPECT_THAT(closestHit("uint i = 1u; if (gl_HitTEXT > 2.0) { i = push.sky; payload.color = vec3(0); }\n"
                         "payload.color = textureLod(textures[i], vec2(0), 0.0).rgb;"),
              ElementsAre("Q704:14"));
  EXPECT_THAT(closestHit("uint i = 1u; if (push.sky > 2u) { i = push.sky; payload.color = vec3(0); }\n"
                         "payload.color = textureLod(textures[i], vec2(0), 0.0).rgb;"),
              IsEmpty());
}

TEST(CheckDescriptorIndices, AcceptsMarkedAndUniformIndices) {
  EXPECT_THAT(
      closestHit("payload.color = textureLod(textures[nonuniformEXT(gl_InstanceCustomIndexEXT)], vec2(0), 0.0).rgb;"),
      IsEmpty());
  EXPECT_THAT(closestHit("uint i = nonuniformEXT(push.indices.at[gl_PrimitiveID]);\n"
                         "payload.color = textureLod(textures[i], vec2(0), 0.0).rgb;"),
              IsEmpty());
  EXPECT_THAT(closestHit("payload.color = textureLod(textures[push.sky], vec2(0), 0.0).rgb;"), IsEmpty());
  EXPECT_THAT(closestHit("payload.color = textureLod(textures[push.indices.at[3]], vec2(0), 0.0).rgb;"), IsEmpty());
  EXPECT_THAT(closestHit("payload.color = textureLod(textures[2], vec2(0), 0.0).rgb;"), IsEmpty());
}

}  // namespace
}  // namespace quintet::check
