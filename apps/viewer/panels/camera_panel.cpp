// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "gui/widgets.h"
#include "panels/panels.h"
#include "view_files.h"

namespace quintet::viewer {
namespace {

void lens(ViewState& state) {
  namespace interactive = job::interactive;
  const scene::Camera& camera = state.snapshot->camera;
  if (camera.orthographic) {
    ImGui::TextDisabled("Orthographic camera: no navigation.");
    return;
  }
  double fov = glm::degrees(camera.verticalFov);
  if (numberField("Field of view", fov, {.least = 1.0, .most = 150.0, .unit = "°"}, "Vertical"))
    state.apply(interactive::SetLens{.verticalFov = static_cast<float>(fov)});
  const double size = state.snapshot->scene->size;
  double aperture = camera.apertureRadius;
  if (numberField("Aperture", aperture, {.least = 0.0, .most = 0.05 * size, .unit = "m"},
                  "Radius of the lens; 0 is a pinhole, with which everything is sharp"))
    state.apply(interactive::SetLens{.apertureRadius = static_cast<float>(aperture)});
  double focus = camera.focusDistance;
  if (numberField("Focus", focus, {.least = 1e-3, .most = 1e6, .unit = "m"},
                  "Distance of sharp objects. A double click on an object sets it"))
    state.apply(interactive::SetLens{.focusDistance = static_cast<float>(focus)});
}

void bookmarks(ViewState& state) {
  namespace interactive = job::interactive;
  const std::string scene = sceneKey(*state.snapshot);
  const std::vector<Bookmark> list = state.bookmarks.of(scene);
  ImGui::TextDisabled("Bookmarks");
  for (std::size_t i = 0; i < list.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Selectable(list[i].name.c_str(), false, ImGuiSelectableFlags_AllowDoubleClick,
                          {ImGui::GetContentRegionAvail().x - 2.0f * ImGui::GetFrameHeight(), 0}))
      state.apply(interactive::SetCamera{list[i].camera});
    ImGui::SameLine();
    if (ImGui::SmallButton("×")) removeBookmark(state, list[i]);
    tooltip("Remove this bookmark");
    ImGui::PopID();
  }
  if (button("Add bookmark", "Keep this camera (B)")) addBookmark(state);
}

}  // namespace

void cameraPanel(ViewState& state) {
  namespace interactive = job::interactive;
  const SceneOutline& scene = *state.snapshot->scene;
  if (!scene.cameras.empty()) {
    std::vector<std::string> names = scene.cameras;
    const job::CameraRequest& camera = state.snapshot->state.camera;
    std::size_t index = camera.lookFrom ? names.size() : 0;
    for (std::size_t i = 0; i < names.size(); ++i)
      if (!camera.lookFrom && (camera.name == names[i] || camera.name == std::to_string(i))) index = i;
    names.emplace_back("moved");
    if (choiceField("Camera", index, names, "Cameras of the scene file") && index < scene.cameras.size())
      state.apply(interactive::SetCamera{{.name = std::to_string(index)}});
  }
  lens(state);
  bookmarks(state);
}

}  // namespace quintet::viewer
