// SPDX-License-Identifier: Apache-2.0
// Which programs get their pipeline before their scene is checked, and that linking then finds it.
#include "job/early_pipeline.h"

#include <gtest/gtest.h>

#include "job/test_engine.h"
#include "program/load.h"
#include "quintet/shared/pass.h"

namespace quintet::job {
namespace {

class EarlyPipelines : public ::testing::Test {
 protected:
  static program::CompiledProgram compiled(const program::Program& program) {
    program::CompiledProgram result = program::compile(program, testEngine().compiler(), {});
    EXPECT_TRUE(result.ok);
    return result;
  }
  static bool isEarly(const program::Program& program) {
    return EarlyPipeline::make(testEngine().context(), program, compiled(program), testEngine().pipelineCache()) !=
           nullptr;
  }
};

TEST_F(EarlyPipelines, LinkingFindsThePipeline) {
  const program::Program normals = program::loadProgram("<programs/normals>");
  const program::CompiledProgram stages = compiled(normals);
  gpu::Context& context = testEngine().context();
  const auto early = EarlyPipeline::make(context, normals, stages, testEngine().pipelineCache());
  ASSERT_TRUE(early);
  const gpu::BindlessSet set(context, 7, shared::kPushConstantBytes);
  const program::LinkedProgram first(context, set, normals, stages, 1, &testEngine().pipelineCache());
  const program::LinkedProgram second(context, set, normals, stages, 2, &testEngine().pipelineCache());
  EXPECT_EQ(first.pipeline().handle(), early->linked().pipeline().handle());
  EXPECT_NE(second.pipeline().handle(), early->linked().pipeline().handle()) << "another depth needs another pipeline";
}

// The check of a program comes first if it can fail, or if it decides on the depth.
TEST_F(EarlyPipelines, OtherProgramsAreCheckedFirst) {
  program::Program own = program::loadProgram("<programs/normals>");
  EXPECT_TRUE(isEarly(own));
  own.origin = "my_program";
  EXPECT_FALSE(isEarly(own));
  EXPECT_FALSE(isEarly(program::loadProgram("<programs/lessons/07_mirror_recursion>")));
}

}  // namespace
}  // namespace quintet::job
