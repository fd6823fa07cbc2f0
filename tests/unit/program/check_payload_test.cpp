// Q101 ... Q105 and Q301 ... Q303: each mistake is found where it is, and what looks alike is not reported.
#include "check_test_support.h"

namespace quintet::program {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(CheckPayload, CleanProgramsAreClean) {
  EXPECT_EQ(textOf(checkFiles(cleanFiles())), "");
  EXPECT_EQ(textOf(checkFiles(boxFiles())), "");
  EXPECT_EQ(textOf(checkFiles(callFiles())), "");
}

TEST(CheckPayload, Q101TypeDiffers) {
  Files files = edited(cleanFiles(), "sky.rmiss", "struct Payload { vec3 color; float t; }",
                       "struct Payload { vec4 color; float t; }");
  files["sky.rmiss"] = changed(files["sky.rmiss"], "payload.color = gl_WorldRayDirectionEXT",
                               "payload.color = vec4(gl_WorldRayDirectionEXT, 1.0)");
  EXPECT_EQ(textOf(checkFiles(files)),
            "Q101 main.rgen:10:3 the payload of this trace is struct Payload { vec3 color; float t; }; the miss shader "
            "'sky.rmiss' (miss index 0) "
            "that it reaches has struct Payload { vec4 color; float t; }: member 0 'color': vec3 against vec4\n");
}

TEST(CheckPayload, Q101MembersChangedPlaces) {
  EXPECT_THAT(checkEdited(cleanFiles(), "surface.rchit", "struct Payload { vec3 color; float t; }",
                          "struct Payload { float t; vec3 color; }"),
              StartsWith("Q101 main.rgen:10:3 "));
}

TEST(CheckPayload, Q101AnyHit) {
  EXPECT_THAT(
      checkEdited(edited(cleanFiles(), "cut_shadow.rahit", "attribs.x < 0.5", "attribs.x < 0.5 && payload.lit == 0u"),
                  "cut_shadow.rahit", "struct Shadow { uint lit; }", "struct Shadow { uint lit; float more; }"),
      StartsWith("Q101 surface.rchit:13:3 the payload of this trace is struct Shadow"));
}

TEST(CheckPayload, Q101WrongMissIndex) {
  EXPECT_THAT(checkEdited(cleanFiles(), "surface.rchit", "kMiss_shadow,\n", "kMiss_primary,\n"),
              HasSubstr("Q101 surface.rchit:13:3 "));
}

// The miss index comes out of a buffer: both miss shaders could run. One of them fits, which is enough.
TEST(CheckPayload, Q101DynamicArgumentsCountIfNothingFits) {
  const Files files = edited(cleanFiles(), "main.rgen", "kMiss_primary, vec3", "gl_LaunchIDEXT.x, vec3");
  EXPECT_THAT(textOf(checkFiles(files)), testing::Not(HasSubstr("Q101")));
  Files wrong =
      edited(files, "sky.rmiss", "struct Payload { vec3 color; float t; }", "struct Payload { vec3 color; int t; }");
  wrong["sky.rmiss"] = changed(wrong["sky.rmiss"], "-1.0", "-1");
  EXPECT_THAT(textOf(checkFiles(wrong)), HasSubstr("Q101 main.rgen:10:3 "));
}

TEST(CheckPayload, Q102LocationDiffers) {
  EXPECT_EQ(checkEdited(cleanFiles(), "lit.rmiss", "location = 1", "location = 3"),
            "Q102 lit.rmiss:6:45 'payload' is at location 3 here; the trace at folder/demo/surface.rchit:13 that runs "
            "this shader sends location 1\n");
}

// A stage that traces cannot use the location at which it receives.
TEST(CheckPayload, Q102NotForNestedTraces) {
  Files files = edited(cleanFiles(), "surface.rchit", "location = 1", "location = 5");
  files["surface.rchit"] = changed(files["surface.rchit"], "1e30, 1)", "1e30, 5)");
  for (const char* file : {"lit.rmiss", "cut_shadow.rahit"})
    files[file] = changed(files[file], "location = 1", "location = 0");
  EXPECT_EQ(textOf(checkFiles(files)), "");
}

TEST(CheckPayload, Q103WrongQualifier) {
  EXPECT_THAT(checkEdited(cleanFiles(), "sky.rmiss", "rayPayloadInEXT", "rayPayloadEXT"),
              StartsWith("Q103 sky.rmiss:6:44 'payload' is a rayPayloadEXT that no trace of this miss shader uses"));
  EXPECT_THAT(checkEdited(cleanFiles(), "surface.rchit", "rayPayloadInEXT", "rayPayloadEXT"),
              HasSubstr("Q103 surface.rchit:7:"));
}

// The compiler refuses it in a stage that cannot trace.
TEST(CheckPayload, Q103InAnAnyHitShader) {
  const Files files = edited(cleanFiles(), "cut.rahit", "attribs.x < 0.5", "attribs.x < payload.t");
  EXPECT_EQ(checkEdited(files, "cut.rahit", "rayPayloadInEXT", "rayPayloadEXT"),
            "Q103 cut.rahit:6:22 rayPayloadEXT in the any-hit shader, which cannot trace: the payload of the ray that "
            "runs it is rayPayloadInEXT\n");
}

TEST(CheckPayload, Q104HitsLeaveNoTrace) {
  const Files files =
      edited(cleanFiles(), "main.rgen", "  traceRayEXT", "  payload = Payload(vec3(0.0), -1.0);\n  traceRayEXT");
  Files silent = files;
  silent["surface.rchit"] = kHead + std::string("void main() {}\n");
  silent["program.toml"] =
      changed(silent["program.toml"], "shadow = { any_hit", "shadow = { closest_hit = \"other.rchit\", any_hit");
  silent["other.rchit"] = files.at("surface.rchit");
  EXPECT_THAT(
      textOf(checkFiles(silent)),
      HasSubstr(
          "Q104 main.rgen:11:3 the payload is read after this trace, but the closest-hit shader 'surface.rchit' (hit "
          "group 'surface', ray type 'primary') writes nothing that is read: its hits leave no trace\n"));
}

TEST(CheckPayload, Q104MissForgetsAMember) {
  EXPECT_EQ(checkEdited(cleanFiles(), "sky.rmiss", "payload.t = -1.0;", ""),
            "Q104 main.rgen:10:3 'payload.t' is read after this trace (line 12), but the miss shader 'sky.rmiss' (miss "
            "index 0) does not write it, "
            "and it was not set before the trace\n");
}

TEST(CheckPayload, Q104ClosestHitForgetsAMemberOnSomePath) {
  EXPECT_EQ(checkEdited(cleanFiles(), "surface.rchit", "payload.t = gl_HitTEXT",
                        "if (attribs.x > 0.5) payload.t = gl_HitTEXT"),
            "Q104 main.rgen:10:3 'payload.t' is read after this trace (line 12), but the closest-hit shader "
            "'surface.rchit' (hit group 'surface', ray "
            "type 'primary'), on some path, does not write it, and it was not set before the trace\n");
}

TEST(CheckPayload, Q104SetBeforeTheTrace) {
  const Files files = edited(cleanFiles(), "sky.rmiss", "payload.t = -1.0;", "");
  EXPECT_EQ(checkEdited(files, "main.rgen", "  traceRayEXT", "  payload.t = -1.0;\n  traceRayEXT"), "");
}

TEST(CheckPayload, Q104SkippedClosestHitLeavesTheValue) {
  EXPECT_EQ(checkEdited(cleanFiles(), "surface.rchit", "  shadow.lit = 0u;\n", ""),
            "Q104 surface.rchit:12:3 'shadow.lit' is read after this trace (line 14), but a hit (closest-hit shaders "
            "are skipped) does not write it, "
            "and it was not set before the trace\n");
}

TEST(CheckPayload, Q104NobodyWrites) {
  EXPECT_EQ(checkEdited(cleanFiles(), "lit.rmiss", "payload.lit = 1u;", ""),
            "Q104 surface.rchit:13:3 'shadow.lit' is read after this trace (line 15), but no shader that the trace can "
            "run writes it: it still has the "
            "constant that was set before\n");
}

// Hits look like misses: what the closest-hit shader forgets was set before, to what the miss shader writes.
TEST(CheckPayload, Q104EverybodyWritesOneConstant) {
  const Files files = edited(cleanFiles(), "main.rgen", "  traceRayEXT", "  payload.t = -1.0;\n  traceRayEXT");
  ASSERT_EQ(textOf(checkFiles(files)), "");
  EXPECT_EQ(checkEdited(files, "surface.rchit", "  payload.t = gl_HitTEXT;\n", ""),
            "Q104 main.rgen:11:3 'payload.t' is read after this trace (line 13), but all that the trace can run writes "
            "the constant that was set "
            "before: it tells nothing\n");
}

TEST(CheckPayload, Q104NotReportedWhereThePayloadTells) {
  const Files files = edited(cleanFiles(), "sky.rmiss", "payload.color = gl_WorldRayDirectionEXT;", "");
  EXPECT_THAT(textOf(checkFiles(files)), HasSubstr("Q104 main.rgen:10:3 'payload.color'"));
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

TEST(CheckPayload, Q104NotReportedInALoopThatEndsWithTheMiss) {
  Files files = edited(cleanFiles(), "sky.rmiss", "payload.color = gl_WorldRayDirectionEXT;", "");
  const std::string& text = files["main.rgen"];
  const std::size_t begin = text.find("  traceRayEXT"), end = text.find("  imageStore");
  const std::string trace = text.substr(begin, text.find(";\n", begin) + 2 - begin);
  files["main.rgen"] = text.substr(0, begin) + "  vec3 color = vec3(1);\n  for (int i = 0; i < 8; ++i) {\n" + trace +
                       "    if (payload.t < 0.0) break;\n    color *= payload.color;\n  }\n" + text.substr(end);
  EXPECT_EQ(textOf(checkFiles(files)), "");
}

// A loop in the stage counts as run: it writes.
TEST(CheckPayload, Q104NotReportedForAWriteInALoop) {
  EXPECT_EQ(checkEdited(cleanFiles(), "surface.rchit", "payload.t = gl_HitTEXT;",
                        "for (int i = 0; i < gl_PrimitiveID; ++i) payload.t = gl_HitTEXT + i;"),
            "");
}

// A nested trace with the incoming payload, as a recursive reflection does it.
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

TEST(CheckPayload, Q105ResultOfTheInnerRayMayBeRead) { EXPECT_EQ(textOf(checkFiles(recursiveFiles())), ""); }

TEST(CheckPayload, Q105WrittenBeforeTheNestedTraceAndReadAfterIt) {
  Files files = recursiveFiles();
  files["surface.rchit"] = changed(files["surface.rchit"], "const vec3 local =", "payload.color =");
  files["surface.rchit"] = changed(files["surface.rchit"], "payload.color = 0.5 * payload.color + local",
                                   "payload.color = 0.5 * payload.color");
  EXPECT_EQ(textOf(checkFiles(files)),
            "Q105 surface.rchit:16:3 this trace uses the incoming payload: 'payload.color', written at line 15, is "
            "overwritten by the miss shader "
            "'sky.rmiss' (miss index 0) before it is read (line 17)\n");
}

TEST(CheckPayload, Q301CallableDataDiffers) {
  EXPECT_EQ(checkEdited(callFiles(), "tint.rcall", "callableDataInEXT vec4", "callableDataInEXT vec3"),
            "Q301 main.rgen:12:3 the data of this call is vec4; the callable shader 'tint.rcall' (callable index 0) "
            "that it reaches has vec3: vec4 against vec3\n");
}

TEST(CheckPayload, Q302CallableIndexBeyondTheTable) {
  EXPECT_THAT(checkEdited(callFiles(), "main.rgen", "executeCallableEXT(0u", "executeCallableEXT(1u"),
              HasSubstr("Q302 main.rgen:12:3 this calls callable shader 1, but the program has 1"));
  Files files = callFiles();
  files["program.toml"] = cleanFiles()["program.toml"];
  EXPECT_THAT(textOf(checkFiles(files)),
              StartsWith("Q302 main.rgen:12:3 this calls callable shader 0, but the program has none"));
}

TEST(CheckPayload, Q303CallableLocationDiffers) {
  EXPECT_THAT(checkEdited(callFiles(), "tint.rcall", "location = 0", "location = 2"), StartsWith("Q303 tint.rcall:6:"));
}

}  // namespace
}  // namespace quintet::program
