// SPDX-License-Identifier: Apache-2.0
#include "program/heat.h"

#include <algorithm>
#include <array>

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
constexpr std::size_t kMaxProgramOutputs = 32;  // shared::kMaxOutputs

}  // namespace

std::span<const HeatMap> heatMaps() { return kHeatMaps; }

Program withHeatMaps(Program program, const std::vector<std::string>& names) {
  for (const HeatMap& map : kHeatMaps) {
    const bool requested = std::ranges::find(names, map.name) != names.end();
    const bool exists = std::ranges::find(program.outputs, map.name, &Output::name) != program.outputs.end();
    if (!requested || exists || program.outputs.size() >= kMaxProgramOutputs) continue;
    Output& output = program.outputs.emplace_back();
    output.name = map.name;
    output.kind = OutputKind::heat;
    output.help = map.help;
    output.optional = output.isHeatMap = true;
  }
  return program;
}

bool hasHeatMap(const Program& program, const std::vector<std::string>& outputs) {
  return std::ranges::any_of(program.outputs, [&](const Output& output) {
    return output.isHeatMap && std::ranges::find(outputs, output.name) != outputs.end();
  });
}

}  // namespace quintet::program
