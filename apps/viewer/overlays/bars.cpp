// SPDX-License-Identifier: Apache-2.0
// The bars below the image: progress and values of a pixel, and the animation.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "base/plural.h"
#include "gui/style.h"
#include "gui/widgets.h"
#include "overlays/overlays.h"

namespace quintet::viewer {
namespace {

constexpr ImGuiWindowFlags kBar = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                  ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;

void beginBar(const char* name, const Area& area) {
  ImGui::SetNextWindowPos({area.origin.x, area.origin.y});
  ImGui::SetNextWindowSize({area.size.x, area.size.y});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {ImGui::GetStyle().WindowPadding.x, 0.0f});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1.0f, 1.0f});
  ImGui::Begin(name, nullptr, kBar);
}

void endBar() {
  ImGui::End();
  ImGui::PopStyleVar(2);
}

std::string progressText(const Snapshot& snapshot) {
  const job::interactive::ImageUpdated& progress = snapshot.progress;
  std::string text =
      fmt::format("{} / {} {}", progress.samples, snapshot.state.samples, snapshot.countsFrames ? "frames" : "samples");
  text += fmt::format("   {} × {}", progress.size.x, progress.size.y);
  if (progress.factor > 1) text += fmt::format(" (1/{} resolution)", progress.factor);
  text += fmt::format("   {:.1f} s", progress.seconds);
  if (snapshot.raysPerSecond > 0) text += fmt::format("   {:.2f} Mrays/s", 1e-6 * snapshot.raysPerSecond);
  return text;
}

// The values of the pixel below the pointer. They are means, unlike those of Explain, which shows one sample.
std::string pixelText(const ViewState& state) {
  const io::Image* image = state.snapshot->image.get();
  if (!image || !state.hoveredPixel || state.snapshot->state.size.x == 0) return {};
  const uvec2 size = state.snapshot->state.size;
  const uvec2 at = *state.hoveredPixel * uvec2(image->width, image->height) / size;
  if (at.x >= image->width || at.y >= image->height) return {};
  const auto values = image->pixel<float>(at.x, at.y);
  const Snapshot& snapshot = *state.snapshot;
  std::string what;
  if (snapshot.state.output != snapshot.program->outputs.front().name) what = snapshot.state.output + ", ";
  if (snapshot.countsFrames)
    what += fmt::format("after {}", counted(snapshot.progress.samples, "frame"));
  else
    what += fmt::format("mean of {}", counted(snapshot.progress.samples, "sample"));
  return fmt::format("({}, {})   {}:   {:.4g}  {:.4g}  {:.4g}", state.hoveredPixel->x, state.hoveredPixel->y, what,
                     values[0], values[1], values[2]);
}

// "3 pixels are NaN or infinite"; empty if there are none.
std::string notFiniteText(const ViewState& state) {
  const std::uint64_t pixels = state.display ? state.display->histogram.notFinitePixels : 0;
  const std::uint64_t samples = state.snapshot->droppedSamples;
  if (pixels > 0) return fmt::format("{} {} NaN or infinite", counted(pixels, "pixel"), nounFor(pixels, "is", "are"));
  if (samples > 0) return fmt::format("{} NaN or infinite, discarded", counted(samples, "sample was", "samples were"));
  return {};
}

}  // namespace

float statusBarHeight() { return std::round(1.6f * ImGui::GetTextLineHeight()); }
float animationBarHeight() { return std::round(ImGui::GetFrameHeight() + 0.5f * ImGui::GetTextLineHeight()); }

void statusBar(const ViewState& state, const Area& area) {
  if (area.size.x < 2.0f || area.size.y < 2.0f) return;
  beginBar("status", area);
  const Snapshot& snapshot = *state.snapshot;
  ImGui::SetCursorPosY(0.5f * (area.size.y - ImGui::GetTextLineHeight()));
  if (state.ready()) {
    // Progress along the upper edge.
    const double share = snapshot.progress.factor > 1 || snapshot.state.samples == 0
                             ? 0.0
                             : static_cast<double>(snapshot.progress.samples) / snapshot.state.samples;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.PushClipRectFullScreen();
    list.AddRectFilled(
        {area.origin.x, area.origin.y},
        {area.origin.x + static_cast<float>(std::min(share, 1.0)) * area.size.x, area.origin.y + 2.0f * state.scale},
        ImGui::GetColorU32(ImGuiCol_CheckMark));
    list.PopClipRect();
    if (!snapshot.renderError.empty())
      ImGui::TextColored(palette(state.settings.theme).error, "%s", snapshot.renderError.c_str());
    else
      ImGui::TextUnformatted(progressText(snapshot).c_str());
    if (const std::string text = notFiniteText(state); !text.empty()) {
      ImGui::SameLine(0.0f, 2.0f * ImGui::GetFontSize());
      ImGui::TextColored(palette(state.settings.theme).warning, "%s", text.c_str());
      logControl(text.c_str());
      tooltip("Marked in the image. Ctrl + click a marked pixel, and Explain shows the first value that is not finite");
    }
    const std::string right = pixelText(state);
    const float width = ImGui::CalcTextSize(right.c_str()).x;
    ImGui::SameLine(std::max(area.size.x - width - ImGui::GetStyle().WindowPadding.x, ImGui::GetCursorPosX()));
    ImGui::TextDisabled("%s", right.c_str());
  } else {
    ImGui::TextDisabled("%s", "Press ? for help");
  }
  endBar();
}

void animationBar(ViewState& state, const Area& area) {
  if (area.size.x < 2.0f || area.size.y < 2.0f) return;
  beginBar("animation", area);
  ImGui::SetCursorPosY(0.5f * (area.size.y - ImGui::GetFrameHeight()));
  const float width = ImGui::CalcTextSize("Pause").x + 2.0f * ImGui::GetStyle().FramePadding.x;
  if (button(state.playing ? "Pause" : "Play", "Space", true, width)) {
    state.playing = !state.playing;
    state.playStart = state.time - state.snapshot->state.frame / state.snapshot->request->render.framesPerSecond;
  }
  ImGui::SameLine();
  double frame = state.snapshot->state.frame;
  const double last = std::max(1.0f, state.snapshot->scene->lastFrame);
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("%s", "Frame");
  ImGui::SameLine();
  if (numberField("##Frame", frame, {.least = 0.0, .most = last})) {
    state.playing = false;
    state.apply(job::interactive::SetFrame{static_cast<float>(frame)});
  }
  endBar();
}

}  // namespace quintet::viewer
