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
#include "render/tone_map/tone_map.h"
#include "scene/load.h"
#include "viewer/edit_script.h"

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
  append(lines, displayScript(snapshot));
  lines.push_back(R"({"do":"save","file":"image.png"})");
  return sessionCommand(snapshot, lines);
}

}  // namespace

std::string reproducingCommand(const Snapshot& snapshot) {
  if (const std::vector<std::string> lines = editScript(snapshot); !lines.empty())
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

std::vector<std::string> viewArguments(const Snapshot& snapshot, bool fixedSize) {
  Snapshot shown = snapshot;
  if (!shown.program) {  // the state is that of the request
    const interactive::SessionRequest& request = *snapshot.request;
    shown.state.program = request.program;
    shown.state.parameterFile = request.render.parameterFile;
    shown.state.assignments = request.render.assignments;
    shown.state.camera = request.render.camera;
    shown.state.environment = request.render.environment;
    shown.state.size = request.render.size;
    if (request.render.limits.samples) shown.state.samples = static_cast<std::uint32_t>(*request.render.limits.samples);
  }
  std::vector<std::string> arguments;
  const std::string scene = snapshot.request->render.scene.string();
  if (!scene.empty()) arguments.push_back(scene);
  append(arguments, {"--program", shown.state.program});
  std::vector<std::string> options = commonOptions(shown);
  if (!fixedSize) options.erase(options.begin(), options.begin() + 2);  // --size, which is the first one
  append(arguments, options);
  return arguments;
}

std::string explainingCommand(const Snapshot& snapshot, uvec2 pixel, std::uint32_t sample) {
  if (std::vector<std::string> lines = editScript(snapshot); !lines.empty()) {
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
