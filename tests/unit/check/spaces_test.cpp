// SPDX-License-Identifier: Apache-2.0
// Q702, Q708, Q709: tags of points, directions and normals within one stage. tests/check has programs with several stages.
#include <gmock/gmock.h>

#include "stage_test_support.h"

namespace quintet::check {
namespace {

using shader::Stage;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kSpaceHead = R"(#include <quintet/hit_geometry.glsl>
struct Payload { vec3 color; };
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 b;
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT tlas;
layout(location = 1) rayPayloadEXT vec4 nested;
const vec3 kLight = vec3(0.0, 0.8, 0.6);
#define AT(array, type, k) type(hitGeometry().array).at[Uvec3Array(hitGeometry().triangles).at[gl_PrimitiveID][k]]
#define P(k) AT(positions, Vec3Array, k)
#define N(k) AT(normals, Vec3Array, k)
void trace(vec3 o, vec3 d) { traceRayEXT(tlas, 0u, 0xFFu, 0u, 1u, 0u, o, 0.001, d, 100.0, 1); }
)";
constexpr int kFirst = 15;  // line of the body's first line

std::vector<std::string> checkSpacesOf(Stage stage, const std::string& text) {
  const auto module = compileStage(stage, text);
  if (!module) return {};
  Report report;
  checkSpaces(*module, report);
  return linesOf(report.take());
}

std::vector<std::string> spacesIn(const std::string& body) {
  return checkSpacesOf(Stage::closestHit, kSpaceHead + ("void main() {\n" + body + "\n}\n"));
}
std::string found(const char* id, int line = kFirst) { return id + (":" + std::to_string(line)); }

TEST(CheckSpaces, ReportsNormalsByMatrices) {
  for (const char* v :
       {"mat3(gl_ObjectToWorldEXT) * N(0)", "gl_ObjectToWorldEXT * vec4(N(0), 0.0)",
        "vec4(N(0), 0.0) * gl_ObjectToWorld3x4EXT", "vec3(mat4(gl_ObjectToWorldEXT) * vec4(N(0), 0.0))",
        "transpose(transpose(mat3(gl_ObjectToWorldEXT))) * N(0)", "inverse(mat3(gl_WorldToObjectEXT)) * N(0)",
        "mat3(gl_ObjectToWorldEXT) * (N(0) * (1.0 - b.x - b.y) + N(1) * b.x + N(2) * b.y)",
        "mat3(gl_ObjectToWorldEXT) * cross(P(1) - P(0), P(2) - P(0))"})
    EXPECT_THAT(spacesIn("payload.color = vec3(max(dot(normalize(" + std::string(v) + "), kLight), 0.0));"),
                ElementsAre(found("Q702")))
        << v;
}

// Uses that the search does not reach can show that the position is meant without translation.
TEST(CheckSpaces, AcceptsValuesWithTooManyUses) {
  const auto body = [](int steps) {
    std::string text = "vec3 p = mat3(gl_ObjectToWorldEXT) * P(0); trace(p, kLight);";
    for (int i = 0; i < steps; ++i) text += "p *= 1.0 + b[" + std::to_string(i % 2) + "];";
    return text + "payload.color = p;";
  };
  EXPECT_THAT(spacesIn(body(2)), ElementsAre(found("Q708")));
  EXPECT_THAT(spacesIn(body(60)), IsEmpty());
}

TEST(CheckSpaces, AcceptsNormalsByTheInverseTranspose) {
  for (const char* v : {"vec3(N(0) * gl_WorldToObjectEXT)", "transpose(mat3(gl_WorldToObjectEXT)) * N(0)",
                        "(gl_WorldToObject3x4EXT * N(0)).xyz", "transpose(inverse(mat3(gl_ObjectToWorldEXT))) * N(0)",
                        "inverse(transpose(mat3(gl_ObjectToWorldEXT))) * N(0)",
                        "cross(mat3(gl_ObjectToWorldEXT) * (P(1) - P(0)), mat3(gl_ObjectToWorldEXT) * (P(2) - P(0)))"})
    EXPECT_THAT(spacesIn("payload.color = vec3(max(dot(normalize(" + std::string(v) +
                         "), kLight), 0.0)) * "
                         "dot(normalize(" +
                         std::string(v) + "), gl_WorldRayDirectionEXT);"),
                IsEmpty())
        << v;
}

TEST(CheckSpaces, RecognizesNormalsByTheirUse) {
  const std::string v = "vec3 x = normalize(mat3(gl_ObjectToWorldEXT) * unpackHalf2x16(gl_PrimitiveID).xyx);\n";
  EXPECT_THAT(spacesIn(v + "payload.color = reflect(gl_WorldRayDirectionEXT, x);"), ElementsAre(found("Q702")));
  EXPECT_THAT(spacesIn(v + "payload.color = vec3(abs(dot(x, kLight)));"), ElementsAre(found("Q702")));
  EXPECT_THAT(spacesIn(v + "payload.color = x;"), IsEmpty());
  EXPECT_THAT(spacesIn(v + "trace(gl_WorldRayOriginEXT, x); payload.color = nested.xyz;"), IsEmpty());
}

TEST(CheckSpaces, AcceptsOffsetsAlongNormals) {
  EXPECT_THAT(
      spacesIn("vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;\n"
               "trace(p + 0.01 * normalize(mat3(gl_ObjectToWorldEXT) * N(0)), kLight); payload.color = nested.xyz;"),
      IsEmpty());
  EXPECT_THAT(
      spacesIn("trace(gl_ObjectToWorldEXT * vec4(P(0) + 0.01 * N(0), 1.0), kLight); payload.color = nested.xyz;"),
      IsEmpty());
}

TEST(CheckSpaces, AcceptsDirections) {
  for (const char* v : {"gl_ObjectRayDirectionEXT", "P(1) - P(0)", "AT(tangents, Vec4Array, 0).xyz",
                        "vec3(0.0, 0.0, 1.0)", "cross(N(0), N(1))"})
    EXPECT_THAT(spacesIn("vec3 x = normalize(gl_ObjectToWorldEXT * vec4(" + std::string(v) +
                         ", 0.0));\n"
                         "payload.color = vec3(max(dot(x, kLight), 0.0) + dot(x, gl_WorldRayDirectionEXT));"),
                IsEmpty())
        << v;
}

TEST(CheckSpaces, ReportsPositionsWithoutTranslation) {
  for (const char* v :
       {"mat3(gl_ObjectToWorldEXT) * P(0)", "gl_ObjectToWorldEXT * vec4(P(0), 0.0)",
        "mat3(gl_ObjectToWorldEXT) * (gl_ObjectRayOriginEXT + gl_HitTEXT * gl_ObjectRayDirectionEXT)"}) {
    EXPECT_THAT(spacesIn("trace(" + std::string(v) + ", kLight); payload.color = nested.xyz;"),
                ElementsAre(found("Q708")))
        << v;
    EXPECT_THAT(spacesIn("payload.color = normalize(vec3(1.0, 2.0, 3.0) - " + std::string(v) + ");"),
                ElementsAre(found("Q708")))
        << v;
  }
}

TEST(CheckSpaces, AcceptsTranslationAddedLater) {
  EXPECT_THAT(
      spacesIn("trace(mat3(gl_ObjectToWorldEXT) * P(0) + gl_ObjectToWorldEXT[3], kLight); payload.color = nested.xyz;"),
      IsEmpty());
  EXPECT_THAT(spacesIn("mat4x3 m = gl_ObjectToWorldEXT; vec3 p = P(0);\n"
                       "trace(m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], kLight); payload.color = nested.xyz;"),
              IsEmpty());
}

TEST(CheckSpaces, ReportsDirectionsWithTranslation) {
  for (const char* v : {"N(0)", "gl_ObjectRayDirectionEXT", "P(1) - P(0)"})
    EXPECT_THAT(spacesIn("vec3 x = normalize(gl_ObjectToWorldEXT * vec4(" + std::string(v) +
                         ", 1.0));\n"
                         "payload.color = vec3(max(dot(x, kLight), 0.0));"),
                ElementsAre(found("Q708")))
        << v;
}

TEST(CheckSpaces, ReportsMixedSpaces) {
  for (const char* v :
       {"vec3(dot(N(0), gl_WorldRayDirectionEXT))", "gl_WorldRayOriginEXT - P(0)",
        "P(0) + gl_HitTEXT * gl_WorldRayDirectionEXT", "cross(gl_WorldRayDirectionEXT, P(1) - P(0))",
        "reflect(gl_WorldRayDirectionEXT, N(0))", "vec3(distance(gl_WorldRayOriginEXT, P(0)))",
        "gl_WorldToObjectEXT * vec4(P(0), 1.0)", "gl_ObjectToWorldEXT * vec4(gl_WorldRayOriginEXT, 1.0)",
        "N(0) * mat3(gl_ObjectToWorldEXT)", "mat3(gl_WorldToObjectEXT) * N(0)"})
    EXPECT_THAT(spacesIn("payload.color = " + std::string(v) + ";"), ElementsAre(found("Q709"))) << v;
}

TEST(CheckSpaces, ReportsRaysInObjectSpace) {
  EXPECT_THAT(spacesIn("trace(P(0), kLight); payload.color = nested.xyz;"), ElementsAre(found("Q709", 13)));
  EXPECT_THAT(spacesIn("vec3 o = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;\n"
                       "trace(o, reflect(gl_ObjectRayDirectionEXT, N(0))); payload.color = nested.xyz;"),
              ElementsAre(found("Q709", 13)));
}

TEST(CheckSpaces, AcceptsValuesOfUnknownSpace) {
  // Either space, depending on the path.
  EXPECT_THAT(spacesIn("vec3 p = gl_PrimitiveID > 3 ? P(0) : gl_WorldRayOriginEXT;\n"
                       "trace(p, kLight); payload.color = nested.xyz * distance(p, gl_WorldRayOriginEXT);"),
              IsEmpty());
  // Constants can be meant in any space.
  EXPECT_THAT(spacesIn("payload.color = vec3(dot(N(0), kLight) + dot(kLight, gl_WorldRayDirectionEXT));"), IsEmpty());
}

TEST(CheckSpaces, FollowsLibraryFunctions) {
  const std::string head = "#include <quintet/surface.glsl>\n" + std::string(kSpaceHead);
  const auto check = [&](const std::string& body) {
    return checkSpacesOf(
        Stage::closestHit,
        head + "void main() {\nInstanceData i = InstanceArray(frame.instances).at[0];\n" + body + "\n}\n");
  };
  const int line = kFirst + 2;
  EXPECT_THAT(
      check("vec3 x = normalize(rowsTimesVector(i.worldFromObject, N(0))); payload.color = reflect(kLight, x);"),
      ElementsAre(found("Q702", line)));
  EXPECT_THAT(check("payload.color = reflect(kLight, normalize(transposeTimesVector(i.objectFromWorld, N(0))));"),
              IsEmpty());
  EXPECT_THAT(check("payload.color = rowsTimesPoint(i.worldFromObject, P(0)) - gl_WorldRayOriginEXT;"), IsEmpty());
  EXPECT_THAT(check("payload.color = rowsTimesPoint(i.objectFromWorld, P(0)) - gl_WorldRayOriginEXT;"),
              ElementsAre(found("Q709", line)));
}

}  // namespace
}  // namespace quintet::check
