// SPDX-License-Identifier: Apache-2.0
// Compares the table of built-ins by stage with the compiler, and checks the messages made from it.
#include "shader/stage_builtins.h"

#include <gmock/gmock.h>

#include "shader_test_support.h"

namespace quintet::shader {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Result compileMain(Stage stage, const std::string& statement, const std::string& globals = "") {
  Source source;
  source.stage = stage;
  source.name = "test" + std::string(stageExtension(stage));
  source.text =
      "#version 460\n#extension GL_EXT_ray_tracing : require\n" + globals + "\nvoid main() {\n" + statement + "\n}\n";
  static const Compiler compiler({.libraryOverride = {}, .includeFolders = {}, .cacheFolder = {}, .optimize = false});
  return compiler.compile(source);
}

// Returns globals and a statement that use the built-in. Payloads are declared only where they are allowed.
std::pair<std::string, std::string> useOf(const StageBuiltIn& builtIn, bool available) {
  const std::string name(builtIn.name);
  if (name == "traceRayEXT")
    return {std::string("layout(binding = 0) uniform accelerationStructureEXT tlas;") +
                (available ? "layout(location = 0) rayPayloadEXT vec3 p;" : ""),
            "traceRayEXT(tlas, 0u, 255u, 0u, 1u, 0u, vec3(0), 0.0, vec3(1), 1.0, 0);"};
  if (name == "executeCallableEXT")
    return {available ? "layout(location = 0) callableDataEXT vec3 p;" : "", "executeCallableEXT(0u, 0);"};
  if (name == "reportIntersectionEXT") return {"", "reportIntersectionEXT(1.0, 0u);"};
  return {"", name + ";"};
}

TEST(StageBuiltIns, AreSorted) {
  EXPECT_TRUE(std::ranges::is_sorted(stageBuiltIns(), {}, &StageBuiltIn::name));
  for (const StageBuiltIn& builtIn : stageBuiltIns()) EXPECT_EQ(findStageBuiltIn(builtIn.name), &builtIn);
  EXPECT_EQ(findStageBuiltIn("gl_Position"), nullptr);
}

TEST(StageBuiltIns, AgreeWithTheCompiler) {
  for (const Stage stage :
       {Stage::rayGeneration, Stage::intersection, Stage::anyHit, Stage::closestHit, Stage::miss, Stage::callable}) {
    for (const StageBuiltIn& builtIn : stageBuiltIns()) {
      const auto [globals, statement] = useOf(builtIn, builtIn.availableIn(stage));
      const Result result = compileMain(stage, statement, globals);
      EXPECT_EQ(result.ok(), builtIn.availableIn(stage)) << builtIn.name << " in " << stageName(stage) << "\n"
                                                         << all(result);
      if (result.ok()) continue;
      EXPECT_EQ(result.diagnostics.at(0).id, "Q706") << all(result);
    }
  }
}

TEST(StageBuiltIns, ListTheStagesThatHaveABuiltIn) {
  const Result result = compileMain(Stage::rayGeneration, "float x = gl_HitTEXT;");
  ASSERT_EQ(result.diagnostics.size(), 1u) << all(result);
  EXPECT_EQ(result.diagnostics[0].id, "Q706");
  EXPECT_THAT(result.diagnostics[0].text, AllOf(HasSubstr("gl_HitTEXT"), HasSubstr("a ray generation shader"),
                                                HasSubstr("any-hit and closest-hit shaders")));
  EXPECT_EQ(result.diagnostics[0].line, 5);
  EXPECT_EQ(result.diagnostics[0].column, 11);
}

TEST(StageBuiltIns, IncludeStatements) {
  const Result result = compileMain(Stage::closestHit, "ignoreIntersectionEXT;");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.diagnostics.at(0).id, "Q706");
  EXPECT_THAT(result.diagnostics.at(0).text, AllOf(HasSubstr("ignoreIntersectionEXT"),
                                                   HasSubstr("a closest-hit shader"), HasSubstr("any-hit shaders")));
}

TEST(StageBuiltIns, ExplainAHitAttributeInAMissShader) {
  const Result result = compileMain(Stage::miss, "", "hitAttributeEXT vec2 baryCoord;");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.diagnostics.at(0).id, "Q204");
  EXPECT_EQ(result.diagnostics.at(0).line, 3);
  EXPECT_THAT(result.diagnostics.at(0).text, HasSubstr("miss shader"));
}

TEST(StageBuiltIns, KeepOtherMessages) {
  std::vector<Diagnostic> diagnostics{{Severity::error, "a", 1, 1, "GLSL", "'color' : undeclared identifier"},
                                      {Severity::error, "a", 1, 1, "GLSL", "'gl_HitTEXT' : cannot convert"},
                                      {Severity::error, "a", 1, 1, "GLSL", "syntax error"}};
  const auto before = diagnostics;
  explainMissingBuiltIns(diagnostics, Stage::miss);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(diagnostics[i].format(), before[i].format());
  // The compiler explains a call with wrong arguments in a stage that can trace.
  const Result result = compileMain(Stage::rayGeneration, "traceRayEXT(1);");
  EXPECT_EQ(result.diagnostics.at(0).id, "GLSL") << all(result);
}

}  // namespace
}  // namespace quintet::shader
