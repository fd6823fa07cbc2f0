// SPDX-License-Identifier: Apache-2.0
// The explanation of a pixel: its value, the tree of its rays, the fields of the selected row, and a comparison.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "base/diagnostic.h"
#include "base/plural.h"
#include "gui/style.h"
#include "gui/widgets.h"
#include "io/color.h"
#include "output/explanation_text.h"
#include "panels/panels.h"

namespace quintet::viewer {
namespace {

constexpr float kTreeRows = 14.0f, kDetailRows = 11.0f;

ImU32 displayColor(const ViewState& state, const vec3& linear) {
  const float exposure = std::exp2(static_cast<float>(state.snapshot->state.exposure));
  const auto channel = [&](float value) {  // NaN becomes 0
    return static_cast<int>(io::byteFromUnit(io::srgbFromLinear(exposure * value)));
  };
  return IM_COL32(channel(linear.r), channel(linear.g), channel(linear.b), 255);
}

void swatch(const ViewState& state, ImVec2 corner, const vec3& linear) {
  const float height = ImGui::GetTextLineHeight();
  const ImVec2 end{corner.x + 1.4f * height, corner.y + height};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float rounding = 3.0f * state.scale;
  list.AddRectFilled(corner, end, displayColor(state, linear), rounding);
  list.AddRect(corner, end, ImGui::GetColorU32(ImGuiCol_Border), rounding);
}

std::string colorText(const vec3& v) { return fmt::format("{:.4g} {:.4g} {:.4g}", v.r, v.g, v.b); }

// A row of the panel with a color.
void valueRow(const ViewState& state, const char* label, const vec3& value, const char* help) {
  const float start = ImGui::GetCursorPosX();
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::TextDisabled("%s", label);
  tooltip(help);
  ImGui::SameLine(start + kLabelShare * width);
  swatch(state, ImGui::GetCursorScreenPos(), value);
  ImGui::Dummy({1.4f * ImGui::GetTextLineHeight(), ImGui::GetTextLineHeight()});
  ImGui::SameLine();
  const std::string text = fittingText(colorText(value), ImGui::GetContentRegionAvail().x);
  ImGui::TextUnformatted(text.c_str());
  tooltip(fmt::format("{:.9g} {:.9g} {:.9g}", value.r, value.g, value.b));
}

void question(ViewState& state) {
  const Snapshot& snapshot = *state.snapshot;
  ExplainControls& explain = state.explain;
  textRow("Pixel", fmt::format("{}, {}", explain.pixel->x, explain.pixel->y));
  double sample = explain.sample;
  const double last = snapshot.state.samples > 0 ? snapshot.state.samples - 1.0 : 0.0;
  if (numberField(snapshot.countsFrames ? "Frame" : "Sample", sample, {.least = 0.0, .most = last, .whole = true},
                  "The number of the sample that is explained; the first one is 0"))
    state.explainPixel(*explain.pixel, static_cast<std::uint32_t>(sample));
}

// The pixel of the image that is shown; nothing if the image is another one.
std::optional<vec3> meanOf(const ViewState& state, const job::PixelExplanation& explanation) {
  const Snapshot& snapshot = *state.snapshot;
  const io::Image* image = snapshot.image.get();
  const uvec2 pixel = explanation.pixel;
  if (!image || snapshot.explanationOutdated || snapshot.state.output != snapshot.program->outputs.front().name ||
      uvec2(image->width, image->height) != explanation.size || pixel.x >= image->width || pixel.y >= image->height)
    return std::nullopt;
  const auto values = image->pixel<float>(pixel.x, pixel.y);
  return vec3(values[0], values[1], values[2]);
}

// What is known before the tree.
void result(ViewState& state) {
  const Palette& colors = palette(state.settings.theme);
  const job::PixelExplanation& explanation = *state.explanation;
  if (!explanation.outputs.empty()) {
    const vec3 value = explanation.outputs.front().value;
    const std::string label =
        fmt::format("Value of {} {}", explanation.frames ? "frame" : "sample", explanation.sample);
    valueRow(state, label.c_str(), value, "What the sample adds to the image, linear Rec. 709");
    if (const std::optional<vec3> mean = meanOf(state, explanation))
      valueRow(state, explanation.frames ? "Value of image" : "Mean of image", *mean,
               "The pixel of the image, of all samples until now, as the bar below the image shows it");
    valueRow(state, "Sum", state.explain.tree->contributionSum(),
             "Sum of the contributions of the rays below; it equals the value");
    if (state.explain.tree->sumDiffers())
      ImGui::TextColored(colors.warning, "%s", "The contributions do not sum to the value.");
    if (!output::isRounding(value, explanation.outputs.front().recorded))
      ImGui::TextColored(colors.warning, "%s", "The recorded variant of the program has another value.");
  }
  if (explanation.discarded)
    ImGui::TextColored(colors.warning, "%s", "The program discarded the sample: it is not finite.");
  if (explanation.origin) {
    const SourceLocation& at = explanation.origin->location;
    const std::string text = fmt::format("First value that is not finite: {}: {}", locationText(at.file, at.line, 0),
                                         job::originText(*explanation.origin));
    ImGui::PushStyleColor(ImGuiCol_Text, colors.error);
    ImGui::TextWrapped("%s", text.c_str());
    ImGui::PopStyleColor();
    logControl("origin");
  }
  if (explanation.lostRecords > 0)
    ImGui::TextColored(colors.warning, "%s",
                       (counted(explanation.lostRecords, "record") + " did not fit into the log.").c_str());
}

// ---- The tree

// Text up to `right`.
void drawText(ImVec2 at, float right, ImU32 color, const std::string& text) {
  if (at.x < right) ImGui::GetWindowDrawList()->AddText(at, color, fittingText(text, right - at.x).c_str());
}

void treeRow(ViewState& state, std::size_t index) {
  ExplainControls& explain = state.explain;
  const ExplanationRow& row = explain.tree->rows()[index];
  const bool selected = explain.row == index;
  const bool hasRows = row.end > index + 1;
  const float line = ImGui::GetTextLineHeight();
  const ImVec2 size{ImGui::GetContentRegionAvail().x, line};
  if (!(selected && explain.revealsRow) && !ImGui::IsRectVisible(size)) return ImGui::Dummy(size);
  const float indent = static_cast<float>(row.depth) * ImGui::GetStyle().IndentSpacing;
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  const float right = origin.x + size.x;
  const float arrowEnd = origin.x + indent + line;
  ImGui::PushID(static_cast<int>(index));
  if (listRow("##row", selected)) {
    const bool onArrow = hasRows && ImGui::GetIO().MousePos.x < arrowEnd;
    if (!onArrow)
      state.selectRow(selected ? std::nullopt : std::optional(index));
    else if (explain.closed.erase(index) == 0)
      explain.closed.insert(index);
  }
  logControl(row.event->type == "ray" || !row.ray ? row.name.c_str()
                                                  : fmt::format("Ray {}/{}", *row.ray + 1, row.name).c_str());
  if (selected && explain.revealsRow) {
    ImGui::SetScrollHereY();
    explain.revealsRow = false;
  }
  tooltip(row.summary.empty() ? row.name : row.name + "\n" + row.summary);
  ImGui::PopID();

  ImDrawList& list = *ImGui::GetWindowDrawList();
  const Palette& colors = palette(state.settings.theme);
  if (explain.comparison && explain.comparison->differs[index]) {
    const bool first = explain.comparison->first == index;
    const ImU32 color = ImGui::ColorConvertFloat4ToU32(first ? colors.error : colors.warning);
    list.AddRectFilled({origin.x - 4.0f * state.scale, origin.y}, {origin.x - 1.0f * state.scale, origin.y + line},
                       color);
  }
  const ImU32 textColor = ImGui::GetColorU32(ImGuiCol_Text);
  if (hasRows) {
    const float x = origin.x + indent + 0.5f * line, y = origin.y + 0.5f * line, r = 0.22f * line;
    if (explain.closed.count(index) > 0)
      list.AddTriangleFilled({x - 0.7f * r, y - r}, {x + r, y}, {x - 0.7f * r, y + r}, textColor);
    else
      list.AddTriangleFilled({x - r, y - 0.7f * r}, {x + r, y - 0.7f * r}, {x, y + r}, textColor);
  }
  const bool ray = row.event->type == "ray";
  const ImU32 faint = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  const float textEnd = right - (row.contribution ? 1.8f * line : 0.0f);
  drawText({arrowEnd, origin.y}, textEnd, ray || selected ? textColor : faint, row.name);
  const float nameEnd = arrowEnd + ImGui::CalcTextSize(row.name.c_str()).x + 0.6f * line;
  drawText({nameEnd, origin.y}, textEnd, ray ? faint : textColor, row.summary);
  if (row.contribution) swatch(state, {right - 1.5f * line, origin.y}, *row.contribution);
}

void tree(ViewState& state) {
  ExplainControls& explain = state.explain;
  // The ray can be selected in the image, too.
  const std::vector<ExplanationRow>& rows = explain.tree->rows();
  const std::optional<std::size_t> ray = explain.row ? rows[*explain.row].ray : std::nullopt;
  if (state.selectedRay && ray != state.selectedRay) {
    const std::size_t row = explain.tree->rowOfRay(*state.selectedRay);
    if (row < rows.size()) state.selectRow(row);
    explain.revealsRow = true;
  }
  if (explain.revealsRow && explain.row)
    std::erase_if(explain.closed, [&](std::size_t i) { return i < *explain.row && *explain.row < rows[i].end; });
  const float shown = std::min(kTreeRows, static_cast<float>(rows.size()) + 1.0f);
  ImGui::BeginChild("tree", {0, shown * ImGui::GetTextLineHeightWithSpacing()}, true);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {ImGui::GetStyle().ItemSpacing.x, 0.25f * ImGui::GetTextLineHeight()});
  for (std::size_t i = 0; i < rows.size();) {
    treeRow(state, i);
    i = explain.closed.count(i) > 0 ? rows[i].end : i + 1;
  }
  ImGui::PopStyleVar();
  ImGui::EndChild();
}

void details(const ViewState& state) {
  const ExplainControls& explain = state.explain;
  if (!explain.row) {
    ImGui::TextDisabled("%s", "Select a row to see all that was recorded.");
    return;
  }
  const ExplanationRow& row = explain.tree->rows()[*explain.row];
  ImGui::TextUnformatted(row.name.c_str());
  logControl(("details of " + row.name).c_str());
  ImGui::BeginChild("details", {0, kDetailRows * ImGui::GetTextLineHeightWithSpacing()}, true);
  if (ImGui::BeginTable("fields", 2)) {
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 0.38f);
    ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 0.62f);
    for (const ExplanationField& field : fieldsOf(*row.event)) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextDisabled("%s", field.name.c_str());
      tooltip(field.name);
      ImGui::TableNextColumn();
      ImGui::PushTextWrapPos(0.0f);
      if (field.before.empty())
        ImGui::TextUnformatted(field.value.c_str());
      else
        ImGui::TextColored(palette(state.settings.theme).note, "%s",
                           fmt::format("{} -> {}", field.before, field.value).c_str());
      ImGui::PopTextWrapPos();
    }
    ImGui::EndTable();
  }
  ImGui::EndChild();
}

// ---- The comparison

std::string nameOf(const job::PixelExplanation& e) {
  return fmt::format("pixel {},{}, {} {}", e.pixel.x, e.pixel.y, e.frames ? "frame" : "sample", e.sample);
}

void difference(const ViewState& state, const job::ExplanationDifference& d) {
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(d.location.c_str());
  ImGui::TextColored(palette(state.settings.theme).note, "A  %s", d.a.c_str());
  ImGui::TextColored(palette(state.settings.theme).warning, "B  %s", d.b.c_str());
  ImGui::PopTextWrapPos();
}

void comparison(ViewState& state) {
  ExplainControls& explain = state.explain;
  if (button("Keep as A", "Keep this explanation, to compare later ones with it", state.explanation != nullptr)) {
    explain.kept = state.explanation;
    state.compareExplanation(true);
  }
  if (!explain.kept) return;
  sameLineIfFits("Forget A");
  if (button("Forget A")) {
    explain.kept = nullptr;
    state.compareExplanation(false);
    return;
  }
  textRow("A", nameOf(*explain.kept));
  bool compares = explain.compares;
  if (checkBox("Compare with A", compares, "Mark the rows that differ from A, and list the first difference"))
    state.compareExplanation(compares);
  if (!explain.comparison) return;
  const job::ExplanationDiff& diff = explain.comparison->diff;
  if (diff.equal()) {
    ImGui::TextColored(palette(state.settings.theme).success, "%s",
                       fmt::format("All {} are equal.", counted(diff.equalEvents, "event")).c_str());
    logControl("equal");
  }
  if (diff.first) {
    ImGui::TextColored(palette(state.settings.theme).error, "%s",
                       fmt::format("First difference, after {}", counted(diff.equalEvents, "equal event")).c_str());
    logControl("first difference");
    difference(state, *diff.first);
  }
  if (diff.outputs.empty() && diff.facts.empty()) return;
  if (!ImGui::TreeNode("Outputs and what was explained")) return;
  for (const job::ExplanationDifference& output : diff.outputs) difference(state, output);
  for (const job::ExplanationDifference& fact : diff.facts) difference(state, fact);
  ImGui::TreePop();
}

}  // namespace

void explainPanel(ViewState& state) {
  const Snapshot& snapshot = *state.snapshot;
  ExplainControls& explain = state.explain;
  if (std::exchange(explain.revealsPanel, false)) ImGui::SetScrollHereY(0.0f);
  if (state.click == ClickUse::explain)
    ImGui::TextColored(palette(state.settings.theme).note, "%s", "Click a pixel of the image.");
  else if (!explain.pixel)
    ImGui::TextDisabled("%s", "Ctrl + click a pixel to see why it has its value.");
  if (button("Choose a pixel", "The next click on the image explains the pixel, as Ctrl + click does, or the key I"))
    state.click = ClickUse::explain;
  if (!explain.pixel) {
    if (explain.kept) comparison(state);
    return;
  }
  const bool outdated = state.explanation && snapshot.explanationOutdated && !snapshot.explaining;
  sameLineIfFits("Explain again");
  if (button("Explain again", "Explain the same pixel of the scene as it is now", !snapshot.explaining))
    state.explainPixel(*explain.pixel, explain.sample);
  question(state);
  if (snapshot.explaining) ImGui::TextDisabled("%s", "Recording...");
  if (outdated)
    ImGui::TextColored(palette(state.settings.theme).warning, "%s", "The image has changed since this was recorded.");
  if (!state.explanation || !explain.tree) {
    if (explain.kept) comparison(state);
    return;
  }
  result(state);
  comparison(state);
  tree(state);
  details(state);
  if (button("Save...", "Write the explanation as JSON")) state.requests.push_back(Action::saveExplanation);
  sameLineIfFits("Copy command");
  if (button("Copy command", "Copy the command line that explains this pixel"))
    state.requests.push_back(Action::copyExplainCommand);
}

}  // namespace quintet::viewer
