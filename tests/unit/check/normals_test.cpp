// SPDX-License-Identifier: Apache-2.0
// Q702: recognizes normals that are multiplied by gl_ObjectToWorldEXT.
#include <gmock/gmock.h>

#include "stage_test_support.h"

namespace quintet::check {
namespace {

using shader::Stage;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kHead = R"(#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
struct Hit { vec3 normal; vec3 position; vec2 uv; };
hitAttributeEXT Hit hit;
struct Payload { vec3 color; };
layout(location = 0) rayPayloadInEXT Payload payload;
layout(buffer_reference, scalar) buffer Mesh { vec3 normals[]; };
layout(push_constant) uniform P { Mesh mesh; } push;
)";
constexpr int kFirst = 12;  // line of the body's first line

std::vector<std::string> closestHit(const std::string& body) {
  return checkText(Stage::closestHit, kHead + ("void main() {\n" + body + "\n}\n"));
}
std::string found(int line) { return "Q702:" + std::to_string(line); }

TEST(CheckNormals, ReportsAHitAttribute) {
  EXPECT_THAT(closestHit("payload.color = normalize(gl_ObjectToWorldEXT * vec4(hit.normal, 0.0));"),
              ElementsAre(found(kFirst)));
}

TEST(CheckNormals, ReportsTheUpperPartOfTheMatrix) {
  EXPECT_THAT(closestHit("payload.color = normalize(mat3(gl_ObjectToWorldEXT) * hit.normal);"),
              ElementsAre(found(kFirst)));
}

TEST(CheckNormals, ReportsNormalsInterpolatedFromABuffer) {
  EXPECT_THAT(closestHit("vec3 v = hit.uv.x * push.mesh.normals[0] + hit.uv.y * push.mesh.normals[1];\n"
                         "payload.color = normalize(mat3(gl_ObjectToWorldEXT) * v);"),
              ElementsAre(found(kFirst + 1)));
}

TEST(CheckNormals, ReportsLocalVariablesByName) {
  EXPECT_THAT(closestHit("vec3 objectNormal = normalize(gl_ObjectRayOriginEXT);\n"
                         "payload.color = normalize(gl_ObjectToWorldEXT * vec4(objectNormal, 0.0));"),
              ElementsAre(found(kFirst + 1)));
  EXPECT_THAT(closestHit("vec3 n = normalize(gl_ObjectRayOriginEXT);\npayload.color = mat3(gl_ObjectToWorldEXT) * n;"),
              ElementsAre(found(kFirst + 1)));
}

TEST(CheckNormals, FollowsFunctions) {
  EXPECT_THAT(checkText(Stage::closestHit, std::string(kHead) +
                                               "vec3 toWorld(vec3 v) { return mat3(gl_ObjectToWorldEXT) * v; }\n"
                                               "void main() { payload.color = normalize(toWorld(hit.normal)); }\n"),
              ElementsAre(found(kFirst - 1)));
}

TEST(CheckNormals, ReportsSumsAndAssignments) {
  EXPECT_THAT(closestHit("vec3 n0 = vec3(1), n1 = gl_ObjectRayOriginEXT;\nmat3 m = mat3(gl_ObjectToWorldEXT);\n"
                         "payload.color = normalize(m * (n0 * hit.uv.x + n1 * hit.uv.y));"),
              ElementsAre(found(kFirst + 2)));
  EXPECT_THAT(closestHit("vec3 e = hit.position;\n"
                         "vec3 worldNormal = normalize(mat3(gl_ObjectToWorldEXT) * cross(e, e.yzx));\n"
                         "payload.color = worldNormal;"),
              ElementsAre(found(kFirst + 1)));
}

TEST(CheckNormals, AcceptsCrossProductsOfWorldSpaceEdges) {
  EXPECT_THAT(closestHit("vec3 e = hit.position;\nmat3 m = mat3(gl_ObjectToWorldEXT);\n"
                         "vec3 normal = normalize(cross(m * e, m * e.yzx));\npayload.color = normal;"),
              IsEmpty());
}

TEST(CheckNormals, AcceptsTheInverseTranspose) {
  EXPECT_THAT(closestHit("payload.color = normalize(vec3(hit.normal * gl_WorldToObjectEXT));"), IsEmpty());
  EXPECT_THAT(closestHit("payload.color = normalize(transpose(mat3(gl_WorldToObjectEXT)) * hit.normal);"), IsEmpty());
  EXPECT_THAT(closestHit("payload.color = normalize(transpose(inverse(mat3(gl_ObjectToWorldEXT))) * hit.normal);"),
              IsEmpty());
}

TEST(CheckNormals, AcceptsPointsAndDirections) {
  EXPECT_THAT(closestHit("payload.color = gl_ObjectToWorldEXT * vec4(hit.position, 1.0);"), IsEmpty());
  EXPECT_THAT(
      closestHit("vec3 tangent = hit.position;\npayload.color = normalize(mat3(gl_ObjectToWorldEXT) * tangent);"),
      IsEmpty());
  EXPECT_THAT(closestHit("payload.color = normalize(mat3(gl_ObjectToWorldEXT) * cross(hit.normal, hit.position));"),
              IsEmpty());
  EXPECT_THAT(closestHit("payload.color = normalize(gl_ObjectToWorldEXT * vec4(gl_ObjectRayDirectionEXT, 0.0));"),
              IsEmpty());
  // "normalized…" is not the name of a normal.
  EXPECT_THAT(closestHit("vec3 normalizedDirection = gl_ObjectRayDirectionEXT;\n"
                         "payload.color = gl_ObjectToWorldEXT * vec4(normalizedDirection, 0.0);"),
              IsEmpty());
}

// From world to object space, the transposed object-to-world matrix is correct.
TEST(CheckNormals, AcceptsTheWayBackToObjectSpace) {
  EXPECT_THAT(closestHit("payload.color = normalize(vec3(vec4(hit.normal * mat3(gl_ObjectToWorldEXT), 0.0)));"),
              IsEmpty());
}

}  // namespace
}  // namespace quintet::check
