// SPDX-License-Identifier: Apache-2.0
// What the program prints for the chosen pixels (debugPrintfEXT).
#include <cstdint>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "base/plural.h"
#include "base/text.h"
#include "gui/style.h"
#include "gui/widgets.h"
#include "output/report.h"
#include "panels/panels.h"

namespace quintet::viewer {
namespace {

constexpr float kLines = 10.0f;

void lines(const ViewState& state, const job::Printed& printed) {
  ImGui::TextDisabled("%s", counted(printed.lines.size(), "line").c_str());
  logControl("lines");
  if (printed.omitted > 0) {
    ImGui::SameLine();
    ImGui::TextColored(palette(state.settings.theme).warning, "%s", fmt::format("{} omitted", printed.omitted).c_str());
    tooltip("Lines beyond the limit, or that the device could not store. Choose fewer pixels to see all");
  }
  ImGui::BeginChild("lines", {0, kLines * ImGui::GetTextLineHeightWithSpacing()}, true,
                    ImGuiWindowFlags_HorizontalScrollbar);
  for (const job::PrintedLine& line : printed.lines) {
    const std::uint32_t number = line.sample.value_or(line.frame.value_or(0));
    ImGui::TextDisabled("%u,%u  %u", line.pixel.x, line.pixel.y, number);
    tooltip(output::printedText(line));
    ImGui::SameLine();
    ImGui::TextUnformatted(printable(line.text).c_str());
    tooltip(output::printedText(line));
  }
  ImGui::EndChild();
}

}  // namespace

void printedPanel(ViewState& state) {
  namespace interactive = job::interactive;
  const Snapshot& snapshot = *state.snapshot;
  if (!snapshot.callsPrint) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextDisabled("%s", "No shader of the program calls debugPrintfEXT.");
    ImGui::PopTextWrapPos();
    if (!snapshot.print) return;
  } else if (state.click == ClickUse::print) {
    ImGui::TextColored(palette(state.settings.theme).note, "%s", "Click a pixel of the image.");
  } else if (!snapshot.print) {
    ImGui::TextDisabled("%s", "Choose the pixels that print.");
  }
  if (button("Choose a pixel##print", "The next click on the image chooses the pixel that prints, as the key P does"))
    state.click = ClickUse::print;
  sameLineIfFits("All pixels");
  if (button("All pixels")) state.apply(interactive::SetPrint{job::PrintRequest{.all = true}});
  if (!snapshot.print) return;
  sameLineIfFits("Stop");
  if (button("Stop", "Print nothing")) state.apply(interactive::SetPrint{});
  if (!snapshot.print->all) {
    const render::Region& pixels = snapshot.print->pixels;
    const uvec2 size = snapshot.state.size;
    double corner[2] = {static_cast<double>(pixels.x), static_cast<double>(pixels.y)};
    double extent[2] = {static_cast<double>(pixels.width), static_cast<double>(pixels.height)};
    const bool moved =
        vectorField("Pixel", corner, 2, {.least = 0.0, .most = 1e6, .whole = true}, "The top left pixel");
    const bool resized = vectorField("Size", extent, 2, {.least = 1.0, .most = 1e6, .whole = true}, "In pixels");
    if (moved || resized) {
      // The largest part of them that is inside the image.
      const uvec2 first = glm::min(uvec2(corner[0], corner[1]), size - 1u);
      const uvec2 count = glm::min(uvec2(extent[0], extent[1]), size - first);
      state.printPixels({first.x, first.y, count.x, count.y});
    }
  }
  if (snapshot.printed)
    lines(state, *snapshot.printed);
  else if (snapshot.callsPrint)
    ImGui::TextDisabled("%s", "Nothing has been printed yet.");
}

}  // namespace quintet::viewer
