#include <gtest/gtest.h>

#include "shader/compiler.h"

namespace quintet::shader {

TEST(Stage, ExtensionsAndNamesBelongTogether) {
  for (const Stage stage : {Stage::rayGeneration, Stage::intersection, Stage::anyHit, Stage::closestHit, Stage::miss,
                            Stage::callable, Stage::compute}) {
    EXPECT_EQ(stageOfFile("folder.rgen/main" + std::string(stageExtension(stage))), stage);
    EXPECT_FALSE(stageName(stage).empty());
  }
  EXPECT_EQ(stageName(Stage::anyHit), "any-hit");
  EXPECT_EQ(stageOfFile("a.rchit"), Stage::closestHit);
}

TEST(Stage, OtherFilesHaveNone) {
  EXPECT_FALSE(stageOfFile("a.glsl"));
  EXPECT_FALSE(stageOfFile("rgen"));
  EXPECT_FALSE(stageOfFile(""));
  EXPECT_FALSE(stageOfFile("a.RGEN"));
}

TEST(Diagnostic, FormatsWhatIsKnown) {
  EXPECT_EQ((Diagnostic{Severity::error, "a.rgen", 3, 7, "GLSL", "bad"}.format()), "a.rgen:3:7: error: bad [GLSL]");
  EXPECT_EQ((Diagnostic{Severity::warning, "a.rgen", 3, 0, "Q101", "odd"}.format()), "a.rgen:3: warning: odd [Q101]");
  EXPECT_EQ((Diagnostic{Severity::note, "a.rgen", 0, 0, "", "so"}.format()), "a.rgen: note: so");
  EXPECT_EQ((Diagnostic{Severity::error, "", 0, 0, "", "no"}.format()), "error: no");
}

}  // namespace quintet::shader
