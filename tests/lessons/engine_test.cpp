// SPDX-License-Identifier: Apache-2.0
// Lessons 17 and 20: the folder programs, compared with the host.
#include <gtest/gtest.h>

#include <cmath>

#include "lesson.h"
#include "scene/defaults/auto_camera.h"
#include "scene_builder.h"

namespace quintet::test {
namespace {

constexpr double kFolderMargin = 3e-4;

struct Blocked {
  bool foil = false;
  bool other = false;
};

Blocked blockers(const scene::Scene& scene, const HostRay& ray, bool& decided) {
  Blocked result;
  double from = 1e-6;
  while (true) {
    const HostHit hit = closestTriangle(scene, ray, from, 1e4);
    decided = decided && hit.margin > kFolderMargin;
    if (hit.t < 0) return result;
    (hit.instance == 2 ? result.foil : result.other) = true;
    from = hit.t + 1e-7;
  }
}

TEST(LessonRecords, UsesHitGroupsRayTypesAndRecordData) {
  const scene::Scene scene = lessonScene("17_records");
  const LessonImage image = renderLesson("17_records");
  const dvec3 toSun(0.48, 0.8, 0.36);
  int stripes = 0, tinted = 0, free = 0;
  const auto pixel = [&](dvec2 point, bool wantFree) {
    const HostRay ray = cameraRay({1.5, 3, 6}, {0, 0.7, 0}, {0, 1, 0}, 35, 1.5, point);
    const HostHit hit = closestTriangle(scene, ray, 1e-6, 1e4);
    if (hit.margin < kFolderMargin) return kUndecided;
    if (hit.t < 0) return wantFree ? glm::dvec4(0, 0, 0, 1) : glm::dvec4(0.35, 0.5, 0.75, 1);
    if (hit.instance == 2) return wantFree ? glm::dvec4(0, 0, 0, 1) : glm::dvec4(0.6 * dvec3(0.2, 0.75, 0.35), 1);
    const HostSurface s = surfaceAt(scene, hit);
    const dvec3 geometric = glm::dot(s.faceNormal, ray.direction) > 0 ? -s.faceNormal : s.faceNormal;
    const dvec3 normal = glm::dot(s.faceNormal, ray.direction) > 0 ? -s.normal : s.normal;
    bool decided = true;
    if (wantFree) {
      const HostHit up = closestTriangle(scene, {s.position + 1e-6 * geometric, geometric}, 1e-6, 1e4);
      free += up.t > 0;
      return up.margin < kFolderMargin ? kUndecided : glm::dvec4(dvec3(std::max(up.t, 0.0)), 1);
    }
    dvec3 base(0.8);
    if (hit.instance == 1) {
      const double phase = 4 * s.position.y;
      const double part = phase - std::floor(phase);
      if (std::min({std::abs(part - 0.5), part, 1 - part}) < 1e-3) return kUndecided;
      base = dvec3(0.85, 0.35, 0.15) * (part < 0.5 ? 0.4 : 1.0);
      stripes += part < 0.5;
    }
    // A surface that faces away from the sun is dark regardless of what is in between.
    const double cosine = std::max(0.0, glm::dot(normal, toSun));
    const Blocked blocked = blockers(
        scene, {s.position + 1e-6 * (glm::dot(toSun, geometric) < 0 ? -geometric : geometric), toSun}, decided);
    if (!decided && cosine > 0) return kUndecided;
    const dvec3 sun = blocked.other ? dvec3(0) : blocked.foil ? dvec3(0.2, 0.75, 0.35) : dvec3(1);
    tinted += blocked.foil && !blocked.other;
    return glm::dvec4(base * (0.2 + 0.8 * sun * cosine), 1);
  };
  expectPixels(
      image, [&](dvec2 p) { return pixel(p, false); }, 1e-4, 0.15, 0);
  expectPixels(
      image, [&](dvec2 p) { return pixel(p, true); }, 1e-3, 0.15, 1);
  EXPECT_GT(stripes, 20);
  EXPECT_GT(tinted, 10);
  EXPECT_GT(free, 10);
}

struct LambertLight {
  dvec3 toLight{0.4, 1, 0.6};
  dvec3 light{0.9, 0.85, 0.8};
  dvec3 ambient{0.15, 0.17, 0.2};
  double mirrorRoughness = 0.05;
};

std::string threeNumbers(const dvec3& v) {
  return std::to_string(v.x) + "," + std::to_string(v.y) + "," + std::to_string(v.z);
}

void expectLambert(const LambertLight& given, std::uint32_t width) {
  const scene::Scene scene = lessonScene("20_lambert");
  const dvec3 toLight = glm::normalize(given.toLight);
  const double roughness[5] = {1, 0, 0.8, 0.8, 0};
  LessonOptions options;
  options.width = width;
  options.height = width * 2 / 3;
  options.set = {{"to_light", threeNumbers(given.toLight)},
                 {"light", threeNumbers(given.light)},
                 {"ambient", threeNumbers(given.ambient)},
                 {"mirror_roughness", std::to_string(given.mirrorRoughness)}};
  const dvec3 base[5] = {{0.7, 0.68, 0.6}, {0.9, 0.9, 0.92}, {0.85, 0.4, 0.15}, {0.85, 0.4, 0.15}, {0.9, 0.9, 0.92}};
  int mirrored = 0, shadowed = 0;
  expectPixels(
      renderLesson("20_lambert", options),
      [&](dvec2 point) {
        HostRay ray = cameraRay({3, 2.6, 6.5}, {0, 0.9, 0}, {0, 1, 0}, 38, 1.5, point);
        dvec3 weight(1);
        for (int bounce = 0; bounce <= 8; ++bounce) {
          const HostHit hit = closestTriangle(scene, ray, 1e-6, 1e5);
          if (hit.margin < kFolderMargin) return kUndecided;
          if (hit.t < 0)
            return glm::dvec4(
                weight * glm::mix(dvec3(0.85, 0.8, 0.75), dvec3(0.25, 0.45, 0.8), 0.5 + 0.5 * ray.direction.y), 1);
          const HostSurface s = surfaceAt(scene, hit);
          const bool front = glm::dot(s.faceNormal, ray.direction) < 0;
          const dvec3 normal = front ? s.normal : -s.normal,
                      position = s.position + 1e-6 * (front ? s.faceNormal : -s.faceNormal);
          const dvec3 color = base[hit.instance];
          if (roughness[hit.instance] < given.mirrorRoughness) {
            if (bounce == 8) return kUndecided;
            mirrored++;
            weight *= color;
            ray = {position, glm::reflect(ray.direction, normal)};
            continue;
          }
          const double cosine = std::max(0.0, glm::dot(normal, toLight));
          const HostHit shadow = closestTriangle(scene, {position, toLight}, 1e-6, 1e5);
          if (cosine > 0 && shadow.margin < kFolderMargin) return kUndecided;
          shadowed += shadow.t > 0;
          const dvec3 sun = shadow.t < 0 ? given.light * cosine : dvec3(0);
          return glm::dvec4(weight * color * (given.ambient + sun), 1);
        }
        return kUndecided;
      },
      2e-3, 0.25);
  const int part = static_cast<int>(48 * 48 / (width * width));
  EXPECT_GT(mirrored, given.mirrorRoughness > 0 ? 100 / part : -1);
  EXPECT_GT(shadowed, 12 / part);
}

TEST(LessonLambert, ShowsMirrorsShadowsAndTheGradient) { expectLambert({}, 48); }
TEST(LessonLambert, FollowsTheDirectionAndColorOfTheLight) {
  expectLambert({{-1.5, 1.2, 0.4}, {0.2, 0.9, 0.5}, {0.3, 0.05, 0.1}, 0.05}, 24);
}
TEST(LessonLambert, MirrorsAreBelowTheLimitOfTheRoughness) {
  LambertLight light;
  light.mirrorRoughness = 0.9;
  expectLambert(light, 24);
  light.mirrorRoughness = 0;
  expectLambert(light, 24);
}

// Between two walls of mirrors, 2 m apart, a ray that moves 0.5 m along the walls for each meter across. They end behind its last
// reflection, and it reaches the sky in the middle of the gradient. The ninth mirror is black.
TEST(LessonLambert, ReflectsEightTimes) {
  for (const int reflections : {1, 8, 9}) {
    SceneBuilder builder;
    scene::Material mirror;
    mirror.baseColor = {0.9f, 0.8f, 0.7f, 1.0f};
    mirror.metallic = 1.0f;
    mirror.roughness = 0.0f;
    const auto end = static_cast<float>(reflections);  // reflection k is at z = 0.5 - k
    for (const float x : {-1.0f, 1.0f}) builder.add(quad({x, -1, 2}, {0, 2, 0}, {0, 0, -end - 2}), mirror);
    LessonOptions options;
    options.width = options.height = 2;
    options.scene = builder.scene;
    options.camera = perspective({0, 0, 0}, {1, 0, -0.5f}, 0.1f);
    const LessonImage image = renderLesson("20_lambert", options);
    const dvec3 sky(0.55, 0.625, 0.775);
    for (std::uint32_t i = 0; i < 4; ++i)
      for (int c = 0; c < 3; ++c) {
        const double weight = std::pow(double{mirror.baseColor[c]}, reflections);
        EXPECT_NEAR(image.fromTop(i % 2, i / 2)[c], reflections > 8 ? 0.0 : weight * sky[c], 1e-3) << reflections;
      }
  }
}

TEST(LessonRecords, UsesTheCenterOfTheLens) {
  EXPECT_LT(pixelsChangedByLens("17_records"), 5) << "more than rounding, which decides at edges";
}

}  // namespace
}  // namespace quintet::test
