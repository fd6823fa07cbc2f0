// SPDX-License-Identifier: Apache-2.0
// Heat maps become outputs of a program on request.
#include "program/heat.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace quintet::program {
namespace {

Program programWith(const std::vector<std::string>& outputs) {
  Program program;
  for (const std::string& name : outputs) program.outputs.push_back({.name = name});
  return program;
}

TEST(HeatMaps, AreAddedOnRequest) {
  const Program program = withHeatMaps(programWith({"color"}), {"heat_rays", "normal", "heat_time"});
  EXPECT_EQ(outputNames(program), (std::vector<std::string>{"color", "heat_time", "heat_rays"}));
  EXPECT_EQ(optionalOutputs(program), (std::vector<std::string>{"heat_time", "heat_rays"}));
  EXPECT_EQ(program.outputs[1].kind, OutputKind::heat);
  EXPECT_EQ(outputChannels(program.outputs[1]), std::vector<std::string>{"X"});
  EXPECT_FALSE(holdsColor(program.outputs[1]));
}

TEST(HeatMaps, AnOutputOfTheProgramComesFirst) {
  const Program program = withHeatMaps(programWith({"color", "heat_rays"}), {"heat_rays"});
  EXPECT_EQ(program.outputs.size(), 2u);
  EXPECT_FALSE(hasHeatMap(program, {"heat_rays"}));
}

TEST(HeatMaps, MustBeRequestedToBeCounted) {
  const Program program = withHeatMaps(programWith({"color"}), {"heat_rays"});
  EXPECT_TRUE(hasHeatMap(program, {"heat_rays"}));
  EXPECT_FALSE(hasHeatMap(program, {"heat_time"}));
  EXPECT_FALSE(hasHeatMap(program, {}));
}

TEST(HeatMaps, DoNotExceedTheNumberOfOutputs) {
  const Program program = withHeatMaps(programWith(std::vector<std::string>(31, "a")), {"heat_time", "heat_rays"});
  EXPECT_EQ(program.outputs.size(), 32u);
}

TEST(HeatMaps, HaveUniqueNames) {
  for (const HeatMap& a : heatMaps()) {
    EXPECT_TRUE(a.name.starts_with("heat_"));
    EXPECT_EQ(std::ranges::count(heatMaps(), a.name, &HeatMap::name), 1) << a.name;
  }
}

}  // namespace
}  // namespace quintet::program
