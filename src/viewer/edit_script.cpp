// SPDX-License-Identifier: Apache-2.0
#include "viewer/edit_script.h"

#include <cmath>
#include <cstddef>

#include <nlohmann/json.hpp>

#include "job/interactive/light_properties.h"
#include "job/interactive/material_properties.h"
#include "render/tone_map/tone_map.h"

namespace quintet::viewer {
namespace {

namespace interactive = job::interactive;
using nlohmann::ordered_json;

ordered_json numbersJson(const std::vector<double>& numbers) {
  if (numbers.size() == 1) return numbers.front();
  return numbers;
}

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

}  // namespace

std::vector<std::string> editScript(const Snapshot& snapshot) {
  std::vector<std::string> lines;
  addMaterialLines(lines, snapshot);
  addLightLines(lines, snapshot);
  addTransformLines(lines, snapshot);
  const float frame = snapshot.state.frame;
  if (frame != std::floor(frame) || (frame != 0.0f && !lines.empty()))
    lines.push_back(ordered_json{{"do", "time"}, {"frame", frame}}.dump());
  return lines;
}

std::vector<std::string> displayScript(const Snapshot& snapshot) {
  const interactive::SessionState& state = snapshot.state;
  std::vector<std::string> lines;
  if (state.output != snapshot.program->outputs.front().name)
    lines.push_back(ordered_json{{"do", "output"}, {"name", state.output}}.dump());
  if (state.exposure != 0.0) lines.push_back(ordered_json{{"do", "exposure"}, {"stops", state.exposure}}.dump());
  if (state.toneMap)
    for (const std::string& name : render::toneMapNames())
      if (render::toneMapByName(name) == state.toneMap)
        lines.push_back(ordered_json{{"do", "tonemap"}, {"name", name}}.dump());
  return lines;
}

}  // namespace quintet::viewer
