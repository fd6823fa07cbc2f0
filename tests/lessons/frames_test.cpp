// SPDX-License-Identifier: Apache-2.0
// Lessons 09 and 19: changes from frame to frame.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <glm/gtc/matrix_transform.hpp>

#include "lesson.h"
#include "scene/animation/keyframes.h"

namespace quintet::test {
namespace {

double halton(int index, int base) {
  double value = 0, digit = 1;
  for (; index > 0; index /= base) value += (digit /= base) * (index % base);
  return value;
}

// Returns one sample of lesson 09.
glm::dvec4 progressiveSample(const scene::Scene& scene, const dvec2& point) {
  const HostHit hit = closestTriangle(scene, cameraRay({0, 1, 6}, {0, 1, 0}, {0, 1, 0}, 30, 1.5, point), 0.001, 1000);
  if (hit.margin < 2e-4) return kUndecided;
  if (hit.t < 0) return {0.05, 0.07, 0.1, 1};
  const double cosine = std::abs(glm::dot(surfaceAt(scene, hit).faceNormal, glm::normalize(dvec3(0.4, 0.7, 1))));
  return glm::dvec4(dvec3(0.9, 0.6, 0.3) * (0.3 + 0.7 * cosine), 1);
}

TEST(LessonProgressive, HaltonHasTheValuesOfTheTables) {
  const double two[] = {0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875};
  const double three[] = {1 / 3., 2 / 3., 1 / 9., 4 / 9., 7 / 9., 2 / 9., 5 / 9., 8 / 9.};
  for (int i = 0; i < 7; ++i) EXPECT_DOUBLE_EQ(halton(i + 1, 2), two[i]);
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(halton(i + 1, 3), three[i], 1e-15);
}

TEST(LessonProgressive, AveragesItsFrames) {
  const scene::Scene scene = lessonScene("09_progressive");
  LessonOptions options;
  options.frames = 5;
  expectPixels(
      renderLesson("09_progressive", options),
      [&](dvec2 point) {
        const dvec2 pixel(options.width, options.height);
        dvec3 sum(0);
        for (int frame = 0; frame < 5; ++frame) {
          const glm::dvec4 value =
              progressiveSample(scene, point + (dvec2(halton(frame + 1, 2), halton(frame + 1, 3)) - 0.5) / pixel);
          if (value.w == 0) return kUndecided;
          sum += dvec3(value);
        }
        return glm::dvec4(sum / 5.0, 1);
      },
      5e-5, 0.1);
}

TEST(LessonProgressive, ConvergesFasterThanRandomSamples) {
  LessonOptions options;
  options.frames = 256;
  const LessonImage reference = renderLesson("09_progressive", options);
  const auto error = [&](std::uint32_t frames) {
    options.frames = frames;
    const LessonImage image = renderLesson("09_progressive", options);
    double sum = 0;
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) {
        const vec3 d(image.at(x, y) - reference.at(x, y));
        sum += glm::dot(d, d);
      }
    return std::sqrt(sum / (3.0 * image.width * image.height));
  };
  const double one = error(1), four = error(4), sixteen = error(16), many = error(64);
  RecordProperty("errors", fmt::format("{:.4f} {:.4f} {:.4f} {:.4f}", one, four, sixteen, many));
  // The error of random samples halves with four times as many.
  EXPECT_LT(four, 0.75 * one);
  EXPECT_LT(sixteen, one / 4);
  EXPECT_LT(many, one / 8);
}

// A shift per pixel makes the errors of adjacent pixels different, and random points converge to the same image.
TEST(LessonProgressive, AllPointsConvergeToTheSameImage) {
  LessonOptions options;
  options.frames = 256;
  const LessonImage halton = renderLesson("09_progressive", options);
  for (const char* points : {"1", "2"}) {
    options.set = {{"points", points}};
    const LessonImage image = renderLesson("09_progressive", options);
    EXPECT_NE(image.outputs[0].data, halton.outputs[0].data);
    dvec3 bias(0);
    double squares = 0;
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) {
        const dvec3 d(image.at(x, y) - halton.at(x, y));
        bias += d;
        squares += glm::dot(d, d);
      }
    const double pixels = image.width * image.height;
    EXPECT_LT(glm::length(bias) / pixels, 5e-4) << points;
    EXPECT_LT(std::sqrt(squares / (3 * pixels)), 0.006) << points;
  }
}

// The shift keeps the points of a pixel well distributed.
TEST(LessonProgressive, ShiftedPointsConvergeFasterThanRandomPoints) {
  LessonOptions options;
  options.frames = 256;
  const LessonImage reference = renderLesson("09_progressive", options);
  const auto error = [&](const char* points) {
    LessonOptions few;
    few.frames = 64;
    few.set = {{"points", points}};
    const LessonImage image = renderLesson("09_progressive", few);
    double sum = 0;
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) {
        const vec3 d(image.at(x, y) - reference.at(x, y));
        sum += glm::dot(d, d);
      }
    return std::sqrt(sum);
  };
  EXPECT_LT(error("1"), 0.6 * error("2"));
}

// In the first frame, an edge through the middle of a row of pixels is on both sides of their points, in both directions.
TEST(LessonProgressive, EachPixelHasItsOwnShiftInBothDirections) {
  LessonOptions options;
  options.set = {{"points", "1"}};
  const float half = 6.0f * std::tan(glm::radians(15.0f));
  for (const bool horizontal : {true, false}) {
    scene::Scene scene = lessonScene("09_progressive");
    scene.instances.resize(1);
    // The upper edge crosses row 16, or the right edge crosses column 24.
    const vec3 center =
        horizontal ? vec3(0, 1 + half * (33.0f / 32 - 1) - 0.5f, 0) : vec3(half * 1.5f * (49.0f / 48 - 1) - 0.5f, 1, 0);
    const vec3 size = horizontal ? vec3(20, 1, 0.002f) : vec3(1, 20, 0.002f);
    scene.instances[0].worldFromObject = glm::scale(glm::translate(mat4(1.0f), center), size);
    options.scene = scene;
    const LessonImage image = renderLesson("09_progressive", options);
    int hits = 0;
    const std::uint32_t count = horizontal ? image.width : image.height;
    for (std::uint32_t i = 0; i < count; ++i) hits += (horizontal ? image.at(i, 16) : image.at(24, i)).x > 0.1f;
    EXPECT_GT(hits, static_cast<int>(count / 5)) << horizontal;
    EXPECT_LT(hits, static_cast<int>(count * 4 / 5)) << horizontal;
  }
}

// A diagonal edge separates the halves of pixels. With the same shift in both directions, all points are on one line along it.
TEST(LessonProgressive, ShiftsInBothDirectionsAreIndependent) {
  LessonOptions options;
  options.set = {{"points", "1"}};
  scene::Scene scene = lessonScene("09_progressive");
  scene.instances.resize(1);
  mat4 m = glm::rotate(glm::translate(mat4(1.0f), vec3(0, 1, 0)), glm::radians(45.0f), vec3(0, 0, 1));
  scene.instances[0].worldFromObject = glm::scale(glm::translate(m, vec3(0, -10, 0)), vec3(40, 20, 0.002f));
  options.scene = scene;
  const LessonImage image = renderLesson("09_progressive", options);
  const auto x = image.width / 2, y = image.height / 2;
  int hits = 0;
  for (std::uint32_t k = 0; k < y; ++k) {
    hits += image.at(x + k, y + k).x > 0.1f;
    hits += image.at(x - 1 - k, y - 1 - k).x > 0.1f;
  }
  EXPECT_GT(hits, static_cast<int>(y * 2 / 3));
  EXPECT_LT(hits, static_cast<int>(y * 4 / 3));
}

TEST(LessonDynamic, MovesInstances) {
  for (const std::uint32_t frame : {0u, 7u, 25u}) {
    scene::Scene scene = lessonScene("19_dynamic");
    LessonOptions options;
    options.frames = frame + 1;
    const LessonImage image = renderLesson("19_dynamic", options);
    for (scene::Instance& instance : scene.instances)
      instance.worldFromObject = scene::worldFromObjectAt(instance, static_cast<float>(frame));
    const dvec3 toSun = glm::normalize(dvec3(0.5, 1, 0.4));
    const dvec3 base[3] = {{0.6, 0.62, 0.6}, {0.85, 0.45, 0.2}, {0.2, 0.5, 0.75}};
    int moving = 0;
    expectPixels(
        image,
        [&](dvec2 point) {
          const dvec2 plane = (2.0 * point - 1.0) * dvec2(1.5, 1) * std::tan(glm::radians(20.0)) - dvec2(0, 0.35);
          const HostRay ray{{0, 3.5, 8}, glm::normalize(dvec3(plane, -1))};
          const HostHit hit = closestTriangle(scene, ray, 0.001, 1000);
          if (hit.margin < 2e-4) return kUndecided;
          if (hit.t < 0) return glm::dvec4(0.6, 0.72, 0.85, 1);
          moving += hit.instance > 0;
          const HostSurface s = surfaceAt(scene, hit);
          const HostHit shadow = closestTriangle(scene, {s.position + 0.001 * s.faceNormal, toSun}, 0, 1000);
          if (shadow.margin < 2e-4) return kUndecided;
          const double light = shadow.t < 0 ? std::max(0.0, glm::dot(s.faceNormal, toSun)) : 0.0;
          return glm::dvec4(base[hit.instance] * (0.2 + 0.8 * light), 1);
        },
        1e-4, 0.1);
    EXPECT_GT(moving, 40) << "frame " << frame;
  }
}

}  // namespace
}  // namespace quintet::test
