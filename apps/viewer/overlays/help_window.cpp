// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <string_view>

#include <imgui.h>

#include "overlays/overlays.h"
#include "viewer/bindings.h"
#include "viewer/labels.h"

namespace quintet::viewer {
namespace {

void row(const std::string& keys, std::string_view text) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(keys.c_str());
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
}

bool beginTable(const char* name, float scale) {
  if (!ImGui::BeginTable(name, 2, ImGuiTableFlags_RowBg)) return false;
  ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed, 150.0f * scale);
  ImGui::TableSetupColumn("text");
  return true;
}

}  // namespace

void helpWindow(ViewState& state) {
  if (!state.showHelp) return;
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * display.x, 0.5f * display.y}, ImGuiCond_Appearing, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(560.0f * state.scale, display.x), std::min(620.0f * state.scale, display.y)},
                           ImGuiCond_Appearing);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 6.0f * state.scale);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1.0f);
  if (ImGui::Begin("Mouse and keyboard", &state.showHelp,
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse)) {
    const BindingSet& set = bindingSet(state.settings.bindings);
    for (const BindingSet& choice : bindingSets()) {
      if (ImGui::RadioButton(std::string(choice.name).c_str(), &choice == &set)) state.settings.bindings = choice.name;
      ImGui::SameLine(0.0f, 20.0f * state.scale);
    }
    ImGui::NewLine();
    ImGui::Spacing();
    if (beginTable("mouse", state.scale)) {
      for (const DragBinding& binding : set.drags) row(capitalized(dragText(binding)), description(binding.drag));
      row("Wheel", "Move closer to what is below the pointer, or away");
      row("Click", "Select the object");
      row("Ctrl + click", description(Action::explain));
      row("Double click", "Set orbit center and focus distance");
      for (const FlyBinding& binding : set.flies)
        row(std::string(binding.key) + (set.flyNeedsButton ? " while looking around" : ""), description(binding.fly));
      row("Shift", "Move faster");
      ImGui::EndTable();
    }
    ImGui::Spacing();
    if (beginTable("keys", state.scale)) {
      for (int i = 0; i <= static_cast<int>(Action::quit); ++i) {
        const std::string keys = keysOf(set, static_cast<Action>(i));
        if (!keys.empty()) row(keys, description(static_cast<Action>(i)));
      }
      ImGui::EndTable();
    }
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
}

}  // namespace quintet::viewer
