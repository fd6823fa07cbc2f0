// SPDX-License-Identifier: Apache-2.0
// Heat maps: outputs of every program that show what its pixels cost. An instrumented variant of the program writes them
// (program/probes.h).
#ifndef QUINTET_PROGRAM_HEAT_H
#define QUINTET_PROGRAM_HEAT_H

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "program/description/program.h"

namespace quintet::program {

struct HeatMap {
  std::string_view name;  // of the output
  std::string_view help;
};

inline constexpr std::string_view kHeatTime = "heat_time";

std::span<const HeatMap> heatMaps();
std::vector<std::string> heatMapNames();

// Returns the program with an optional output for each name of a heat map, unless it has an output of this name itself.
// Other names are ignored. Throws UsageError if the program then has more than kMaxOutputs outputs.
Program withHeatMaps(Program program, const std::vector<std::string>& names);
// The same with as many heat maps as the program can have.
Program withAllHeatMaps(Program program);

// True if one of the outputs is a heat map of the program; with a name, if it is this one.
bool hasHeatMap(const Program& program, const std::vector<std::string>& outputs, std::string_view name = {});

}  // namespace quintet::program
#endif
