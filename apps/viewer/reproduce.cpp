// SPDX-License-Identifier: Apache-2.0
#include "reproduce.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "cli/values.h"
#include "job/interactive/light_properties.h"
#include "job/interactive/material_properties.h"
#include "render/tone_map/tone_map.h"
#include "scene/load.h"

namespace quintet::viewer {
namespace {

namespace interactive = job::interactive;
using nlohmann::ordered_json;

// 9 digits restore each float.
std::string number(double value) { return fmt::format("{:.9g}", value); }
std::string point(const vec3& p) { return fmt::format("{:.9g},{:.9g},{:.9g}", p.x, p.y, p.z); }

// Options that all commands have.
std::vector<std::string> commonOptions(const Snapshot& snapshot) {
  const interactive::SessionState& state = snapshot.state;
  const job::RenderRequest& request = snapshot.request->render;
  std::vector<std::string> options;
  const auto add = [&](const char* name, const std::string& value) { options.insert(options.end(), {name, value}); };
  const auto addNumber = [&](const char* name, const std::optional<float>& value) {
    if (value) add(name, number(*value));
  };
  add("--size", fmt::format("{}x{}", state.size.x, state.size.y));
  add("--spp", std::to_string(state.samples));
  if (request.seed != 0) add("--seed", std::to_string(request.seed));
  if (request.transparent) options.emplace_back("--transparent");
  const scene::LoadOptions& load = request.load;
  if (!load.scene.empty()) add("--scene", load.scene);
  if (!load.variant.empty()) add("--variant", load.variant);
  if (load.strict) options.emplace_back("--strict");
  if (load.missingTextures == scene::MissingTextures::warn) add("--missing-textures", "warn");
  if (load.maxMemory > 0) add("--max-memory", std::to_string(load.maxMemory));
  if (load.allowExternal) options.emplace_back("--allow-external");
  const bool isGltf = !request.scene.empty() && scene::sceneFormat(request.scene, {}) != scene::SceneFormat::toml;
  if (!request.animation.empty())
    add("--animation", request.animation);
  else if (snapshot.animated && isGltf)
    add("--animation", "0");  // otherwise frame 0 would be the rest pose
  if (snapshot.animated && request.framesPerSecond != scene::kDefaultFramesPerSecond)
    add("--fps", number(request.framesPerSecond));
  if (request.shutter) add("--shutter", fmt::format("{},{}", request.shutter->open, request.shutter->close));
  const job::CameraRequest& camera = state.camera;
  if (!camera.name.empty() && !camera.lookFrom) add("--camera", camera.name);
  if (camera.lookFrom) {
    add("--look-from", point(*camera.lookFrom));
    if (camera.lookAt) add("--look-at", point(*camera.lookAt));
    if (camera.up != vec3(0, 1, 0)) add("--up", point(camera.up));
  }
  addNumber("--fov", camera.verticalFov);
  addNumber("--aperture", camera.apertureRadius);
  addNumber("--focus", camera.focusDistance);
  const job::EnvironmentRequest& environment = state.environment;
  if (!state.environmentOn)
    add("--env", "none");
  else if (!environment.source.empty())
    add("--env", environment.source);
  addNumber("--env-intensity", environment.intensity);
  addNumber("--env-rotation", environment.rotation);
  if (!state.parameterFile.empty()) add("--set-file", state.parameterFile.string());
  for (const std::string& assignment : state.assignments) add("--set", assignment);
  return options;
}

std::vector<std::string> displayOptions(const interactive::SessionState& state) {
  std::vector<std::string> options;
  if (state.exposure != 0.0) options.insert(options.end(), {"--exposure", number(state.exposure)});
  if (state.toneMap)
    for (const std::string& name : render::toneMapNames())
      if (render::toneMapByName(name) == state.toneMap) options.insert(options.end(), {"--tonemap", name});
  return options;
}

ordered_json numbersJson(const std::vector<double>& numbers) {
  if (numbers.size() == 1) return numbers.front();
  return numbers;
}

// ---- Lines of a script (docs/viewer.md)

void addMaterialLines(std::vector<std::string>& lines, const Snapshot& snapshot) {
  for (const auto& [index, edited] : snapshot.state.materials) {
    ordered_json line{{"do", "material"}, {"name", snapshot.scene->materialNames[index]}};
    const std::size_t before = line.size();
    for (const std::string& property : interactive::materialProperties()) {
      const std::vector<double> value = interactive::materialPropertyValue(*edited, property);
      if (value != interactive::materialPropertyValue(snapshot.scene->materials[index], property))
        line[property] = numbersJson(value);
    }
    if (line.size() > before) lines.push_back(line.dump());
  }
}

void addLightLines(std::vector<std::string>& lines, const Snapshot& snapshot) {
  const auto list = [](const vec3& v) { return std::vector<double>{v.x, v.y, v.z}; };
  for (const auto& [index, edited] : snapshot.state.lights) {
    const scene::Light& light = edited->light;
    ordered_json line{{"do", "light"}, {"name", snapshot.scene->lightNames[index]}, {"on", edited->on}};
    for (const std::string& property : interactive::lightProperties(light.type)) {
      if (property == "intensity") line[property] = interactive::lightIntensity(light);
      if (property == "color") line[property] = list(interactive::lightColor(light));
      if (property == "position") line[property] = list(light.position);
      if (property == "direction") line[property] = list(light.direction);
      if (property == "innerConeAngle") line[property] = glm::degrees(light.innerConeAngle);
      if (property == "outerConeAngle") line[property] = glm::degrees(light.outerConeAngle);
    }
    lines.push_back(line.dump());
  }
}

void addTransformLines(std::vector<std::string>& lines, const Snapshot& snapshot) {
  for (const auto& [index, transform] : snapshot.state.transforms) {
    std::vector<double> rows;
    for (glm::length_t row = 0; row < 3; ++row)
      for (glm::length_t column = 0; column < 4; ++column) rows.push_back(transform[column][row]);
    lines.push_back(
        ordered_json{{"do", "transform"}, {"instance", snapshot.scene->instances[index].name}, {"matrix", rows}}
            .dump());
  }
}

// Everything that `render` and `run` have no option for.
std::vector<std::string> scriptLines(const Snapshot& snapshot) {
  std::vector<std::string> lines;
  addMaterialLines(lines, snapshot);
  addLightLines(lines, snapshot);
  addTransformLines(lines, snapshot);
  const float frame = snapshot.state.frame;
  if (frame != std::floor(frame) || (frame != 0.0f && !lines.empty()))
    lines.push_back(ordered_json{{"do", "time"}, {"frame", frame}}.dump());
  return lines;
}

void append(std::vector<std::string>& list, const std::vector<std::string>& more) {
  list.insert(list.end(), more.begin(), more.end());
}

// A session that executes these lines.
std::string sessionCommand(const Snapshot& snapshot, const std::vector<std::string>& lines) {
  std::string command = "printf '%s\\n'";
  for (const std::string& line : lines) command += " " + shellQuoted(line);
  std::vector<std::string> arguments;
  const std::string scene = snapshot.request->render.scene.string();
  if (!scene.empty()) arguments.push_back(scene);
  append(arguments, {"--program", snapshot.state.program});
  append(arguments, commonOptions(snapshot));
  append(arguments, {"--script", "-"});
  return command + " | " + cli::commandLine("view", arguments);
}

std::string scriptCommand(const Snapshot& snapshot, std::vector<std::string> lines) {
  const interactive::SessionState& state = snapshot.state;
  if (state.output != snapshot.program->outputs.front().name)
    lines.push_back(ordered_json{{"do", "output"}, {"name", state.output}}.dump());
  if (state.exposure != 0.0) lines.push_back(ordered_json{{"do", "exposure"}, {"stops", state.exposure}}.dump());
  const std::vector<std::string> display = displayOptions(state);
  if (state.toneMap) lines.push_back(ordered_json{{"do", "tonemap"}, {"name", display.back()}}.dump());
  lines.push_back(R"({"do":"save","file":"image.png"})");
  return sessionCommand(snapshot, lines);
}

}  // namespace

std::string reproducingCommand(const Snapshot& snapshot) {
  if (const std::vector<std::string> lines = scriptLines(snapshot); !lines.empty())
    return scriptCommand(snapshot, lines);
  const interactive::SessionState& state = snapshot.state;
  const std::string scene = snapshot.request->render.scene.string();
  const bool firstOutput = state.output == snapshot.program->outputs.front().name;
  const bool renders = !scene.empty() && firstOutput && state.frame == 0.0f;
  std::vector<std::string> arguments;
  if (renders) {
    arguments = {scene, "-o", "image.png"};
    if (state.program != "pathtracer") append(arguments, {"--program", state.program});
  } else {
    arguments = {state.program};
    if (!scene.empty()) arguments.push_back(scene);
    append(arguments, {"-o", "image.png"});
    if (!firstOutput) append(arguments, {"--output", state.output});
    if (state.frame != 0.0f) append(arguments, {"--frame", fmt::format("{:.0f}", state.frame)});
  }
  append(arguments, commonOptions(snapshot));
  append(arguments, displayOptions(state));
  return cli::commandLine(renders ? "render" : "run", arguments);
}

std::string explainingCommand(const Snapshot& snapshot, uvec2 pixel, std::uint32_t sample) {
  if (std::vector<std::string> lines = scriptLines(snapshot); !lines.empty()) {
    lines.push_back(
        ordered_json{{"do", "explain"}, {"x", pixel.x}, {"y", pixel.y}, {"sample", sample}, {"file", "pixel.json"}}
            .dump());
    return sessionCommand(snapshot, lines);
  }
  const interactive::SessionState& state = snapshot.state;
  const std::string scene = snapshot.request->render.scene.string();
  std::vector<std::string> arguments;
  if (!scene.empty()) arguments.push_back(scene);
  append(arguments, {"--pixel", fmt::format("{},{}", pixel.x, pixel.y)});
  if (sample != 0) append(arguments, {"--sample", std::to_string(sample)});
  if (state.program != "pathtracer") append(arguments, {"--program", state.program});
  if (state.frame != 0.0f) append(arguments, {"--frame", fmt::format("{:.0f}", state.frame)});
  append(arguments, commonOptions(snapshot));
  return cli::commandLine("explain-pixel", arguments);
}

}  // namespace quintet::viewer
