// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include "shader/stage.h"

namespace quintet::shader {

TEST(Stage, HasANameAndAnExtension) {
  for (const Stage stage : {Stage::rayGeneration, Stage::intersection, Stage::anyHit, Stage::closestHit, Stage::miss,
                            Stage::callable, Stage::compute, Stage::vertex, Stage::fragment}) {
    EXPECT_EQ(stageOfFile("folder.rgen/main" + std::string(stageExtension(stage))), stage);
    EXPECT_FALSE(stageName(stage).empty());
  }
  EXPECT_EQ(stageName(Stage::anyHit), "any-hit");
  EXPECT_EQ(stageOfFile("a.rchit"), Stage::closestHit);
}

TEST(Stage, IsUnknownForOtherFiles) {
  EXPECT_FALSE(stageOfFile("a.glsl"));
  EXPECT_FALSE(stageOfFile("rgen"));
  EXPECT_FALSE(stageOfFile(""));
  EXPECT_FALSE(stageOfFile("a.RGEN"));
}

}  // namespace quintet::shader
