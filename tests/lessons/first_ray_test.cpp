// SPDX-License-Identifier: Apache-2.0
// Lesson 01: every pixel shows whether its ray hits a triangle.
#include <gtest/gtest.h>

#include "lesson.h"

namespace quintet::test {
namespace {

constexpr double kFirstRayMargin = 1e-4;  // below this margin, float rounding decides

void expectSilhouette(const LessonImage& image, const scene::Scene& scene, double fieldOfView, const vec3& color) {
  const double aspect = static_cast<double>(image.width) / image.height;
  int hits = 0, misses = 0;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const dvec2 point((x + 0.5) / image.width, (y + 0.5) / image.height);
      const HostHit hit = closestTriangle(
          scene, cameraRay(dvec3(0), dvec3(0, 0, -1), dvec3(0, 1, 0), fieldOfView, aspect, point), 0.001, 1000);
      if (hit.margin < kFirstRayMargin) continue;
      const vec3 expected = hit.t > 0 ? color : vec3(0);
      EXPECT_LT(glm::length(vec3(image.at(x, y)) - expected), 1e-5f) << x << ", " << y;
      (hit.t > 0 ? hits : misses)++;
    }
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 100);
}

TEST(LessonFirstRay, ShowsTheSilhouette) {
  expectSilhouette(renderLesson("01_first_ray"), lessonScene("01_first_ray"), 45, {1, 0, 0});
}

TEST(LessonFirstRay, FollowsItsParametersAndAspectRatio) {
  LessonOptions options;
  options.width = 20;
  options.height = 60;
  options.set = {{"fieldOfView", "70"}, {"hitColor", "0.25,0.5,1"}};
  expectSilhouette(renderLesson("01_first_ray", options), lessonScene("01_first_ray"), 70, {0.25f, 0.5f, 1.0f});
}

}  // namespace
}  // namespace quintet::test
