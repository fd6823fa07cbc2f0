// SPDX-License-Identifier: Apache-2.0
// Which programs get their pipeline before their scene is checked, and that linking then finds it.
#include "job/early_pipeline.h"

#include <gtest/gtest.h>

#include "job/engine.h"
#include "program/load.h"
#include "quintet/shared/pass.h"

namespace quintet::job {
namespace {

class EarlyPipelines : public ::testing::Test {
 protected:
  static Engine& engine() {
    static Engine engine({.caches = {}});
    return engine;
  }
  static program::CompiledProgram compiled(const program::Program& program) {
    program::CompiledProgram result = program::compile(program, engine().compiler(), {});
    EXPECT_TRUE(result.ok);
    return result;
  }
  static bool isEarly(const program::Program& program) {
    return EarlyPipeline::make(engine().context(), program, compiled(program), engine().pipelineCache()) != nullptr;
  }
};

TEST_F(EarlyPipelines, LinkingFindsThePipeline) {
  const program::Program normals = program::loadProgram("<programs/normals>");
  const program::CompiledProgram stages = compiled(normals);
  gpu::Context& context = engine().context();
  const auto early = EarlyPipeline::make(context, normals, stages, engine().pipelineCache());
  ASSERT_TRUE(early);
  const gpu::BindlessSet set(context, 7, shared::kPushConstantBytes);
  const program::LinkedProgram first(context, set, normals, stages, 1, &engine().pipelineCache());
  const program::LinkedProgram second(context, set, normals, stages, 2, &engine().pipelineCache());
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
