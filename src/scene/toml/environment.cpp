// SPDX-License-Identifier: Apache-2.0
// [environment], with its keyframes.
#include <fmt/format.h>

#include "scene/defaults/default_environment.h"
#include "scene/model/limits.h"
#include "scene/toml/context.h"
#include "scene/toml/keyframes.h"

namespace quintet::scene {
namespace {

constexpr NumberRange kRadiance{0.0, 1e12};  // kMaxRadiance as a decimal number

// The keys that keyframes can change, in the units of the file.
struct EnvironmentKeys {
  float intensity = 1.0f;
  float rotation = 0.0f;
};

EnvironmentKeys readKeys(TomlReader& reader, const EnvironmentKeys& keys) {
  return {reader.number("intensity", keys.intensity, kNotNegative), reader.number("rotation", keys.rotation)};
}

std::vector<KeyTrack> tracksOf(const std::vector<EnvironmentKeys>& states) {
  KeyTrack intensity{.key = "intensity", .property = *findEnvironmentKey("intensity")};
  KeyTrack rotation{.key = "rotation", .property = *findEnvironmentKey("rotation"), .unit = glm::radians(1.0f)};
  for (const EnvironmentKeys& keys : states) {
    intensity.values.emplace_back(keys.intensity, vec3(0.0f));
    rotation.values.emplace_back(keys.rotation, vec3(0.0f));
  }
  return {intensity, rotation};
}

}  // namespace

void readEnvironment(SceneTomlContext& context, TomlReader& root) {
  const TomlValue* const table = root.find("environment");
  if (!table) return;
  TomlReader reader(*table, "[environment]", context.file);
  Environment environment;
  const TomlValue* source = reader.findOneOf({"image", "color", "default", "none"});
  if (!source) reader.fail("[environment] needs 'image', 'color', 'default = true' or 'none = true'");
  if (reader.has("image")) {
    const std::filesystem::path file = context.resolvePath(*source, reader.toText(*source, "image"));
    environment.image = context.readRadiance(file);
    environment.name = file.filename().string();
  } else if (reader.has("color")) {
    environment.constant = toColor(reader, *source, "color", kRadiance);
  } else {
    const std::string key = reader.has("default") ? "default" : "none";
    if (!reader.boolean(key)) reader.fail(*source, fmt::format("'{}' of [environment] must be true", key));
    if (key == "default") environment = defaultEnvironment();
  }
  environment.present = true;
  const EnvironmentKeys keys = readKeys(reader, {});
  environment.intensity = keys.intensity;
  environment.rotation = glm::radians(keys.rotation);
  KeyframeList list(reader, context.options.framesPerSecond);
  reader.rejectUnknownKeys();
  std::vector<EnvironmentKeys> states;
  for (std::size_t i = 0; i < list.size(); ++i)
    states.push_back(readKeys(list.table(i), i == 0 ? keys : states.back()));
  environment.values = addTracks(context, reader, list, tracksOf(states));
  context.scene.environment = std::move(environment);
}

}  // namespace quintet::scene
