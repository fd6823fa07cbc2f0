// SPDX-License-Identifier: Apache-2.0
// Suppressions in sources and descriptions (check/suppression.h), and what the check does with them.
#include "check/suppression.h"

#include "check_test_support.h"
#include "program/lecture/lecture.h"

namespace quintet::check {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(CheckSuppression, AppliesToItsLineOrToTheNextLineOfCode) {
  const std::vector<Suppression> found = findSuppressions("a.rgen",
                                                          "int a;  // quintet: allow Q604 leaves are solid\n"
                                                          "// quintet: allow Q104, Q105 set by the caller\n"
                                                          "\n"
                                                          "// why\n"
                                                          "/* quintet: allow q506 */\n"
                                                          "int b; /* quintet: allow Q705 */ int c;\n");
  ASSERT_THAT(found, SizeIs(4));
  EXPECT_THAT(found[0].ids, ElementsAre("Q604"));
  EXPECT_EQ(found[0].reason, "leaves are solid");
  EXPECT_EQ(found[0].line, 1);
  EXPECT_EQ(found[0].location.column, 9);
  EXPECT_THAT(found[1].ids, ElementsAre("Q104", "Q105"));
  EXPECT_EQ(found[1].reason, "set by the caller");
  EXPECT_EQ(found[1].location.line, 2);
  EXPECT_EQ(found[1].line, 6);
  EXPECT_THAT(found[2].ids, ElementsAre("Q506"));
  EXPECT_EQ(found[2].line, 6);
  EXPECT_THAT(found[3].ids, ElementsAre("Q705"));
  EXPECT_EQ(found[3].reason, "");
  for (const Suppression& s : found) EXPECT_EQ(s.problem, "");
}

TEST(CheckSuppression, HasCommentsOfTomlInDescriptions) {
  const std::vector<Suppression> found = findSuppressions("p/program.toml",
                                                          "# quintet: allow Q802 for other scenes\r\n"
                                                          "[[hit_group]]  # quintet: allow Q604\r\n"
                                                          "// quintet: allow Q604\r\n");
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].line, 2);
  EXPECT_EQ(found[0].reason, "for other scenes");
  EXPECT_EQ(found[1].line, 2);
  EXPECT_THAT(found[1].ids, ElementsAre("Q604"));
}

TEST(CheckSuppression, IgnoresOtherComments) {
  EXPECT_THAT(findSuppressions("a.rgen",
                               "// see quintet: allow Q604\n"
                               "// quintet: a renderer\n"
                               "// quintet\n"
                               "quintet: allow Q604\n"),
              IsEmpty());
}

TEST(CheckSuppression, NamesTheProblem) {
  const auto problem = [](const std::string& comment) {
    const std::vector<Suppression> found = findSuppressions("a.rgen", "// quintet: " + comment + "\n");
    return found.empty() ? std::string("none") : found[0].problem;
  };
  EXPECT_THAT(problem("allow"), HasSubstr("is missing"));
  EXPECT_THAT(problem("allow Q6O4 solid"), HasSubstr("unknown diagnostic 'Q6O4' (did you mean 'Q604'?)"));
  EXPECT_THAT(problem("allow Q604, Q999"), HasSubstr("'Q999'"));
  EXPECT_THAT(problem("allow Q101 not my fault"), HasSubstr("Q101 is an error"));
  EXPECT_THAT(problem("alow Q604"), HasSubstr("unknown word 'alow'"));
  EXPECT_EQ(problem("allow Q604: solid"), "");
}

// A cull mask of more than 8 bits is Q505.
Files withWideMask(const std::string& comment) {
  return edited(edited(cleanFiles(), "main.rgen", "0xFFu", "0x1FFu"), "main.rgen", "  traceRayEXT",
                comment + "\n  traceRayEXT");
}

TEST(CheckSuppression, MovesAcceptedDiagnosticsToTheirOwnList) {
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(withWideMask(""))), "Q505 main.rgen:11:3 "));
  const CheckResult result = checkFiles(withWideMask("  // quintet: allow Q505 the low bits count"));
  EXPECT_EQ(textOf(result), "");
  ASSERT_THAT(result.suppressed, SizeIs(1));
  EXPECT_EQ(result.suppressed[0].diagnostic.id, "Q505");
  EXPECT_EQ(result.suppressed[0].diagnostic.line, 11);
  EXPECT_EQ(result.suppressed[0].reason, "the low bits count");
  EXPECT_EQ(result.suppressed[0].comment.line, 10);
}

TEST(CheckSuppression, Q803ReportsUnusedSuppressions) {
  EXPECT_TRUE(
      reportsOnly(checkEdited(cleanFiles(), "main.rgen", "  traceRayEXT", "  // quintet: allow Q505\n  traceRayEXT"),
                  "Q803 main.rgen:10:3 ", {"Q505", "line 11"}));
  // A check with a scene can give this one.
  const Files files = edited(cleanFiles(), "main.rgen", "  traceRayEXT", "  // quintet: allow Q507\n  traceRayEXT");
  const program::SceneFacts scene = sceneWith({{program::GeometryKind::triangles, true, "tree", "leaf"}});
  EXPECT_EQ(textOf(checkFiles(files)), "");
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(files, &scene)), "Q803 main.rgen:10:3 ", {"Q507"}));
  // Only a run or a device can give these.
  EXPECT_EQ(checkEdited(cleanFiles(), "main.rgen", "  traceRayEXT", "  // quintet: allow Q005, Q901\n  traceRayEXT"),
            "");
}

TEST(CheckSuppression, Q804ReportsInvalidSuppressions) {
  const std::string text = textOf(checkFiles(withWideMask("  // quintet: allow Q5O5")));
  EXPECT_TRUE(reports(text, "Q505 main.rgen:11:3 "));
  EXPECT_TRUE(reports(text, "Q804 main.rgen:10:3 ", {"'Q5O5'", "'Q505'"}));
}

TEST(CheckSuppression, CannotHideErrors) {
  const Files files = edited(edited(cleanFiles(), "main.rgen", "kMiss_primary,", "7u,"), "main.rgen", "  traceRayEXT",
                             "  // quintet: allow Q502\n  traceRayEXT");
  EXPECT_TRUE(reports(textOf(checkFiles(files)), "Q502 main.rgen:11:3 "));
}

TEST(CheckSuppression, WorksInDescriptions) {
  Files files = cleanFiles();
  files["program.toml"] +=
      "\n# quintet: allow Q802 for scenes with glass\n[[hit_group]]\nname = \"glass\"\nmaterial = \"glass\"\n"
      "primary = { closest_hit = \"surface.rchit\" }\n";
  const program::SceneFacts scene = sceneWith({{program::GeometryKind::triangles, true, "tree", "leaf"}});
  const CheckResult result = checkFiles(files, &scene);
  EXPECT_EQ(textOf(result), "");
  ASSERT_THAT(result.suppressed, SizeIs(1));
  EXPECT_EQ(result.suppressed[0].diagnostic.id, "Q802");
}

// The stages of a lecture-form file are parts of one text: its comments count once, with its name and lines.
TEST(CheckSuppression, WorksInTheLectureForm) {
  const std::string text =
      "struct RayPayloadType { vec3 color; };\n"
      "void main() { /**** RAY GENERATION SHADER ****/\n"
      "  // quintet: allow Q505 the low bits count\n"
      "  traceRayEXT(topLevelAS, 0u, 0x1FFu, 0u, 1u, 0u, vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), 1e9, 0);\n"
      "  gsnSetPixel(vec4(payload.color, 1.0));\n"
      "}\n"
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(baryCoord, 1.0); }\n"
      "void main() { /**** MISS SHADER ****/ payload.color = gl_WorldRayDirectionEXT; }\n";
  const auto checkText = [](const std::string& source) {
    return check(program::parseLecture(source, "a.rt.glsl", "folder/demo"), checkCompiler(), nullptr, {});
  };
  const CheckResult result = checkText(text);
  EXPECT_EQ(textOf(result), "");
  ASSERT_THAT(result.suppressed, SizeIs(1));
  EXPECT_EQ(result.suppressed[0].comment.file, "folder/demo/a.rt.glsl");
  EXPECT_TRUE(reportsOnly(textOf(checkText(changed(text, "0x1FFu", "0xFFu"))), "Q803 a.rt.glsl:3:3 ", {"line 4"}));
}

}  // namespace
}  // namespace quintet::check
