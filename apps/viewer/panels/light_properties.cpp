// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <imgui.h>

#include "gui/widgets.h"
#include "job/interactive/light_properties.h"
#include "panels/panels.h"
#include "scene/model/names.h"

namespace quintet::viewer {

void lightProperties(ViewState& state, std::size_t index) {
  namespace interactive = job::interactive;
  const SceneOutline& scene = *state.snapshot->scene;
  const interactive::LightState light = lightOf(scene, state.snapshot->state, index);
  const std::string& name = scene.lightNames[index];
  const scene::LightType type = light.light.type;
  const auto set = [&](const char* property, std::vector<double> numbers) {
    state.apply(interactive::EditLight{name, {{property, std::move(numbers)}}});
  };
  ImGui::PushID("light");
  ImGui::PushID(static_cast<int>(index));
  textRow("Light", name);
  textRow("Type", nameOf(type));
  bool on = light.on;
  if (checkBox("On", on)) set("on", {on ? 1.0 : 0.0});
  vec3 color = interactive::lightIntensity(light.light) > 0.0f ? interactive::lightColor(light.light) : light.color;
  if (colorField("Color", color, "Linear Rec. 709")) set("color", {color.r, color.g, color.b});
  double intensity = interactive::lightIntensity(light.light);
  if (numberField("Intensity", intensity,
                  {.least = 0.0, .most = 1e9, .unit = type == scene::LightType::directional ? "W/m²" : "W/sr"}))
    set("intensity", {intensity});
  if (type != scene::LightType::directional) {
    const vec3 p = light.light.position;
    double position[3] = {p.x, p.y, p.z};
    if (vectorField("Position", position, 3, {}, "World space, meters"))
      set("position", {position[0], position[1], position[2]});
  }
  if (type != scene::LightType::point) {
    const vec3 d = light.light.direction;
    double direction[3] = {d.x, d.y, d.z};
    if (vectorField("Direction", direction, 3, {.least = -1.0, .most = 1.0}, "Direction in which the light travels") &&
        glm::length(vec3(direction[0], direction[1], direction[2])) > 1e-4f)
      set("direction", {direction[0], direction[1], direction[2]});
  }
  if (type == scene::LightType::spot) {
    const double outer = glm::degrees(light.light.outerConeAngle), inner = glm::degrees(light.light.innerConeAngle);
    double edited = outer;
    if (numberField("Outer angle", edited, {.least = inner, .most = 90.0, .unit = "°"}))
      set("outerConeAngle", {edited});
    edited = inner;
    if (numberField("Inner angle", edited, {.least = 0.0, .most = outer, .unit = "°"})) set("innerConeAngle", {edited});
  }
  ImGui::PopID();
  ImGui::PopID();
}

void environmentPanel(ViewState& state) {
  namespace interactive = job::interactive;
  const interactive::SessionState& session = state.snapshot->state;
  const job::EnvironmentRequest& environment = session.environment;
  bool on = session.environmentOn;
  if (checkBox("On", on, "The environment emits light")) state.apply(interactive::SetEnvironment{.on = on});
  double intensity = environment.intensity.value_or(1.0f);
  if (numberField("Intensity", intensity, {.least = 0.0, .most = 1e6}, "Factor"))
    state.apply(interactive::SetEnvironment{.intensity = static_cast<float>(intensity)});
  double rotation = environment.rotation.value_or(0.0f);
  if (numberField("Rotation", rotation, {.least = -180.0, .most = 180.0, .unit = "°"},
                  "About the vertical axis, counter-clockwise seen from above"))
    state.apply(interactive::SetEnvironment{.rotation = static_cast<float>(rotation)});
  std::string source = environment.source;
  if (textField(
          "Source", source,
          "A file, 'none', 'default', or a color R,G,B; empty: that of the scene. An .hdr or .exr file can also be "
          "dropped on the window"))
    state.apply(interactive::SetEnvironment{.source = source});
}

}  // namespace quintet::viewer
