// SPDX-License-Identifier: Apache-2.0
// Point, spot and directional lights against their formulas, and the choice among many lights.
#include <algorithm>

#include <gtest/gtest.h>

#include "lights/light_scene.h"

namespace quintet::test {
namespace {

scene::Scene withLight(const scene::Light& light) {
  scene::Scene scene;
  scene.lights = {light};
  return scene;
}

LightOut only(const LightScene& scene, const vec3& position) { return sampleLights(scene, position, 1).at(0); }

TEST(PointLight, InverseSquare) {
  scene::Light light;
  light.intensity = {2, 4, 8};
  light.position = {1, 2, 3};
  const LightScene scene(withLight(light), {});
  for (const vec3& position : {vec3(1, 2, 2), vec3(-4, 0, 7), vec3(1000, -2000, 500), vec3(1.001f, 2.0f, 3.0f)}) {
    const LightOut s = only(scene, position);
    const vec3 d = light.position - position;
    ASSERT_TRUE(s.valid);
    EXPECT_TRUE(s.delta);
    EXPECT_EQ(s.pdf, 1.0f);
    EXPECT_EQ(s.point, light.position);
    EXPECT_NEAR(s.distance, glm::length(d), 1e-6f * glm::length(d));
    EXPECT_LT(glm::distance(s.wi, glm::normalize(d)), 1e-6f);
    const vec3 wanted = light.intensity / glm::dot(d, d);
    EXPECT_LT(glm::distance(s.radiance, wanted), 1e-6f * glm::length(wanted));
  }
  EXPECT_FALSE(only(scene, light.position).valid);
}

// KHR_lights_punctual: max(min(1 - (distance / range)^4, 1), 0) / distance^2.
TEST(PointLight, RangeOfTheExtension) {
  for (const scene::LightType type : {scene::LightType::point, scene::LightType::spot}) {
    scene::Light light;
    light.type = type;
    light.intensity = vec3(3.0f);
    light.direction = {1, 0, 0};
    light.range = 4.0f;
    const LightScene scene(withLight(light), {});
    for (const float distance : {0.01f, 1.0f, 2.0f, 3.0f, 3.99f, 4.0f, 4.01f, 1000.0f}) {
      const LightOut s = only(scene, {distance, 0, 0});
      const float ratio = distance / light.range, window = std::max(1.0f - ratio * ratio * ratio * ratio, 0.0f);
      const float expected = 3.0f * window / (distance * distance);
      EXPECT_EQ(s.valid, distance < light.range ? 1u : 0u) << distance;
      EXPECT_NEAR(s.radiance.y, expected, 1e-5f * expected + 1e-7f) << distance;
    }
  }
}

TEST(SpotLight, FalloffOfTheExtension) {
  scene::Light light;
  light.type = scene::LightType::spot;
  light.intensity = vec3(10.0f);
  light.position = {0, 5, 0};
  light.direction = glm::normalize(vec3(1, -1, 0.5f));
  light.innerConeAngle = 0.3f;
  light.outerConeAngle = 0.7f;
  const LightScene scene(withLight(light), {});
  const vec3 side = glm::normalize(glm::cross(light.direction, vec3(0, 1, 0)));
  for (const float angle : {0.0f, 0.2f, 0.29f, 0.35f, 0.5f, 0.69f, 0.71f, 1.5f, 3.1f}) {
    const vec3 axis = std::cos(angle) * light.direction + std::sin(angle) * side;
    const LightOut s = only(scene, light.position + 2.0f * axis);
    const float ramp = (std::cos(angle) - std::cos(0.7f)) / (std::cos(0.3f) - std::cos(0.7f));
    const float a = std::clamp(ramp, 0.0f, 1.0f);
    EXPECT_EQ(s.valid, a > 0.0f ? 1u : 0u) << angle;
    EXPECT_NEAR(s.radiance.y, 10.0f * a * a / 4.0f, 2e-5f) << angle;
  }
}

// Down to half angles of 1°, where the cosines differ by less than the limit of 0.001 of the extension.
TEST(SpotLight, NarrowCones) {
  for (const double outer : {1.0, 2.0, 2.6, 5.0, 20.0}) {
    for (const double inner : {0.0, 0.5 * outer}) {
      scene::Light light;
      light.type = scene::LightType::spot;
      light.intensity = vec3(10.0f);
      light.direction = {0, 0, -1};
      light.innerConeAngle = static_cast<float>(glm::radians(inner));
      light.outerConeAngle = static_cast<float>(glm::radians(outer));
      const LightScene scene(withLight(light), {});
      const double cosInner = std::cos(glm::radians(inner)), cosOuter = std::cos(glm::radians(outer));
      for (const double part : {0.0, 0.3, 0.7, 0.9, 1.1}) {
        const double angle = glm::radians(part * outer);
        const LightOut s = only(scene, 2.0f * vec3(std::sin(angle), 0, -std::cos(angle)));
        const double a = std::clamp((std::cos(angle) - cosOuter) / std::max(0.001, cosInner - cosOuter), 0.0, 1.0);
        // Cosines near 1 have the rounding error of floats.
        const double rounding = 3e-7 / std::max(0.001, cosInner - cosOuter);
        EXPECT_EQ(s.valid, part < 1 ? 1u : 0u) << outer << "° at " << part;
        EXPECT_NEAR(s.radiance.y, 2.5 * a * a, 2.5 * 2 * rounding + 1e-5)
            << inner << "° to " << outer << "° at " << part;
      }
    }
  }
}

TEST(DirectionalLight, SameEverywhere) {
  scene::Light light;
  light.type = scene::LightType::directional;
  light.intensity = {1, 2, 3};
  light.direction = glm::normalize(vec3(1, -2, 3));
  const LightScene scene(withLight(light), {});
  for (const vec3& position : {vec3(0), vec3(1e5f, -3, 2)}) {
    const LightOut s = only(scene, position);
    ASSERT_TRUE(s.valid);
    EXPECT_TRUE(s.delta);
    EXPECT_TRUE(s.distance > 3e38f);
    EXPECT_EQ(s.wi, -light.direction);
    EXPECT_EQ(s.radiance, light.intensity);
  }
}

// Selection by power samples lights by the table's probabilities. The position identifies each light.
TEST(Lights, SelectionByPowerFollowsTheTable) {
  constexpr int kCount = 300;
  scene::Scene scene;
  for (int i = 0; i < kCount; ++i) {
    scene::Light light;
    light.intensity = i % 7 == 3 ? vec3(0.0f) : vec3(std::exp(static_cast<float>(i % 13) - 6.0f));
    light.position = {static_cast<float>(i), 10.0f, 0.0f};
    scene.lights.push_back(light);
  }
  const LightScene onDevice(scene, {});
  const std::vector<LightOut> samples = sampleLights(onDevice, vec3(0.0f), 400'000, kByPower);
  std::vector<double> observed(kCount, 0.0), expected, uniform(kCount, 400'000.0 / kCount);
  for (const shared::AliasEntry& entry : onDevice.table.entries) expected.push_back(400'000.0 * entry.probability);
  for (const LightOut& s : samples) {
    ASSERT_TRUE(s.valid);
    const auto light = static_cast<std::size_t>(s.point.x + 0.5f);
    observed[light] += 1.0;
    ASSERT_EQ(s.pdf, onDevice.table.entries[light].probability);
  }
  for (int i = 3; i < kCount; i += 7) EXPECT_EQ(observed[i], 0.0) << i;
  EXPECT_GT(chiSquareTest(observed, expected).pValue, 0.01);
  EXPECT_LT(chiSquareTest(observed, uniform).pValue, 1e-9);
}

// The fixed-point split of a 56-bit number, exactly, up to counts that 24 bits cannot address evenly.
TEST(Lights, SplitIndexIsExact) {
  struct In {
    float u;
    std::uint32_t extra, count;
  };
  std::vector<In> inputs;
  std::uint32_t state = 1;
  const auto next = [&] { return state = state * 747796405u + 2891336453u; };
  for (const std::uint32_t count : {1u, 2u, 3u, 1000u, 4096u, 1'000'003u, 8'388'608u, 16'777'216u})
    for (int i = 0; i < 200; ++i) inputs.push_back({static_cast<float>(next() >> 8) * 0x1p-24f, next(), count});
  for (const std::uint32_t count : {1u, 5u, 8'388'608u}) inputs.push_back({1.0f - 0x1p-24f, 0xFFFFFFFFu, count});
  const auto found = runCompute<uvec2>(R"(
    #include <quintet/lights/alias.glsl>
    struct In { float u; uint extra; uint count; };
    #define Out uvec2
    uvec2 run(uint i, In value) {
      uvec2 result;
      result.x = splitIndex(value.u, value.extra, value.count, result.y);
      return result;
    }
  )",
                                       inputs);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const In& in = inputs[i];
    // k · count · 2^32 + extra · count, in units of 2^-56: by halves, since it has 88 bits.
    const auto k = static_cast<std::uint64_t>(in.u * 16777216.0f);
    const std::uint64_t high = k * in.count;                                    // units of 2^-24
    const std::uint64_t low = static_cast<std::uint64_t>(in.extra) * in.count;  // units of 2^-56
    const std::uint64_t sum = ((high & 0xFFFFFF) << 8) + (low >> 24);           // units of 2^-32
    EXPECT_EQ(found[i].x, static_cast<std::uint32_t>((high >> 24) + (sum >> 32))) << i;
    EXPECT_EQ(found[i].y, static_cast<std::uint32_t>(sum)) << i;
    EXPECT_LT(found[i].x, in.count);
  }
}

}  // namespace
}  // namespace quintet::test
