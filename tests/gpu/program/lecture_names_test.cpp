// SPDX-License-Identifier: Apache-2.0
// The values of every predeclared name of the lecture form: one ray per pixel straight down onto known triangles and boxes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "lecture_run.h"

namespace quintet::test {
namespace {

// A ray to (x + 0.3, row + 0.2) from z = 10 with a direction of length 2.
const std::string kNamesHead = R"(struct RayPayloadType { vec4 value; int depth; };
uniform int what;
void main() { /**** RAY GENERATION SHADER ****/
  payload.value = vec4(-9.0);
  payload.depth = 0;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(vec2(gl_LaunchIDEXT.xy) + vec2(0.3, 0.2), 10.0), 0.0, vec3(0.0, 0.0, -2.0), 50.0, 0);
  gsnSetPixel(payload.value);
}
void main() { /**** MISS SHADER ****/ payload.value = vec4(-1.0); }
)";

std::string closestHit(const std::string& body) {
  return kNamesHead + "void main() { /**** CLOSEST-HIT SHADER ****/\n" + body + "\n}\n";
}

// Returns a row of 8 unit squares from (0, y, 0) with two triangles each in permuted order: square s has index 5 s mod 8.
scene::Geometry squares(float y, bool attributes) {
  scene::Geometry g;
  g.triangles.resize(16);
  for (std::uint32_t s = 0; s < 8; ++s) {
    const auto first = static_cast<std::uint32_t>(g.positions.size());
    const auto x = static_cast<float>(s);
    for (const vec2& c : {vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 1)}) {
      g.positions.push_back({x + c.x, y + c.y, 0});
      if (!attributes) continue;
      g.normals.push_back(glm::normalize(vec3(c, 1.0f + x)));
      g.uvs[0].push_back({0.1f * x + c.x, 0.2f * c.y});
    }
    g.triangles[5 * s % 8 * 2] = {first, first + 1, first + 2};
    g.triangles[5 * s % 8 * 2 + 1] = {first, first + 2, first + 3};
  }
  return g;
}

// Rows 0 and 1 are instance 0 with two geometries, the second without attributes. Row 2 is instance 1, mirrored and scaled.
scene::Scene grid() {
  scene::Scene scene;
  scene::Mesh& mesh = scene.meshes.emplace_back();
  mesh.geometries = {squares(0.0f, true), squares(1.0f, false)};
  scene.meshes.emplace_back().geometries = {squares(0.0f, true)};
  scene.instances.resize(2);
  scene.instances[0].mesh = 0;
  scene.instances[0].customIndex = 7;
  scene.instances[1].mesh = 1;
  scene.instances[1].customIndex = 5;
  // Seen from above, squares of 2 x 3 scaled to 1 x 1, mirrored in x: square s is in column 7 - s.
  scene.instances[1].worldFromObject =
      glm::translate(mat4(1.0f), vec3(8, 2, -1)) * glm::scale(mat4(1.0f), vec3(-1, 1, 3));
  return scene;
}

// Returns the index of a triangle of a square.
int triangleOf(std::uint32_t square, bool second = false) {
  return static_cast<int>(5 * square % 8 * 2 + (second ? 1 : 0));
}

TEST(LectureNames, IdsAreIndicesInTheScene) {
  const LectureImage image = runLecture(
      closestHit(
          "payload.value = vec4(gl_PrimitiveID, gl_InstanceID, gl_GeometryIndexEXT, gl_InstanceCustomIndexEXT);"),
      grid(), {.width = 8, .height = 4});
  for (std::uint32_t x = 0; x < 8; ++x) {
    EXPECT_EQ(image.at(x, 0), vec4(triangleOf(x), 0, 0, 7)) << x;
    EXPECT_EQ(image.at(x, 1), vec4(triangleOf(x), 0, 1, 7)) << x;
    EXPECT_EQ(image.at(x, 2), vec4(triangleOf(7 - x), 1, 0, 5)) << x;  // (1 - 0.3, 0.2) is in the first triangle too
    EXPECT_EQ(image.at(x, 3), vec4(-1)) << x;
  }
}

// what = 0 … 2: positions, 3 … 5 normals, 6 … 8 texture coordinates, 9 … 11 columns of the normal matrix, 12 barycentrics.
constexpr const char* kMeshData = R"(
  int inst = gl_InstanceID, prim = gl_PrimitiveID;
  vec3 p[3], n[3]; vec2 t[3]; mat3 m;
  gsnGetPositions(inst, prim, p[0], p[1], p[2]);
  gsnGetNormals(inst, prim, n[0], n[1], n[2]);
  gsnGetTexCoords(inst, prim, t[0], t[1], t[2]);
  gsnGetNormal3x3Matrix(inst, m);
  payload.value.w = 1.0;
  payload.value.xyz = what < 3 ? p[what] : what < 6 ? n[what - 3] : what < 9 ? vec3(t[what - 6], 0.0) : what < 12 ? m[what - 9] : vec3(baryCoord, 0.0);
)";

void expectNear(const vec4& value, const vec3& exact, const std::string& where) {
  for (glm::length_t i = 0; i < 3; ++i) EXPECT_NEAR(value[i], exact[i], 1e-5f) << where << " component " << i;
}

TEST(LectureNames, MeshDataIsThatOfTheTriangle) {
  const scene::Scene scene = grid();
  const std::string text = closestHit(kMeshData);
  for (int what = 0; what < 9; ++what) {
    const LectureImage image =
        runLecture(text, scene, {.width = 8, .height = 3, .set = {"what=" + std::to_string(what)}});
    for (std::uint32_t row = 0; row < 3; ++row) {
      const scene::Geometry& g = row < 2 ? scene.meshes[0].geometries[row] : scene.meshes[1].geometries[0];
      for (std::uint32_t x = 0; x < 8; ++x) {
        const uvec3 triangle = g.triangles[static_cast<std::size_t>(triangleOf(row < 2 ? x : 7 - x))];
        const std::uint32_t v = triangle[what % 3];
        const vec3 exact = what < 3   ? g.positions[v]
                           : what < 6 ? (g.normals.empty() ? vec3(0, 0, 1) : g.normals[v])
                                      : (g.uvs[0].empty() ? vec3(0) : vec3(g.uvs[0][v].x, 1.0f - g.uvs[0][v].y, 0));
        expectNear(image.at(x, row), exact,
                   "what " + std::to_string(what) + " at " + std::to_string(x) + "," + std::to_string(row));
      }
    }
  }
}

TEST(LectureNames, NormalMatrixAndBarycentrics) {
  const scene::Scene scene = grid();
  for (int what = 9; what < 13; ++what) {
    const LectureImage image =
        runLecture(closestHit(kMeshData), scene, {.width = 8, .height = 3, .set = {"what=" + std::to_string(what)}});
    for (std::uint32_t row = 0; row < 3; ++row) {
      const mat3 m = glm::transpose(glm::inverse(mat3(scene.instances[row < 2 ? 0 : 1].worldFromObject)));
      // Corners (0,0), (1,0), (1,1): the point (u, v) has weights u - v of the second and v of the third.
      const vec3 exact = what < 12 ? m[what - 9] : row < 2 ? vec3(0.1f, 0.2f, 0) : vec3(0.5f, 0.2f, 0);
      expectNear(image.at(3, row), exact, "what " + std::to_string(what) + " row " + std::to_string(row));
    }
  }
}

// Outside hit shaders, the first geometry of a mesh counts; indices out of range give zeros.
// Of a closest hit behind a candidate that an any-hit shader rejects, in all parts of a triangle.
TEST(LectureNames, BarycentricsBehindARejectedCandidate) {
  scene::Scene scene;
  scene::Geometry& g = scene.meshes.emplace_back().geometries.emplace_back();
  const vec2 a(-0.5f, 0.1f), b(8.5f, -0.5f), c(1.5f, 7.0f);
  g.positions = {vec3(a, 0), vec3(b, 0), vec3(c, 0)};
  g.triangles = {{0, 1, 2}};
  scene.instances.resize(2);
  scene.instances[0].mesh = scene.instances[1].mesh = 0;
  scene.instances[1].worldFromObject = glm::translate(mat4(1.0f), vec3(-0.4f, -0.3f, 1));  // in front
  const LectureImage image =
      runLecture(closestHit("payload.value = vec4(baryCoord, float(gl_InstanceID), 1.0);") +
                     "void main() { /**** ANY-HIT SHADER ****/ if (gl_InstanceID == 1) ignoreIntersectionEXT; }\n",
                 scene, {.width = 8, .height = 6});
  int compared = 0;
  vec3 largest(0.0f);
  for (std::uint32_t x = 0; x < 8; ++x)
    for (std::uint32_t row = 0; row < 6; ++row) {
      const vec2 p = vec2(static_cast<float>(x) + 0.3f, static_cast<float>(row) + 0.2f) - a;
      const glm::mat2 edges(b - a, c - a);
      const vec2 expected = glm::inverse(edges) * p;
      const vec3 weights(1.0f - expected.x - expected.y, expected);
      if (std::min({weights.x, weights.y, weights.z}) < 1e-3f) continue;
      EXPECT_LT(glm::length(image.at(x, row) - vec4(expected, 0, 1)), 1e-5f) << x << " " << row;
      largest = glm::max(largest, weights);
      ++compared;
    }
  EXPECT_GT(compared, 15);
  EXPECT_GT(std::min({largest.x, largest.y, largest.z}), 0.7f);
}

TEST(LectureNames, RayGenerationReadsMeshData) {
  const std::string text = R"(void main() { /**** RAY GENERATION SHADER ****/
  int x = int(gl_LaunchIDEXT.x);
  int inst = x < 4 ? x - 1 : 0, prim = x < 4 ? 3 : x == 4 ? -1 : x == 5 ? 15 : 16;
  vec3 p0, p1, p2, n0, n1, n2, low, high; vec2 t0, t1, t2; mat3 m;
  gsnGetPositions(inst, prim, p0, p1, p2);
  gsnGetNormals(inst, prim, n0, n1, n2);
  gsnGetTexCoords(inst, prim, t0, t1, t2);
  gsnGetIntersectionBox(inst, prim, low, high);
  gsnGetNormal3x3Matrix(inst, m);
  gsnSetPixel(vec4(p0.x, n0.z, t2.x + low.x + high.x, m[2].z));
}
)";
  const scene::Scene scene = grid();
  const LectureImage image = runLecture(text, scene, {.width = 7, .height = 1});
  const auto expected = [&](std::size_t mesh, std::size_t prim, float m) {
    const scene::Geometry& g = scene.meshes[mesh].geometries[0];
    const uvec3 t = g.triangles[prim];
    return vec4(g.positions[t.x].x, g.normals[t.x].z, g.uvs[0][t.z].x, m);
  };
  EXPECT_EQ(image.at(0), vec4(0, 0, 0, 1));
  EXPECT_EQ(image.at(1), expected(0, 3, 1));
  EXPECT_EQ(image.at(2), expected(1, 3, 1.0f / 3.0f));
  EXPECT_EQ(image.at(3), vec4(0, 0, 0, 1));
  EXPECT_EQ(image.at(4), vec4(0, 0, 0, 1));
  EXPECT_EQ(image.at(5), expected(0, 15, 1));
  EXPECT_EQ(image.at(6), vec4(0, 0, 0, 1));
}

// All built-ins of a hit, after a nested trace with another hit.
TEST(LectureNames, BuiltInsSurviveANestedTrace) {
  const std::string text = "// gsnShaderOptions: precompiler=\"recursion: 2\"\n" + closestHit(R"(
  if (payload.depth > 0) { payload.value = vec4(gl_PrimitiveID); return; }
  payload.depth = 1;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(6.3, 2.2, 10.0), 0.0, vec3(0.0, 0.0, -1.0), 50.0, 0);
  payload.value = what == 0 ? vec4(gl_PrimitiveID, gl_InstanceID, gl_InstanceCustomIndexEXT, gl_GeometryIndexEXT)
                : what == 1 ? vec4(gl_ObjectToWorldEXT[3], gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT ? 1.0 : 0.0)
                : what == 2 ? vec4(gl_WorldToObjectEXT[3], gl_WorldToObject3x4EXT[0][3]) : vec4(baryCoord, gl_HitTEXT, payload.value.x);)");
  const scene::Scene scene = grid();
  const auto pixel = [&](int what, std::uint32_t row) {
    return runLecture(text, scene, {.width = 2, .height = 3, .set = {"what=" + std::to_string(what)}}).at(1, row);
  };
  EXPECT_EQ(pixel(0, 1), vec4(triangleOf(1), 0, 7, 1));
  EXPECT_EQ(pixel(1, 0), vec4(0, 0, 0, 1));
  EXPECT_EQ(pixel(1, 2),
            vec4(8, 2, -1, 1));  // mirrored and still front-facing, because facing is determined in object space
  EXPECT_EQ(pixel(2, 0), vec4(0, 0, 0, 0));
  const vec4 last = pixel(3, 1);
  EXPECT_NEAR(last.x, 0.1f, 1e-5f);
  EXPECT_NEAR(last.z, 5.0f, 1e-5f);
  EXPECT_EQ(last.w, triangleOf(1));  // the square that the inner ray hits: column 6 of the mirrored row
}

// Both forms of both matrices, for an instance with a rotation, different scales, a shear and a translation.
TEST(LectureNames, MatricesInBothForms) {
  const std::string text = closestHit(R"(
  vec4 row = what < 3 ? vec4(gl_ObjectToWorldEXT[0][what], gl_ObjectToWorldEXT[1][what], gl_ObjectToWorldEXT[2][what], gl_ObjectToWorldEXT[3][what])
           : what < 6 ? gl_ObjectToWorld3x4EXT[what - 3]
           : what < 9 ? vec4(gl_WorldToObjectEXT[0][what - 6], gl_WorldToObjectEXT[1][what - 6], gl_WorldToObjectEXT[2][what - 6], gl_WorldToObjectEXT[3][what - 6])
           : what < 12 ? gl_WorldToObject3x4EXT[what - 9] : vec4(0.0);
  if (what >= 12) {
    mat3 m;
    gsnGetNormal3x3Matrix(gl_InstanceID, m);
    row = vec4(m[0][what - 12], m[1][what - 12], m[2][what - 12], 0.0);
  }
  payload.value = row;)");
  scene::Scene scene;
  scene.meshes.emplace_back().geometries.emplace_back();
  scene::Geometry& g = scene.meshes[0].geometries[0];
  g.positions = {{-20, -20, 0}, {20, -20, 0}, {0, 40, 0}};
  g.triangles = {{0, 1, 2}};
  scene.instances.resize(1);
  scene.instances[0].mesh = 0;
  mat4 shear(1.0f);
  shear[1][0] = 0.3f;
  const mat4 world = glm::translate(mat4(1.0f), vec3(0.5f, -0.25f, 1.5f)) *
                     glm::rotate(mat4(1.0f), 0.4f, glm::normalize(vec3(1, 2, 0.5f))) * shear *
                     glm::scale(mat4(1.0f), vec3(2.0f, 0.5f, -1.25f));
  scene.instances[0].worldFromObject = world;
  const mat4 object = glm::inverse(world);
  const glm::mat3 normal = glm::transpose(glm::inverse(glm::mat3(world)));
  for (int what = 0; what < 15; ++what) {
    const vec4 got = runLecture(text, scene, {.width = 1, .set = {"what=" + std::to_string(what)}}).at(0);
    const int row = what % 3;
    const vec4 expected = what < 6    ? vec4(world[0][row], world[1][row], world[2][row], world[3][row])
                          : what < 12 ? vec4(object[0][row], object[1][row], object[2][row], object[3][row])
                                      : vec4(normal[0][row], normal[1][row], normal[2][row], 0);
    EXPECT_LT(glm::distance(got, expected), 1e-5f) << "row " << what;
  }
}

TEST(LectureNames, CallablesHaveIndices) {
  const std::string text = R"(struct CallableDataType { float x; };
void main() { /**** RAY GENERATION SHADER ****/
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 2; ++i) {
    callableData.x = 3.0;
    executeCallableEXT(uint(i), 0);
    sum[i] = callableData.x;
  }
  gsnSetPixel(sum);
}
void main() { /**** CALLABLE SHADER ****/ callableData.x *= 2.0; }
void main() { /**** CALLABLE SHADER ****/ callableData.x += float(gl_LaunchIDEXT.x); }
)";
  const LectureImage image = runLecture(text, grid(), {.width = 3});
  EXPECT_EQ(image.at(2), vec4(6, 5, 0, 0));
}

TEST(LectureNames, ConstantsHaveTheirValues) {
  const std::string text = R"(void main() { /**** RAY GENERATION SHADER ****/
  const uint flags[11] = uint[](gl_RayFlagsNoneEXT, gl_RayFlagsOpaqueEXT, gl_RayFlagsNoOpaqueEXT, gl_RayFlagsTerminateOnFirstHitEXT,
    gl_RayFlagsSkipClosestHitShaderEXT, gl_RayFlagsCullBackFacingTrianglesEXT, gl_RayFlagsCullFrontFacingTrianglesEXT, gl_RayFlagsCullOpaqueEXT,
    gl_RayFlagsCullNoOpaqueEXT, gl_RayFlagsSkipTrianglesEXT, gl_RayFlagsSkipAABBEXT);
  gsnSetPixel(vec4(flags[gl_LaunchIDEXT.x], gl_HitKindFrontFacingTriangleEXT, gl_HitKindBackFacingTriangleEXT, PI));
}
)";
  const LectureImage image = runLecture(text, grid(), {.width = 11});
  for (std::uint32_t i = 0; i < 11; ++i)
    EXPECT_EQ(image.at(i), vec4(i == 0 ? 0.0f : static_cast<float>(1u << (i - 1)), 0xFE, 0xFF, 3.14159265f));
}

}  // namespace
}  // namespace quintet::test
