// SPDX-License-Identifier: Apache-2.0
// Lesson 02: three ways to compute a camera ray give the same ray.
#include <gtest/gtest.h>

#include "lesson.h"

namespace quintet::test {
namespace {

constexpr double kCamerasMargin = 1e-3;

void expectRays(const std::string& way, const dvec3& eye, const dvec3& target, const LessonOptions& given) {
  LessonOptions options = given;
  options.set.emplace_back("way", way);
  const LessonImage image = renderLesson("02_cameras", options);
  const scene::Scene scene = lessonScene("02_cameras");
  const double aspect = static_cast<double>(image.width) / image.height;
  int hits = 0, misses = 0;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const dvec2 point((x + 0.5) / image.width, (y + 0.5) / image.height);
      const HostRay ray = cameraRay(eye, target, dvec3(0, 1, 0), 40, aspect, point);
      const HostHit hit = closestTriangle(scene, ray, 0.1, 100);
      if (hit.margin < kCamerasMargin) continue;
      const dvec3 expected = hit.t > 0 ? dvec3(hit.t / 10) : 0.5 + 0.5 * ray.direction;
      const dvec3 got(image.at(x, y));
      EXPECT_LT(glm::length(got - expected), 2e-5) << "way " << way << ", pixel " << x << ", " << y;
      (hit.t > 0 ? hits : misses)++;
    }
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 100);
}

TEST(LessonCameras, ThreeWaysGiveTheSameRays) {
  for (const char* way : {"0", "1", "2"}) expectRays(way, {3, 2, 4}, {0, 0.5, 0}, {});
}

TEST(LessonCameras, FollowPositionAndTarget) {
  LessonOptions options;
  options.width = 24;
  options.height = 40;
  options.set = {{"eye", "-2,5,-4"}, {"target", "0.5,0,0"}};
  for (const char* way : {"0", "1", "2"}) expectRays(way, {-2, 5, -4}, {0.5, 0, 0}, options);
}

}  // namespace
}  // namespace quintet::test
