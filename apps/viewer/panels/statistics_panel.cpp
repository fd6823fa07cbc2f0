// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "gui/widgets.h"
#include "panels/panels.h"

namespace quintet::viewer {
namespace {

void graph(const char* id, const RateHistory& history, const std::string& text) {
  const std::vector<float> values = history.values();
  ImGui::PlotLines(id, values.data(), static_cast<int>(values.size()), 0, text.c_str(), 0.0f,
                   1.1f * history.largest() + 1e-6f,
                   {ImGui::GetContentRegionAvail().x, 3.0f * ImGui::GetTextLineHeight()});
}

}  // namespace

void statisticsPanel(ViewState& state) {
  const Snapshot& snapshot = *state.snapshot;
  textRow("Device", snapshot.device);
  textRow("Image", fmt::format("{} × {}", snapshot.state.size.x, snapshot.state.size.y));
  textRow(snapshot.countsFrames ? "Frames" : "Samples",
          fmt::format("{} of {}", snapshot.progress.samples, snapshot.state.samples));
  textRow("Time", fmt::format("{:.2f} s", snapshot.progress.seconds));
  if (!state.imageRates.empty())
    graph("##images", state.imageRates, fmt::format("{:.1f} images/s", state.imageRates.latest()));
  if (!state.rayRates.empty()) graph("##rays", state.rayRates, fmt::format("{:.2f} Mrays/s", state.rayRates.latest()));
}

}  // namespace quintet::viewer
