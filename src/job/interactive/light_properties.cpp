// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/light_properties.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/suggestion.h"
#include "scene/model/limits.h"

namespace quintet::job::interactive {
namespace {

using scene::Light;
using scene::LightType;

bool all(LightType) { return true; }
bool hasPosition(LightType type) { return type != LightType::directional; }
bool hasDirection(LightType type) { return type != LightType::point; }
bool isSpot(LightType type) { return type == LightType::spot; }

[[noreturn]] void failProperty(std::string_view name, const char* rule) {
  throw UsageError(fmt::format("the property '{}' of a light is {}", name, rule));
}

vec3 toVec3(std::span<const double> v) { return {v[0], v[1], v[2]}; }

void setIntensity(Light& light, std::span<const double> values) {
  const double intensity = values[0];
  if (!(intensity >= 0.0 && static_cast<float>(intensity) <= scene::kMaxRadiance))
    failProperty("intensity", "a number from 0 to 1e12");
  if (static_cast<float>(intensity) != lightIntensity(light))
    light.intensity = static_cast<float>(intensity) * lightColor(light);
}

void setColor(Light& light, std::span<const double> values) {
  const vec3 color = toVec3(values);
  const float largest = std::max({color.r, color.g, color.b});
  if (!isFinite(color) || glm::any(glm::lessThan(color, vec3(0.0f))) || !(largest > 0.0f))
    failProperty("color", "three numbers of at least 0, not all 0");
  if (color / largest != lightColor(light)) light.intensity = lightIntensity(light) * (color / largest);
}

void setPosition(Light& light, std::span<const double> values) {
  const vec3 position = toVec3(values);
  if (!isFinite(position)) failProperty("position", "three numbers");
  light.position = position;
}

void setDirection(Light& light, std::span<const double> values) {
  const vec3 direction = toVec3(values);
  const float length = glm::length(direction);
  if (!(length > 0.0f) || !std::isfinite(length)) failProperty("direction", "a vector with a length above 0");
  if (direction != light.direction) light.direction = direction / length;
}

void setConeAngle(float& angle, std::string_view name, double degrees) {
  if (!(degrees >= 0.0 && degrees <= 90.0)) failProperty(name, "from 0 to 90 degrees");
  if (static_cast<float>(degrees) != glm::degrees(angle)) angle = glm::radians(static_cast<float>(degrees));
}

void setInnerConeAngle(Light& light, std::span<const double> values) {
  setConeAngle(light.innerConeAngle, "innerConeAngle", values[0]);
}

void setOuterConeAngle(Light& light, std::span<const double> values) {
  setConeAngle(light.outerConeAngle, "outerConeAngle", values[0]);
}

struct LightProperty {
  std::string_view name;
  std::size_t count;  // of values
  bool (*isOf)(LightType);
  void (*set)(Light&, std::span<const double>);
};

constexpr std::array<LightProperty, 6> kLightProperties{{{"intensity", 1, all, setIntensity},
                                                         {"color", 3, all, setColor},
                                                         {"position", 3, hasPosition, setPosition},
                                                         {"direction", 3, hasDirection, setDirection},
                                                         {"innerConeAngle", 1, isSpot, setInnerConeAngle},
                                                         {"outerConeAngle", 1, isSpot, setOuterConeAngle}}};

const char* nameOf(LightType type) {
  constexpr const char* kNames[] = {"point", "spot", "directional"};
  return kNames[static_cast<std::size_t>(type)];
}

}  // namespace

std::vector<std::string> lightProperties() {
  std::vector<std::string> names;
  for (const LightProperty& property : kLightProperties) names.emplace_back(property.name);
  return names;
}

std::vector<std::string> lightProperties(LightType type) {
  std::vector<std::string> names;
  for (const LightProperty& property : kLightProperties)
    if (property.isOf(type)) names.emplace_back(property.name);
  return names;
}

void setLightProperty(Light& light, const std::string& name, std::span<const double> values) {
  const auto found = std::ranges::find(kLightProperties, name, &LightProperty::name);
  if (found == kLightProperties.end())
    throw UsageError(
        fmt::format("lights have no property '{}'{}", name, suggestionOrList(name, lightProperties(light.type))));
  if (!found->isOf(light.type))
    throw UsageError(fmt::format("{} lights have no property '{}'", nameOf(light.type), name));
  if (values.size() != found->count) failProperty(name, found->count == 1 ? "a number" : "three numbers");
  found->set(light, values);
}

void setLightProperty(Light& light, vec3& color, const std::string& name, std::span<const double> values) {
  const bool dark = !(lightIntensity(light) > 0.0f);
  Light edited = light;
  if (dark) edited.intensity = color;  // of intensity 1
  setLightProperty(edited, name, values);
  if (lightIntensity(edited) > 0.0f) color = lightColor(edited);
  if (dark && name != "intensity") edited.intensity = vec3(0.0f);
  light = edited;
}

float lightIntensity(const Light& light) {
  return std::max({light.intensity.r, light.intensity.g, light.intensity.b, 0.0f});
}

vec3 lightColor(const Light& light) {
  const float intensity = lightIntensity(light);
  return intensity > 0.0f ? light.intensity / intensity : vec3(1.0f);
}

}  // namespace quintet::job::interactive
