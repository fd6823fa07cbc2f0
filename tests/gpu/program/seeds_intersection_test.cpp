// SPDX-License-Identifier: Apache-2.0
// The intersection shaders of document 003, unchanged from its slides: sphere in world and in object space, box, triangle,
// and the three CSG operations, compared with references in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>

#include "lecture_run.h"
#include "seeds.h"

namespace quintet::test {
namespace {

using dmat4 = glm::dmat4;

// Returns what the slides omit: the other types, the ray generation shader, and a closest-hit shader that shows `hit`.
std::string around(const std::string& camera) {
  return R"(struct RayPayloadType { vec4 value; };
uniform int show;
)" + camera +
         R"(
void main() { /**** RAY GENERATION SHADER ****/
  vec2 texCoord = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy);
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0), 0.001, getCameraRay(60.0, aspect, texCoord), 1000.0, 0);
  gsnSetPixel(payload.value);
}
void main() { /**** CLOSEST-HIT SHADER ****/
  payload.value = show == 0 ? vec4(hit.normal, gl_HitTEXT) : vec4(hit.texCoord, gl_HitKindEXT, gl_PrimitiveID);
}
void main() { /**** MISS SHADER ****/ payload.value = vec4(0.0, 0.0, 0.0, -1.0); }
)";
}

struct ExpectedHit {
  double t = -1;
  dvec3 normal{0};
  dvec2 texCoord{0};
  int kind = 0;
  int primitive = 0;
};

struct SeedsCase {
  std::vector<Bounds3> boxes;
  mat4 worldFromObject{1.0f};
};

// Computes the hit of a box by a ray in object space; `t` is the same as in world space.
using Surface = std::function<ExpectedHit(const RayD&, const Bounds3&)>;

ExpectedHit nearest(const SeedsCase& scene, const RayD& world, const Surface& surface) {
  const dmat4 objectFromWorld = glm::inverse(dmat4(scene.worldFromObject));
  const RayD ray{dvec3(objectFromWorld * glm::dvec4(world.origin, 1)),
                 dvec3(objectFromWorld * glm::dvec4(world.direction, 0))};
  ExpectedHit best;
  for (std::size_t i = 0; i < scene.boxes.size(); ++i) {
    ExpectedHit e = surface(ray, scene.boxes[i]);
    e.primitive = static_cast<int>(i);
    if (e.t >= 0.001 && (best.t < 0 || e.t < best.t)) best = e;
  }
  return best;
}

// Renders and compares, except pixels close to a discontinuity of the reference. Returns the number of compared hits.
int expectSurface(const std::string& text, const SeedsCase& test, const Surface& surface,
                  const std::vector<std::string>& set = {}) {
  scene::Scene scene;
  addBoxes(scene, test.boxes, test.worldFromObject);
  LectureOptions options{.width = 40, .height = 30};
  options.set = set;
  options.set.push_back("show=0");
  const LectureImage first = runLecture(text, scene, options);
  options.set.back() = "show=1";
  const LectureImage second = runLecture(text, scene, options);
  int compared = 0;
  for (std::uint32_t row = 0; row < options.height; ++row) {
    for (std::uint32_t x = 0; x < options.width; ++x) {
      const auto at = [&](double dx, double dy) {
        return nearest(test,
                       {dvec3(0), cameraDirection(60, 4.0 / 3.0, dvec2((x + 0.5 + dx) / 40, (row + 0.5 + dy) / 30))},
                       surface);
      };
      const ExpectedHit exact = at(0, 0);
      bool steady = true;
      for (const dvec2& d : {dvec2(0.02, 0), dvec2(-0.02, 0), dvec2(0, 0.02), dvec2(0, -0.02)}) {
        const ExpectedHit other = at(d.x, d.y);
        steady = steady && other.primitive == exact.primitive && other.kind == exact.kind &&
                 std::abs(other.t - exact.t) < 0.05 * std::abs(exact.t) &&
                 glm::distance(other.texCoord, exact.texCoord) < 0.5 && glm::distance(other.normal, exact.normal) < 0.5;
      }
      if (!steady) continue;
      const vec4 a = first.at(x, row), b = second.at(x, row);
      const std::string where = "pixel " + std::to_string(x) + "," + std::to_string(row);
      EXPECT_NEAR(a.w, exact.t, 2e-4 * std::max(1.0, exact.t)) << where;
      if (exact.t < 0) continue;
      ++compared;
      for (glm::length_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], exact.normal[i], 2e-3) << where << " normal";
      EXPECT_LT(glm::distance(dvec2(b), exact.texCoord), 2e-3) << where << " texture coordinate " << b.x << " " << b.y;
      EXPECT_EQ(b.z, exact.kind) << where;
      EXPECT_EQ(b.w, exact.primitive) << where;
    }
  }
  return compared;
}

// Returns the interval of t inside a sphere.
std::optional<dvec2> sphereInterval(const RayD& ray, const dvec3& center, double radius) {
  const dvec3 k = ray.origin - center;
  const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(k, ray.direction),
               c = glm::dot(k, k) - radius * radius;
  if (b * b - a * c < 0) return {};
  const double root = std::sqrt(b * b - a * c);
  return dvec2((-b - root) / a, (-b + root) / a);
}

ExpectedHit sphereIn(const RayD& ray, const Bounds3& box) {
  ExpectedHit e;
  const dvec3 center(box.center());
  const auto interval = sphereInterval(ray, center, 0.5 * static_cast<double>(box.extent().x));
  if (!interval || interval->y < 0.001) return e;
  e.kind = interval->x >= 0.001 ? 1 : 2;
  e.t = e.kind == 1 ? interval->x : interval->y;
  e.normal = glm::normalize(ray.origin + e.t * ray.direction - center);
  const double turn = std::atan2(e.normal.y, e.normal.x) / (2 * glm::pi<double>());
  e.texCoord = {turn - std::floor(turn), std::acos(-e.normal.z) / glm::pi<double>()};
  return e;
}

// Returns a few cubes in front of the camera and one around it.
SeedsCase cubes(const mat4& worldFromObject) {
  SeedsCase test;
  test.worldFromObject = worldFromObject;
  const auto cube = [](const vec3& c, float r) { return Bounds3{c - r, c + r}; };
  test.boxes = {cube({-1.5f, 0.5f, -6}, 1), cube({1, -0.6f, -5}, 1.2f), cube({0.4f, 1.4f, -7}, 0.8f),
                cube({0, 0, 0}, 20)};
  return test;
}

TEST(Seed003, SphereInWorldSpace) {
  QUINTET_NEED_SEED(document, "003");
  QUINTET_NEED_SEED(other, "002");
  const std::string program = cutProgram(document, "struct HitAttributeType {", 0, "/**** INTERSECTION SHADER ****/");
  ASSERT_NE(program.find("ray-sphere intersection in world space"), std::string::npos);
  const std::string text = supplied(program, around(cutBlock(other, "// Returns a camera ray")));
  // The shader computes the normal in world space; uniform scale keeps its direction.
  const SeedsCase test = cubes(glm::translate(mat4(1.0f), vec3(0.2f, 0.1f, 0)) * glm::scale(mat4(1.0f), vec3(1.1f)));
  EXPECT_GT(expectSurface(text, test, sphereIn), 1000);
}

TEST(Seed003, SphereInObjectSpace) {
  QUINTET_NEED_SEED(document, "003");
  QUINTET_NEED_SEED(other, "002");
  const std::string program = cutProgram(document, "struct HitAttributeType {", 1, "/**** INTERSECTION SHADER ****/");
  ASSERT_NE(program.find("ray-sphere intersection in object space"), std::string::npos);
  const std::string text = supplied(program, around(cutBlock(other, "// Returns a camera ray")));
  const SeedsCase test =
      cubes(glm::rotate(mat4(1.0f), 0.3f, vec3(0, 1, 0)) * glm::scale(mat4(1.0f), vec3(1.3f, 0.7f, 1.1f)));
  EXPECT_GT(expectSurface(text, test, sphereIn), 1000);
}

TEST(Seed003, Box) {
  QUINTET_NEED_SEED(document, "003");
  QUINTET_NEED_SEED(other, "002");
  const std::string program = cutProgram(document, "struct HitAttributeType {", 2, "/**** INTERSECTION SHADER ****/");
  ASSERT_NE(program.find("ray-box intersection"), std::string::npos);
  const std::string text = supplied(program, around(cutBlock(other, "// Returns a camera ray")));
  // One cube centered at the object's origin, because the shader finds the face by the largest coordinate.
  SeedsCase test;
  test.boxes = {{vec3(-1), vec3(1)}};
  test.worldFromObject = glm::translate(mat4(1.0f), vec3(0.3f, -0.2f, -5)) *
                         glm::rotate(mat4(1.0f), 0.7f, vec3(1, 2, 0.5f)) * glm::scale(mat4(1.0f), vec3(2, 1, 1.2f));
  const Surface surface = [](const RayD& ray, const Bounds3&) {
    ExpectedHit e;
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const double t = (side - ray.origin[axis]) / ray.direction[axis];
        const dvec3 p = ray.origin + t * ray.direction;
        const glm::length_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
        if (t < 0.001 || std::abs(p[u]) > 1 || std::abs(p[v]) > 1 || (e.t > 0 && t > e.t)) continue;
        e.t = t;
        e.kind = side * ray.direction[axis] < 0 ? 1 : 2;
        e.normal = dvec3(0);
        e.normal[axis] = side;
        // Seen from outside, s runs to the right: mirrored on the faces -x, +y and -z.
        const double sign = axis == 1 ? -side : side;
        e.texCoord = {(sign * p[u] + 1) / 2, (p[v] + 1) / 2};
      }
    }
    return e;
  };
  EXPECT_GT(expectSurface(text, test, surface), 200);
  test.worldFromObject = glm::scale(mat4(1.0f), vec3(9, 5, 7));  // around the camera
  EXPECT_GT(expectSurface(text, test, surface), 1000);
}

TEST(Seed003, Triangle) {
  QUINTET_NEED_SEED(document, "003");
  QUINTET_NEED_SEED(other, "002");
  const std::string program = cutProgram(document, "struct HitAttributeType {", 3, "/**** INTERSECTION SHADER ****/");
  ASSERT_NE(program.find("ray-triangle intersection"), std::string::npos);
  std::string text = supplied(program, around(cutBlock(other, "// Returns a camera ray")));
  const Surface surface = [](const RayD& ray, const Bounds3& box) {
    ExpectedHit e;
    const dvec3 low(box.min), size(box.extent());
    const double t = (low.z + size.z / 2 - ray.origin.z) / ray.direction.z;
    const dvec2 p = (dvec2(ray.origin + t * ray.direction) - dvec2(low)) / dvec2(size);  // in [0,1]² of the box
    // Vertices (0,0), (1,0), (1/2,1): the third weight is p.y.
    const double v = p.y, u = p.x - 0.5 * v;
    if (t < 0.001 || u < 0 || v < 0 || u + v > 1) return e;
    e.t = t;
    e.normal = {0, 0, 1};
    e.texCoord = p;
    e.kind = ray.direction.z < 0 ? 0xFE : 0xFF;
    return e;
  };
  SeedsCase test;
  test.boxes = {{vec3(-2, -1, -5), vec3(1, 1.5f, -4)}, {vec3(-0.5f, -1.5f, -7), vec3(2.5f, 2, -6)}};
  EXPECT_GT(expectSurface(text, test, surface), 150);
  test.worldFromObject =
      glm::rotate(mat4(1.0f), glm::radians(170.0f), vec3(0, 1, 0)) * glm::translate(mat4(1.0f), vec3(0, 0, 10));
  EXPECT_GT(expectSurface(text, test, surface), 150);
  // hit.baryCoord holds the weights of b and c.
  const std::string shown = "vec4(hit.texCoord, gl_HitKindEXT, gl_PrimitiveID)";
  text.replace(text.find(shown), shown.size(), "vec4(hit.baryCoord, gl_HitKindEXT, gl_PrimitiveID)");
  const Surface weights = [&](const RayD& ray, const Bounds3& box) {
    ExpectedHit e = surface(ray, box);
    e.texCoord = {e.texCoord.x - 0.5 * e.texCoord.y, e.texCoord.y};
    return e;
  };
  EXPECT_GT(expectSurface(text, test, weights), 150);
}

// Two spheres in a box of 2 x 2 x 2; positions relative to its center.
const std::array<dvec3, 2> kCenters{dvec3(-0.25, 0, 0.1), dvec3(0.35, 0.1, 0.3)};
constexpr std::array<double, 2> kRadii{0.65, 0.5};

constexpr const char* kCsgMain = R"(
void main() { /**** INTERSECTION SHADER ****/
  vec3 aabbMin, aabbMax;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, aabbMin, aabbMax);
  vec3 center = (aabbMin + aabbMax) / 2.0;
  vec3 centers[2] = vec3[](center + vec3(-0.25, 0.0, 0.1), center + vec3(0.35, 0.1, 0.3));
  vec2 interval0 = sphereInterval(centers[0], 0.65), interval1 = sphereInterval(centers[1], 0.5), combined;
  ivec2 hitIndex;
  bool found = operation == 0 ? computeCsgUnion(interval0, interval1, gl_RayTminEXT, combined, hitIndex)
           : operation == 1 ? computeCsgIntersection(interval0, interval1, gl_RayTminEXT, combined, hitIndex)
                            : computeCsgDifference(interval0, interval1, gl_RayTminEXT, combined, hitIndex);
  if (!found) return;
  bool enters = combined.x >= gl_RayTminEXT;
  float t = enters ? combined.x : combined.y;
  int index = enters ? hitIndex.x : hitIndex.y;
  if (t < gl_RayTminEXT || t > gl_RayTmaxEXT) return;
  vec3 from = index == 0 ? centers[0] : centers[1];
  hit.normal = normalize(gl_ObjectRayOriginEXT + t * gl_ObjectRayDirectionEXT - from) * (operation == 2 && index == 1 ? -1.0 : 1.0);
  hit.texCoord = vec2(float(index), 0.0);
  reportIntersectionEXT(t, enters ? 1u : 2u);
}
)";

constexpr const char* kIntervals = R"(
struct HitAttributeType { vec3 normal; vec2 texCoord; };
uniform int operation;
bool intervalsOverlap(vec2 a, vec2 b) { return a.x <= b.y && b.x <= a.y; }
vec2 sphereInterval(vec3 center, float radius) {
  vec3 b = gl_ObjectRayOriginEXT - center;
  float rr = dot(gl_ObjectRayDirectionEXT, gl_ObjectRayDirectionEXT);
  float p = dot(gl_ObjectRayDirectionEXT, b) / rr, q = (dot(b, b) - radius * radius) / rr;
  float d = p * p - q;
  return d < 0.0 ? vec2(1e8, -1e8) : vec2(-p - sqrt(d), -p + sqrt(d));
}
)";

TEST(Seed003, CsgOfTwoSpheres) {
  QUINTET_NEED_SEED(document, "003");
  QUINTET_NEED_SEED(other, "002");
  const std::string functions = cutBlock(document, "bool computeCsgUnion(") + "\n" +
                                cutBlock(document, "bool computeCsgIntersection(") + "\n" +
                                cutBlock(document, "bool computeCsgDifference(") + "\n";
  const std::string text = kIntervals + functions + around(cutBlock(other, "// Returns a camera ray")) + kCsgMain;
  SeedsCase test;
  test.boxes = {{vec3(-1), vec3(1)}};
  test.worldFromObject = glm::translate(mat4(1.0f), vec3(0.1f, 0, -2.2f)) * glm::scale(mat4(1.0f), vec3(1, 1.2f, 1));
  for (int operation = 0; operation < 3; ++operation) {
    // The first t at which the ray enters the set, by testing points between the four crossings.
    const Surface surface = [&](const RayD& ray, const Bounds3&) {
      ExpectedHit e;
      std::vector<std::pair<double, int>> crossings;
      std::array<std::optional<dvec2>, 2> intervals;
      for (std::size_t i = 0; i < 2; ++i) {
        intervals[i] = sphereInterval(ray, kCenters[i], kRadii[i]);
        if (!intervals[i]) continue;
        crossings.emplace_back(intervals[i]->x, static_cast<int>(i));
        crossings.emplace_back(intervals[i]->y, static_cast<int>(i));
      }
      std::ranges::sort(crossings);
      const auto inside = [&](double t) {
        const bool a = intervals[0] && t > intervals[0]->x && t < intervals[0]->y,
                   b = intervals[1] && t > intervals[1]->x && t < intervals[1]->y;
        return operation == 0 ? a || b : operation == 1 ? a && b : a && !b;
      };
      for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        if (!inside(0.5 * (crossings[i].first + crossings[i + 1].first))) continue;
        const int index = crossings[i].second;
        e.t = crossings[i].first;
        e.kind = 1;
        e.texCoord = {index, 0};
        e.normal = glm::normalize(ray.origin + e.t * ray.direction - kCenters[static_cast<std::size_t>(index)]);
        if (operation == 2 && index == 1) e.normal = -e.normal;
        return e;
      }
      return e;
    };
    EXPECT_GT(expectSurface(text, test, surface, {"operation=" + std::to_string(operation)}), 40) << operation;
  }
}

}  // namespace
}  // namespace quintet::test
