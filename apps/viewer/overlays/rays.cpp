// SPDX-License-Identifier: Apache-2.0
// The rays of the explained pixel over the image: their lines, the legend, and selection with the pointer.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <imgui.h>

#include "gui/gui.h"
#include "gui/widgets.h"
#include "overlay/ray_overlay.h"
#include "overlays/overlays.h"

namespace quintet::viewer {
namespace {

constexpr float kPointerDistance = 6.0f;  // pixels at scale 1
constexpr float kLegendArea = 0.2f;       // the legend covers at most this fraction of the image

bool sameView(const scene::Camera& a, const scene::Camera& b) {
  return a.worldFromCamera == b.worldFromCamera && a.orthographic == b.orthographic && a.verticalFov == b.verticalFov &&
         a.orthographicHalfSize == b.orthographicHalfSize;
}

// The depths of the shown view; null while they are not known.
std::shared_ptr<const job::DepthMap> shownDepth(const ViewState& state) {
  const Snapshot& snapshot = *state.snapshot;
  const bool fits = snapshot.depth && snapshot.depth->size == state.placement.size &&
                    sameView(snapshot.depth->camera, snapshot.camera);
  return fits ? snapshot.depth : nullptr;
}

overlay::OverlayView viewOf(const ViewState& state) { return {state.snapshot->camera, state.placement}; }

}  // namespace

void updateRays(ViewState& state) {
  ShownRays& rays = state.rays;
  const bool usesCamera = state.snapshot->explanationUsesCamera;
  if (rays.explanation != state.explanation) {
    rays.explanation = state.explanation;
    rays.paths.reset();
    rays.lines = {};
    if (state.explanation) rays.paths = overlay::rayOverlay(*state.explanation, state.snapshot->scene->size);
    if (rays.paths && rays.paths->rays.empty()) rays.paths.reset();
    if (rays.paths && !usesCamera) {
      rays.paths.reset();
      state.addMessage(
          {Message::Kind::note, "the rays are not drawn over the image, because the program has a camera of its own"});
    }
  } else if (rays.paths && !usesCamera) {  // the program has changed since
    rays.paths.reset();
    rays.lines = {};
  }
  if (rays.depthRequested == rays.visible()) return;
  rays.depthRequested = rays.visible();
  state.session->showDepth(rays.depthRequested);
}

void rayLines(ViewState& state, const Area& area) {
  state.rays.lines = {};
  if (!state.rays.visible()) return;
  const float pixels = ImGui::GetIO().DisplayFramebufferScale.x;  // of the target, per unit of ImGui
  overlay::OverlayView view = viewOf(state);
  view.placement.origin *= pixels;
  view.placement.scale *= pixels;
  state.rays.depth = shownDepth(state);
  state.rays.lines =
      overlay::overlayLines(*state.rays.paths, view, {pixels * state.scale, state.selectedRay}, state.rays.depth.get());
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.PushClipRect({area.origin.x, area.origin.y}, {area.origin.x + area.size.x, area.origin.y + area.size.y});
  list.AddCallback(drawExternally, nullptr);
  list.PopClipRect();
  const ImVec2 pointer = ImGui::GetIO().MousePos;
  if (!Gui::wantsMouse() &&
      overlay::rayAt(*state.rays.paths, viewOf(state), {pointer.x, pointer.y}, kPointerDistance * state.scale))
    ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
}

void rayLegendBox(const ViewState& state, const Area& area) {
  if (!state.rays.visible()) return;
  const std::vector<overlay::RayLegendEntry> entries = overlay::rayLegend(*state.rays.paths);
  const float scale = state.scale;
  const float row = ImGui::GetTextLineHeightWithSpacing();
  const float sample = 26.0f * scale, margin = 10.0f * scale;
  float textWidth = 0.0f;
  for (const overlay::RayLegendEntry& entry : entries)
    textWidth = std::max(textWidth, ImGui::CalcTextSize(entry.text.c_str()).x);
  const ImVec2 size{sample + textWidth + 3.0f * margin, static_cast<float>(entries.size()) * row + 2.0f * margin};
  const ImVec2 end{area.origin.x + area.size.x - margin, area.origin.y + area.size.y - margin};
  const ImVec2 begin{end.x - size.x, end.y - size.y};
  const bool fits = size.x * size.y <= kLegendArea * area.size.x * area.size.y;
  if (entries.empty() || !fits || begin.x < area.origin.x || begin.y < area.origin.y) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled(begin, end, kShade, 6.0f * scale);
  float y = begin.y + margin + 0.5f * ImGui::GetTextLineHeight();
  for (const overlay::RayLegendEntry& entry : entries) {
    ImVec4 color = ImGui::ColorConvertU32ToFloat4(entry.color);
    const float left = begin.x + margin, width = 2.0f * scale;
    if (entry.hidden) {
      color.w = gpu::LineList{}.hiddenOpacity;
      for (float x = 0.0f; x < sample; x += 10.0f * scale)
        list.AddLine({left + x, y}, {left + x + 5.0f * scale, y}, ImGui::ColorConvertFloat4ToU32(color), width);
    } else {
      list.AddLine({left, y}, {left + sample, y}, ImGui::ColorConvertFloat4ToU32(color), width);
    }
    list.AddText({left + sample + margin, y - 0.5f * ImGui::GetTextLineHeight()}, kWhite, entry.text.c_str());
    y += row;
  }
  logControlAt("Legend of rays", {begin.x, begin.y}, {end.x, end.y});
}

bool selectRay(ViewState& state, vec2 position) {
  if (!state.rays.visible()) return false;
  const auto ray = overlay::rayAt(*state.rays.paths, viewOf(state), position, kPointerDistance * state.scale);
  if (ray && ray == state.selectedRay)
    state.selectRow(std::nullopt);
  else if (ray)
    state.selectedRay = ray;
  return ray.has_value();
}

}  // namespace quintet::viewer
