// SPDX-License-Identifier: Apache-2.0
// [[light]], with its keyframes.
#include <fmt/format.h>

#include <algorithm>

#include "base/normal_float.h"
#include "scene/model/limits.h"
#include "scene/toml/context.h"
#include "scene/toml/keyframes.h"

namespace quintet::scene {
namespace {

// The keys that keyframes can change, in the units of the file.
struct LightKeys {
  vec3 color{1.0f};
  float intensity = 1.0f;
  vec3 position{0.0f};
  float range = Light().range;
  vec3 direction{0, 0, -1};  // or the target, which is a position
  float outerAngle = 45.0f, innerAngle = 0.0f;
};

// Which keys a light has.
struct LightKind {
  LightType type = LightType::point;
  bool hasTarget = false;
};

// Reads the keys of a light or of one of its keyframes. Missing ones keep their values.
LightKeys readKeys(TomlReader& reader, const LightKind& kind, LightKeys keys) {
  keys.color = readColor(reader, "color", keys.color, kNotNegative);
  keys.intensity = reader.number("intensity", keys.intensity, kNotNegative);
  if (const vec3 product = keys.color * keys.intensity; !(std::max({product.x, product.y, product.z}) <= kMaxRadiance))
    reader.fail(fmt::format("the intensity of {} is too large; at most {:g}", reader.what(), kMaxRadiance));
  if (kind.type != LightType::directional) {
    keys.position = reader.triple("position", keys.position);
    if (const TomlValue* const range = reader.find("range"))
      keys.range = distanceOrInfinity(reader.toNumber(*range, "range", kPositive));
  }
  if (kind.hasTarget) {
    keys.direction = reader.triple("target", keys.direction);
    if (keys.direction == keys.position) {
      const TomlValue* const target = reader.find("target");
      reader.fail(target ? *target : reader.table(), fmt::format("'target' of {} is its position", reader.what()));
    }
  } else if (kind.type != LightType::point) {
    if (const TomlValue* const direction = reader.find("direction"))
      keys.direction = reader.toDirection(*direction, "direction");
  }
  if (kind.type == LightType::spot) {
    keys.outerAngle = reader.number("outer_angle", keys.outerAngle, {0.0, 90.0, true});
    keys.innerAngle = reader.number("inner_angle", std::min(keys.innerAngle, keys.outerAngle),
                                    {0.0, static_cast<double>(keys.outerAngle)});
  }
  return keys;
}

Light lightOf(const LightKeys& keys, const LightKind& kind) {
  Light light;
  light.type = kind.type;
  light.intensity = keys.color * keys.intensity;
  light.position = keys.position;
  light.range = keys.range;
  light.direction = keys.direction;
  if (kind.hasTarget) light.direction = vec3(glm::normalize(glm::dvec3(keys.direction) - glm::dvec3(keys.position)));
  if (kind.type == LightType::spot) {
    light.outerConeAngle = std::min(glm::radians(keys.outerAngle), kPi / 2.0f);
    light.innerConeAngle = std::min(glm::radians(keys.innerAngle), light.outerConeAngle);
  }
  return light;
}

std::vector<KeyTrack> tracksOf(const std::vector<LightKeys>& states, const LightKind& kind) {
  // The scene has the product of color and intensity, and the direction to the target.
  constexpr int kEmission = 1, kAim = 2;
  std::vector<KeyTrack> tracks;
  const auto add = [&](const char* key, auto value, int group = 0, float unit = 1.0f) {
    KeyTrack& track = tracks.emplace_back(KeyTrack{.key = key, .property = *findLightKey(key)});
    for (const LightKeys& keys : states) track.values.push_back(value(keys));
    track.group = group;
    track.unit = unit;
  };
  add(
      "color", [](const LightKeys& k) { return vec4(k.color, 0.0f); }, kEmission);
  add(
      "intensity", [](const LightKeys& k) { return vec4(k.intensity, vec3(0.0f)); }, kEmission);
  if (kind.type != LightType::directional) {
    add(
        "position", [](const LightKeys& k) { return vec4(k.position, 0.0f); }, kind.hasTarget ? kAim : 0);
    add("range", [](const LightKeys& k) { return vec4(k.range, vec3(0.0f)); });
  }
  if (kind.type != LightType::point)
    add(
        kind.hasTarget ? "target" : "direction", [](const LightKeys& k) { return vec4(k.direction, 0.0f); },
        kind.hasTarget ? kAim : 0);
  if (kind.type == LightType::spot) {
    const float degree = glm::radians(1.0f);
    add(
        "outer_angle", [](const LightKeys& k) { return vec4(k.outerAngle, vec3(0.0f)); }, 0, degree);
    add(
        "inner_angle", [](const LightKeys& k) { return vec4(k.innerAngle, vec3(0.0f)); }, 0, degree);
  }
  return tracks;
}

LightKind readKind(TomlReader& reader) {
  reader.require("type");
  LightKind kind;
  kind.type = static_cast<LightType>(reader.choice("type", {"point", "spot", "directional"}, 0));
  if (kind.type != LightType::directional) reader.require("position");
  if (kind.type == LightType::directional) reader.require("direction");
  if (kind.type == LightType::spot && !reader.findOneOf({"direction", "target"}))
    reader.fail(fmt::format("{} needs 'direction' or 'target'", reader.what()));
  kind.hasTarget = kind.type == LightType::spot && reader.has("target");
  return kind;
}

void readLight(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, describeTable("light", table), context.file);
  const std::string name = reader.text("name");
  const LightKind kind = readKind(reader);
  const LightKeys keys = readKeys(reader, kind, {});
  KeyframeList list(reader, context.options.framesPerSecond);
  reader.rejectUnknownKeys();
  std::vector<LightKeys> states;
  for (std::size_t i = 0; i < list.size(); ++i)
    states.push_back(readKeys(list.table(i), kind, i == 0 ? keys : states.back()));
  Light light = lightOf(keys, kind);
  light.name = name;
  if (!isWithinLimits(light.position))
    reader.fail(fmt::format("{} is too far away: its coordinates can be at most {:g}", reader.what(), kMaxCoordinate));
  light.values = addTracks(context, reader, list, tracksOf(states, kind));
  context.scene.lights.push_back(std::move(light));
}

}  // namespace

void readLights(SceneTomlContext& context, TomlReader& root) {
  for (const TomlValue& table : root.tables("light")) readLight(context, table);
}

}  // namespace quintet::scene
