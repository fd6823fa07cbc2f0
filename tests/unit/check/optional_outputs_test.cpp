// SPDX-License-Identifier: Apache-2.0
// The code of optional outputs is checked too: #ifdef QUINTET_OUTPUT_… .
#include "check_test_support.h"

namespace quintet::check {
namespace {

// The clean program with two optional outputs, and this code in its ray generation shader from line 13 on.
Files withOutputs(const std::string& code) {
  Files files = cleanFiles();
  files["program.toml"] +=
      "\n[[output]]\nname = \"color\"\n\n[[output]]\nname = \"albedo\"\noptional = true\n\n[[output]]\nname = "
      "\"depth\"\noptional = true\n";
  const std::string store = "  addOutput(0u, launchPixel(), vec4(color, 1.0));\n";
  files["main.rgen"] = changed(files["main.rgen"], store,
                               code + store + "#ifdef QUINTET_OUTPUT_albedo\n" + changed(store, "0u", "1u") +
                                   "#endif\n#ifdef QUINTET_OUTPUT_depth\n" + changed(store, "0u", "2u") + "#endif\n");
  return files;
}

std::string checkAll(const Files& files) {
  return textOf(checkWithOptionalOutputs(program::parseProgram(files.at("program.toml"), "demo", "folder/demo", files),
                                         checkCompiler(), nullptr, {}));
}

std::string checkDefaults(const std::string& code) { return textOf(checkFiles(withOutputs(code))); }

TEST(OptionalOutputs, AreCheckedWithoutAMistake) {
  EXPECT_EQ(checkAll(withOutputs("#ifdef QUINTET_OUTPUT_albedo\n  color += 1.0;\n#endif\n")), "");
  EXPECT_EQ(checkAll(cleanFiles()), "");
}

TEST(OptionalOutputs, ReportOutputsThatAreNotStored) {
  const Files files = withOutputs("");
  EXPECT_TRUE(reportsOnly(checkAll(edited(files, "main.rgen", "addOutput(2u", "addOutput(1u")),
                          "Q712 program.toml:24:0 ", {"'depth'", "(with optional output 'depth')"}));
}

TEST(OptionalOutputs, ReportTheirTypingErrorsWithFileAndLine) {
  const std::string code = "#ifdef QUINTET_OUTPUT_depth\n  color += colr;\n#endif\n";
  EXPECT_EQ(checkDefaults(code), "");
  EXPECT_TRUE(reportsOnly(checkAll(withOutputs(code)), "GLSL main.rgen:14:12 ",
                          {"'colr' : undeclared identifier", "(with optional output 'depth')"}));
}

TEST(OptionalOutputs, ReportEachOutputOnce) {
  const std::string text =
      checkAll(withOutputs("#ifdef QUINTET_OUTPUT_albedo\n  color += colr;\n#endif\n#ifdef QUINTET_OUTPUT_depth\n  "
                           "color += dpth;\n#endif\n"));
  EXPECT_EQ(std::ranges::count(text, '\n'), 2) << text;
  EXPECT_TRUE(reports(text, "GLSL main.rgen:14:", {"'colr'", "(with optional output 'albedo')"}));
  EXPECT_TRUE(reports(text, "GLSL main.rgen:17:", {"'dpth'", "(with optional output 'depth')"}));
}

TEST(OptionalOutputs, ReportWhatFailsOnlyWithAllOfThem) {
  const std::string code =
      "#ifdef QUINTET_OUTPUT_albedo\n  vec3 extra = vec3(0.0);\n#endif\n#ifdef QUINTET_OUTPUT_depth\n  vec3 extra = "
      "vec3(0.0);\n#endif\n";
  EXPECT_TRUE(reportsOnly(checkAll(withOutputs(code)), "GLSL main.rgen:17:",
                          {"'extra' : redefinition", "(with all optional outputs: albedo, depth)"}));
}

TEST(OptionalOutputs, DoNotRepeatOtherDiagnostics) {
  EXPECT_TRUE(reportsOnly(checkAll(withOutputs("  color += colr;\n")), "GLSL main.rgen:13:", {"'colr'"}));
  const Files files = edited(withOutputs(""), "main.rgen", "0xFFu", "0x1FFu");
  EXPECT_TRUE(reportsOnly(checkAll(files), "Q505 main.rgen:10:"));
}

TEST(OptionalOutputs, AreCheckedByTheRules) {
  const std::string code =
      "#ifdef QUINTET_OUTPUT_depth\n  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0x1FFu, kRay_primary, kRayTypeCount, "
      "kMiss_primary, vec3(1), 0.0, vec3(0, 0, 1), 1e30, 0);\n#endif\n";
  EXPECT_EQ(checkDefaults(code), "");
  EXPECT_TRUE(reportsOnly(checkAll(withOutputs(code)), "Q505 main.rgen:14:", {"(with optional output 'depth')"}));
}

// A stage that only an optional output reaches is used.
TEST(OptionalOutputs, CanUseStages) {
  Files files = withOutputs(
      "#ifdef QUINTET_OUTPUT_depth\n  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount, 2u, "
      "vec3(1), 0.0, vec3(0, 0, 1), 1e30, 0);\n#endif\n");
  files["program.toml"] += "\n[[miss]]\nname = \"other\"\nfile = \"other.rmiss\"\n";
  files["other.rmiss"] = files["sky.rmiss"];
  EXPECT_TRUE(reports(textOf(checkFiles(files)), "Q801 "));
  EXPECT_EQ(checkAll(files), "");
}

}  // namespace
}  // namespace quintet::check
