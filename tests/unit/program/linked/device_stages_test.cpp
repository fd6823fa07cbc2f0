// SPDX-License-Identifier: Apache-2.0
// The stages of devices with driver defects. tests/gpu/program tests the images.
#include "program/linked/device_stages.h"

#include <gtest/gtest.h>

#include "spirv/interleave_rows.h"
#include "spirv/launch_test_support.h"

namespace quintet::program {
namespace {

CompiledProgram compiled() {
  CompiledProgram result;
  result.stages = {{"main.rgen", shader::Stage::rayGeneration, {1}},
                   {"sphere.rint", shader::Stage::intersection, {2, 3}},
                   {"a.rahit", shader::Stage::anyHit, {4}},
                   {"b.rahit", shader::Stage::anyHit, {5}}};
  result.ok = true;
  return result;
}

TEST(DeviceStages, KeepsTheCompiledStagesWithoutDefects) {
  const CompiledProgram program = compiled();
  const DeviceStages stages({}, program, {});
  EXPECT_EQ(stages.index("a.rahit"), 2);
  EXPECT_EQ(stages.index(""), rt::kNoStage);
  EXPECT_EQ(stages.index("sphere.rint"), 1);
  EXPECT_EQ(stages.stages().size(), 4u);
}

// If one stage had other rows than the rest, shaders would disagree on the pixel.
TEST(DeviceStages, InterleavesTheRowsOfAllStagesOrOfNone) {
  const std::vector<std::uint32_t> words = spirv::compileRayGeneration(spirv::kStoresAtItsPlace);
  CompiledProgram program;
  program.stages = {{"a.rgen", shader::Stage::rayGeneration, words}, {"b.rgen", shader::Stage::rayGeneration, words}};
  program.ok = true;
  gpu::Quirks quirks;
  quirks.launchParts = 2;
  const auto moduleOf = [&](std::size_t stage) {
    const DeviceStages stages({}, program, quirks);
    return std::vector<std::uint32_t>(stages.stages()[stage].spirv.begin(), stages.stages()[stage].spirv.end());
  };
  for (std::size_t stage : {0u, 1u}) EXPECT_EQ(moduleOf(stage), spirv::interleaveRows(words, 2));
  EXPECT_NE(moduleOf(0), words);
  program.stages[1].spirv = spirv::withCopiedPointers(words);
  ASSERT_FALSE(spirv::canInterleaveRows(program.stages[1].spirv));
  EXPECT_EQ(moduleOf(0), words);
}

}  // namespace
}  // namespace quintet::program
