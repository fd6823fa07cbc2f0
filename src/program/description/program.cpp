// SPDX-License-Identifier: Apache-2.0
#include "program/description/program.h"

#include <algorithm>
#include <array>

namespace quintet::program {

bool isLibraryStage(const std::string& file) { return file.size() > 2 && file.front() == '<' && file.back() == '>'; }

const std::vector<std::string>& geometryClasses() {
  static const std::vector<std::string> kClasses{"triangles",  "solids", "csg",   "custom",
                                                 "procedural", "opaque", "alpha", "thin"};
  return kClasses;
}

std::string_view outputKindName(OutputKind kind) {
  constexpr std::array<std::string_view, 7> kNames{"color", "linear", "normal", "depth", "id", "display", "heat"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string_view outputPixelName(OutputPixel pixel) {
  constexpr std::array<std::string_view, 3> kNames{"mean", "center", "coverage"};
  return kNames[static_cast<std::size_t>(pixel)];
}

std::vector<std::string> outputChannels(const Output& output) {
  if (!output.channels.empty()) return output.channels;
  switch (output.kind) {
    case OutputKind::color:
    case OutputKind::display: return {"R", "G", "B"};
    case OutputKind::linear:
    case OutputKind::normal: return {"X", "Y", "Z"};
    case OutputKind::depth: return {"Z"};
    case OutputKind::id:
    case OutputKind::heat: return {"X"};
  }
  return {};
}

bool holdsColor(const Output& output) {
  const std::vector<std::string> channels = outputChannels(output);
  const std::vector<std::string> colors{"R", "G", "B"};
  return channels.size() >= 3 && std::equal(colors.begin(), colors.end(), channels.begin());
}

std::vector<MissShader> missShaders(const Program& program) {
  std::vector<MissShader> all;
  for (const RayType& ray : program.rays) all.push_back({ray.name, ray.miss, ray.record, ray.line});
  all.insert(all.end(), program.misses.begin(), program.misses.end());
  return all;
}

std::vector<std::string> outputNames(const Program& program) {
  std::vector<std::string> names;
  for (const Output& output : program.outputs) names.push_back(output.name);
  return names;
}

std::vector<std::string> optionalOutputs(const Program& program) {
  std::vector<std::string> names;
  for (const Output& output : program.outputs)
    if (output.optional) names.push_back(output.name);
  return names;
}

std::string outputMacro(const std::string& name) { return "QUINTET_OUTPUT_" + name; }

void chooseDefaultScene(Program& program) {
  if (!program.scene.empty()) return;
  const auto isScene = [](const auto& file) { return file.first.ends_with(".scene.toml"); };
  if (std::ranges::count_if(program.files, isScene) == 1)
    program.scene = std::ranges::find_if(program.files, isScene)->first;
}

}  // namespace quintet::program
