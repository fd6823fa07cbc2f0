// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "base/text.h"
#include "gui/widgets.h"
#include "panels/panels.h"
#include "view_files.h"
#include "viewer/labels.h"

namespace quintet::viewer {
namespace {

constexpr std::size_t kListRows = 10;  // of the tree

// Rows whose names contain `filter`, and those alone if there are many.
template <class Name>
void list(ViewState& state, Selection::Kind kind, std::size_t count, const std::string& filter, const Name& nameOf) {
  const std::string wanted = lowerCase(filter);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < count; ++i)
    if (wanted.empty() || lowerCase(nameOf(i)).find(wanted) != std::string::npos) rows.push_back(i);
  // A selection in the image scrolls the list to its row.
  static Selection revealed;
  const bool reveals = state.selection.kind == kind && state.selection != revealed;
  const auto selectedRow = std::ranges::find(rows, state.selection.index);
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()));
  if (reveals && selectedRow != rows.end()) {
    const auto row = static_cast<int>(selectedRow - rows.begin());
    clipper.ForceDisplayRangeByIndices(row, row + 1);
  }
  while (clipper.Step()) {
    for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row) {
      const std::size_t index = rows[static_cast<std::size_t>(row)];
      const bool selected = state.selection.kind == kind && state.selection.index == index;
      const std::string& name = nameOf(index);
      const std::string shown = fittingText(name, ImGui::GetContentRegionAvail().x);
      if (listRow(fmt::format("{}##{}", shown, index).c_str(), selected)) state.selection = revealed = {kind, index};
      logControl(name.c_str());
      if (shown != name) tooltip(name);
      if (selected && reveals) {
        ImGui::SetScrollHereY();
        revealed = state.selection;
      }
      if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0) && kind == Selection::Kind::instance)
        state.apply(job::interactive::Frame{name});
    }
  }
}

bool treeGroup(const char* name, std::size_t count, bool open) {
  if (count == 0) return false;
  const ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_SpanAvailWidth | (open ? int{ImGuiTreeNodeFlags_DefaultOpen} : 0);
  return ImGui::TreeNodeEx(name, flags, "%s (%zu)", name, count);
}

constexpr const char* kReopens = ". The file is read again: edits of materials, lights and objects are lost";

void variantChoice(ViewState& state, const std::vector<std::string>& variants) {
  if (variants.empty()) return;
  std::vector<std::string> names{"default materials"};
  names.insert(names.end(), variants.begin(), variants.end());
  const std::string& current = state.snapshot->request->render.load.variant;
  auto index = static_cast<std::size_t>(std::ranges::find(variants, current) - variants.begin()) + 1;
  if (current.empty()) index = 0;
  if (choiceField("Variant", index, names, std::string("Material variant of the file") + kReopens))
    reopenScene(state,
                [&](job::RenderRequest& request) { request.load.variant = index == 0 ? "" : variants[index - 1]; });
}

// By index, because names need not be unique.
void animationChoice(ViewState& state, const std::vector<std::string>& animations) {
  if (animations.empty()) return;
  std::vector<std::string> names{"rest pose"};
  names.insert(names.end(), animations.begin(), animations.end());
  const std::string& current = state.snapshot->request->render.animation;
  std::size_t index = 1;
  for (std::size_t i = 1; i <= animations.size(); ++i)
    if (current == std::to_string(i - 1)) index = i;
  for (std::size_t i = animations.size(); i > 0; --i)
    if (current == animations[i - 1]) index = i;
  if (current == "none") index = 0;
  if (choiceField("Animation", index, names, std::string("Animation of the file that plays") + kReopens))
    reopenScene(state, [&](job::RenderRequest& request) {
      request.animation = index == 0 ? "none" : std::to_string(index - 1);
    });
}

}  // namespace

void scenePanel(ViewState& state) {
  const SceneOutline& scene = *state.snapshot->scene;
  static std::string filter;
  textRow("Scene", scene.name.empty() ? "built-in scene" : scene.name);
  if (scene.triangles.stored > 0) textRow("Triangles", groupedDigits(scene.triangles.stored));
  if (scene.triangles.instanced != scene.triangles.stored)
    textRow("In all instances", groupedDigits(scene.triangles.instanced));
  variantChoice(state, scene.variants);
  animationChoice(state, scene.animations);
  if (scene.instances.size() + scene.materials.size() > 20)
    searchField("Filter", filter, "Show only names that contain this text");
  else
    filter.clear();
  std::size_t rows = 0;
  for (const std::size_t count : {scene.instances.size(), scene.materials.size(), scene.lights.size()})
    rows += count > 0 ? count + 1 : 0;
  const float height =
      static_cast<float>(std::clamp(rows, std::size_t{3}, kListRows)) * ImGui::GetTextLineHeightWithSpacing();
  ImGui::BeginChild("tree", {0, height + 2.0f * ImGui::GetStyle().WindowPadding.y}, true);
  if (treeGroup("Objects", scene.instances.size(), true)) {
    list(state, Selection::Kind::instance, scene.instances.size(), filter,
         [&](std::size_t i) -> const std::string& { return scene.instances[i].name; });
    ImGui::TreePop();
  }
  if (treeGroup("Materials", scene.materials.size(), true)) {
    list(state, Selection::Kind::material, scene.materials.size(), filter,
         [&](std::size_t i) -> const std::string& { return scene.materialNames[i]; });
    ImGui::TreePop();
  }
  if (treeGroup("Lights", scene.lights.size(), true)) {
    list(state, Selection::Kind::light, scene.lights.size(), filter,
         [&](std::size_t i) -> const std::string& { return scene.lightNames[i]; });
    ImGui::TreePop();
  }
  ImGui::EndChild();
}

void selectionPanel(ViewState& state) {
  const SceneOutline& scene = *state.snapshot->scene;
  switch (state.selection.kind) {
    case Selection::Kind::none: ImGui::TextDisabled("Click an object in the image or in the list."); break;
    case Selection::Kind::instance:
      if (state.selection.index < scene.instances.size()) instanceProperties(state, state.selection.index);
      break;
    case Selection::Kind::material:
      if (state.selection.index < scene.materials.size()) materialProperties(state, state.selection.index);
      break;
    case Selection::Kind::light:
      if (state.selection.index < scene.lights.size()) lightProperties(state, state.selection.index);
      break;
  }
}

}  // namespace quintet::viewer
