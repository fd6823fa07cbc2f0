// SPDX-License-Identifier: Apache-2.0
// The stages of devices with driver defects. tests/gpu/program tests the images.
#include "program/linked/device_stages.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace quintet::program
