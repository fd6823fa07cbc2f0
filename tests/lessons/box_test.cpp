// SPDX-License-Identifier: Apache-2.0
// Lessons 12, 13 and 14: box, triangle and combined solids with intersection shaders, compared with the host.
#include <gtest/gtest.h>

#include <map>

#include "solids.h"

namespace quintet::test {
namespace {

struct BoxHit {
  double t = 1e30;
  dvec3 normal{0};
  dvec2 texCoord{0};
};

// Returns the nearest face by testing each face, which is independent of the slab method.
BoxHit nearestFace(const scene::Scene& scene, const HostRay& ray, double tmin, bool& decided) {
  BoxHit best;
  for (const scene::Instance& instance : scene.instances) {
    const HostRay local = toObject(ray, instance.worldFromObject);
    for (const Bounds3& box : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitiveSets.front().boxes) {
      for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        const bool high = face % 2 == 1;
        const double t = ((high ? box.max : box.min)[axis] - local.origin[axis]) / local.direction[axis];
        if (t < tmin) continue;
        const dvec3 p = (local.origin + t * local.direction - dvec3(box.min)) / dvec3(box.max - box.min);
        bool inside = true;
        for (int k = 0; k < 3; ++k) {
          if (k == axis) continue;
          inside = inside && p[k] >= 0 && p[k] <= 1;
          bool near = true;
          for (int m = 0; m < 3; ++m) near = near && (m == axis || (p[m] > -1e-3 && p[m] < 1 + 1e-3));
          if (near && (std::abs(p[k]) < 1e-3 || std::abs(p[k] - 1) < 1e-3)) decided = false;
        }
        if (!inside || t >= best.t) continue;
        dvec3 normal(0);
        normal[axis] = high ? 1 : -1;
        dvec2 uv;
        if (axis == 0)
          uv = {high ? 1 - p.z : p.z, p.y};
        else if (axis == 1)
          uv = {p.x, high ? 1 - p.z : p.z};
        else
          uv = {high ? p.x : 1 - p.x, p.y};
        best = {t, normalToWorld(normal, instance.worldFromObject), uv};
      }
    }
  }
  return best;
}

void expectBoxes(const dvec3& eye, int show, const std::function<dvec3(const BoxHit&)>& color) {
  const scene::Scene scene = lessonScene("12_box");
  LessonOptions options;
  options.set = {{"show", std::to_string(show)},
                 {"eye", std::to_string(eye.x) + "," + std::to_string(eye.y) + "," + std::to_string(eye.z)}};
  int hits = 0;
  expectPixels(
      renderLesson("12_box", options),
      [&](dvec2 point) {
        bool decided = true;
        const BoxHit hit =
            nearestFace(scene, cameraRay(eye, eye - dvec3(0, 0, 1), {0, 1, 0}, 40, 1.5, point), 0.001, decided);
        if (!decided) return kUndecided;
        hits += hit.t < 1e30;
        return glm::dvec4(hit.t < 1e30 ? color(hit) : dvec3(0.1, 0.12, 0.16), 1);
      },
      1e-4, 0.1);
  EXPECT_GT(hits, 150);
}

TEST(LessonBox, ShowsNormals) {
  expectBoxes({0, 0.5, 6}, 1, [](const BoxHit& h) { return 0.5 + 0.5 * h.normal; });
}
TEST(LessonBox, ShowsTextureCoordinates) {
  expectBoxes({0, 0.5, 6}, 2, [](const BoxHit& h) { return dvec3(h.texCoord, 0); });
}
TEST(LessonBox, ShowsTheInside) {
  expectBoxes({-1.4, 0.3, 0.1}, 1, [](const BoxHit& h) { return 0.5 + 0.5 * h.normal; });
}

TEST(LessonTriangle, AgreesWithTheBuiltInTest) {
  // The triangles on the host: those of the mesh, and for a box the one inside it.
  scene::Scene scene = lessonScene("13_triangle");
  std::map<int, bool> builtIn;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    scene::Mesh& mesh = scene.meshes[static_cast<std::size_t>(scene.instances[i].mesh)];
    builtIn[static_cast<int>(i)] = !mesh.procedural() && mesh.primitiveSets.empty();
  }
  for (scene::Mesh& mesh : scene.meshes) {
    if (!mesh.procedural()) continue;
    const Bounds3 box = mesh.primitiveSets.front().boxes.front();
    const float z = 0.5f * (box.min.z + box.max.z);
    scene::Geometry geometry;
    geometry.positions = {
        {box.min.x, box.min.y, z}, {box.max.x, box.min.y, z}, {0.5f * (box.min.x + box.max.x), box.max.y, z}};
    geometry.triangles = {{0, 1, 2}};
    mesh.geometries = {geometry};
  }
  for (const int show : {0, 1}) {
    LessonOptions options;
    options.set = {{"show", std::to_string(show)}};
    int custom = 0, triangles = 0, back = 0;
    expectPixels(
        renderLesson("13_triangle", options),
        [&](dvec2 point) {
          const HostRay ray = cameraRay({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40, 1.5, point);
          const HostHit hit = closestTriangle(scene, ray, 0.001, 1000);
          if (hit.margin < 1e-3) return kUndecided;
          if (hit.t < 0) return glm::dvec4(0, 0, 0, 1);
          (builtIn[hit.instance] ? triangles : custom)++;
          const bool front = glm::dot(surfaceAt(scene, hit).faceNormal, ray.direction) < 0;
          back += !front;
          if (show == 0) return glm::dvec4(1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric, 1);
          return glm::dvec4(hit.t / 10, front ? 1 : 0, builtIn[hit.instance] ? 1 : 0, 1);
        },
        2e-5);
    EXPECT_GT(custom, 50);
    EXPECT_GT(triangles, 50);
    EXPECT_GT(back, 50);
  }
}

// Finds the first candidate in [tmin, ∞) with different membership in the combined solid on its two sides.
TEST(LessonCsg, ShowsUnionIntersectionAndDifference) {
  const scene::Scene scene = lessonScene("14_csg");
  const std::vector<Bounds3>& boxes = scene.meshes.front().primitiveSets.front().boxes;
  const dvec3 eye(0, 2.5, 7);
  int hits[3] = {0, 0, 0}, holes = 0;
  expectPixels(
      renderLesson("14_csg"),
      [&](dvec2 point) {
        const HostRay ray = cameraRay(eye, {0, 0, 0}, {0, 1, 0}, 40, 1.5, point);
        double best = 1e30;
        glm::dvec4 color(0.1, 0.12, 0.16, 1);
        int op = -1;
        bool hole = false;
        for (std::size_t i = 0; i < 3; ++i) {
          const dvec3 center = 0.5 * (dvec3(boxes[i].min) + dvec3(boxes[i].max));
          const double half = 0.55 * 0.5 * (double(boxes[i].max.x) - boxes[i].min.x), radius = 1.25 * half;
          const auto inside = [&](const dvec3& p) {
            const dvec3 q = glm::abs(p - center);
            const bool inBox = std::max({q.x, q.y, q.z}) < half, inBall = glm::length(p - center) < radius;
            return i == 0 ? inBox || inBall : i == 1 ? inBox && inBall : inBox && !inBall;
          };
          std::vector<std::pair<double, bool>> candidates;
          const auto add = [&](const std::optional<Interval>& interval, bool ball) {
            if (interval) candidates.insert(candidates.end(), {{interval->in, ball}, {interval->out, ball}});
          };
          add(boxInterval(ray, center - half, center + half), false);
          add(sphereInterval(ray, center, radius), true);
          for (const auto& [t, ball] : candidates) {
            for (const auto& [other, unused] : candidates)
              if (other != t && std::abs(other - t) < 2e-2) return kUndecided;  // near an edge or the outline
            if (t < 0.001 || t >= best) continue;
            if (inside(ray.origin + (t - 1e-4) * ray.direction) == inside(ray.origin + (t + 1e-4) * ray.direction))
              continue;
            best = t;
            const dvec3 p = ray.origin + t * ray.direction - center;
            dvec3 normal = p / radius;
            if (!ball) {
              const dvec3 q = glm::abs(p);
              normal = q.x > q.y && q.x > q.z ? dvec3(glm::sign(p.x), 0, 0)
                       : q.y > q.z            ? dvec3(0, glm::sign(p.y), 0)
                                              : dvec3(0, 0, glm::sign(p.z));
            }
            hole = i == 2 && ball;
            if (hole) normal = -normal;
            op = static_cast<int>(i);
            const double light = 0.25 + 0.75 * std::max(0.0, glm::dot(normal, glm::normalize(dvec3(0.5, 1, 0.8))));
            color = glm::dvec4((ball ? dvec3(0.2, 0.45, 0.7) : dvec3(0.85, 0.6, 0.25)) * light, 1);
          }
        }
        if (op >= 0) hits[op]++;
        holes += hole;
        return color;
      },
      1e-4, 0.15);
  for (const int count : hits) EXPECT_GT(count, 30);
  EXPECT_GT(holes, 10);
}

}  // namespace
}  // namespace quintet::test
