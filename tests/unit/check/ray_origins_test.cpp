// SPDX-License-Identifier: Apache-2.0
// Q705: recognizes rays with tmin 0 that start on a surface.
#include <gmock/gmock.h>

#include "stage_test_support.h"

namespace quintet::check {
namespace {

using shader::Stage;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kOriginHead = R"(#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT topLevelAS;
struct Payload { vec3 color; float t; vec3 position; vec3 normal; };
layout(location = 1) rayPayloadEXT Payload inner;
layout(buffer_reference, scalar) buffer Mesh { vec3 positions[]; };
layout(push_constant, scalar) uniform P { Mesh mesh; float tmin; } push;
void shoot(vec3 origin, float tmin, vec3 direction) {
traceRayEXT(topLevelAS, 0u, 255u, 0u, 1u, 0u, origin, tmin, direction, 1e30, 1);
}
)";
constexpr const char* kHitHead = "layout(location = 0) rayPayloadInEXT Payload payload;\nhitAttributeEXT vec2 b;\n";
constexpr const char* kReported = "Q705:11";  // the trace in kOriginHead

std::vector<std::string> originsOf(Stage stage, const std::string& text) {
  const auto module = compileStage(stage, text);
  Report report;
  if (module) checkRayOrigins(*module, report);
  return linesOf(report.take());
}

std::vector<std::string> originsIn(const std::string& body) {
  return originsOf(Stage::closestHit, std::string(kOriginHead) + kHitHead + "void main() {\n" + body +
                                          "\npayload.color = inner.color;\n}\n");
}
std::vector<std::string> rayGeneration(const std::string& body) {
  return originsOf(
      Stage::rayGeneration,
      kOriginHead + ("layout(set = 0, binding = 2, rgba8) uniform writeonly image2D result;\nvoid main() {\n"
                     "vec3 o = vec3(0, 0, 9), d = normalize(vec3(gl_LaunchIDEXT.xy, -9));\n" +
                     body + "\nimageStore(result, ivec2(gl_LaunchIDEXT.xy), vec4(inner.color, 1));\n}\n"));
}

constexpr const char* kPoint = "vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;\n";

TEST(CheckRayOrigins, ReportsPointsOnTheRay) {
  EXPECT_THAT(originsIn(std::string(kPoint) + "shoot(p, 0.0, vec3(0, 1, 0));"), ElementsAre(kReported));
  EXPECT_THAT(
      originsIn("vec3 p = gl_WorldRayDirectionEXT * gl_HitTEXT + gl_WorldRayOriginEXT;\nshoot(p, 0.0, vec3(0, 1, 0));"),
      ElementsAre(kReported));
}

TEST(CheckRayOrigins, AcceptsAnOffsetOrTmin) {
  EXPECT_THAT(originsIn(std::string(kPoint) + "shoot(p, 0.001, vec3(0, 1, 0));"), IsEmpty());
  EXPECT_THAT(originsIn(std::string(kPoint) + "shoot(p, push.tmin, vec3(0, 1, 0));"), IsEmpty());
  EXPECT_THAT(originsIn(std::string(kPoint) + "shoot(p + 0.001 * vec3(0, 1, 0), 0.0, vec3(0, 1, 0));"), IsEmpty());
  EXPECT_THAT(originsIn("vec3 p = gl_WorldRayOriginEXT + 0.999 * gl_HitTEXT * gl_WorldRayDirectionEXT;\nshoot(p, 0.0, "
                        "vec3(0, 1, 0));"),
              IsEmpty());
}

constexpr const char* kVertices =
    "vec3 v = (1.0 - b.x - b.y) * push.mesh.positions[0] + b.x * push.mesh.positions[1] + b.y * "
    "push.mesh.positions[2];\n";

TEST(CheckRayOrigins, ReportsInterpolatedVertices) {
  EXPECT_THAT(originsIn(std::string(kVertices) + "shoot(gl_ObjectToWorldEXT * vec4(v, 1.0), 0.0, vec3(0, 1, 0));"),
              ElementsAre(kReported));
  EXPECT_THAT(
      originsIn(std::string(kVertices) +
                "vec3 p = gl_ObjectToWorldEXT * vec4(v, 1.0);\nshoot(p + vec3(0, 1e-3, 0), 0.0, vec3(0, 1, 0));"),
      IsEmpty());
}

TEST(CheckRayOrigins, FollowsALoopInRayGeneration) {
  const std::string loop =
      "for (int i = 0; i < 4; ++i) {\nshoot(o, 0.0, d);\nif (inner.t < 0.0) break;\n%\nd = reflect(d, "
      "inner.normal);\n}";
  const auto with = [&](const std::string& step) {
    return rayGeneration(std::string(loop).replace(loop.find('%'), 1, step));
  };
  EXPECT_THAT(with("o = o + inner.t * d;"), ElementsAre(kReported));
  EXPECT_THAT(with("o += d * inner.t;"), ElementsAre(kReported));
  EXPECT_THAT(with("o += d * inner.t + 1e-3 * inner.normal;"), IsEmpty());
  EXPECT_THAT(with("o = inner.position;"), IsEmpty());  // the hit shader can add an offset: not followed within a stage
}

TEST(CheckRayOrigins, AcceptsCameraRays) { EXPECT_THAT(rayGeneration("shoot(o, 0.0, d);"), IsEmpty()); }

}  // namespace
}  // namespace quintet::check
