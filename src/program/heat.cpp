// SPDX-License-Identifier: Apache-2.0
#include "program/heat.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "program/description/limits.h"

namespace quintet::program {
namespace {

constexpr std::array kHeatMaps{
    HeatMap{kHeatTime, "Time of a sample, in ticks of the device's shader clock"},
    HeatMap{"heat_rays", "Number of rays per sample"},
    HeatMap{"heat_bounces", "Number of rays per sample that can run a closest-hit shader"},
    HeatMap{"heat_depth", "Depth of nested traces"},
    HeatMap{"heat_any_hit", "Number of any-hit shader calls per sample"},
    HeatMap{"heat_intersection", "Number of intersection shader calls per sample"},
};

void addHeatMap(Program& program, const HeatMap& map) {
  Output& output = program.outputs.emplace_back();
  output.name = map.name;
  output.kind = OutputKind::heat;
  output.help = map.help;
  output.optional = output.isHeatMap = true;
}

bool hasOutput(const Program& program, std::string_view name) {
  return std::ranges::find(program.outputs, name, &Output::name) != program.outputs.end();
}

}  // namespace

std::span<const HeatMap> heatMaps() { return kHeatMaps; }

std::vector<std::string> heatMapNames() {
  std::vector<std::string> names;
  for (const HeatMap& map : kHeatMaps) names.emplace_back(map.name);
  return names;
}

Program withHeatMaps(Program program, const std::vector<std::string>& names) {
  for (const HeatMap& map : kHeatMaps) {
    if (std::ranges::find(names, map.name) == names.end() || hasOutput(program, map.name)) continue;
    if (program.outputs.size() >= kMaxOutputs)
      throw UsageError(fmt::format("heat map '{}': the program '{}' would have more than {} outputs", map.name,
                                   program.name, kMaxOutputs));
    addHeatMap(program, map);
  }
  return program;
}

Program withAllHeatMaps(Program program) {
  for (const HeatMap& map : kHeatMaps)
    if (!hasOutput(program, map.name) && program.outputs.size() < kMaxOutputs) addHeatMap(program, map);
  return program;
}

bool hasHeatMap(const Program& program, const std::vector<std::string>& outputs, std::string_view name) {
  return std::ranges::any_of(program.outputs, [&](const Output& output) {
    return output.isHeatMap && (name.empty() || output.name == name) &&
           std::ranges::find(outputs, output.name) != outputs.end();
  });
}

}  // namespace quintet::program
