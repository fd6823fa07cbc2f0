// Which stages a device with defects gets. That the pictures are then right, tests/gpu/program shows.
#include "program/device_stages.h"

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

TEST(DeviceStages, DeviceWithoutDefectsGetsTheCompilersStages) {
  const CompiledProgram program = compiled();
  DeviceStages stages({}, program, {});
  EXPECT_EQ(stages.index("a.rahit"), 2);
  EXPECT_EQ(stages.index(""), rt::kNoStage);
  EXPECT_EQ(stages.intersection("sphere.rint", "a.rahit"), 1);
  EXPECT_EQ(stages.intersection("sphere.rint", "b.rahit"), 1);
  EXPECT_EQ(stages.intersection("", "b.rahit"), rt::kNoStage);
  EXPECT_EQ(stages.stages().size(), 4u);
}

TEST(DeviceStages, EachAnyHitShaderGetsAnIntersectionStageOfItsOwn) {
  const CompiledProgram program = compiled();
  gpu::Quirks quirks;
  quirks.sharesAnyHit = true;
  DeviceStages stages({}, program, quirks);
  EXPECT_EQ(stages.intersection("sphere.rint", "a.rahit"), 1);
  EXPECT_EQ(stages.intersection("sphere.rint", "b.rahit"), 4);
  EXPECT_EQ(stages.intersection("sphere.rint", ""), 5);
  EXPECT_EQ(stages.intersection("sphere.rint", "b.rahit"), 4);
  EXPECT_EQ(stages.intersection("", "b.rahit"), rt::kNoStage);
  ASSERT_EQ(stages.stages().size(), 6u);
  EXPECT_EQ(stages.stages()[4].stage, shader::Stage::intersection);
  EXPECT_EQ(stages.stages()[4].spirv.data(), stages.stages()[1].spirv.data());
}

}  // namespace
}  // namespace quintet::program
