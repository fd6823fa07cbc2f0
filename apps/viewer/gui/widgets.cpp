// SPDX-License-Identifier: Apache-2.0
#include "gui/widgets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

namespace quintet::viewer {
namespace {

using Values = std::array<double, 4>;

// A value that the user chose and the session has not confirmed.
struct Pending {
  Values value{};
  double time = 0;  // ImGui::GetTime() of the last change
};
constexpr double kConfirmSeconds = 1.5;

struct State {
  std::unordered_map<ImGuiID, Pending> pending;
  ImGuiID active = 0;  // the control that the user holds
  bool editEnded = false;
  std::string section;
  WidgetLog log;
};

State& state() {
  static State instance;
  return instance;
}

bool isClose(const Values& a, const Values& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(std::abs(a[i] - b[i]) <= 1e-5 * std::max(1.0, std::abs(b[i])))) return false;
  return true;
}

// The value to show: that of the user until the session has it.
Values shownValue(ImGuiID id, const Values& actual) {
  const auto found = state().pending.find(id);
  if (found == state().pending.end()) return actual;
  if (state().active == id ||
      (!isClose(found->second.value, actual) && ImGui::GetTime() - found->second.time < kConfirmSeconds))
    return found->second.value;
  state().pending.erase(found);
  return actual;
}

void logWidget(const char* label) {
  if (!state().log) return;
  const ImVec2 least = ImGui::GetItemRectMin(), most = ImGui::GetItemRectMax();
  const char* end = std::strstr(label, "##");
  const std::string name = end == label ? label + 2 : end ? std::string(label, end) : label;
  state().log(state().section.empty() ? name : state().section + "/" + name, {least.x, least.y}, {most.x, most.y});
}

// Label in the left part of the row; the control gets the rest. Labels that start with "##" are not shown.
void beginRow(const char* label, std::string_view help) {
  if (std::strncmp(label, "##", 2) == 0) return ImGui::SetNextItemWidth(-1.0f);
  const float width = ImGui::GetContentRegionAvail().x;
  const float start = ImGui::GetCursorPosX();
  const char* end = std::strstr(label, "##");
  ImGui::AlignTextToFramePadding();
  const std::string_view text(label, end ? static_cast<std::size_t>(end - label) : std::strlen(label));
  const std::string shown = fittingText(text, kLabelShare * width - ImGui::GetStyle().ItemSpacing.x);
  ImGui::TextUnformatted(shown.c_str());
  if (!help.empty())
    tooltip(help);
  else if (shown != text)
    tooltip(text);
  ImGui::SameLine(start + kLabelShare * width);
  ImGui::SetNextItemWidth(-1.0f);
}

// After the control.
bool endRow(const char* label, ImGuiID id, std::string_view help, bool changed) {
  if (ImGui::IsItemActive())
    state().active = id;
  else if (state().active == id)
    state().active = 0;
  if (!help.empty()) tooltip(help);
  if (ImGui::IsItemDeactivatedAfterEdit()) state().editEnded = true;
  logWidget(label);
  return changed;
}

std::string hiddenLabel(const char* label) { return fmt::format("##{}", label); }

bool isSlider(const NumberRange& range) { return range.least > -1e4 && range.most < 1e4; }

std::string formatOf(const NumberRange& range) {
  if (range.whole) return range.unit.empty() ? "%.0f" : fmt::format("%.0f {}", range.unit);
  return range.unit.empty() ? "%.4g" : fmt::format("%.4g {}", range.unit);
}

bool editNumbers(const char* label, double* values, int count, const NumberRange& range) {
  const std::string format = formatOf(count == 1 ? range : NumberRange{.whole = range.whole});  // several are narrow
  const ImGuiSliderFlags flags =
      ImGuiSliderFlags_AlwaysClamp | (range.logarithmic ? int{ImGuiSliderFlags_Logarithmic} : 0);
  bool changed = false;
  if (isSlider(range)) {
    changed = ImGui::SliderScalarN(label, ImGuiDataType_Double, values, count, &range.least, &range.most,
                                   format.c_str(), flags);
  } else {
    double largest = 0.0;
    for (int i = 0; i < count; ++i) largest = std::max(largest, std::abs(values[i]));
    const float speed = range.whole ? 0.2f : static_cast<float>(std::clamp(0.005 * largest, 1e-4, 1e4));
    changed = ImGui::DragScalarN(label, ImGuiDataType_Double, values, count, speed, &range.least, &range.most,
                                 format.c_str(), flags);
  }
  if (changed && range.whole)
    for (int i = 0; i < count; ++i) values[i] = std::round(values[i]);
  return changed;
}

std::string fullValues(const Values& values, int count) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += fmt::format("{}{:.6g}", i > 0 ? "   " : "", values[static_cast<std::size_t>(i)]);
  return text;
}

}  // namespace

bool vectorField(const char* label, double* values, int count, const NumberRange& range, std::string_view help) {
  beginRow(label, help);
  const std::string hidden = hiddenLabel(label);
  const ImGuiID id = ImGui::GetID(hidden.c_str());
  Values actual{};
  std::copy_n(values, count, actual.begin());
  Values shown = shownValue(id, actual);
  const bool changed = editNumbers(hidden.c_str(), shown.data(), count, range);
  if (changed) {
    state().pending[id] = {shown, ImGui::GetTime()};
    std::copy_n(shown.begin(), count, values);
  }
  // A narrow panel cuts the numbers.
  const std::string all = count > 1 ? fullValues(shown, count) : std::string();
  const std::string separator = help.empty() || all.empty() ? "" : "\n";
  return endRow(label, id, std::string(help) + separator + all, changed);
}

bool numberField(const char* label, double& value, const NumberRange& range, std::string_view help) {
  return vectorField(label, &value, 1, range, help);
}

bool colorField(const char* label, vec3& linear, std::string_view help) {
  beginRow(label, help);
  const std::string hidden = hiddenLabel(label);
  const ImGuiID id = ImGui::GetID(hidden.c_str());
  const Values shown = shownValue(id, {linear.r, linear.g, linear.b, 0.0});
  float color[3] = {static_cast<float>(shown[0]), static_cast<float>(shown[1]), static_cast<float>(shown[2])};
  const bool changed = ImGui::ColorEdit3(
      hidden.c_str(), color, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_PickerHueWheel);
  if (changed) {
    for (float& component : color) component = std::max(component, 0.0f);
    state().pending[id] = {{color[0], color[1], color[2], 0.0}, ImGui::GetTime()};
    linear = {color[0], color[1], color[2]};
  }
  return endRow(label, id, help, changed);
}

bool checkBox(const char* label, bool& value, std::string_view help) {
  beginRow(label, help);
  const std::string hidden = hiddenLabel(label);
  const ImGuiID id = ImGui::GetID(hidden.c_str());
  bool shown = shownValue(id, {value ? 1.0 : 0.0}).front() != 0.0;
  const bool changed = ImGui::Checkbox(hidden.c_str(), &shown);
  if (changed) {
    state().pending[id] = {{shown ? 1.0 : 0.0}, ImGui::GetTime()};
    value = shown;
    state().editEnded = true;
  }
  return endRow(label, id, help, changed);
}

bool choiceField(const char* label, std::size_t& index, const std::vector<std::string>& names, std::string_view help) {
  beginRow(label, help);
  const std::string hidden = hiddenLabel(label);
  const ImGuiID id = ImGui::GetID(hidden.c_str());
  const auto shown = static_cast<std::size_t>(shownValue(id, {static_cast<double>(index)}).front());
  bool changed = false;
  const bool open = ImGui::BeginCombo(hidden.c_str(), shown < names.size() ? names[shown].c_str() : "");
  logWidget(label);
  const std::string name = shown < names.size() ? names[shown] : std::string();
  const bool isCut = ImGui::CalcTextSize(name.c_str()).x >
                     ImGui::GetItemRectSize().x - ImGui::GetFrameHeight() - 2.0f * ImGui::GetStyle().FramePadding.x;
  if (isCut || !help.empty())
    tooltip(isCut ? name + (help.empty() ? "" : "\n" + std::string(help)) : std::string(help));
  if (!open) return false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (ImGui::Selectable(fmt::format("{}##{}", names[i], i).c_str(), i == shown) && i != shown) {
      index = i;
      changed = true;
      state().pending[id] = {{static_cast<double>(i)}, ImGui::GetTime()};
      state().editEnded = true;
    }
    logWidget(fmt::format("{}/{}", label, names[i]).c_str());
    if (i == shown) ImGui::SetItemDefaultFocus();
  }
  ImGui::EndCombo();
  return changed;
}

bool textField(const char* label, std::string& value, std::string_view help) {
  beginRow(label, help);
  // The text that is being edited. Only one field is edited at a time.
  static ImGuiID edited = 0;
  static std::string text;
  const std::string hidden = hiddenLabel(label);
  const ImGuiID id = ImGui::GetID(hidden.c_str());
  std::string shown = edited == id ? text : value;
  ImGui::InputText(hidden.c_str(), &shown);
  if (ImGui::IsItemActive()) {
    edited = id;
    text = shown;
  }
  const bool changed = ImGui::IsItemDeactivatedAfterEdit() && shown != value;
  if (changed) value = shown;
  if (!ImGui::IsItemActive() && edited == id) edited = 0;
  return endRow(label, id, help, changed);
}

bool searchField(const char* label, std::string& value, std::string_view help) {
  beginRow(label, help);
  const std::string hidden = hiddenLabel(label);
  const bool changed = ImGui::InputTextWithHint(hidden.c_str(), "type a part of a name", &value);
  if (!help.empty()) tooltip(help);
  logWidget(label);
  return changed;
}

void sameLineIfFits(const char* label) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float width = ImGui::CalcTextSize(label, nullptr, /*hide_text_after_double_hash=*/true).x;
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  const float end = ImGui::GetItemRectMax().x + style.ItemSpacing.x + width + 2.0f * style.FramePadding.x;
  if (end <= right) ImGui::SameLine();
}

bool button(const char* label, std::string_view help, bool enabled, float width) {
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::Button(label, {width, 0.0f});
  ImGui::EndDisabled();
  if (!help.empty()) tooltip(help);
  logWidget(label);
  return pressed && enabled;
}

void textRow(const char* label, const std::string& value) {
  const float width = ImGui::GetContentRegionAvail().x;
  const float start = ImGui::GetCursorPosX();
  ImGui::TextDisabled("%s", label);
  ImGui::SameLine(start + kLabelShare * width);
  const std::string shown = fittingText(value, ImGui::GetContentRegionAvail().x);
  ImGui::TextUnformatted(shown.c_str());
  if (shown != value) tooltip(value);
}

bool listRow(const char* label, bool selected) {
  ImVec4 color = ImGui::GetStyleColorVec4(ImGuiCol_CheckMark);
  color.w = 0.4f;
  ImGui::PushStyleColor(ImGuiCol_Header, color);
  const bool clicked = ImGui::Selectable(label, selected);
  ImGui::PopStyleColor();
  return clicked;
}

std::string fittingText(std::string_view text, float width) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (ImGui::CalcTextSize(begin, end).x <= width) return std::string(text);
  constexpr const char* kDots = "...";
  const char* fits = begin;
  ImGui::GetFont()->CalcTextSizeA(ImGui::GetFontSize(), std::max(width - ImGui::CalcTextSize(kDots).x, 0.0f), 0.0f,
                                  begin, end, &fits);
  return std::string(begin, fits) + kDots;
}

void tooltip(std::string_view text) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 26.0f);
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

bool section(const char* label, bool& open) {
  state().section.clear();
  ImGui::SetNextItemOpen(open);
  open = ImGui::CollapsingHeader(label);
  logWidget(label);
  state().section = label;
  return open;
}

void endSections() { state().section.clear(); }

bool takeEditEnd() { return std::exchange(state().editEnded, false); }

void forgetPendingValues() { state().pending.clear(); }

void logControl(const char* label) { logWidget(label); }

void logControlAt(const char* label, vec2 least, vec2 most) {
  if (state().log) state().log(label, least, most);
}

void setWidgetLog(WidgetLog log) { state().log = std::move(log); }

}  // namespace quintet::viewer
