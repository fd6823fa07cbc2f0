// SPDX-License-Identifier: Apache-2.0
// Lessons 15, 16 and 18: any-hit, callable shaders, instances.
#include <gtest/gtest.h>

#include "lesson.h"

namespace quintet::test {
namespace {

constexpr double kStageMargin = 2e-4;

// Returns all hits of a ray, sorted by distance.
std::vector<HostHit> allHits(const scene::Scene& scene, const HostRay& ray, bool& decided) {
  std::vector<HostHit> hits;
  double from = 1e-9;
  while (true) {
    const HostHit hit = closestTriangle(scene, ray, from, 1000);
    decided = decided && hit.margin > kStageMargin;
    if (hit.t < 0) return hits;
    hits.push_back(hit);
    from = hit.t + 1e-7;
  }
}

HostRay anyHitRay(dvec2 point) {
  const dvec2 plane = (2.0 * point - 1.0) * dvec2(1.5, 1) * std::tan(glm::radians(20.0)) - dvec2(0, 0.2);
  return {{0, 2.5, 6}, glm::normalize(dvec3(plane, -1))};
}

bool passes(const scene::Scene& scene, const HostHit& hit, bool& decided) {
  if (hit.instance == 0) return false;
  const dvec2 uv = 4.0 * surfaceAt(scene, hit).texCoord;
  const double distance = glm::length(uv - glm::floor(uv) - 0.5);
  decided = decided && std::abs(distance - 0.35) > 2e-3;
  return distance < 0.35;
}

TEST(LessonAnyHit, CutsHolesIntoPlatesAndShadows) {
  const scene::Scene scene = lessonScene("15_any_hit");
  const dvec3 base[3] = {{0.7, 0.7, 0.65}, {0.8, 0.4, 0.2}, {0.25, 0.45, 0.7}};
  int through = 0, shadowed = 0;
  expectPixels(
      renderLesson("15_any_hit"),
      [&](dvec2 point) {
        bool decided = true;
        const HostRay ray = anyHitRay(point);
        for (const HostHit& hit : allHits(scene, ray, decided)) {
          const bool hole = passes(scene, hit, decided);
          if (!decided) return kUndecided;
          if (hole) {
            through++;
            continue;
          }
          const HostSurface s = surfaceAt(scene, hit);
          const dvec3 normal = glm::dot(s.faceNormal, ray.direction) > 0 ? -s.faceNormal : s.faceNormal;
          const dvec3 position = s.position + 0.001 * normal, toLamp = dvec3(2, 5, 4) - position;
          const double distance = glm::length(toLamp);
          bool seen = true;
          for (const HostHit& other : allHits(scene, {position, toLamp / distance}, decided))
            if (other.t < distance && !passes(scene, other, decided)) seen = false;
          if (!decided) return kUndecided;
          shadowed += !seen;
          const double light = seen ? std::max(0.0, glm::dot(normal, toLamp / distance)) : 0.0;
          return glm::dvec4(base[hit.instance] * (0.15 + 0.85 * light), 1);
        }
        return decided ? glm::dvec4(0.35, 0.45, 0.6, 1) : kUndecided;
      },
      1e-4, 0.3);
  EXPECT_GT(through, 50);
  EXPECT_GT(shadowed, 50);
}

TEST(LessonAnyHit, KeepsPayloadWritesOfIgnoredHits) {
  const scene::Scene scene = lessonScene("15_any_hit");
  LessonOptions options;
  options.set = {{"mode", "1"}};
  int several = 0;
  expectPixels(
      renderLesson("15_any_hit", options),
      [&](dvec2 point) {
        bool decided = true;
        const std::size_t layers = allHits(scene, anyHitRay(point), decided).size();
        if (!decided) return kUndecided;
        several += layers > 1;
        return glm::dvec4(dvec3(static_cast<double>(layers) / 4), 1);
      },
      1e-6, 0.1);
  EXPECT_GT(several, 50);
}

TEST(LessonAnyHit, TerminatesAtOneOfTheCandidates) {
  const scene::Scene scene = lessonScene("15_any_hit");
  LessonOptions options;
  options.set = {{"mode", "2"}};
  const LessonImage image = renderLesson("15_any_hit", options);
  const vec3 base[3] = {{0.7f, 0.7f, 0.65f}, {0.8f, 0.4f, 0.2f}, {0.25f, 0.45f, 0.7f}};
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      bool decided = true;
      const auto hits = allHits(scene, anyHitRay(dvec2((x + 0.5) / image.width, (y + 0.5) / image.height)), decided);
      if (!decided) continue;
      const vec3 color(image.at(x, y));
      bool possible = hits.empty() && glm::length(color - vec3(0.35f, 0.45f, 0.6f)) < 1e-4f;
      for (const HostHit& hit : hits) possible = possible || glm::length(color - base[hit.instance]) < 1e-4f;
      EXPECT_TRUE(possible) << "pixel " << x << ", " << y;
    }
  }
}

TEST(LessonCallable, CallsTheMaterialOfEachInstance) {
  const scene::Scene scene = lessonScene("16_callable");
  const dvec3 toLight = glm::normalize(dvec3(0.4, 0.8, 0.45));
  int count[3] = {0, 0, 0};
  expectPixels(
      renderLesson("16_callable"),
      [&](dvec2 point) {
        const HostHit hit =
            closestTriangle(scene, cameraRay({0, 0, 7}, {0, 0, 0}, {0, 1, 0}, 35, 1.5, point), 0.001, 1000);
        if (hit.margin < kStageMargin) return kUndecided;
        if (hit.t < 0) return glm::dvec4(0.08, 0.09, 0.12, 1);
        const HostSurface s = surfaceAt(scene, hit);
        const double light = glm::dot(s.normal, toLight);
        count[hit.instance]++;
        if (hit.instance == 0) return glm::dvec4(dvec3(0.8, 0.3, 0.2) * std::max(light, 0.0), 1);
        if (hit.instance == 1) {
          const dvec3 p = 3.0 * s.position;
          const dvec3 edge = glm::abs(p - glm::round(p));
          if (std::min({edge.x, edge.y, edge.z}) < 1e-4) return kUndecided;
          const dvec3 cell = glm::floor(p);
          const bool odd = (static_cast<int>(cell.x + cell.y + cell.z) & 1) != 0;
          return glm::dvec4((odd ? dvec3(0.9) : dvec3(0.1, 0.2, 0.3)) * (0.3 + 0.7 * std::max(light, 0.0)), 1);
        }
        if (std::abs(light - 0.7) < 1e-4 || std::abs(light - 0.2) < 1e-4) return kUndecided;
        return glm::dvec4(dvec3(0.3, 0.6, 0.9) * (light > 0.7 ? 1.0 : light > 0.2 ? 0.6 : 0.3), 1);
      },
      2e-4, 0.15);
  for (const int n : count) EXPECT_GT(n, 80);
}

// Applies the rules of the Vulkan specification: the winding in object space and the flag of the instance determine the
// facing; the instance can disable culling; the ray sees an instance if their masks share a bit.
void expectInstances(int mask, bool cullBack) {
  const scene::Scene all = lessonScene("18_instances");
  LessonOptions options;
  options.set = {{"cullMask", std::to_string(mask)}, {"cullBack", cullBack ? "true" : "false"}};
  const dvec3 palette[4] = {{0.8, 0.25, 0.2}, {0.25, 0.6, 0.3}, {0.2, 0.4, 0.8}, {0.8, 0.7, 0.2}};
  int seen = 0, back = 0;
  const auto isFront = [&](const HostHit& hit, const HostRay& ray) {
    const scene::Instance& instance = all.instances[static_cast<std::size_t>(hit.instance)];
    // The inverse transpose transforms faceNormal, so its sign relative to the ray is the same as in object space.
    const bool front = glm::dot(surfaceAt(all, hit).faceNormal, ray.direction) < 0;
    return front != ((instance.flags & scene::kInstanceFlipFacing) != 0);
  };
  expectPixels(
      renderLesson("18_instances", options),
      [&](dvec2 point) {
        const HostRay ray = cameraRay({0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 40, 1.5, point);
        bool decided = true;
        for (const HostHit& hit : allHits(all, ray, decided)) {
          const scene::Instance& instance = all.instances[static_cast<std::size_t>(hit.instance)];
          if ((instance.mask & static_cast<std::uint32_t>(mask)) == 0) continue;
          const bool front = isFront(hit, ray);
          if (cullBack && !front && (instance.flags & scene::kInstanceCullDisable) == 0) continue;
          seen++;
          back += !front;
          const double cosine = std::abs(glm::dot(surfaceAt(all, hit).faceNormal, glm::normalize(dvec3(1, 1, 2))));
          const dvec3 color = palette[instance.customIndex & 3] * ((hit.instance & 1) != 0 ? 1.0 : 0.8) *
                              (0.25 + 0.75 * cosine) * (front ? 1.0 : 0.5);
          return decided ? glm::dvec4(color, 1) : kUndecided;
        }
        return decided ? glm::dvec4(0.05, 0.05, 0.05, 1) : kUndecided;
      },
      1e-4, 0.2);
  EXPECT_GT(seen, mask == 255 ? 150 : 50);
  EXPECT_GT(back, cullBack ? 2 : 8);
}

TEST(LessonInstances, ShowsCustomIndexAndFacing) { expectInstances(255, false); }
TEST(LessonInstances, CullsBackFaces) { expectInstances(255, true); }
TEST(LessonInstances, MasksRows) { expectInstances(5, false); }

}  // namespace
}  // namespace quintet::test
