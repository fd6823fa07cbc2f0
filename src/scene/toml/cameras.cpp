// SPDX-License-Identifier: Apache-2.0
// [[camera]], with its keyframes.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "base/error.h"
#include "scene/defaults/auto_camera.h"
#include "scene/model/limits.h"
#include "scene/toml/context.h"
#include "scene/toml/keyframes.h"

namespace quintet::scene {
namespace {

// The keys that keyframes can change, in the units of the file.
struct CameraKeys {
  vec3 lookFrom{0.0f}, lookAt{0.0f}, up{0, 1, 0};
  float fov = 45.0f;
  vec2 size{2.0f};  // of an orthographic camera
  float aperture = 0.0f;
  std::optional<float> focus;  // the default is the distance to lookAt
};

float focusOf(const CameraKeys& keys) { return keys.focus.value_or(glm::distance(keys.lookFrom, keys.lookAt)); }

// Reads the keys of a camera or of one of its keyframes. Missing ones keep their values.
CameraKeys readKeys(TomlReader& reader, bool orthographic, CameraKeys keys) {
  keys.lookFrom = reader.triple("look_from", keys.lookFrom);
  keys.lookAt = reader.triple("look_at", keys.lookAt);
  keys.up = reader.triple("up", keys.up);
  if (orthographic)
    keys.size = reader.pair("orthographic", keys.size, kPositive);
  else
    keys.fov = reader.number("fov", keys.fov, {0.0, 180.0, true, true});
  keys.aperture = reader.number("aperture", keys.aperture, kNotNegative);
  if (const TomlValue* const focus = reader.find("focus")) keys.focus = reader.toNumber(*focus, "focus", kPositive);
  return keys;
}

Camera cameraOf(TomlReader& reader, const CameraKeys& keys, bool orthographic) {
  Camera camera;
  try {
    camera = lookAtCamera(keys.lookFrom, keys.lookAt, keys.up, glm::radians(keys.fov), keys.aperture);
  } catch (const UsageError& error) {
    const TomlValue* const from = reader.find("look_from");
    reader.fail(from ? *from : reader.table(), fmt::format("{}: {}", reader.what(), error.what()));
  }
  if (keys.focus) camera.focusDistance = *keys.focus;
  camera.orthographic = orthographic;
  if (orthographic) camera.orthographicHalfSize = 0.5f * keys.size;
  for (int column = 0; column < 4; ++column)
    if (!isWithinLimits(vec3(camera.worldFromCamera[column])))
      reader.fail(
          fmt::format("{} is too far away: its coordinates can be at most {:g}", reader.what(), kMaxCoordinate));
  return camera;
}

std::vector<KeyTrack> tracksOf(const std::vector<CameraKeys>& states, bool orthographic, bool hasFocus) {
  constexpr int kFrame = 1;  // which look_from, look_at and up define; look_at sets the focus, too
  std::vector<KeyTrack> tracks;
  const auto add = [&](const char* key, auto value, int group = 0, float unit = 1.0f) {
    KeyTrack& track = tracks.emplace_back(KeyTrack{.key = key, .property = *findCameraKey(key)});
    for (const CameraKeys& keys : states) track.values.push_back(value(keys));
    track.group = group;
    track.unit = unit;
  };
  add(
      "look_from", [](const CameraKeys& k) { return vec4(k.lookFrom, 0.0f); }, kFrame);
  add(
      "look_at", [](const CameraKeys& k) { return vec4(k.lookAt, 0.0f); }, kFrame);
  add(
      "up", [](const CameraKeys& k) { return vec4(glm::normalize(k.up), 0.0f); }, kFrame);
  if (orthographic)
    add(
        "orthographic", [](const CameraKeys& k) { return vec4(k.size, 0.0f, 0.0f); }, 0, 0.5f);
  else
    add(
        "fov", [](const CameraKeys& k) { return vec4(k.fov, vec3(0.0f)); }, 0, glm::radians(1.0f));
  add("aperture", [](const CameraKeys& k) { return vec4(k.aperture, vec3(0.0f)); });
  add(
      "focus", [](const CameraKeys& k) { return vec4(focusOf(k), vec3(0.0f)); }, hasFocus ? kFrame : 0);
  return tracks;
}

void readCamera(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, describeTable("camera", table), context.file);
  const std::string name = reader.text("name");
  reader.require("look_from");
  reader.require("look_at");
  const bool orthographic = reader.findOneOf({"orthographic", "fov"}) && reader.has("orthographic");
  const CameraKeys keys = readKeys(reader, orthographic, {});
  Camera camera = cameraOf(reader, keys, orthographic);
  camera.name = name;
  camera.aspect = orthographic ? keys.size.x / keys.size.y : reader.number("aspect", 0.0f, kPositive);
  KeyframeList list(reader, context.options.framesPerSecond);
  reader.rejectUnknownKeys();
  std::vector<CameraKeys> states;
  for (std::size_t i = 0; i < list.size(); ++i) {
    states.push_back(readKeys(list.table(i), orthographic, i == 0 ? keys : states.back()));
    cameraOf(list.table(i), states.back(), orthographic);
  }
  camera.values = addTracks(context, reader, list, tracksOf(states, orthographic, keys.focus.has_value()));
  context.scene.cameras.push_back(std::move(camera));
}

}  // namespace

void readCameras(SceneTomlContext& context, TomlReader& root) {
  // The cameras of the scene precede those of its files, because the first camera is the default.
  std::vector<Camera> fileCameras = std::move(context.scene.cameras);
  context.scene.cameras.clear();
  for (const TomlValue& table : root.tables("camera")) readCamera(context, table);
  std::ranges::move(fileCameras, std::back_inserter(context.scene.cameras));
}

}  // namespace quintet::scene
