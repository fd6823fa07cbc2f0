// SPDX-License-Identifier: Apache-2.0
// The states of animated materials have all features of the animation, also those that exist only between keys.
#include "scene/animation/material_states.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "scene/animation/pose.h"
#include "scene/animation/properties.h"
#include "scene/model/surface_class.h"

namespace quintet::test {
namespace {

constexpr std::string_view kTransmission = "extensions/KHR_materials_transmission/transmissionFactor";
constexpr std::string_view kThickness = "extensions/KHR_materials_volume/thicknessFactor";
constexpr std::string_view kEmission = "emissiveFactor";
constexpr std::string_view kRoughness = "pbrMetallicRoughness/roughnessFactor";

// An animated material, one property after the other.
struct ChangingMaterial {
  scene::Material material;
  scene::NodeAnimation animation;
  std::vector<scene::AnimatedValue> values;

  ChangingMaterial& add(std::string_view pointer, scene::Interpolation interpolation, std::vector<float> times,
                        std::vector<float> numbers) {
    const scene::PropertyInfo property = *scene::findMaterialProperty(pointer);
    animation.animation.samplers.push_back({interpolation, std::move(times), std::move(numbers), property.size});
    animation.values.push_back(animation.animation.samplers.size() - 1);
    values.push_back({property.index, animation.values.size() - 1});
    return *this;
  }
  std::vector<scene::Material> states() const { return scene::materialStates(material, values, animation); }
  template <class Condition>
  bool everHas(const Condition& condition) const {
    return std::ranges::any_of(states(), condition);
  }
};

bool transmits(const scene::Material& m) { return m.transmission > 0.0f; }

TEST(MaterialStates, FindWhatACubicSplineHasOnlyBetweenItsKeys) {
  // Tangents lift the spline above 0 in one half of the interval, or only near one end.
  for (const float leaving : {4.0f, 1e-3f}) {
    for (const float arriving : {4.0f, -40.0f, 0.0f}) {
      ChangingMaterial m;
      m.add(kTransmission, scene::Interpolation::cubicSpline, {0, 1}, {0, 0, leaving, arriving, 0, 0});
      EXPECT_TRUE(m.everHas(transmits)) << leaving << arriving;
      EXPECT_TRUE(m.everHas([](const auto& state) { return !transmits(state); }));
    }
  }
  ChangingMaterial never;
  never.add(kTransmission, scene::Interpolation::cubicSpline, {0, 1}, {0, 0, -4, 4, 0, 0});
  EXPECT_FALSE(never.everHas(transmits)) << "the spline is below 0, where the value is clamped";
  // 1e-6 - (t - 1/2)², which is above 0 for 2 ms.
  ChangingMaterial narrow;
  narrow.add(kTransmission, scene::Interpolation::cubicSpline, {0, 1}, {0, -0.249999f, 1, -1, -0.249999f, 0});
  EXPECT_TRUE(narrow.everHas(transmits));
}

TEST(MaterialStates, FindWhatBeginsLater) {
  ChangingMaterial m;
  m.add(kTransmission, scene::Interpolation::linear, {0, 1, 2}, {0, 0, 1e-6f});
  EXPECT_TRUE(m.everHas(transmits));
  ChangingMaterial step;
  step.add(kTransmission, scene::Interpolation::step, {0, 1, 2}, {0, 1, 0});
  EXPECT_TRUE(step.everHas(transmits));
  EXPECT_FALSE(step.everHas([](const auto& state) { return state.transmission > 0.0f && state.transmission < 1.0f; }));
}

// Both properties have the values of the same time.
TEST(MaterialStates, CombineFeaturesOfOneTime) {
  const auto solidGlass = [](const scene::Material& m) { return m.transmission > 0.0f && m.thickness > 0.0f; };
  ChangingMaterial overlap;
  overlap.add(kTransmission, scene::Interpolation::linear, {0, 10}, {1, -1})
      .add(kThickness, scene::Interpolation::linear, {0, 10}, {-1, 1.02f});
  EXPECT_TRUE(overlap.everHas(solidGlass)) << "from 4.95 to 5 seconds";
  ChangingMaterial apart;
  apart.add(kTransmission, scene::Interpolation::linear, {0, 10}, {1, -1})
      .add(kThickness, scene::Interpolation::linear, {0, 10}, {-1, 0.98f});
  EXPECT_FALSE(apart.everHas(solidGlass));
}

TEST(MaterialStates, FindPanes) {
  ChangingMaterial m;
  m.material.transmission = 1.0f;
  m.material.metallic = 0.0f;
  m.add(kRoughness, scene::Interpolation::linear, {0, 1, 2}, {1, 0.022f, 1});
  EXPECT_TRUE(m.everHas([](const auto& state) { return scene::isPane(state); }));
  ChangingMaterial rough = m;
  rough.animation.animation.samplers[0].values[1] = 0.0225f;
  EXPECT_FALSE(rough.everHas([](const auto& state) { return scene::isPane(state); }));
  ChangingMaterial dips = m;  // the least roughness is that of a pane only between the keys
  dips.animation.animation.samplers[0] = {
      scene::Interpolation::cubicSpline, {0, 1}, {0, 0.5f, -1.97f, 1.97f, 0.5f, 0}, 1};
  EXPECT_TRUE(dips.everHas([](const auto& state) { return scene::isPane(state); }));
}

// Few states, among them the brightest.
TEST(MaterialStates, AreFewButBright) {
  ChangingMaterial m;
  std::vector<float> times, colors;
  for (int i = 0; i < 1000; ++i) {
    times.push_back(static_cast<float>(i));
    const float light = static_cast<float>(i * 37 % 1000);
    colors.insert(colors.end(), {light, 0.5f * light, 0});
  }
  m.add(kEmission, scene::Interpolation::linear, times, colors);
  const std::vector<scene::Material> states = m.states();
  EXPECT_LT(states.size(), 80u);
  const auto brightest = std::ranges::max_element(states, {}, [](const auto& s) { return s.emissive.x; });
  EXPECT_EQ(brightest->emissive, vec3(999, 499.5f, 0));
}

}  // namespace
}  // namespace quintet::test
