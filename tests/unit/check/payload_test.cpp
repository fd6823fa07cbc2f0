// SPDX-License-Identifier: Apache-2.0
// Q101 to Q105 and Q301 to Q303: mistakes with payloads and callable data, and similar code that is correct.
#include <fmt/format.h>

#include "check_test_support.h"
#include "program/lecture/lecture.h"

namespace quintet::check {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(CheckPayload, AcceptsProgramsWithoutMistakes) {
  EXPECT_EQ(textOf(checkFiles(cleanFiles())), "");
  EXPECT_EQ(textOf(checkFiles(boxFiles())), "");
  EXPECT_EQ(textOf(checkFiles(callFiles())), "");
}

TEST(CheckPayload, Q101ReportsADifferentType) {
  Files files = edited(cleanFiles(), "sky.rmiss", "struct Payload { vec3 color; float t; }",
                       "struct Payload { vec4 color; float t; }");
  files["sky.rmiss"] = changed(files["sky.rmiss"], "payload.color = gl_WorldRayDirectionEXT",
                               "payload.color = vec4(gl_WorldRayDirectionEXT, 1.0)");
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(files)), "Q101 main.rgen:10:3 ",
                          {"struct Payload { vec3 color; float t; }", "miss shader 'sky.rmiss' (miss index 0)",
                           "struct Payload { vec4 color; float t; }", "member 0 'color': vec3 vs vec4"}));
}

TEST(CheckPayload, Q101ReportsADifferentOrder) {
  EXPECT_TRUE(reports(checkEdited(cleanFiles(), "surface.rchit", "struct Payload { vec3 color; float t; }",
                                  "struct Payload { float t; vec3 color; }"),
                      "Q101 main.rgen:10:3 "));
}

TEST(CheckPayload, Q101ReportsAnyHitShaders) {
  const Files files =
      edited(cleanFiles(), "cut_shadow.rahit", "attribs.x < 0.5", "attribs.x < 0.5 && payload.lit == 0u");
  EXPECT_TRUE(reports(
      checkEdited(files, "cut_shadow.rahit", "struct Shadow { uint lit; }", "struct Shadow { uint lit; float more; }"),
      "Q101 surface.rchit:13:3 ", {"struct Shadow"}));
}

TEST(CheckPayload, Q101ReportsAWrongMissIndex) {
  EXPECT_TRUE(reports(checkEdited(cleanFiles(), "surface.rchit", "kMiss_shadow,\n", "kMiss_primary,\n"),
                      "Q101 surface.rchit:13:3 "));
}

// With a dynamic miss index, both miss shaders can run. It is enough that one of them agrees.
TEST(CheckPayload, Q101ReportsDynamicArgumentsIfNoTypeAgrees) {
  const Files files = edited(cleanFiles(), "main.rgen", "kMiss_primary, vec3", "gl_LaunchIDEXT.x, vec3");
  EXPECT_THAT(textOf(checkFiles(files)), Not(HasSubstr("Q101")));
  Files wrong =
      edited(files, "sky.rmiss", "struct Payload { vec3 color; float t; }", "struct Payload { vec3 color; int t; }");
  wrong["sky.rmiss"] = changed(wrong["sky.rmiss"], "-1.0", "-1");
  EXPECT_TRUE(reports(textOf(checkFiles(wrong)), "Q101 main.rgen:10:3 "));
}

TEST(CheckPayload, Q102ReportsADifferentLocation) {
  EXPECT_TRUE(reportsOnly(checkEdited(cleanFiles(), "lit.rmiss", "location = 1", "location = 3"),
                          "Q102 lit.rmiss:6:45 ",
                          {"'payload'", "location 3", "folder/demo/surface.rchit:13", "location 1"}));
}

// A stage cannot trace with the location at which it receives.
TEST(CheckPayload, Q102AcceptsNestedTraces) {
  Files files = edited(cleanFiles(), "surface.rchit", "location = 1", "location = 5");
  files["surface.rchit"] = changed(files["surface.rchit"], "1e30, 1)", "1e30, 5)");
  for (const char* file : {"lit.rmiss", "cut_shadow.rahit"})
    files[file] = changed(files[file], "location = 1", "location = 0");
  EXPECT_EQ(textOf(checkFiles(files)), "");
}

TEST(CheckPayload, Q103ReportsAWrongQualifier) {
  EXPECT_TRUE(reports(checkEdited(cleanFiles(), "sky.rmiss", "rayPayloadInEXT", "rayPayloadEXT"),
                      "Q103 sky.rmiss:6:44 ", {"'payload'", "miss shader"}));
  EXPECT_TRUE(
      reports(checkEdited(cleanFiles(), "surface.rchit", "rayPayloadInEXT", "rayPayloadEXT"), "Q103 surface.rchit:7:"));
}

// The compiler rejects it in a stage that cannot trace.
TEST(CheckPayload, Q103ReportsAnyHitShaders) {
  const Files files = edited(cleanFiles(), "cut.rahit", "attribs.x < 0.5", "attribs.x < payload.t");
  EXPECT_TRUE(reportsOnly(checkEdited(files, "cut.rahit", "rayPayloadInEXT", "rayPayloadEXT"), "Q103 cut.rahit:6:22 ",
                          {"any-hit shader", "rayPayloadInEXT"}));
}

TEST(CheckPayload, Q104ReportsHitsWithoutEffect) {
  const Files files =
      edited(cleanFiles(), "main.rgen", "  traceRayEXT", "  payload = Payload(vec3(0.0), -1.0);\n  traceRayEXT");
  Files silent = files;
  silent["surface.rchit"] = kHead + std::string("void main() {}\n");
  silent["program.toml"] =
      changed(silent["program.toml"], "shadow = { any_hit", "shadow = { closest_hit = \"other.rchit\", any_hit");
  silent["other.rchit"] = files.at("surface.rchit");
  EXPECT_TRUE(reports(textOf(checkFiles(silent)), "Q104 main.rgen:11:3 ",
                      {"closest-hit shader 'surface.rchit' (hit group 'surface', ray type 'primary')"}));
}

TEST(CheckPayload, Q104ReportsAMissShaderWithoutTheMember) {
  EXPECT_TRUE(reportsOnly(checkEdited(cleanFiles(), "sky.rmiss", "payload.t = -1.0;", ""), "Q104 main.rgen:10:3 ",
                          {"'payload.t'", "(line 12)", "miss shader 'sky.rmiss' (miss index 0)"}));
}

TEST(CheckPayload, Q104ReportsAPathThatDoesNotWrite) {
  EXPECT_TRUE(reportsOnly(checkEdited(cleanFiles(), "surface.rchit", "payload.t = gl_HitTEXT",
                                      "if (attribs.x > 0.5) payload.t = gl_HitTEXT"),
                          "Q104 main.rgen:10:3 ", {"'payload.t'", "(line 12)", "'surface.rchit'", "on some path"}));
}

TEST(CheckPayload, Q104AcceptsAMemberSetBeforeTheTrace) {
  const Files files = edited(cleanFiles(), "sky.rmiss", "payload.t = -1.0;", "");
  EXPECT_EQ(checkEdited(files, "main.rgen", "  traceRayEXT", "  payload.t = -1.0;\n  traceRayEXT"), "");
}

TEST(CheckPayload, Q104ReportsSkippedClosestHitShaders) {
  EXPECT_TRUE(reportsOnly(checkEdited(cleanFiles(), "surface.rchit", "  shadow.lit = 0u;\n", ""),
                          "Q104 surface.rchit:12:3 ",
                          {"'shadow.lit'", "(line 14)", "closest-hit shaders are skipped"}));
}

TEST(CheckPayload, Q104ReportsAMemberThatNoShaderWrites) {
  EXPECT_TRUE(reportsOnly(checkEdited(cleanFiles(), "lit.rmiss", "payload.lit = 1u;", ""), "Q104 surface.rchit:13:3 ",
                          {"'shadow.lit'", "(line 15)", "no shader", "constant"}));
}

// The closest-hit shader does not write the member, and the miss shader writes the value that it had before.
TEST(CheckPayload, Q104ReportsAMemberWithOneConstant) {
  const Files files = edited(cleanFiles(), "main.rgen", "  traceRayEXT", "  payload.t = -1.0;\n  traceRayEXT");
  ASSERT_EQ(textOf(checkFiles(files)), "");
  EXPECT_TRUE(reportsOnly(checkEdited(files, "surface.rchit", "  payload.t = gl_HitTEXT;\n", ""),
                          "Q104 main.rgen:11:3 ", {"'payload.t'", "(line 13)", "same constant"}));
}

TEST(CheckPayload, Q104AcceptsReadsThatThePayloadGuards) {
  const Files files = edited(cleanFiles(), "sky.rmiss", "payload.color = gl_WorldRayDirectionEXT;", "");
  EXPECT_TRUE(reports(textOf(checkFiles(files)), "Q104 main.rgen:10:3 ", {"'payload.color'"}));
  for (const char* use :
       {"vec3 color = vec3(0); if (payload.t > 0.0) color = payload.color * payload.t;",
        "vec3 color = payload.t > 0.0 ? payload.color : vec3(0);",
        "Payload p = payload; vec3 color = vec3(0.5); if (p.t < 0.0) color = vec3(1); else color = p.color;",
        "vec3 color = vec3(0.5); bool hit = payload.t > 0.0; for (int i = 0; i < 4 && hit; ++i) color += "
        "payload.color;"}) {
    Files guarded =
        edited(files, "main.rgen", "vec3 color = payload.color;\n  if (payload.t > 0.0) color *= payload.t;", use);
    EXPECT_EQ(textOf(checkFiles(guarded)), "") << use;
  }
}

TEST(CheckPayload, Q104AcceptsALoopThatAMissEnds) {
  Files files = edited(cleanFiles(), "sky.rmiss", "payload.color = gl_WorldRayDirectionEXT;", "");
  const std::string& text = files["main.rgen"];
  const std::size_t begin = text.find("  traceRayEXT"), end = text.find("  addOutput");
  const std::string trace = text.substr(begin, text.find(";\n", begin) + 2 - begin);
  files["main.rgen"] = text.substr(0, begin) + "  vec3 color = vec3(1);\n  for (int i = 0; i < 8; ++i) {\n" + trace +
                       "    if (payload.t < 0.0) break;\n    color *= payload.color;\n  }\n" + text.substr(end);
  EXPECT_EQ(textOf(checkFiles(files)), "");
}

// A loop in the stage counts as executed.
TEST(CheckPayload, Q104AcceptsAWriteInALoop) {
  EXPECT_EQ(checkEdited(cleanFiles(), "surface.rchit", "payload.t = gl_HitTEXT;",
                        "for (int i = 0; i < gl_PrimitiveID; ++i) payload.t = gl_HitTEXT + i;"),
            "");
}

// A nested trace with the incoming payload, as for a recursive reflection.
Files recursiveFiles() {
  Files files = cleanFiles();
  files["program.toml"] = changed(files["program.toml"], "ray_generation", "max_recursion = 4\nray_generation");
  std::string& text = files["surface.rchit"];
  const std::size_t begin = text.find("  payload.color = ");
  text = text.substr(0, begin) + R"(  const vec3 local = vec3(attribs, float(shadow.lit));
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary, origin, 1e-3, vec3(1, 0, 0), 1e30, 0);
  payload.color = 0.5 * payload.color + local;
  payload.t = gl_HitTEXT;
}
)";
  return files;
}

TEST(CheckPayload, Q105AcceptsReadsOfTheInnerResult) { EXPECT_EQ(textOf(checkFiles(recursiveFiles())), ""); }

TEST(CheckPayload, Q105ReportsAValueThatANestedTraceOverwrites) {
  Files files = recursiveFiles();
  files["surface.rchit"] = changed(files["surface.rchit"], "const vec3 local =", "payload.color =");
  files["surface.rchit"] = changed(files["surface.rchit"], "payload.color = 0.5 * payload.color + local",
                                   "payload.color = 0.5 * payload.color");
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(files)), "Q105 surface.rchit:16:3 ",
                          {"'payload.color'", "line 15", "'sky.rmiss'", "(line 17)"}));
}

// The default is read if no trace runs, or if the trace keeps it.
TEST(CheckPayload, Q105AcceptsDefaults) {
  Files files = recursiveFiles();
  files["surface.rchit"] = changed(files["surface.rchit"], "const vec3 local =", "payload.color =");
  files["surface.rchit"] = changed(files["surface.rchit"], "payload.color = 0.5 * payload.color + local",
                                   "payload.color = 0.5 * payload.color");
  files["main.rgen"] = changed(files["main.rgen"], "  traceRayEXT", "  payload.color = vec3(0.0);\n  traceRayEXT");
  EXPECT_EQ(checkEdited(files, "surface.rchit", "  traceRayEXT(tlas, gl_RayFlagsNoneEXT",
                        "  if (attribs.x > 0.5) traceRayEXT(tlas, gl_RayFlagsNoneEXT"),
            "");
  EXPECT_EQ(
      checkEdited(files, "sky.rmiss", "  payload.color = ", "  if (gl_WorldRayDirectionEXT.y > 0.0) payload.color = "),
      "");
}

// A payload that has the result of the previous shadow ray.
Files loopFiles(const std::string& before, const std::string& inside, const std::string& test) {
  Files files = cleanFiles();
  std::string& text = files["surface.rchit"];
  text =
      changed(text, "  shadow.lit = 0u;\n  traceRayEXT",
              before + "  uint lit = 0u;\n  for (int i = 0; i < gl_PrimitiveID; ++i) {\n" + inside + "  traceRayEXT");
  text = changed(text, "1e30, 1);\n", "1e30, 1);\n" + test + "  }\n");
  text = changed(text, "shadow.lit != 0u", "lit != 0u");
  return files;
}

TEST(CheckPayload, Q104ReportsTheValueOfThePreviousRay) {
  const std::string clear = "  shadow.lit = 0u;\n", sum = "  lit += shadow.lit;\n";
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(loopFiles(clear, "", sum))), "Q104 surface.rchit:15:3 ",
                          {"'shadow.lit'", "closest-hit shaders are skipped", "previous ray", "before each trace"}));
  EXPECT_EQ(textOf(checkFiles(loopFiles("", clear, sum))), "");
  // The loop ends if the value changes, or goes on only if it has changed.
  EXPECT_EQ(textOf(checkFiles(loopFiles(clear, "", sum + "  if (shadow.lit != 0u) break;\n"))), "");
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(loopFiles(clear, "", sum + "  if (shadow.lit == 0u) break;\n"))),
                          "Q104 surface.rchit:15:3 "));
  // The miss shader adds to the value.
  const Files counts = loopFiles(clear, "", sum);
  EXPECT_EQ(checkEdited(counts, "lit.rmiss", "payload.lit = 1u", "payload.lit += 1u"), "");
}

TEST(CheckPayload, Q107ReportsInputsThatNothingSets) {
  const Files files = edited(cleanFiles(), "cut.rahit", "attribs.x < 0.5", "attribs.x < payload.t");
  EXPECT_TRUE(reportsOnly(textOf(checkFiles(files)), "Q107 cut.rahit:8:", {"'payload.t'", "main.rgen:10"}));
  EXPECT_EQ(checkEdited(files, "main.rgen", "  traceRayEXT", "  payload.t = 0.5;\n  traceRayEXT"), "");
}

TEST(CheckCallable, Q301ReportsADifferentType) {
  EXPECT_TRUE(reportsOnly(checkEdited(callFiles(), "tint.rcall", "callableDataInEXT vec4", "callableDataInEXT vec3"),
                          "Q301 main.rgen:12:3 ", {"callable shader 'tint.rcall' (callable index 0)", "vec4 vs vec3"}));
}

TEST(CheckCallable, Q302ReportsAnIndexOutOfRange) {
  EXPECT_TRUE(reports(checkEdited(callFiles(), "main.rgen", "executeCallableEXT(0u", "executeCallableEXT(1u"),
                      "Q302 main.rgen:12:3 ", {"is 1", "1 callable shader (index 0)"}));
  Files files = callFiles();
  files["program.toml"] = cleanFiles()["program.toml"];
  EXPECT_TRUE(reports(textOf(checkFiles(files)), "Q302 main.rgen:12:3 ", {"no callable shaders"}));
}

TEST(CheckCallable, Q304ReportsUnsetInputAndUnwrittenResult) {
  EXPECT_TRUE(reportsOnly(checkEdited(callFiles(), "main.rgen", "data = vec4(0.5);\n", "\n"), "Q304 main.rgen:12:3 ",
                          {"'data'", "callable shader 'tint.rcall' (callable index 0)", "tint.rcall:7"}));
  Files partly = edited(callFiles(), "main.rgen", "data = vec4(0.5);\n", "\n");
  EXPECT_TRUE(reportsOnly(checkEdited(partly, "tint.rcall", "data *= 2.0", "data.rgb = vec3(2.0)"),
                          "Q304 main.rgen:12:3 ", {"'data.w' is read after this call (line "}));
}

TEST(CheckCallable, Q303ReportsADifferentLocation) {
  EXPECT_TRUE(reports(checkEdited(callFiles(), "tint.rcall", "location = 0", "location = 2"), "Q303 tint.rcall:6:"));
}

// Returns "sky.rmiss:7 received here as vec3" for each related location.
std::vector<std::string> relatedOf(const CheckResult& result) {
  std::vector<std::string> texts;
  for (const Diagnostic& d : result.diagnostics)
    for (const RelatedLocation& r : d.related)
      texts.push_back(fmt::format("{}:{} {}", r.file.substr(r.file.rfind('/') + 1), r.line, r.text));
  return texts;
}

TEST(CheckPayload, NamesBothEnds) {
  const Files types = edited(cleanFiles(), "sky.rmiss", "struct Payload { vec3 color; float t; };",
                             "struct Payload { vec3 color; float t; float more; };");
  EXPECT_THAT(relatedOf(checkFiles(types)),
              testing::ElementsAre("main.rgen:8 sent here as struct Payload { vec3 color; float t; }",
                                   "sky.rmiss:6 received here as struct Payload { vec3 color; float t; float more; }"));
  const Files forgets = edited(cleanFiles(), "sky.rmiss", "  payload.t = -1.0;\n", "");
  EXPECT_THAT(relatedOf(checkFiles(forgets)),
              testing::ElementsAre("main.rgen:12 read here",
                                   "sky.rmiss:6 not written by the miss shader 'sky.rmiss' (miss index 0)"));
}

// The lecture form declares the payload itself, so the other end is the main() of the shader.
TEST(CheckPayload, NamesTheMainFunctionOfTheLectureForm) {
  const std::string text =
      "struct RayPayloadType { vec3 color; float t; };\n"
      "void main() { /**** RAY GENERATION SHADER ****/\n"
      "  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 1u, 0u, vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), 1e9, 0);\n"
      "  gsnSetPixel(vec4(payload.color, payload.t));\n"
      "}\n"
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(1.0); payload.t = gl_HitTEXT; }\n"
      "void main() { /**** MISS SHADER ****/ payload.color = gl_WorldRayDirectionEXT; }\n";
  const CheckResult result =
      check(program::parseLecture(text, "a.rt.glsl", "folder/demo"), checkCompiler(), nullptr, {});
  EXPECT_THAT(relatedOf(result),
              testing::ElementsAre("a.rt.glsl:4 read here",
                                   "a.rt.glsl:7 not written by the miss shader 'a.rt.glsl' (miss index 0)"));
}

}  // namespace
}  // namespace quintet::check
