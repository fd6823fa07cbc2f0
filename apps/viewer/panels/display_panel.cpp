// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "base/plural.h"
#include "gui/style.h"
#include "gui/widgets.h"
#include "panels/panels.h"
#include "render/tone_map/tone_map.h"

namespace quintet::viewer {
namespace {

namespace interactive = job::interactive;

void outputChoice(ViewState& state) {
  std::vector<std::string> names;
  std::size_t index = 0;
  std::string help;
  for (const program::Output& output : state.snapshot->program->outputs) {
    if (output.pixel == program::OutputPixel::coverage) continue;
    if (output.name == state.snapshot->state.output) {
      index = names.size();
      help = output.help;
    }
    names.push_back(output.name);
  }
  if (choiceField("Output", index, names, help)) state.apply(interactive::SelectOutput{names[index]});
}

void toneMapChoice(ViewState& state) {
  std::vector<std::string> names{"default"};
  for (const std::string& name : render::toneMapNames()) names.push_back(name);
  const std::optional<render::ToneMap> current = state.snapshot->state.toneMap;
  std::size_t index = 0;
  for (std::size_t i = 1; i < names.size(); ++i)
    if (current && render::toneMapByName(names[i]) == current) index = i;
  if (choiceField("Tone mapping", index, names, "Default: neutral for colors, linear for all else"))
    state.apply(interactive::SetToneMap{render::toneMapByName(names[index])});
}

void falseColorControls(ViewState& state) {
  DisplayControls& controls = state.controls;
  std::vector<std::string> channels;
  for (int i = 0; i <= static_cast<int>(Channel::alpha); ++i)
    channels.emplace_back(channelName(static_cast<Channel>(i)));
  auto channel = static_cast<std::size_t>(controls.channel);
  if (choiceField("Channel", channel, channels)) controls.channel = static_cast<Channel>(channel);
  double range[2] = {controls.range.least, controls.range.most};
  if (vectorField("Range", range, 2, {}, "The values at both ends of the legend") && range[0] < range[1]) {
    controls.range.least = range[0];
    controls.range.most = range[1];
  }
  checkBox("Logarithmic", controls.range.logarithmic);
  if (controls.range.logarithmic && !(controls.range.least > 0.0)) controls.range.least = 1e-4 * controls.range.most;
  if (button("Fit range", "Use the range of the image", state.display != nullptr) && state.display) {
    const bool logarithmic = controls.range.logarithmic;
    controls.range = roundRange(state.display->histogram.least, state.display->histogram.most);
    controls.range.logarithmic = logarithmic;
  }
}

// Filled curves of the channels, added where they overlap.
void histogramGraph(const Histogram& histogram) {
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = 4.5f * ImGui::GetTextLineHeight();
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end{origin.x + width, origin.y + height};
  list.AddRectFilled(origin, end, ImGui::GetColorU32(ImGuiCol_FrameBg, 0.5f), ImGui::GetStyle().FrameRounding);
  double largest = 1.0;
  for (const auto& counts : histogram.channels)
    for (std::size_t i = 1; i + 1 < kHistogramBins; ++i) largest = std::max<double>(largest, counts[i]);
  const auto x = [&](double bin) { return origin.x + width * static_cast<float>(bin / kHistogramBins); };
  constexpr std::array<ImU32, 3> kColors{IM_COL32(235, 80, 80, 110), IM_COL32(70, 190, 90, 110),
                                         IM_COL32(80, 130, 250, 110)};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < kHistogramBins; ++i) {
      const double share = std::min(1.0, std::sqrt(histogram.channels[c][i] / largest));
      if (share <= 0.0) continue;
      list.AddRectFilled({x(static_cast<double>(i)), end.y - static_cast<float>(share) * (height - 2.0f)},
                         {x(static_cast<double>(i) + 1.0), end.y}, kColors[c]);
    }
  const double white = -Histogram::kFirstStop / Histogram::kStopsPerBin;
  list.AddLine({x(white), origin.y}, {x(white), end.y}, ImGui::GetColorU32(ImGuiCol_TextDisabled));
  ImGui::Dummy({width, height});
  tooltip(
      fmt::format("Pixels per value, from 2^{:.0f} to 2^{:.0f}. The line marks 1.\nLuminance: {:.4g} to {:.4g}, mean "
                  "{:.4g}",
                  Histogram::kFirstStop, Histogram::kLastStop, histogram.least, histogram.most, histogram.mean));
}

// The user asks for another size, so the samples may be discarded.
void changesResolution(ViewState& state, float resolution) {
  state.settings.resolution = resolution;
  state.fitsImage = true;
}

void notFiniteRows(ViewState& state) {
  const std::uint64_t pixels = state.display->histogram.notFinitePixels, samples = state.snapshot->droppedSamples;
  if (pixels == 0 && samples == 0) return;
  ImGui::PushStyleColor(ImGuiCol_Text, palette(state.settings.theme).warning);
  if (pixels > 0)
    ImGui::TextWrapped(
        "%s", fmt::format("{} {} NaN or infinite.", counted(pixels, "pixel"), nounFor(pixels, "is", "are")).c_str());
  if (samples > 0)
    ImGui::TextWrapped("%s", fmt::format("{} NaN or infinite, and the program discarded {}.",
                                         counted(samples, "sample was", "samples were"), nounFor(samples, "it", "them"))
                                 .c_str());
  ImGui::PopStyleColor();
  checkBox("Mark them", state.controls.marksNotFinite,
           "Magenta instead of the color of the pixel, and a circle around it");
  const std::vector<uvec2>& found = pixels > 0 ? state.display->notFinite : state.snapshot->droppedPixels;
  if (found.empty() || !state.snapshot->image) return;
  if (button("Explain the first one", "As Ctrl + click on this pixel"))
    state.explainPixel(
        found.front() * state.snapshot->state.size / uvec2(state.snapshot->image->width, state.snapshot->image->height),
        state.explain.sample);
}

}  // namespace

void displayPanel(ViewState& state) {
  outputChoice(state);
  double exposure = state.snapshot->state.exposure;
  if (numberField("Exposure", exposure, {.least = -10.0, .most = 10.0, .unit = "stops"}, "Keys: - and +"))
    state.apply(interactive::SetExposure{exposure});
  toneMapChoice(state);
  checkBox("False color", state.controls.falseColor, "Show one number per pixel as a color, with a legend");
  if (state.controls.falseColor) falseColorControls(state);
  std::vector<std::string> resolutions{"100 %", "50 %", "25 %", "12.5 %"};
  std::size_t resolution = 0;
  for (std::size_t i = 0; i < resolutions.size(); ++i)
    if (std::abs(state.settings.resolution - std::exp2(-static_cast<float>(i))) < 1e-3f) resolution = i;
  if (!state.fixedSize &&
      choiceField("Resolution", resolution, resolutions, "Pixels of the image per pixel of the window"))
    changesResolution(state, std::exp2(-static_cast<float>(resolution)));
  if (!state.display) return;
  histogramGraph(state.display->histogram);
  notFiniteRows(state);
}

void comparePanel(ViewState& state) {
  DisplayControls& controls = state.controls;
  if (!state.reference) {
    ImGui::TextWrapped("%s", "Compare with a file or with the image as it is now.");
    if (button("Choose a file...",
               "PNG, JPEG, WebP, OpenEXR, Radiance HDR, KTX2. Files can also be dropped on the window"))
      state.requests.push_back(Action::openReference);
    sameLineIfFits("Use the current image");
    if (button("Use the current image", "Compare with the image as it is now", state.snapshot->image != nullptr)) {
      state.reference = state.snapshot->image;
      state.referenceFile = "current image";
      controls.compare = CompareMode::split;
    }
    return;
  }
  textRow("Reference", state.referenceFile);
  const uvec2 size(state.reference->width, state.reference->height), shown = state.snapshot->state.size;
  if (size != shown) {
    textRow("Its size", fmt::format("{} × {}", size.x, size.y));
    const bool isCut = std::uint64_t{size.x} * shown.y != std::uint64_t{shown.x} * size.y;
    ImGui::PushStyleColor(ImGuiCol_Text, palette(state.settings.theme).warning);
    ImGui::TextWrapped("%s", fmt::format("The image has {} × {}, so the reference is scaled{}.", shown.x, shown.y,
                                         isCut ? " and has bars at its sides" : "")
                                 .c_str());
    ImGui::PopStyleColor();
    logControl("scaled");
  }
  const std::vector<std::string> modes{"off", "split", "difference", "FLIP"};
  auto mode = static_cast<std::size_t>(controls.compare);
  if (choiceField("Mode", mode, modes, "Split: drag the line. Difference: linear values. FLIP: perceived difference"))
    controls.compare = static_cast<CompareMode>(mode);
  if (controls.compare == CompareMode::difference) {
    double most = controls.range.most;
    if (numberField("Largest difference", most, {.least = 1e-4, .most = 100.0, .logarithmic = true}))
      controls.range.most = most;
  }
  if (state.display && state.display->error)
    textRow(controls.compare == CompareMode::flip ? "Mean FLIP" : "Mean difference",
            fmt::format("{:.5f}", *state.display->error));
  if (button("Remove reference")) {
    state.reference = nullptr;
    controls.compare = CompareMode::off;
  }
}

}  // namespace quintet::viewer
