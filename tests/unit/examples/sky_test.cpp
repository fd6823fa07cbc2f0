// SPDX-License-Identifier: Apache-2.0
// The sky: finite values, the requested irradiance, the direction of the sun, a dim lower half.
#include "demo/sky.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "demo/still_life.h"

namespace quintet::demo {
namespace {

float luminance(const vec3& c) { return glm::dot(c, vec3(0.2126f, 0.7152f, 0.0722f)); }

vec3 directionOf(std::uint32_t x, std::uint32_t y, const io::Image& image) {
  const float phi = 2.0f * kPi * ((static_cast<float>(x) + 0.5f) / static_cast<float>(image.width) - 0.5f);
  const float theta = kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height);
  return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

// Luminance of the irradiance from the image on a surface with this normal.
float irradiance(const io::Image& image, const vec3& normal) {
  const double pi = glm::pi<double>();
  double sum = 0.0;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const double theta = pi * (y + 0.5) / image.height;
    const double solidAngle = std::sin(theta) * (pi / image.height) * (2.0 * pi / image.width);
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const auto p = image.pixel<float>(x, y);
      const float cosine = std::max(0.0f, glm::dot(directionOf(x, y, image), normal));
      sum += luminance({p[0], p[1], p[2]}) * cosine * solidAngle;
    }
  }
  return static_cast<float>(sum);
}

TEST(Sky, IsFiniteAndNotNegative) {
  for (float elevation : {3.0f, 20.0f, 45.0f, 88.0f}) {
    SkySettings settings;
    settings.sunDirection = {std::cos(glm::radians(elevation)), std::sin(glm::radians(elevation)), 0.0f};
    const io::Image image = skyImage(settings, 128, 64);
    for (float sample : image.samples<float>()) ASSERT_TRUE(std::isfinite(sample) && sample >= 0.0f) << elevation;
  }
}

TEST(Sky, HasTheRequestedIrradiance) {
  SkySettings settings = stillLifeSky();
  settings.clouds = settings.haze = 0.0f;
  settings.hills = false;
  const io::Image image = skyImage(settings, 512, 256);
  const float expected = settings.skyIrradiance + settings.sunIrradiance * settings.sunDirection.y;
  EXPECT_NEAR(irradiance(image, {0, 1, 0}), expected, 0.03f * expected);
  const float below = irradiance(image, {0, -1, 0});
  EXPECT_GT(below, 0.03f * expected);
  EXPECT_LT(below, 0.40f * expected);
}

TEST(Sky, KeepsTheIrradianceOfTheDemoSkyWithClouds) {  // clouds, haze and hills change it slightly
  const SkySettings settings = stillLifeSky();
  const float clear = settings.skyIrradiance + settings.sunIrradiance * settings.sunDirection.y;
  EXPECT_NEAR(irradiance(skyImage(settings, 512, 256), {0, 1, 0}), clear, 0.25f * clear);
}

TEST(Sky, IsBrightestInTheDirectionOfTheSun) {
  const SkySettings settings = stillLifeSky();
  const io::Image image = skyImage(settings, 512, 256);
  float brightest = 0.0f;
  vec3 where(0.0f);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const auto p = image.pixel<float>(x, y);
      const float value = luminance({p[0], p[1], p[2]});
      if (value > brightest) brightest = value, where = directionOf(x, y, image);
    }
  }
  EXPECT_LT(std::acos(glm::dot(where, settings.sunDirection)), settings.sunRadius);
}

TEST(Sky, MatchesThePaperAtTheZenith) {
  // Preetham et al. 1999, appendix A.2, computed by hand: (x, y) of the zenith for turbidity 3 and a sun at 60° from
  // it. The luminance is scaled to the requested irradiance.
  SkySettings settings;
  settings.sunDirection = {std::sin(glm::radians(60.0f)), 0.5f, 0.0f};
  const vec3 rgb = Sky(settings).radiance({0, 1, 0});
  const mat3 xyzFromRgb(0.4124564f, 0.2126729f, 0.0193339f, 0.3575761f, 0.7151522f, 0.1191920f, 0.1804375f, 0.0721750f,
                        0.9503041f);
  const vec3 xyz = xyzFromRgb * rgb;
  const float sum = xyz.x + xyz.y + xyz.z;
  EXPECT_NEAR(xyz.x / sum, 0.2449f, 0.001f);
  EXPECT_NEAR(xyz.y / sum, 0.2526f, 0.001f);
}

}  // namespace
}  // namespace quintet::demo
