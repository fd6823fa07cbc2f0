// SPDX-License-Identifier: Apache-2.0
// Projection of known points by both kinds of cameras, and blur by a lens.
#include <array>

#include <gtest/gtest.h>

#include "rendered_image.h"

namespace quintet::test {
namespace {

// Returns the center of brightness in pixels.
vec2 centroid(const RenderedImage& image) {
  double sum = 0, x = 0, y = 0;
  for (std::uint32_t row = 0; row < image.height(); ++row) {
    for (std::uint32_t column = 0; column < image.width(); ++column) {
      const double v = image.at(column, row, 0).mean();
      sum += v, x += v * (column + 0.5), y += v * (row + 0.5);
    }
  }
  return {x / sum, y / sum};
}

// An unlit square with this half size around a point, parallel to the image plane, so that its center is projected to
// its image's center.
SceneBuilder square(const scene::Camera& camera, const vec3& center, float half) {
  const vec3 x = half * vec3(camera.worldFromCamera[0]), y = half * vec3(camera.worldFromCamera[1]);
  SceneBuilder scene;
  scene.add(quad(center - x - y, 2.0f * x, 2.0f * y), unlit(vec3(1.0f))).camera(camera);
  return scene;
}

ImageOptions wide() {
  ImageOptions options;
  options.width = 40;
  options.height = 30;
  options.batches = 64;  // the centroid's standard error is then about 0.01 pixels
  return options;
}

const vec3 kEye(1.0f, 2.0f, 3.0f), kTarget(-2.0f, 1.5f, -4.0f);

TEST(Camera, ProjectsPointsInPerspective) {
  const scene::Camera camera = perspective(kEye, kTarget, 50.0f);
  for (const vec2 tangent : {vec2(0.0f), vec2(0.42f, 0.31f), vec2(-0.35f, 0.2f), vec2(0.1f, -0.33f)}) {
    const vec3 point = camera.worldFromCamera * vec4(5.0f * tangent, -5.0f, 1.0f);
    const float half = std::tan(glm::radians(25.0f));
    const vec2 expected = {20.0f + 15.0f * tangent.x / half, 15.0f - 15.0f * tangent.y / half};
    const vec2 seen = centroid(renderImage(square(camera, point, 0.4f), wide()));
    EXPECT_NEAR(seen.x, expected.x, 0.06f);
    EXPECT_NEAR(seen.y, expected.y, 0.06f);
  }
}

TEST(Camera, ProjectsPointsOrthographically) {
  scene::Camera camera = orthographic(kEye, kTarget, 1.0f);
  camera.orthographicHalfSize = {0.9f, 1.2f};  // the image is wider: its height decides
  for (const vec2 offset : {vec2(0.0f), vec2(1.2f, 0.8f), vec2(-0.9f, 0.4f), vec2(0.3f, -0.9f)}) {
    const vec3 point = camera.worldFromCamera * vec4(offset, -5.0f, 1.0f);
    const vec2 seen = centroid(renderImage(square(camera, point, 0.2f), wide()));
    EXPECT_NEAR(seen.x, 20.0f + 15.0f * offset.x / 1.2f, 0.06f);
    EXPECT_NEAR(seen.y, 15.0f - 15.0f * offset.y / 1.2f, 0.06f);
  }
}

TEST(Camera, BlursPointsOutOfFocus) {
  scene::Camera camera = perspective(kEye, kTarget, 40.0f);
  camera.apertureRadius = 0.15f;
  camera.focusDistance = 4.0f;
  const float pixelsPerTangent = 15.0f / std::tan(glm::radians(20.0f));
  for (const float distance : {4.0f, 2.5f, 8.0f}) {
    const vec3 point = camera.worldFromCamera * vec4(0, 0, -distance, 1.0f);
    const float half = 0.06f * distance;
    ImageOptions options = wide();
    options.batches = 64;
    const RenderedImage image = renderImage(square(camera, point, half), options);
    double sum = 0, squares = 0;
    for (std::uint32_t y = 0; y < image.height(); ++y) {
      for (std::uint32_t x = 0; x < image.width(); ++x) {
        const double v = image.at(x, y, 0).mean();
        sum += v, squares += v * std::pow(x + 0.5 - 20.0, 2);
      }
    }
    // The variances per axis add up: a²/3 for the square, r²/6 for the filter, and R²/4 for the uniform disk.
    const double a = half / distance * pixelsPerTangent;
    const double blur = 0.15 * std::abs(1.0 / distance - 1.0 / 4.0) * pixelsPerTangent;
    EXPECT_NEAR(squares / sum, a * a / 3.0 + 0.75 * 0.75 / 6.0 + blur * blur / 4.0, 0.03 * squares / sum) << distance;
    EXPECT_NEAR(centroid(image).x, 20.0f, 0.05f);
  }
}

// A small square far from the plane in focus shows the lens: its variance is that of a uniform disk, and its fourth cumulant
// tells a disk from a square or a ring. Cumulants of independent parts add up.
TEST(Camera, TheLensIsAUniformDisk) {
  scene::Camera camera = perspective(kEye, kTarget, 40.0f);
  camera.apertureRadius = 0.3f;
  camera.focusDistance = 4.0f;
  const double pixelsPerTangent = 15.0 / std::tan(glm::radians(20.0));
  for (const float distance : {2.0f, 10.0f}) {
    const vec3 point = camera.worldFromCamera * vec4(0, 0, -distance, 1.0f);
    const float half = 0.024f * distance;
    ImageOptions options = wide();
    options.batches = 512;  // the variance below has a standard deviation of about 1 %
    const RenderedImage image = renderImage(square(camera, point, half), options);
    double sum = 0;
    std::array<double, 2> squares{}, fourth{};
    for (std::uint32_t y = 0; y < image.height(); ++y)
      for (std::uint32_t x = 0; x < image.width(); ++x) {
        const double v = image.at(x, y, 0).mean();
        const std::array<double, 2> p{x + 0.5 - 20.0, y + 0.5 - 15.0};
        sum += v;
        for (std::size_t k = 0; k < 2; ++k) squares[k] += v * p[k] * p[k], fourth[k] += v * std::pow(p[k], 4);
      }
    const double a = half / distance * pixelsPerTangent, h = 0.75;
    const double r = 0.3 * std::abs(1.0 / distance - 1.0 / 4.0) * pixelsPerTangent;
    const double variance = a * a / 3 + h * h / 6 + r * r / 4;
    const double cumulant = -2 * std::pow(a, 4) / 15 - std::pow(h, 4) / 60 - std::pow(r, 4) / 16;
    for (std::size_t k = 0; k < 2; ++k) {
      const double second = squares[k] / sum;
      EXPECT_NEAR(second, variance, 0.03 * variance) << distance << ", axis " << k;
      EXPECT_NEAR(fourth[k] / sum - 3 * second * second, cumulant, 0.15 * -cumulant + 0.05)
          << distance << ", axis " << k;
    }
  }
}

}  // namespace
}  // namespace quintet::test
