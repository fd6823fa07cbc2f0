// SPDX-License-Identifier: Apache-2.0
// [[light]], [[camera]] and [environment].
#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "base/error.h"
#include "io/codec.h"
#include "scene/defaults/auto_camera.h"
#include "scene/defaults/default_environment.h"
#include "scene/toml/context.h"

namespace quintet::scene {
namespace {

void readLight(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, describeTable("light", table), context.file);
  Light light;
  light.name = reader.text("name");
  reader.require("type");
  light.type = static_cast<LightType>(reader.choice("type", {"point", "spot", "directional"}, 0));
  light.intensity =
      readColor(reader, "color", vec3(1.0f), kNotNegative) * reader.number("intensity", 1.0f, kNotNegative);
  if (!isFinite(light.intensity)) reader.fail(table, fmt::format("the intensity of {} is too large", reader.what()));
  if (light.type != LightType::directional) {
    light.position = reader.toTriple(reader.require("position"), "position");
    light.range = reader.number("range", light.range, kPositive);
  }
  if (light.type != LightType::point) {
    const TomlValue* direction =
        light.type == LightType::spot ? reader.findOneOf({"direction", "target"}) : &reader.require("direction");
    if (!direction) reader.fail(table, fmt::format("{} needs 'direction' or 'target'", reader.what()));
    light.direction = reader.has("direction") ? reader.toDirection(*direction, "direction") : vec3(0.0f);
    if (!reader.has("direction")) {
      const glm::dvec3 to = glm::dvec3(reader.toTriple(*direction, "target")) - glm::dvec3(light.position);
      if (!(glm::length(to) > 0.0))
        reader.fail(*direction, fmt::format("'target' of {} is its position", reader.what()));
      light.direction = vec3(glm::normalize(to));
    }
  }
  if (light.type == LightType::spot) {
    const float outer = reader.number("outer_angle", 45.0f, {0.0, 90.0, true});
    const float inner = reader.number("inner_angle", 0.0f, {0.0, static_cast<double>(outer)});
    light.outerConeAngle = std::min(glm::radians(outer), kPi / 2.0f);
    light.innerConeAngle = std::min(glm::radians(inner), light.outerConeAngle);
  }
  reader.rejectUnknownKeys();
  context.scene.lights.push_back(std::move(light));
}

Camera lookingCamera(TomlReader& reader) {
  const TomlValue& from = reader.require("look_from");
  const vec3 eye = reader.toTriple(from, "look_from");
  const vec3 target = reader.toTriple(reader.require("look_at"), "look_at");
  try {
    return lookAtCamera(eye, target, reader.triple("up", vec3(0, 1, 0)), glm::radians(45.0f), 0.0f);
  } catch (const UsageError& error) {
    reader.fail(from, fmt::format("{}: {}", reader.what(), error.what()));
  }
}

void readCamera(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, describeTable("camera", table), context.file);
  Camera camera = lookingCamera(reader);
  camera.name = reader.text("name");
  if (const TomlValue* size = reader.find("orthographic")) {
    if (const TomlValue* fov = reader.find("fov"))
      reader.fail(*fov, fmt::format("'orthographic' and 'fov' of {} are mutually exclusive", reader.what()));
    camera.orthographic = true;
    camera.orthographicHalfSize = 0.5f * reader.toPair(*size, "orthographic", kPositive);
    camera.aspect = camera.orthographicHalfSize.x / camera.orthographicHalfSize.y;
  } else {
    camera.verticalFov = glm::radians(reader.number("fov", 45.0f, {0.0, 180.0, true, true}));
    camera.aspect = reader.number("aspect", 0.0f, kPositive);
  }
  camera.apertureRadius = reader.number("aperture", 0.0f, kNotNegative);
  camera.focusDistance = reader.number("focus", camera.focusDistance, kPositive);
  reader.rejectUnknownKeys();
  for (int column = 0; column < 4; ++column)
    if (!isFinite(vec3(camera.worldFromCamera[column])))
      reader.fail(table, fmt::format("{} is too far away", reader.what()));
  context.scene.cameras.push_back(std::move(camera));
}

void readEnvironment(SceneTomlContext& context, const TomlValue& table) {
  TomlReader reader(table, "[environment]", context.file);
  Environment environment;
  const TomlValue* source = reader.findOneOf({"image", "color", "default", "none"});
  if (!source) reader.fail(table, "[environment] needs 'image', 'color', 'default = true' or 'none = true'");
  if (reader.has("image")) {
    const std::filesystem::path file = context.resolvePath(*source, reader.toText(*source, "image"));
    environment.image = io::readRadiance(file, context.budget);
    context.scene.report.files.push_back(file);
    environment.name = file.filename().string();
  } else if (reader.has("color")) {
    environment.constant = toColor(reader, *source, "color", kNotNegative);
  } else {
    const std::string key = reader.has("default") ? "default" : "none";
    if (!reader.boolean(key)) reader.fail(*source, fmt::format("'{}' of [environment] must be true", key));
    if (key == "default") environment = defaultEnvironment();
  }
  environment.present = true;
  environment.intensity = reader.number("intensity", 1.0f, kNotNegative);
  environment.rotation = glm::radians(reader.number("rotation", 0.0f));
  reader.rejectUnknownKeys();
  context.scene.environment = std::move(environment);
}

}  // namespace

void readView(SceneTomlContext& context, TomlReader& root) {
  for (const TomlValue& table : root.tables("light")) readLight(context, table);
  // The cameras of the scene precede those of its files, because the first camera is the default.
  std::vector<Camera> fileCameras = std::move(context.scene.cameras);
  context.scene.cameras.clear();
  for (const TomlValue& table : root.tables("camera")) readCamera(context, table);
  std::ranges::move(fileCameras, std::back_inserter(context.scene.cameras));
  if (const TomlValue* environment = root.find("environment")) readEnvironment(context, *environment);
}

}  // namespace quintet::scene
