// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "gui/widgets.h"
#include "panels/panels.h"

namespace quintet::viewer {
namespace {

using program::Parameter;
using program::ParameterType;
using program::ParameterValue;

NumberRange rangeOf(const Parameter& parameter) {
  NumberRange range;
  if (program::hasMin(parameter)) range.least = parameter.min;
  if (program::hasMax(parameter)) range.most = parameter.max;
  range.whole = program::isWhole(parameter.type);
  if (range.whole) {
    const auto [least, most] = program::typeRange(parameter.type);
    range.least = std::max(range.least, least);
    range.most = std::min(range.most, most);
  }
  range.unit = parameter.unit;
  return range;
}

std::string assignedText(const ParameterValue& value, int count, bool whole) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    const double number = value[static_cast<std::size_t>(i)];
    text += (i == 0 ? "" : ",") + (whole ? fmt::format("{:.0f}", number) : fmt::format("{:.9g}", number));
  }
  return text;
}

// The text of the new value, if the user has changed it.
std::string edited(const Parameter& parameter, const ParameterValue& value, const std::string& imageFile) {
  const char* label = parameter.name.c_str();
  switch (parameter.type) {
    case ParameterType::boolean: {
      bool on = value[0] != 0.0;
      return checkBox(label, on, parameter.help) ? (on ? "true" : "false") : "";
    }
    case ParameterType::choice: {
      auto index = static_cast<std::size_t>(value[0]);
      return choiceField(label, index, parameter.choices, parameter.help) ? parameter.choices[index] : "";
    }
    case ParameterType::color: {
      vec3 color(value[0], value[1], value[2]);
      if (!colorField(label, color, parameter.help)) return "";
      return assignedText({color.r, color.g, color.b}, 3, /*whole=*/false);
    }
    case ParameterType::image: {
      std::string file = imageFile;
      return textField(label, file, parameter.help) ? file : "";
    }
    default: break;
  }
  ParameterValue numbers = value;
  const int count = program::componentCount(parameter.type);
  if (!vectorField(label, numbers.data(), count, rangeOf(parameter), parameter.help)) return "";
  return assignedText(numbers, count, program::isWhole(parameter.type));
}

}  // namespace

void parametersPanel(ViewState& state) {
  const Snapshot& snapshot = *state.snapshot;
  textRow("Program", snapshot.program->name);
  if (!snapshot.program->description.empty()) tooltip(snapshot.program->description);
  const program::ParameterValues& values = *snapshot.parameters;
  if (values.parameters().empty()) ImGui::TextDisabled("The program has no parameters.");
  const std::vector<program::ImageValue> images = values.images();
  for (const Parameter& parameter : values.parameters()) {
    std::string file;
    for (const program::ImageValue& image : images)
      if (image.parameter == parameter.name) file = image.file;
    const ParameterValue value = parameter.type == ParameterType::image ? ParameterValue{} : values.get(parameter.name);
    const std::string text = edited(parameter, value, file);
    if (!text.empty()) state.apply(job::interactive::SetParameter{parameter.name, text});
  }
  double samples = snapshot.state.samples;
  if (numberField(snapshot.countsFrames ? "Frames" : "Samples", samples, {.least = 1, .most = 65536, .whole = true},
                  snapshot.countsFrames ? "Number of frames that the program draws"
                                        : "Number of samples per pixel that the image reaches"))
    state.apply(job::interactive::SetSamples{static_cast<std::uint32_t>(samples)});
}

}  // namespace quintet::viewer
