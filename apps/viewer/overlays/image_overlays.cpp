// SPDX-License-Identifier: Apache-2.0
// Drawn on the image: the legend of false color, the line of the comparison, messages, and the problems of the program.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "base/diagnostic.h"
#include "gui/style.h"
#include "gui/widgets.h"
#include "overlay/box_outline.h"
#include "overlays/overlays.h"
#include "viewer/labels.h"

namespace quintet::viewer {
namespace {

constexpr ImU32 kPrinted = IM_COL32(110, 200, 255, 255);
constexpr ImU32 kNotFinite = IM_COL32(255, 0, 255, 255);
constexpr ImU32 kSelected = IM_COL32(255, 170, 60, 255);

ImU32 toColor(const vec3& color) {
  return IM_COL32(static_cast<int>(255.0f * color.r + 0.5f), static_cast<int>(255.0f * color.g + 0.5f),
                  static_cast<int>(255.0f * color.b + 0.5f), 255);
}

ImVec4 severityColor(Severity severity, Theme theme) {
  const Palette& colors = palette(theme);
  return severity == Severity::error ? colors.error : severity == Severity::warning ? colors.warning : colors.note;
}

ImVec4 messageColor(Message::Kind kind, Theme theme) {
  const Palette& colors = palette(theme);
  return kind == Message::Kind::error ? colors.error : kind == Message::Kind::warning ? colors.warning : colors.note;
}

// What the colors of the image mean; nothing if they are those of the scene.
std::optional<FalseColorRange> shownRange(const ViewState& state) {
  const CompareMode compare = state.reference ? state.controls.compare : CompareMode::off;
  if (compare == CompareMode::difference) return FalseColorRange{0.0, state.controls.range.most, false};
  if (compare == CompareMode::flip) return FalseColorRange{0.0, 1.0, false};
  if (state.controls.falseColor) return state.controls.range;
  if (state.display) return state.display->heatRange;
  return std::nullopt;
}

}  // namespace

void selectionOutline(const ViewState& state, const Area& area) {
  const SceneOutline& scene = *state.snapshot->scene;
  if (state.selection.kind != Selection::Kind::instance || state.selection.index >= scene.instances.size()) return;
  const InstanceOutline& instance = scene.instances[state.selection.index];
  if (instance.animated) return;  // the snapshot has no transform of this frame
  const overlay::ImagePlacement& at = state.placement;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.PushClipRect({area.origin.x, area.origin.y}, {area.origin.x + area.size.x, area.origin.y + area.size.y});
  for (const auto& [a, b] : overlay::boxOutline(state.snapshot->camera, at.size, instance.bounds,
                                                transformOf(scene, state.snapshot->state, state.selection.index))) {
    const vec2 from = at.origin + at.scale * a, to = at.origin + at.scale * b;
    list.AddLine({from.x, from.y}, {to.x, to.y}, kShade, 3.0f * state.scale);
    list.AddLine({from.x, from.y}, {to.x, to.y}, kSelected, 1.3f * state.scale);
  }
  list.PopClipRect();
}

void explainedPixel(const ViewState& state, const Area& area) {
  const overlay::ImagePlacement& at = state.placement;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.PushClipRect({area.origin.x, area.origin.y}, {area.origin.x + area.size.x, area.origin.y + area.size.y});
  const auto mark = [&](const render::Region& pixels, ImU32 color) {
    const float margin = 3.0f * state.scale;
    const vec2 begin = at.origin + at.scale * vec2(pixels.x, pixels.y) - margin;
    const vec2 end = at.origin + at.scale * vec2(pixels.x + pixels.width, pixels.y + pixels.height) + margin;
    list.AddRect({begin.x, begin.y}, {end.x, end.y}, kShade, 0.0f, 0, 3.5f * state.scale);
    list.AddRect({begin.x, begin.y}, {end.x, end.y}, color, 0.0f, 0, 1.5f * state.scale);
  };
  if (const auto& print = state.snapshot->print; print && !print->all) mark(print->pixels, kPrinted);
  if (state.explanation && state.explanation->size == state.snapshot->state.size)
    mark({state.explanation->pixel.x, state.explanation->pixel.y, 1, 1}, kWhite);
  list.PopClipRect();
}

void notFinitePixels(const ViewState& state, const Area& area) {
  if (!state.controls.marksNotFinite || !state.snapshot->image) return;
  const io::Image& image = *state.snapshot->image;
  const overlay::ImagePlacement& at = state.placement;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.PushClipRect({area.origin.x, area.origin.y}, {area.origin.x + area.size.x, area.origin.y + area.size.y});
  // Images of reduced resolution have larger pixels.
  const vec2 pixel = at.scale * vec2(at.size) / vec2(image.width, image.height);
  const auto mark = [&](uvec2 position) {
    const vec2 center = at.origin + pixel * (vec2(position) + 0.5f);
    const float radius = 0.7f * std::max(pixel.x, pixel.y) + 4.0f * state.scale;
    list.AddCircle({center.x, center.y}, radius, kShade, 0, 3.5f * state.scale);
    list.AddCircle({center.x, center.y}, radius, kNotFinite, 0, 1.5f * state.scale);
  };
  // Where many are close to each other, their color shows them.
  if (state.display && state.display->histogram.notFinitePixels <= kMaxNotFinite)
    for (const uvec2 position : state.display->notFinite) mark(position);
  for (const uvec2 position : state.snapshot->droppedPixels) mark(position);
  list.PopClipRect();
}

// The width of the widest text, but not more than a note has room for over the image.
float noteWidth(const ViewState& state, const Area& area, std::initializer_list<const char*> texts) {
  float width = 0.0f;
  for (const char* text : texts) width = std::max(width, ImGui::CalcTextSize(text).x);
  const float room = area.size.x - 2.0f * ImGui::GetStyle().WindowPadding.x - 12.0f * state.scale;
  return std::clamp(room, std::min(60.0f * state.scale, width), width);
}

void sizeNote(ViewState& state, const Area& area) {
  if (!state.keptSize) return;
  const Snapshot& snapshot = *state.snapshot;
  const std::string label = fmt::format("Render at {} × {}##fit", state.viewSize.x, state.viewSize.y);
  ImGui::SetNextWindowPos({area.origin.x + 12.0f * state.scale, area.origin.y + area.size.y - 12.0f * state.scale},
                          ImGuiCond_Always, {0.0f, 1.0f});
  ImGui::SetNextWindowBgAlpha(0.9f);
  ImGui::Begin("size", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize);
  const std::string text = fmt::format("The image of {} × {} is scaled.", snapshot.state.size.x, snapshot.state.size.y);
  const float width = noteWidth(state, area, {text.c_str()});
  ImGui::AlignTextToFramePadding();
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  if (area.size.x > 2.5f * width) ImGui::SameLine();  // the button is about as wide as the text
  if (button(label.c_str(), fmt::format("Discards the samples of {:.0f} s (key 0)", snapshot.progress.seconds)))
    state.fitsImage = true;
  ImGui::End();
}

void waitingNote(ViewState& state, const Area& area) {
  constexpr double kShownAfter = 0.3, kStopAfter = 5.0;  // seconds
  if (!state.waitingSince || state.time - *state.waitingSince < kShownAfter) return;
  const Snapshot& snapshot = *state.snapshot;
  const double blocked = state.session->blockedSeconds();
  const bool first = !snapshot.image;
  const double seconds = first ? state.time - *state.waitingSince : std::max(state.time - *state.waitingSince, blocked);
  const std::string work = snapshot.explaining       ? "Explaining the pixel"
                           : !snapshot.stage.empty() ? capitalized(snapshot.stage)
                           : first                   ? "Rendering the first image; the driver compiles the shaders"
                                                     : "A launch takes long";
  const std::string progress = fmt::format("{}... {:.0f} s", work, seconds);
  constexpr const char* kAdvice = "If a shader does not end, save its repaired file, or stop the work.";
  const bool canStop = blocked > kStopAfter;
  const float width = noteWidth(state, area, {progress.c_str(), canStop ? kAdvice : ""});
  // At the center of the area, or at its top over an image.
  const float y = first ? 0.5f * area.size.y : 12.0f * state.scale;
  ImGui::SetNextWindowPos({area.origin.x + 0.5f * area.size.x, area.origin.y + y}, ImGuiCond_Always,
                          {0.5f, first ? 0.5f : 0.0f});
  ImGui::SetNextWindowBgAlpha(0.9f);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 6.0f * state.scale);
  ImGui::Begin("waiting", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width);
  ImGui::TextUnformatted(progress.c_str());
  logControl("Waiting");
  if (canStop) {
    ImGui::TextDisabled("%s", kAdvice);
    if (button("Stop", "End the work. The scene is opened again when a file of the program is saved"))
      state.stopsWork = true;
  }
  ImGui::PopTextWrapPos();
  ImGui::End();
  ImGui::PopStyleVar();
}

void legend(const ViewState& state, const Area& area) {
  const std::optional<FalseColorRange> range = shownRange(state);
  if (!range || area.size.x < 160.0f || area.size.y < 160.0f) return;
  const float scale = state.scale;
  const float height = std::min(220.0f * scale, 0.6f * area.size.y);
  const float width = 14.0f * scale;
  const float margin = 12.0f * scale;
  const ImVec2 bottom{area.origin.x + 2.0f * margin, area.origin.y + area.size.y - 2.0f * margin};
  const ImVec2 top{bottom.x, bottom.y - height};
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const std::vector<LegendTick> ticks = legendTicks(*range, 6);
  float textWidth = 0.0f;
  for (const LegendTick& tick : ticks) textWidth = std::max(textWidth, ImGui::CalcTextSize(tick.label.c_str()).x);
  list.AddRectFilled({top.x - margin, top.y - margin}, {top.x + width + textWidth + 2.0f * margin, bottom.y + margin},
                     kShade, 6.0f * scale);
  constexpr int kSteps = 64;
  for (int i = 0; i < kSteps; ++i) {
    const float from = static_cast<float>(i) / kSteps, to = static_cast<float>(i + 1) / kSteps;
    const ImU32 low = toColor(falseColor(from)), high = toColor(falseColor(to));
    list.AddRectFilledMultiColor({top.x, bottom.y - to * height}, {top.x + width, bottom.y - from * height}, high, high,
                                 low, low);
  }
  const float textHeight = ImGui::GetTextLineHeight();
  for (const LegendTick& tick : ticks) {
    const float y = bottom.y - static_cast<float>(tick.position) * height;
    list.AddLine({top.x + width, y}, {top.x + width + 4.0f * scale, y}, kWhite);
    list.AddText({top.x + width + 7.0f * scale, y - 0.5f * textHeight}, kWhite, tick.label.c_str());
  }
}

void splitLine(ViewState& state, const Area& area) {
  if (!state.reference || state.controls.compare != CompareMode::split) return;
  const float scale = state.scale;
  const overlay::ImagePlacement& image = state.placement;
  const float width = image.scale * static_cast<float>(image.size.x);
  const float height = image.scale * static_cast<float>(image.size.y);
  const float x = std::round(image.origin.x + state.controls.split * width);
  const float grip = 7.0f * scale;
  ImGui::SetNextWindowPos({x - grip, area.origin.y});
  ImGui::SetNextWindowSize({2.0f * grip, area.size.y});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::Begin("split", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBackground |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::InvisibleButton("line", {2.0f * grip, std::max(area.size.y, 1.0f)});
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  if (ImGui::IsItemActive() && width > 0.0f)
    state.controls.split = std::clamp((ImGui::GetIO().MousePos.x - image.origin.x) / width, 0.0f, 1.0f);
  ImGui::End();
  ImGui::PopStyleVar();
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddLine({x, image.origin.y}, {x, image.origin.y + height}, kWhite, std::max(1.0f, scale));
  const uvec2 size = state.display ? state.display->referenceSize : uvec2(0);
  const bool isScaled = size.x > 0 && size != image.size;
  const std::string reference =
      isScaled ? fmt::format("reference {} × {}, scaled", size.x, size.y) : std::string("reference");
  const std::string labels[] = {"image", reference};
  for (int side = 0; side < 2; ++side) {
    const ImVec2 extent = ImGui::CalcTextSize(labels[side].c_str());
    const float left = side == 0 ? x - extent.x - 2.0f * grip : x + 2.0f * grip;
    const float top = image.origin.y + 8.0f * scale;
    list.AddRectFilled({left - 5.0f * scale, top - 2.0f * scale},
                       {left + extent.x + 5.0f * scale, top + extent.y + 2.0f * scale}, kShade, 4.0f * scale);
    list.AddText({left, top}, kWhite, labels[side].c_str());
  }
}

void diagnosticsDrawer(ViewState& state, const Area& area) {
  const std::vector<Diagnostic>& found = state.snapshot->diagnostics;
  if (found.empty() || !state.showDiagnostics) return;
  const float rows = std::min<float>(static_cast<float>(found.size()), 6.0f);
  const float height =
      std::min((rows + 2.2f) * ImGui::GetTextLineHeightWithSpacing() + 16.0f * state.scale, area.size.y);
  ImGui::SetNextWindowPos({area.origin.x, area.origin.y + area.size.y - height});
  ImGui::SetNextWindowSize({area.size.x, height});
  ImGui::SetNextWindowBgAlpha(0.94f);
  ImGui::Begin("diagnostics", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  const bool failed = hasErrors(found);
  ImGui::TextColored(severityColor(failed ? Severity::error : Severity::warning, state.settings.theme), "%s",
                     countText(found).c_str());
  if (state.snapshot->outdatedProgram) {
    ImGui::SameLine();
    ImGui::TextDisabled("The image shows the last version without errors.");
  }
  ImGui::SameLine(ImGui::GetWindowWidth() - ImGui::GetFrameHeight() - ImGui::GetStyle().WindowPadding.x);
  if (button("×##diagnostics", "Hide. View > Diagnostics shows them again")) state.showDiagnostics = false;
  ImGui::Separator();
  ImGui::BeginChild("list");
  for (const Diagnostic& diagnostic : found) {
    const std::string location = locationText(diagnostic.file, diagnostic.line, diagnostic.column);
    ImGui::TextColored(severityColor(diagnostic.severity, state.settings.theme), "%s", location.c_str());
    if (!location.empty()) ImGui::SameLine();
    ImGui::PushTextWrapPos(0.0f);
    const std::string text =
        diagnostic.id.empty() ? diagnostic.text : fmt::format("{} [{}]", diagnostic.text, diagnostic.id);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    for (const RelatedLocation& related : diagnostic.related)
      ImGui::TextDisabled("    %s: %s", locationText(related.file, related.line, related.column).c_str(),
                          related.text.c_str());
  }
  ImGui::EndChild();
  ImGui::End();
}

void toasts(ViewState& state, const Area& area) {
  std::erase_if(state.toasts, [&](const Toast& toast) { return toast.shownUntil <= state.time; });
  if (state.toasts.empty() || area.size.x < 120.0f * state.scale) return;
  const float width = std::min(440.0f * state.scale, area.size.x - 24.0f * state.scale);
  ImGui::SetNextWindowPos({area.origin.x + 12.0f * state.scale, area.origin.y + 12.0f * state.scale});
  ImGui::SetNextWindowSize({width, 0.0f});
  ImGui::SetNextWindowBgAlpha(0.9f);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 6.0f * state.scale);
  ImGui::Begin("messages", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs);
  ImGui::PushTextWrapPos(width - 12.0f * state.scale);
  for (const Toast& toast : state.toasts) {
    ImGui::PushStyleColor(ImGuiCol_Text, messageColor(toast.message.kind, state.settings.theme));
    ImGui::TextUnformatted(toast.message.text.c_str());
    ImGui::PopStyleColor();
    logControl(toast.message.text.c_str());
  }
  ImGui::PopTextWrapPos();
  ImGui::End();
  ImGui::PopStyleVar();
}

}  // namespace quintet::viewer
