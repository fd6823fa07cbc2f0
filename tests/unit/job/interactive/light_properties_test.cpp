// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/light_properties.h"

#include <limits>

#include <gmock/gmock.h>

#include "base/error.h"

namespace quintet::job::interactive {
namespace {

using scene::LightType;

void set(scene::Light& light, const std::string& name, std::vector<double> values) {
  setLightProperty(light, name, values);
}

scene::Light makeLight(LightType type) {
  scene::Light light;
  light.type = type;
  light.intensity = {2, 4, 1};
  return light;
}

TEST(LightProperties, IntensityAndColorAreIndependent) {
  scene::Light light = makeLight(LightType::point);
  EXPECT_EQ(lightIntensity(light), 4.0f);
  EXPECT_EQ(lightColor(light), vec3(0.5f, 1, 0.25f));
  set(light, "intensity", {8});
  EXPECT_EQ(light.intensity, vec3(4, 8, 2));
  set(light, "color", {0.25, 0.125, 0});
  EXPECT_EQ(light.intensity, vec3(8, 4, 0));
  set(light, "intensity", {0});
  EXPECT_EQ(light.intensity, vec3(0));
  set(light, "intensity", {3});
  EXPECT_EQ(light.intensity, vec3(3)) << "white";
}

TEST(LightProperties, AreSetByName) {
  scene::Light light = makeLight(LightType::spot);
  set(light, "position", {1, 2, 3});
  set(light, "direction", {0, -4, 0});
  set(light, "outerConeAngle", {60});
  set(light, "innerConeAngle", {30});
  EXPECT_EQ(light.position, vec3(1, 2, 3));
  EXPECT_EQ(light.direction, vec3(0, -1, 0));
  EXPECT_FLOAT_EQ(light.outerConeAngle, kPi / 3);
  EXPECT_FLOAT_EQ(light.innerConeAngle, kPi / 6);
}

TEST(LightProperties, DependOnTheType) {
  using testing::ElementsAre;
  EXPECT_THAT(lightProperties(LightType::point), ElementsAre("intensity", "color", "position"));
  EXPECT_THAT(lightProperties(LightType::directional), ElementsAre("intensity", "color", "direction"));
  EXPECT_EQ(lightProperties(LightType::spot), lightProperties());
  scene::Light point = makeLight(LightType::point);
  EXPECT_THAT(
      [&] {
        set(point, "direction", {0, 0, 1});
      },
      testing::ThrowsMessage<UsageError>("point lights have no property 'direction'"));
  EXPECT_THAT(
      [&] {
        set(point, "positon", {0, 0, 1});
      },
      testing::ThrowsMessage<UsageError>(testing::HasSubstr("did you mean 'position'?")));
}

TEST(LightProperties, RejectsWrongValues) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::pair<const char*, std::vector<double>> wrong[] = {
      {"intensity", {-1}},      {"intensity", {kInfinity}},      {"intensity", {1, 2, 3}},
      {"color", {0, 0, 0}},     {"color", {1, -1, 0}},           {"color", {1}},
      {"position", {1, 2}},     {"position", {1, kInfinity, 2}}, {"direction", {0, 0, 0}},
      {"innerConeAngle", {91}}, {"innerConeAngle", {-1}},        {"outerConeAngle", {91}},
      {"outerConeAngle", {-1}}, {"direction", {kInfinity, 0, 0}}};
  for (const auto& [name, values] : wrong) {
    scene::Light light = makeLight(LightType::spot);
    light.innerConeAngle = 0.2f;
    const scene::Light before = light;
    EXPECT_THROW(set(light, name, values), UsageError) << name;
    EXPECT_EQ(light.intensity, before.intensity);
    EXPECT_EQ(light.position, before.position);
    EXPECT_EQ(light.direction, before.direction);
    EXPECT_EQ(light.innerConeAngle, before.innerConeAngle);
    EXPECT_EQ(light.outerConeAngle, before.outerConeAngle);
  }
}

// The color survives the intensity 0, also if it changes meanwhile.
TEST(LightProperties, KeepTheColorOfADarkLight) {
  scene::Light light;
  light.intensity = {1, 2, 4};
  vec3 color = lightColor(light);
  const auto set = [&](const char* name, std::vector<double> values) { setLightProperty(light, color, name, values); };
  set("intensity", {0});
  EXPECT_EQ(light.intensity, vec3(0.0f));
  set("intensity", {8});
  EXPECT_EQ(light.intensity, vec3(2, 4, 8));
  set("intensity", {0});
  set("color", {1, 0, 0});
  EXPECT_EQ(light.intensity, vec3(0.0f)) << "it stays dark";
  set("position", {1, 2, 3});
  set("intensity", {3});
  EXPECT_EQ(light.intensity, vec3(3, 0, 0));
  EXPECT_EQ(light.position, vec3(1, 2, 3));
}

}  // namespace
}  // namespace quintet::job::interactive
