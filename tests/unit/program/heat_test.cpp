// SPDX-License-Identifier: Apache-2.0
// Heat maps become outputs of a program on request.
#include "program/heat.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "program/description/limits.h"

namespace quintet::program {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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
  const Program almost = programWith(std::vector<std::string>(kMaxOutputs - 1, "a"));
  EXPECT_EQ(withHeatMaps(almost, {"heat_rays"}).outputs.back().name, "heat_rays");
  EXPECT_EQ(withAllHeatMaps(almost).outputs.size(), kMaxOutputs);
  try {
    withHeatMaps(almost, {"heat_rays", "heat_depth"});
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("'heat_depth'"), HasSubstr("32 outputs")));
  }
}

TEST(HeatMaps, AreFoundByName) {
  const Program program = withAllHeatMaps(programWith({"color", "heat_depth"}));
  EXPECT_EQ(program.outputs.size(), 1 + heatMaps().size());
  EXPECT_TRUE(hasHeatMap(program, {"heat_rays", "heat_time"}, kHeatTime));
  EXPECT_FALSE(hasHeatMap(program, {"heat_rays"}, kHeatTime));
  EXPECT_FALSE(hasHeatMap(program, {"heat_depth"}, "heat_depth")) << "it is an output of the program";
  EXPECT_EQ(heatMapNames().front(), kHeatTime);
}

TEST(HeatMaps, HaveUniqueNames) {
  for (const HeatMap& a : heatMaps()) {
    EXPECT_TRUE(a.name.starts_with("heat_"));
    EXPECT_EQ(std::ranges::count(heatMaps(), a.name, &HeatMap::name), 1) << a.name;
  }
}

}  // namespace
}  // namespace quintet::program
