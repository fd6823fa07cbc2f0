// SPDX-License-Identifier: Apache-2.0
// The default environment: neutral, brightest from above. The rule that chooses the environment of a scene.
#include "scene/defaults/default_environment.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace quintet::test {
namespace {

TEST(DefaultEnvironment, IsNeutralAndBrightFromAbove) {
  const scene::Environment sky = scene::defaultEnvironment();
  EXPECT_TRUE(sky.present);
  ASSERT_EQ(sky.image.width, 512u);
  ASSERT_EQ(sky.image.height, 256u);
  ASSERT_EQ(sky.image.channels, 3u);
  glm::dvec3 mean(0), up(0), down(0);
  float highest = 0, lowest = 1e9f;
  glm::uvec2 brightest(0);
  constexpr double kMean = 0.6;
  for (std::uint32_t y = 0; y < 256; ++y)
    for (std::uint32_t x = 0; x < 512; ++x) {
      const auto pixel = sky.image.pixel<float>(x, y);
      const double theta = kPi * (y + 0.5) / 256, solidAngle = std::sin(theta) * (kPi / 256) * (2 * kPi / 512);
      const glm::dvec3 radiance(pixel[0], pixel[1], pixel[2]);
      mean += radiance * solidAngle / (4 * glm::pi<double>());
      (y < 128 ? up : down) += radiance * solidAngle * std::abs(std::cos(theta)) / glm::pi<double>();
      lowest = std::min({lowest, pixel[0], pixel[1], pixel[2]});
      if (pixel[1] > highest) highest = pixel[1], brightest = {x, y};
    }
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], kMean, 1e-3);
  EXPECT_GT(up.y, 2.0 * down.y);
  EXPECT_GT(lowest, 0.1 * kMean);
  EXPECT_GT(highest, 5.0 * kMean);
  // u = atan2(z, x)/2π + 0.5, v = acos(y)/π of the direction of the key light.
  const vec3 key = glm::normalize(vec3(0.5f, 0.75f, 0.55f));
  EXPECT_NEAR(static_cast<float>(brightest.x) / 512.0f, std::atan2(key.z, key.x) / (2 * kPi) + 0.5f, 0.01f);
  EXPECT_NEAR(static_cast<float>(brightest.y) / 256.0f, std::acos(key.y) / kPi, 0.01f);
}

TEST(EffectiveEnvironment, IsTheDefaultOnlyForScenesThatDoNotLightThemselves) {
  scene::Scene s;
  EXPECT_FALSE(scene::effectiveEnvironment(s).image.empty());
  s.lights.emplace_back();
  EXPECT_FALSE(scene::effectiveEnvironment(s).present);
  s.environment.present = true;
  s.environment.constant = vec3(2);
  EXPECT_EQ(scene::effectiveEnvironment(s).constant, vec3(2));
}

}  // namespace
}  // namespace quintet::test
