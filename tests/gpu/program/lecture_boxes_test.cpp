// SPDX-License-Identifier: Apache-2.0
// Procedural primitives in the lecture form: boxes, `hit`, hit kinds and any-hit. Attributes are those of the hit even if
// shaders write them for rejected candidates.
#include <gtest/gtest.h>

#include "lecture_run.h"

namespace quintet::test {
namespace {

// A ray down to (x + 0.3, row + 0.2) from z = 10 with a direction of length 2.
const std::string kBoxesHead = R"(// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, app: 1"
struct RayPayloadType { vec4 value; };
struct HitAttributeType { float id; vec3 point; };
uniform int what;
void main() { /**** RAY GENERATION SHADER ****/
  payload.value = vec4(-9.0);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(vec2(gl_LaunchIDEXT.xy) + vec2(0.3, 0.2), 10.0), 0.0, vec3(0.0, 0.0, -2.0), 50.0, 0);
  gsnSetPixel(payload.value);
}
void main() { /**** MISS SHADER ****/ payload.value = vec4(-1.0); }
)";

// The surface is the top of the box. The shader writes attributes before it knows whether the hit counts.
const std::string kTop = R"(void main() { /**** INTERSECTION SHADER ****/
  vec3 low, high;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, low, high);
  float t = (high.z - gl_ObjectRayOriginEXT.z) / gl_ObjectRayDirectionEXT.z;
  hit.id = float(gl_PrimitiveID);
  hit.point = gl_ObjectRayOriginEXT + t * gl_ObjectRayDirectionEXT;
  // Drivers can run the shader for boxes that the ray misses by a small distance.
  if (any(lessThan(hit.point.xy, low.xy)) || any(greaterThan(hit.point.xy, high.xy))) return;
  reportIntersectionEXT(t, fract(high.z) > 0.25 ? 9u : 7u);
}
)";

// Box i is above square (5 i mod 8) of row 0, up to z = 1 + i / 64, so that the order on the device differs from the scene.
std::vector<Bounds3> rowOfBoxes() {
  std::vector<Bounds3> boxes;
  for (int i = 0; i < 8; ++i) {
    const auto x = static_cast<float>(5 * i % 8);
    boxes.push_back({vec3(x, 0, 0), vec3(x + 1, 1, 1.0f + static_cast<float>(i) / 64.0f)});
  }
  return boxes;
}

TEST(LectureBoxes, HaveTheIdsAndBoxesOfTheScene) {
  scene::Scene scene;
  addBoxes(scene, rowOfBoxes());
  addBoxes(scene, rowOfBoxes(), glm::translate(mat4(1.0f), vec3(0, 1, -2)) * glm::scale(mat4(1.0f), vec3(1, 1, 2)));
  const std::string hit =
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.value = what == 0 ? vec4(hit.id, gl_PrimitiveID, "
      "gl_InstanceID, gl_HitTEXT)"
      " : what == 1 ? vec4(hit.point, gl_HitKindEXT) : vec4(baryCoord, gl_GeometryIndexEXT, 0.0); }\n";
  const auto run = [&](int what) {
    return runLecture(kBoxesHead + kTop + hit, scene,
                      {.width = 8, .height = 3, .set = {"what=" + std::to_string(what)}});
  };
  const LectureImage ids = run(0), points = run(1), rest = run(2);
  for (int i = 0; i < 8; ++i) {
    const auto x = static_cast<std::uint32_t>(5 * i % 8);
    const auto top = 1.0f + static_cast<float>(i) / 64.0f;
    EXPECT_EQ(ids.at(x, 0), vec4(i, i, 0, (10.0f - top) / 2.0f));
    EXPECT_EQ(ids.at(x, 1), vec4(i, i, 1, (10.0f - (2.0f * top - 2.0f)) / 2.0f));
    for (std::uint32_t rowOfBoxes = 0; rowOfBoxes < 2; ++rowOfBoxes) {
      const vec4 point = points.at(x, rowOfBoxes);
      EXPECT_NEAR(point.x, static_cast<float>(x) + 0.3f, 1e-5f);
      EXPECT_NEAR(point.y, 0.2f, 1e-5f);
      EXPECT_NEAR(point.z, top, 1e-5f);
      EXPECT_EQ(point.w, 7.0f);
      EXPECT_EQ(rest.at(x, rowOfBoxes), vec4(0));
    }
    EXPECT_EQ(ids.at(x, 2), vec4(-1));
  }
}

// Columns of two boxes in every order. An any-hit shader ignores some of the hits (kind 9).
TEST(LectureBoxes, AttributesAreThoseOfTheHit) {
  const float tops[5] = {1.0f, 2.0f, 3.0f, 2.5f, 3.5f};  // the last two are ignored
  std::vector<Bounds3> boxes;
  std::vector<float> expected;  // id by column
  for (int a = 0; a < 5; ++a) {
    for (int b = 0; b < 5; ++b) {
      const auto x = static_cast<float>(expected.size());
      const int first = static_cast<int>(boxes.size());
      for (const int k : {a, b}) boxes.push_back({vec3(x, 0, 0), vec3(x + 1, 1, tops[k])});
      const bool firstCounts = a < 3 && (b >= 3 || tops[a] > tops[b]);
      // With two equal boxes either could win, so move one down.
      if (a == b && a < 3) boxes.back() = {vec3(x, 0, -2), vec3(x + 1, 1, -1)};
      const bool equal = a == b && a < 3;
      expected.push_back(firstCounts || equal ? static_cast<float>(first)
                         : b < 3              ? static_cast<float>(first + 1)
                                              : -1.0f);
    }
  }
  scene::Scene scene;
  addBoxes(scene, boxes);
  const std::string stages =
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.value = vec4(hit.id, hit.point.z, gl_PrimitiveID, "
      "gl_HitTEXT); }\n"
      "void main() { /**** ANY-HIT SHADER ****/ if (gl_HitKindEXT == 9u && hit.id == float(gl_PrimitiveID)) "
      "ignoreIntersectionEXT; }\n";
  const auto width = static_cast<std::uint32_t>(expected.size());
  const LectureImage image = runLecture(kBoxesHead + kTop + stages, scene, {.width = width});
  for (std::uint32_t x = 0; x < width; ++x) {
    const vec4& value = image.at(x);
    EXPECT_EQ(value.x, expected[x]) << "column " << x;
    if (expected[x] < 0) continue;
    EXPECT_EQ(value.z, expected[x]) << "column " << x;
    EXPECT_NEAR(value.y, boxes[static_cast<std::size_t>(expected[x])].max.z, 1e-5f) << "column " << x;
  }
}

// Triangles with boxes below and above them keep their barycentrics, and `hit` is zero on triangles.
TEST(LectureBoxes, TrianglesKeepTheirBarycentrics) {
  scene::Scene scene;
  scene.meshes.emplace_back().geometries = {quad({0, 0, 2}, {4, 0, 0}, {0, 1, 0})};
  scene.instances.emplace_back().mesh = 0;
  addBoxes(scene, {{vec3(1, 0, 0), vec3(2, 1, 1)}, {vec3(2, 0, 0), vec3(3, 1, 2.5f)}, {vec3(3, 0, 0), vec3(4, 1, 3)}});
  const std::string stages =
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.value = vec4(baryCoord, hit.id, gl_HitTEXT); }\n"
      "void main() { /**** ANY-HIT SHADER ****/ if (gl_HitKindEXT == 9u) ignoreIntersectionEXT; }\n";
  const LectureImage image = runLecture(kBoxesHead + kTop + stages, scene, {.width = 4});
  for (std::uint32_t x = 0; x < 3; ++x) {
    // The lower right triangle (0,0), (4,0), (4,1) at (x + 0.3, 0.2), or the upper left one (0,0), (4,1), (0,1).
    const float u = (static_cast<float>(x) + 0.3f) / 4.0f, v = 0.2f;
    const vec2 exact = u >= v ? vec2(u - v, v) : vec2(u, v - u);
    EXPECT_NEAR(image.at(x).x, exact.x, 1e-5f) << x;
    EXPECT_NEAR(image.at(x).y, exact.y, 1e-5f) << x;
    EXPECT_EQ(image.at(x).z, 0.0f) << x;
    EXPECT_EQ(image.at(x).w, 4.0f) << x;
  }
  EXPECT_EQ(image.at(3), vec4(0, 0, 2, 3.5f));
}

// Without HitAttributeType, only `hit` is missing.
TEST(LectureBoxes, WorkWithoutAttributes) {
  scene::Scene scene;
  addBoxes(scene, rowOfBoxes());
  const std::string text =
      "struct RayPayloadType { vec4 value; };\nvoid main() { /**** RAY GENERATION SHADER ****/\n"
      "traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(vec2(gl_LaunchIDEXT.xy) + 0.5, 10.0), 0.0, vec3(0.0, 0.0, "
      "-1.0), 50.0, 0);\n"
      "gsnSetPixel(payload.value); }\n"
      "void main() { /**** MISS SHADER ****/ payload.value = vec4(-1.0); }\n"
      "void main() { /**** INTERSECTION SHADER ****/ reportIntersectionEXT(8.5, 3u); }\n"
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.value = vec4(gl_HitTEXT, gl_HitKindEXT, gl_PrimitiveID, "
      "0.0); }\n";
  const LectureImage image = runLecture(text, scene, {.width = 9});
  EXPECT_EQ(image.at(5), vec4(8.5f, 3, 1, 0));
  EXPECT_EQ(image.at(8), vec4(-1));
}

}  // namespace
}  // namespace quintet::test
