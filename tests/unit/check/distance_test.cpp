// SPDX-License-Identifier: Apache-2.0
// Q701: recognizes a t that is a distance in object space.
#include <gmock/gmock.h>

#include "stage_test_support.h"

namespace quintet::check {
namespace {

using shader::Stage;
using testing::ElementsAre;
using testing::IsEmpty;

// Checks an intersection shader whose `body` declares o and d and computes t.
std::vector<std::string> sphere(const std::string& body) {
  return checkText(Stage::intersection, "void main() {\n" + body + "\nreportIntersectionEXT(t, 0u);\n}\n");
}

constexpr const char* kUnit = "vec3 o = gl_ObjectRayOriginEXT; vec3 d = normalize(gl_ObjectRayDirectionEXT);\n";
constexpr const char* kPlain = "vec3 o = gl_ObjectRayOriginEXT; vec3 d = gl_ObjectRayDirectionEXT;\n";

TEST(CheckDistance, ReportsAUnitDirection) {
  EXPECT_THAT(sphere(std::string(kUnit) + "float b = dot(o, d); float t = -b - sqrt(b * b - dot(o, o) + 1.0);"),
              ElementsAre("Q701:4"));
}

TEST(CheckDistance, AcceptsAUnitDirectionDividedByItsLength) {
  EXPECT_THAT(sphere(std::string(kUnit) + "float b = dot(o, d); float t = -b - sqrt(b * b - dot(o, o) + 1.0);\n"
                                          "t /= length(gl_ObjectRayDirectionEXT);"),
              IsEmpty());
}

TEST(CheckDistance, AcceptsAUnitDirectionTimesItsInverseLength) {
  EXPECT_THAT(sphere(std::string(kUnit) + "float b = dot(o, d); float t = -b - sqrt(b * b - dot(o, o) + 1.0);\n"
                                          "t *= inversesqrt(dot(gl_ObjectRayDirectionEXT, gl_ObjectRayDirectionEXT));"),
              IsEmpty());
}

TEST(CheckDistance, AcceptsThePlainDirection) {
  EXPECT_THAT(sphere(std::string(kPlain) + "float a = dot(d, d); float b = dot(o, d);\n"
                                           "float t = (-b - sqrt(b * b - a * (dot(o, o) - 1.0))) / a;"),
              IsEmpty());
}

TEST(CheckDistance, ReportsManualNormalization) {
  EXPECT_THAT(sphere("vec3 o = gl_ObjectRayOriginEXT; float l = length(gl_ObjectRayDirectionEXT);\n"
                     "vec3 d = gl_ObjectRayDirectionEXT / l;\nfloat t = -dot(o, d);"),
              ElementsAre("Q701:4"));
  EXPECT_THAT(sphere("vec3 o = gl_ObjectRayOriginEXT; vec3 d = gl_ObjectRayDirectionEXT;\n"
                     "d *= inversesqrt(dot(d, d));\nfloat t = -dot(o, d);"),
              ElementsAre("Q701:5"));
}

TEST(CheckDistance, FollowsClamping) {
  EXPECT_THAT(sphere(std::string(kUnit) + "float t = max(-dot(o, d), gl_RayTminEXT);"), ElementsAre("Q701:4"));
  EXPECT_THAT(sphere(std::string(kPlain) + "float t = max(-dot(o, d) / dot(d, d), gl_RayTminEXT);"), IsEmpty());
}

TEST(CheckDistance, FollowsSlabs) {
  const std::string slabs =
      "vec3 a = (vec3(-1) - o) / d, b = (vec3(1) - o) / d; vec3 lo = min(a, b);\nfloat t = max(max(lo.x, lo.y), lo.z);";
  EXPECT_THAT(sphere(kPlain + slabs), IsEmpty());
  EXPECT_THAT(sphere(kUnit + slabs), ElementsAre("Q701:4"));
}

// The unit direction can be used for anything but t.
TEST(CheckDistance, AcceptsAUnitDirectionForAnAttribute) {
  EXPECT_THAT(checkText(Stage::intersection,
                        "hitAttributeEXT vec3 view;\nvoid main() {\nview = normalize(gl_ObjectRayDirectionEXT);\n"
                        "vec3 d = gl_ObjectRayDirectionEXT;\n"
                        "reportIntersectionEXT(-dot(gl_ObjectRayOriginEXT, d) / dot(d, d), 0u);\n}\n"),
              IsEmpty());
}

// The steps through a distance field are distances, so t must be rescaled.
TEST(CheckDistance, FollowsSphereTracing) {
  const std::string march = "float s = 0.0;\nfor (int i = 0; i < 64; ++i) s += length(o + s * d) - 1.0;\n";
  EXPECT_THAT(sphere(kUnit + march + "float t = s;"), ElementsAre("Q701:4"));
  EXPECT_THAT(sphere(kUnit + march + "float t = s / length(gl_ObjectRayDirectionEXT);"), IsEmpty());
}

TEST(CheckDistance, IgnoresTheWorldSpaceDirection) {
  EXPECT_THAT(sphere("vec3 d = normalize(gl_WorldRayDirectionEXT);\nfloat t = -dot(gl_WorldRayOriginEXT, d);"),
              IsEmpty());
}

// One of two branches is wrong; their degrees do not mix.
TEST(CheckDistance, ReportsOneOfTwoBranches) {
  const std::string rest =
      "float a = dot(d, d), b = dot(o, d);\nfloat t = (-b - sqrt(b * b - a * (dot(o, o) - 1.0))) / a;";
  const std::string branch =
      "vec3 o, d;\nif (gl_GeometryIndexEXT == 0) { o = gl_WorldRayOriginEXT; d = gl_WorldRayDirectionEXT; }\n"
      "else { o = gl_ObjectRayOriginEXT; d = %; }\n";
  const auto with = [&](const std::string& direction) {
    return sphere(std::string(branch).replace(branch.find('%'), 1, direction) + rest);
  };
  EXPECT_THAT(with("gl_ObjectRayDirectionEXT"), IsEmpty());
  EXPECT_THAT(with("normalize(gl_ObjectRayDirectionEXT)"), ElementsAre("Q701:6"));
}

TEST(CheckDistance, AcceptsATThatDoesNotDependOnTheDirection) {
  EXPECT_THAT(sphere("float t = 1.0;"), IsEmpty());
  EXPECT_THAT(sphere("float t = gl_ObjectRayOriginEXT.x * length(vec3(gl_PrimitiveID));"), IsEmpty());
}

// Two roots in an array; a loop selects the closer one.
TEST(CheckDistance, FollowsRootsInAnArray) {
  const std::string roots =
      "float ts[2]; float b = dot(o, d); float h = sqrt(b * b - dot(o, o) + 1.0);\n"
      "ts[0] = -b - h; ts[1] = -b + h;\nfloat t = gl_RayTmaxEXT;\n"
      "for (int i = 0; i < gl_PrimitiveID; ++i) if (ts[i & 1] > gl_RayTminEXT) t = min(t, ts[i & 1]);";
  EXPECT_THAT(sphere(kUnit + roots), ElementsAre("Q701:4"));
}

}  // namespace
}  // namespace quintet::check
