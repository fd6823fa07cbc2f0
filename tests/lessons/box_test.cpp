// SPDX-License-Identifier: Apache-2.0
// Lessons 12, 13 and 14: box, triangle and combined solids with intersection shaders, compared with the host.
#include <gtest/gtest.h>

#include <array>
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
  expectBoxes({-1.4, 0.3, 0.1}, 2, [](const BoxHit& h) { return dvec3(h.texCoord, 0); });
}

// The shaded checkerboard, without the borders of its fields.
TEST(LessonBox, ShowsACheckerboard) {
  const scene::Scene scene = lessonScene("12_box");
  int dark = 0, light = 0;
  expectPixels(
      renderLesson("12_box"),
      [&](dvec2 point) {
        bool decided = true;
        const dvec3 eye(0, 0.5, 6);
        const BoxHit hit =
            nearestFace(scene, cameraRay(eye, eye - dvec3(0, 0, 1), {0, 1, 0}, 40, 1.5, point), 0.001, decided);
        const dvec2 fields = 6.0 * hit.texCoord, border = glm::abs(fields - glm::round(fields));
        if (!decided || (hit.t < 1e30 && std::min(border.x, border.y) < 1e-2)) return kUndecided;
        if (hit.t >= 1e30) return glm::dvec4(0.1, 0.12, 0.16, 1);
        const bool odd = ((static_cast<int>(fields.x) + static_cast<int>(fields.y)) & 1) != 0;
        (odd ? dark : light)++;
        return glm::dvec4((odd ? dvec3(0.45, 0.2, 0.15) : dvec3(0.9, 0.8, 0.65)) *
                              (0.2 + 0.8 * std::abs(glm::dot(hit.normal, glm::normalize(dvec3(1, 2, 3))))),
                          1);
      },
      1e-4, 0.15);
  EXPECT_GT(dark, 60);
  EXPECT_GT(light, 60);
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

struct TreeHit {
  double t = -1;
  int leaf = -1;      // 0 box, 1 sphere, 2 to 4 cylinders along x, y and z
  dvec3 normal{0};    // out of the combined solid, object space
  double margin = 1;  // distance of the hit from the nearest other surface
};

// The first surface of the tree of lesson 14 along a ray in object space, by membership on both sides of all candidates.
TreeHit treeHit(const HostRay& ray, double tmin) {
  const auto radial = [](const dvec3& p, int axis) {
    dvec3 q = p;
    q[axis] = 0;
    return q;
  };
  const auto distances = [&](const dvec3& p) {
    const dvec3 q = glm::abs(p);
    return std::array<double, 5>{std::max({q.x, q.y, q.z}) - 1, glm::length(p) - 1.35, glm::length(radial(p, 0)) - 0.6,
                                 glm::length(radial(p, 1)) - 0.6, glm::length(radial(p, 2)) - 0.6};
  };
  const auto inside = [&](double t) {
    const auto d = distances(ray.origin + t * ray.direction);
    return d[0] < 0 && d[1] < 0 && d[2] > 0 && d[3] > 0 && d[4] > 0;
  };
  std::vector<std::pair<double, int>> candidates;
  const auto add = [&](const std::optional<Interval>& interval, int leaf) {
    if (interval) candidates.insert(candidates.end(), {{interval->in, leaf}, {interval->out, leaf}});
  };
  add(boxInterval(ray, dvec3(-1), dvec3(1)), 0);
  add(sphereInterval(ray, dvec3(0), 1.35), 1);
  for (int axis = 0; axis < 3; ++axis)
    add(sphereInterval({radial(ray.origin, axis), radial(ray.direction, axis)}, dvec3(0), 0.6), 2 + axis);
  TreeHit best;
  for (const auto& [t, leaf] : candidates) {
    if (t < tmin || (best.t > 0 && t >= best.t) || inside(t - 1e-5) == inside(t + 1e-5)) continue;
    best = {t, leaf, dvec3(0), 1};
  }
  if (best.t < 0) return best;
  const dvec3 p = ray.origin + best.t * ray.direction;
  const auto d = distances(p);
  for (int i = 0; i < 5; ++i)
    if (i != best.leaf) best.margin = std::min(best.margin, std::abs(d[static_cast<std::size_t>(i)]));
  if (best.leaf == 0) {
    const dvec3 q = glm::abs(p);
    const int axis = q.x > q.y && q.x > q.z ? 0 : q.y > q.z ? 1 : 2;
    best.normal[axis] = glm::sign(p[axis]);
  } else if (best.leaf == 1) {
    best.normal = glm::normalize(p);
  } else {
    best.normal = -glm::normalize(radial(p, best.leaf - 2));
  }
  best.margin = std::min(best.margin, std::abs(glm::dot(best.normal, glm::normalize(ray.direction))));
  return best;
}

TEST(LessonCsgTree, CombinesFiveLeavesWithTheirMaterials) {
  const scene::Scene scene = lessonScene("14_csg_tree");
  const mat4 world = scene.instances.front().worldFromObject;
  const dvec3 toSun(0.48, 0.8, 0.36), side = glm::normalize(glm::cross(toSun, dvec3(1, 0, 0))),
                                      other = glm::cross(toSun, side);
  const dvec3 base[5] = {
      {0.85, 0.62, 0.25}, {0.25, 0.45, 0.75}, {0.75, 0.2, 0.15}, {0.75, 0.2, 0.15}, {0.75, 0.2, 0.15}};
  int leaves[5] = {0, 0, 0, 0, 0}, shadowed = 0;
  expectPixels(
      renderLesson("14_csg_tree"),
      [&](dvec2 point) {
        const HostRay ray = cameraRay({3, 2.4, 4}, {0, 0, 0}, {0, 1, 0}, 35, 1.5, point);
        const TreeHit hit = treeHit(toObject(ray, world), 1e-4);
        // Near the outline, floats can decide differently.
        for (const double e : {-4e-3, 4e-3}) {
          const TreeHit near = treeHit(toObject({ray.origin, ray.direction + e * side + 0.7 * e * other}, world), 1e-4);
          if (near.leaf != hit.leaf) return kUndecided;
        }
        if (hit.t < 0) return glm::dvec4(0.1, 0.12, 0.16, 1);
        if (hit.margin < 1e-2) return kUndecided;
        const dvec3 normal = normalToWorld(hit.normal, world), position = ray.origin + hit.t * ray.direction;
        const double cosine = glm::dot(normal, toSun);
        if (std::abs(cosine) < 1e-3) return kUndecided;
        bool dark = false;
        if (cosine > 0) {
          const auto blocked = [&](const dvec3& shift) {
            return treeHit(toObject({position + 1e-4 * normal + shift, toSun}, world), 2e-4).t > 0;
          };
          dark = blocked(dvec3(0));
          for (const dvec3& shift : {4e-3 * side, -4e-3 * side, 4e-3 * other, -4e-3 * other})
            if (blocked(shift + std::abs(glm::dot(shift, normal)) * normal) != dark) return kUndecided;
        }
        leaves[hit.leaf]++;
        shadowed += dark;
        return glm::dvec4(base[hit.leaf] * (0.2 + (cosine > 0 && !dark ? 0.8 * cosine : 0.0)), 1);
      },
      2e-4, 0.3);
  for (const int count : leaves) EXPECT_GT(count, 8);
  EXPECT_GT(shadowed, 8);
}

TEST(LessonCsgTree, UsesTheCenterOfTheLens) {
  EXPECT_LT(pixelsChangedByLens("14_csg_tree"), 5) << "more than rounding, which decides at edges";
}

}  // namespace
}  // namespace quintet::test
