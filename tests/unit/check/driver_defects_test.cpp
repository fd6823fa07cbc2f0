// SPDX-License-Identifier: Apache-2.0
// Q901, Q902, Q904, Q905: reported for a driver with the defect, and only there.
#include <gmock/gmock.h>

#include "stage_test_support.h"

namespace quintet::check {
namespace {

using shader::Stage;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kTracer = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 inner;
void main() {
traceRayEXT(topLevelAS, 0u, 255u, 0u, 1u, 0u, gl_WorldRayOriginEXT, 0.1, vec3(0, 1, 0), 1e30, 1);
)";

TEST(CheckDriverDefects, ReportsBuiltInsAfterATraceUnlessTheyCanBeCopied) {
  const std::string computed = kTracer + std::string("color = inner * gl_ObjectToWorldEXT[int(inner.x) & 3];\n}\n");
  EXPECT_THAT(checkText(Stage::closestHit, computed, defectiveDevice()), ElementsAre("Q901:8"));
  EXPECT_THAT(checkText(Stage::closestHit, computed), IsEmpty());
  for (const char* use : {"color = inner * float(gl_PrimitiveID);\n}\n", "color = inner * gl_ObjectToWorldEXT[2];\n}\n",
                          "color = inner * gl_HitTEXT;\n}\n"})
    EXPECT_THAT(checkText(Stage::closestHit, kTracer + std::string(use), defectiveDevice()), IsEmpty()) << use;
}

std::vector<std::string> intersection(const std::string& body, const StageContext& context = defectiveDevice()) {
  return checkText(Stage::intersection,
                   "hitAttributeEXT vec3 normal;\nvoid main() {\n"
                   "float t = -gl_ObjectRayOriginEXT.y / gl_ObjectRayDirectionEXT.y;\n" +
                       body + "\n}\n",
                   context);
}

TEST(CheckDriverDefects, ReportsAttributesWrittenBeforeTheComparison) {
  const std::string unguarded = "normal = vec3(0, t, 0);\nreportIntersectionEXT(t, 0u);";
  EXPECT_THAT(intersection(unguarded), ElementsAre("Q902:6"));
  EXPECT_THAT(intersection(unguarded, {}), IsEmpty());
  EXPECT_THAT(intersection("if (t > 0.0) {\nnormal = vec3(0, t, 0);\nreportIntersectionEXT(t, 0u);\n}"),
              ElementsAre("Q902:7"));
  EXPECT_THAT(intersection("if (t < gl_RayTmaxEXT) normal.x = 1.0;\nnormal.y = t;\nreportIntersectionEXT(t, 0u);"),
              ElementsAre("Q902:7"));
}

TEST(CheckDriverDefects, AcceptsGuardedAttributes) {
  EXPECT_THAT(
      intersection(
          "if (gl_RayTminEXT <= t && t < gl_RayTmaxEXT) {\nnormal = vec3(0, t, 0);\nreportIntersectionEXT(t, 0u);\n}"),
      IsEmpty());
  EXPECT_THAT(intersection("if (t < gl_RayTminEXT || t >= gl_RayTmaxEXT) return;\nnormal = vec3(0, t, "
                           "0);\nreportIntersectionEXT(t, 0u);"),
              IsEmpty());
  EXPECT_THAT(
      intersection(
          "float nearest = gl_RayTmaxEXT; bool hit = false;\nfor (int i = 0; i < gl_PrimitiveID; ++i)\n"
          "if (t + float(i) < nearest) { nearest = t + float(i); hit = true; }\n"
          "if (hit && nearest < gl_RayTmaxEXT) { normal = vec3(nearest); reportIntersectionEXT(nearest, 0u); }"),
      IsEmpty());
}

// The comparison selects the candidate, which decides about the report.
TEST(CheckDriverDefects, AcceptsACandidateSelectedByTheComparison) {
  EXPECT_THAT(
      intersection("float nearest = 1e30;\nfor (int i = 0; i < gl_PrimitiveID; ++i) {\nfloat c = t * float(i);\n"
                   "if (!(c >= gl_RayTminEXT && c <= gl_RayTmaxEXT && c < nearest)) continue;\nnearest = c;\n}\n"
                   "if (nearest >= 1e30) return;\nnormal = vec3(nearest);\nreportIntersectionEXT(nearest, 0u);"),
      IsEmpty());
}

TEST(CheckDriverDefects, ReportsRayTmaxAfterAReport) {
  const std::string twice =
      "if (t < gl_RayTmaxEXT) reportIntersectionEXT(t, 0u);\nif (2.0 * t < gl_RayTmaxEXT)\nreportIntersectionEXT(2.0 * "
      "t, 0u);";
  EXPECT_THAT(intersection(twice), ElementsAre("Q904:7"));
  EXPECT_THAT(intersection(twice, {}), ElementsAre("Q904:7"));  // the optimizer merges the reads for all devices
  EXPECT_THAT(
      intersection("float nearest = gl_RayTmaxEXT;\nif (t < nearest && reportIntersectionEXT(t, 0u)) nearest = t;\n"
                   "if (2.0 * t < nearest) reportIntersectionEXT(2.0 * t, 0u);"),
      IsEmpty());
}

TEST(CheckDriverDefects, ReportsLocalArrays) {
  const std::string body =
      "float ts[8];\nfor (int i = 0; i < gl_PrimitiveID; ++i) ts[i & 7] = t * float(i);\n"
      "for (int i = 0; i < gl_PrimitiveID; ++i)\nreportIntersectionEXT(ts[i & 7], 0u);";
  EXPECT_EQ(intersection(body).size(), 1u);
  EXPECT_EQ(intersection(body).at(0).substr(0, 4), "Q905");
  EXPECT_THAT(intersection(body, {}), IsEmpty());
  StageContext alone = defectiveDevice();
  alone.hasAnyHit = false;
  EXPECT_THAT(intersection(body, alone), IsEmpty());
  EXPECT_THAT(intersection("float ts[2]; ts[0] = t; ts[1] = 2.0 * t;\nreportIntersectionEXT(ts[0], 0u); "
                           "reportIntersectionEXT(ts[1], 0u);"),
              IsEmpty());
}

}  // namespace
}  // namespace quintet::check
