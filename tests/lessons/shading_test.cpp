// SPDX-License-Identifier: Apache-2.0
// Lessons 04 to 07: light, shadow and reflection, compared with the host.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "lesson.h"

namespace quintet::test {
namespace {

constexpr double kShadingMargin = 2e-4;
const dvec3 kEye(2, 3, 6);
const dvec3 kTarget(0, 0.7, 0);
const dvec3 kBackground(0.3, 0.35, 0.45);
const dvec3 kAmbient(0.1, 0.1, 0.12);

HostRay eyeRay(dvec2 point, double aspect) { return cameraRay(kEye, kTarget, {0, 1, 0}, 35, aspect, point); }

// Returns whether the lamp is visible from just above the surface. Clears `decided` if an edge is too close.
bool seesLamp(const scene::Scene& scene, const dvec3& position, const dvec3& lamp, bool& decided) {
  const double distance = glm::length(lamp - position);
  const HostHit hit = closestTriangle(scene, {position, (lamp - position) / distance}, 0, distance);
  decided = decided && hit.margin > kShadingMargin;
  return hit.t < 0;
}

TEST(LessonDiffuse, FollowsLambert) {
  const scene::Scene scene = lessonScene("04_diffuse");
  const LessonImage image = renderLesson("04_diffuse");
  expectPixels(
      image,
      [&](dvec2 point) {
        const HostHit hit = closestTriangle(scene, eyeRay(point, 1.5), 0.001, 1000);
        if (hit.margin < kShadingMargin) return glm::dvec4(0);
        if (hit.t < 0) return glm::dvec4(kBackground, 1);
        const HostSurface s = surfaceAt(scene, hit);
        const double cosine = std::max(0.0, glm::dot(s.normal, glm::normalize(dvec3(3, 5, 3) - s.position)));
        return glm::dvec4(kAmbient + dvec3(0.8, 0.7, 0.55) * cosine, 1);
      },
      2e-5);
}

void expectShadow(std::uint32_t frame, const scene::Scene& scene) {
  LessonOptions options;
  options.scene = scene;
  options.frames = frame + 1;
  const double turn = 2 * glm::pi<double>() * (frame % 45) / 45.0;
  const dvec3 lamp(4 * std::cos(turn), 5, 4 * std::sin(turn));
  int lit = 0, dark = 0;
  expectPixels(
      renderLesson("05_shadow", options),
      [&](dvec2 point) {
        const HostRay ray = eyeRay(point, 1.5);
        const HostHit hit = closestTriangle(scene, ray, 0.001, 1000);
        if (hit.margin < kShadingMargin) return glm::dvec4(0);
        if (hit.t < 0) return glm::dvec4(kBackground, 1);
        const HostSurface s = surfaceAt(scene, hit);
        const dvec3 side = glm::dot(s.normal, ray.direction) < 0 ? s.normal : -s.normal;
        bool decided = true;
        const bool seen = seesLamp(scene, s.position + 0.001 * side, lamp, decided);
        if (!decided) return glm::dvec4(0);
        (seen ? lit : dark)++;
        const double cosine = std::max(0.0, glm::dot(s.normal, glm::normalize(lamp - s.position)));
        return glm::dvec4(kAmbient + dvec3(0.8, 0.7, 0.55) * (seen ? cosine : 0.0), 1);
      },
      3e-5, 0.1);
  EXPECT_GT(lit, 200);
  EXPECT_GT(dark, 100);
}

TEST(LessonShadow, CastsShadowsInTheFirstFrame) { expectShadow(0, lessonScene("05_shadow")); }
TEST(LessonShadow, MovesTheLamp) { expectShadow(16, lessonScene("05_shadow")); }
// A plate just below the lamp hides it from a part of the floor.
TEST(LessonShadow, ReachesTheLamp) {
  scene::Scene scene = lessonScene("05_shadow");
  scene::Instance plate = scene.instances.front();
  plate.worldFromObject = glm::scale(glm::translate(mat4(1.0f), vec3(3.29f, 4.5f, 0.023f)), vec3(0.1f));
  scene.instances.push_back(plate);
  expectShadow(0, scene);
}

// What is behind the lamp casts no shadow.
TEST(LessonShadow, EndsAtTheLamp) {
  scene::Scene scene = lessonScene("05_shadow");
  scene::Instance ceiling = scene.instances.front();
  ceiling.worldFromObject = glm::scale(glm::translate(mat4(1.0f), vec3(0, 6, 0)), vec3(5.0f));
  scene.instances.push_back(ceiling);
  expectShadow(0, scene);
}
TEST(LessonShadow, RepeatsAfterAWholeTurn) {
  LessonOptions options;
  options.width = 24;
  options.height = 16;
  const LessonImage first = renderLesson("05_shadow", options);
  options.frames = 46;
  EXPECT_EQ(renderLesson("05_shadow", options).outputs[0].data, first.outputs[0].data);
}

// Returns the color of the mirror path of lessons 06 and 07.
glm::dvec4 mirrorColor(const scene::Scene& scene, HostRay ray, double reflectance, int maxLevel) {
  const dvec3 lamp(3, 5, 3);
  const dvec3 base[3] = {{0.55, 0.55, 0.5}, {0.15, 0.3, 0.6}, {0.7, 0.35, 0.1}};
  dvec3 color(0);
  double contribution = 1;
  bool decided = true;
  for (int level = 0; level < maxLevel && contribution > 0.001; ++level) {
    const HostHit hit = closestTriangle(scene, ray, 0, 1000);
    if (hit.margin < kShadingMargin) return glm::dvec4(0);
    if (hit.t < 0) return glm::dvec4(color + contribution * kBackground, decided ? 1 : 0);
    const HostSurface s = surfaceAt(scene, hit);
    const dvec3 normal = glm::dot(s.normal, ray.direction) > 0 ? -s.normal : s.normal;
    const dvec3 position = s.position + 0.001 * normal;
    dvec3 light = kAmbient;
    if (seesLamp(scene, position, lamp, decided))
      light += std::max(0.0, glm::dot(normal, glm::normalize(lamp - position)));
    color += contribution * base[hit.instance] * light;
    contribution *= reflectance;
    ray = {position, glm::reflect(ray.direction, normal)};
  }
  return glm::dvec4(color, decided ? 1 : 0);
}

void expectMirrors(const std::string& name, double reflectance, int maxLevel = 5) {
  const scene::Scene scene = lessonScene(name);
  LessonOptions options;
  options.set = {{"reflectance", std::to_string(reflectance)}};
  if (maxLevel != 5) options.set.emplace_back("maxLevel", std::to_string(maxLevel));
  expectPixels(
      renderLesson(name, options),
      [&](dvec2 point) { return mirrorColor(scene, eyeRay(point, 1.5), reflectance, maxLevel); }, 2e-4, 0.25);
}

TEST(LessonMirrorLoop, FollowsTheReflections) { expectMirrors("06_mirror_loop", 0.4); }
TEST(LessonMirrorLoop, StopsWithoutReflectance) { expectMirrors("06_mirror_loop", 0.0); }
// With 0.03, the third ray has a weight below the limit of 0.001; with 0.09, it is above the limit and visible.
TEST(LessonMirrorLoop, StopsAtTheSmallestContribution) {
  for (const double reflectance : {0.03, 0.09}) expectMirrors("06_mirror_loop", reflectance);
}
TEST(LessonMirrorLoop, StopsAtTheMaximumLevel) {
  for (const int level : {1, 2, 3}) expectMirrors("06_mirror_loop", 0.9, level);
}
TEST(LessonMirrorRecursion, FollowsTheReflections) { expectMirrors("07_mirror_recursion", 0.4); }
TEST(LessonMirrorRecursion, StopsAtTheSmallestContribution) {
  for (const double reflectance : {0.03, 0.09}) expectMirrors("07_mirror_recursion", reflectance);
}
TEST(LessonMirrorRecursion, StopsAfterFiveLevels) { expectMirrors("07_mirror_recursion", 0.95); }
TEST(LessonMirrorRecursion, GivesTheImageOfTheLoop) {
  const LessonImage loop = renderLesson("06_mirror_loop"), recursion = renderLesson("07_mirror_recursion");
  double worst = 0;
  for (std::uint32_t y = 0; y < loop.height; ++y)
    for (std::uint32_t x = 0; x < loop.width; ++x)
      worst = std::max<double>(worst, glm::length(loop.at(x, y) - recursion.at(x, y)));
  EXPECT_LT(worst, 1e-4);
}

}  // namespace
}  // namespace quintet::test
