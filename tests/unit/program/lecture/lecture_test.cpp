// SPDX-License-Identifier: Apache-2.0
// The lecture form: which text becomes which stage, the errors, and the line and column of messages of the compiler.
#include "program/lecture/lecture.h"

#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "program/compile.h"
#include "program/program_test_support.h"

namespace quintet::program {
namespace {

using shader::Stage;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const shader::Compiler& compiler() {
  static const shader::Compiler kCompiler{shader::CompilerOptions{}};
  return kCompiler;
}

Program lecture(const std::string& text, Files included = {}) {
  return parseLecture(text, "demo.rt.glsl", "here", std::move(included));
}

std::vector<std::string> messages(const std::vector<Diagnostic>& diagnostics) {
  std::vector<std::string> lines;
  for (const Diagnostic& d : diagnostics) lines.push_back(d.format());
  return lines;
}

// Returns the errors of the front end, or those of the compiler if there are none.
std::vector<std::string> problems(const std::string& text, Files included = {}) {
  const Program program = lecture(text, std::move(included));
  return messages(compile(program, compiler(), {}).diagnostics);
}

constexpr const char* kCommon = R"(/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct HitAttributeType { vec3 normal; };
struct CallableDataType { float x; };
/**** COMMON END ****/
)";
constexpr const char* kRayGeneration = R"(void main() { /**** RAY GENERATION SHADER ****/
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0), 0.0, vec3(1.0), 1.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}
)";

// Returns a program with `line` inserted into one of its parts: 0 is the common text, 1 to 6 are the stages in order.
std::string wholeProgram(int part, const std::string& line) {
  const auto at = [&](int i) { return i == part ? line : std::string(); };
  return "// first line\n/**** COMMON START ****/\nstruct RayPayloadType { vec3 color; };\nstruct HitAttributeType { "
         "vec3 normal; };\n"
         "struct CallableDataType { float x; };\n" +
         at(0) +
         "\n/**** COMMON END ****/\n"
         "void main() { /**** RAY GENERATION SHADER ****/\n" +
         at(1) +
         "\ngsnSetPixel(vec4(0.0));\n}\n"
         "void main() { /**** CLOSEST-HIT SHADER ****/\n" +
         at(2) +
         "\npayload.color = hit.normal;\n}\n"
         "void main() { /**** MISS SHADER ****/\n" +
         at(3) +
         "\npayload.color = vec3(0.0);\n}\n"
         "void main() { /**** INTERSECTION SHADER ****/\n" +
         at(4) +
         "\nhit.normal = vec3(1.0); reportIntersectionEXT(1.0, 1u);\n}\n"
         "void main() { /**** ANY-HIT SHADER ****/\n" +
         at(5) +
         "\nif (baryCoord.x > 0.5) ignoreIntersectionEXT;\n}\n"
         "void main() { /**** CALLABLE SHADER ****/\n" +
         at(6) + "\ncallableData.x = 1.0;\n}\n";
}

TEST(Lecture, BecomesAProgram) {
  const Program p = lecture(wholeProgram(-1, ""));
  EXPECT_THAT(messages(p.diagnostics), IsEmpty());
  EXPECT_EQ(p.name, "demo");
  EXPECT_EQ(p.accumulation, Accumulation::program);
  ASSERT_EQ(p.outputs.size(), 1u);
  EXPECT_EQ(p.outputs[0].kind, OutputKind::display);
  ASSERT_EQ(p.rays.size(), 1u);
  ASSERT_EQ(p.hitGroups.size(), 2u);
  EXPECT_EQ(p.hitGroups[0].geometry, std::vector<std::string>{"triangles"});
  EXPECT_EQ(p.hitGroups[1].geometry, std::vector<std::string>{"procedural"});
  const HitShaders& triangles = p.hitGroups[0].shaders.at("ray");
  const HitShaders& boxes = p.hitGroups[1].shaders.at("ray");
  EXPECT_TRUE(triangles.intersection.empty());
  EXPECT_FALSE(boxes.intersection.empty());
  EXPECT_NE(triangles.closestHit, boxes.closestHit);
  EXPECT_NE(triangles.anyHit, boxes.anyHit);
  EXPECT_EQ(p.callables.size(), 1u);
  const CompiledProgram compiled = compile(p, compiler(), {});
  EXPECT_TRUE(compiled.ok);
  EXPECT_THAT(messages(compiled.diagnostics), IsEmpty());
  EXPECT_EQ(compiled.stages.size(), 8u);  // closest-hit and any-hit have two variants each
}

TEST(Lecture, ReportsLineAndColumnOfErrors) {
  const std::string text = wholeProgram(-1, "");
  for (int part = 0; part <= 6; ++part) {
    const std::string line = part == 0 ? "float wrong() { return missing; }" : "  float wrong = missing;";
    const std::string broken = wholeProgram(part, line);
    const auto lineNumber =
        std::count(broken.begin(), broken.begin() + static_cast<std::ptrdiff_t>(broken.find(line)), '\n') + 1;
    EXPECT_EQ(problems(broken), std::vector<std::string>{fmt::format(
                                    "here/demo.rt.glsl:{}:{}: error: 'missing' : undeclared identifier [GLSL]",
                                    lineNumber, line.find("missing") + 1)})
        << "part " << part;
  }
}

TEST(Lecture, NeedsNoCommonSection) {
  EXPECT_THAT(
      problems(std::string("struct RayPayloadType { vec3 color; };\nvec3 red() { return vec3(1.0, 0.0, 0.0); }\n") +
               kRayGeneration + "void main()\n{\n  /* Miss Shader */\n  payload.color = red();\n}\n"),
      IsEmpty());
}

TEST(Lecture, AcceptsVariantsOfMarkers) {
  for (const char* head :
       {"void main() { /**** RAY GENERATION SHADER ****/", "void main(void)\n{\n  /* ray-generation shader */",
        "/*** Raygen Shader ***/\nvoid main() {", "// RAY GENERATION SHADER\nvoid  main ( ) {",
        "void main() /**RAY_GENERATION SHADER**/ {", "void main() { int i = 0; /**** RAY GENERATION SHADER ****/"}) {
    const Program p = lecture(std::string(kCommon) + head + " gsnSetPixel(vec4(1.0)); }\n");
    EXPECT_THAT(messages(p.diagnostics), IsEmpty()) << head;
    EXPECT_THAT(p.rayGeneration, HasSubstr(".rgen"));
  }
}

// Matches a message at a position ("3:1") with an id and a word.
auto isError(const std::string& position, const std::string& id, const std::string& word) {
  return testing::AllOf(StartsWith("here/demo.rt.glsl:" + position), HasSubstr("error: "), HasSubstr(word),
                        testing::EndsWith("[" + id + "]"));
}

// Returns the errors of a program that must not compile.
std::vector<std::string> errors(const std::string& text) {
  const std::vector<std::string> all = messages(lecture(text).diagnostics);
  EXPECT_FALSE(compile(lecture(text), compiler(), {}).ok);
  return all;
}

TEST(Lecture, RejectsInvalidStages) {
  EXPECT_THAT(errors(""), Contains(isError("1:1", "Q010", "ray generation")));
  EXPECT_THAT(errors("void main() { /**** MISS SHADER ****/ }"), Contains(HasSubstr("[Q010]")));
  EXPECT_THAT(errors(std::string(kRayGeneration) + "\n void main() { }").back(), isError("6:2", "Q011", "CLOSEST-HIT"));
  EXPECT_THAT(errors(std::string(kRayGeneration) + "void main() { /**** CLOSEST-HITT SHADER ****/ }").back(),
              isError("5:15", "Q012", "/**** CLOSEST-HIT SHADER ****/"));
  EXPECT_THAT(errors(std::string(kRayGeneration) + "void main() { /**** XYZZY ****/ }").back(),
              isError("5:15", "Q012", "RAY GENERATION, CLOSEST-HIT"));
  EXPECT_THAT(errors(std::string(kRayGeneration) +
                     "void main() { /**** MISS SHADER ****/ }\nvoid main() { /**** MISS SHADER ****/ }")
                  .back(),
              isError("6:1", "Q013", "line 5"));
}

TEST(Lecture, FindsUnmatchedBraces) {
  const auto onlyError = [](const std::string& text) {
    const std::vector<std::string> all = errors(text);
    EXPECT_EQ(all.size(), 1u);
    return all.empty() ? "" : all.front();
  };
  EXPECT_THAT(onlyError("void main() { /**** RAY GENERATION SHADER ****/\n  if (true) {\n}\n"
                        "void main() { /**** MISS SHADER ****/ }\n"),
              isError("1:13", "Q014", "line 4"));
  EXPECT_THAT(onlyError("struct A {\n  int b; };\n};\n"), isError("3:1", "Q014", "'}'"));
  EXPECT_THAT(onlyError("int f() {\n"), isError("1:9", "Q014", "'{'"));
  // Braces in comments and in other branches of a conditional do not count.
  const std::string branches =
      "#ifdef A\nvoid f() { // {\n#else\nvoid f() { /* { */\n#endif\n}\n#if 0\n}}} void main() {\n#endif\n";
  EXPECT_THAT(problems(std::string(kCommon) + branches + kRayGeneration), IsEmpty());
}

TEST(Lecture, GivesHelpersToTheStageThatFollows) {
  const std::string hit =
      "vec3 shade() { return vec3(gl_HitTEXT); }\nvoid main() { /**** CLOSEST-HIT SHADER ****/ payload.color = "
      "shade(); }\n";
  const std::string miss =
      "vec3 shade() { return vec3(0.5); }\nvoid main() { /**** MISS SHADER ****/ payload.color = shade(); }\n";
  EXPECT_THAT(problems(std::string(kCommon) + kRayGeneration + hit + miss), IsEmpty());
  // A COMMON section can be anywhere.
  const std::string late = "/**** COMMON START ****/\nvec3 late() { return vec3(0.1); }\n/**** COMMON END ****/\n";
  EXPECT_THAT(problems(std::string(kCommon) + kRayGeneration + late + hit +
                       "void main() { /**** MISS SHADER ****/ payload.color = late(); }\n"),
              IsEmpty());
}

TEST(Lecture, GivesCommonFunctionsToTheStagesThatUseThem) {
  // shadow() traces rays and depth() reads a built-in of hits: neither compiles in every stage. Some stages have no payload.
  const std::string common =
      std::string(kCommon) +
      "bool shadow(vec3 o) {\n  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, o, 0.0, vec3(1.0), 1.0, "
      "0);\n"
      "  return payload.color.x > 0.0;\n}\n#define SHADOW shadow(vec3(0.0))\nfloat depth() { return gl_HitTEXT; }\n"
      "vec3 both() { return vec3(SHADOW ? depth() : 0.0); }\n" +
      kRayGeneration;
  const std::string stages =
      "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = both(); }\nvoid main() { /**** INTERSECTION SHADER "
      "****/ reportIntersectionEXT(1.0, 1u); }\n";
  EXPECT_THAT(problems(common + stages), IsEmpty());
  EXPECT_THAT(problems(common + stages + "void main() { /**** MISS SHADER ****/ payload.color = vec3(depth()); }\n"),
              Contains(HasSubstr("gl_HitTEXT does not exist in a miss shader")));
  // The compiler also checks functions that no stage uses.
  EXPECT_THAT(problems(std::string(kCommon) + "float unused() { return missing; }\n" + kRayGeneration),
              Contains(HasSubstr("demo.rt.glsl:6:25: error: 'missing'")));
}

TEST(Lecture, CompilesUnusedFunctionsInAStageThatHasTheirNames) {
  const std::string hit = "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = twice(payload.color); }\n";
  const std::string twice = "vec3 twice(vec3 c) { return 2.0 * c; }\n";
  const auto with = [&](const std::string& function) { return kCommon + twice + function + kRayGeneration + hit; };
  EXPECT_THAT(problems(with("vec3 point() { return gl_HitTEXT * gl_WorldRayDirectionEXT; }\n")), IsEmpty());
  EXPECT_THAT(problems(with("#define T gl_HitTEXT\nvec3 point() { return twice(vec3(T)); }\n")), IsEmpty());
  EXPECT_THAT(problems(with("void both() { gsnSetPixel(vec4(twice(payload.color), 1.0)); }\n")), IsEmpty());
  EXPECT_THAT(problems(with("float corner() { return 1.0 - baryCoord.x - baryCoord.y; }\n")), IsEmpty());
  // No stage of this program has the name.
  EXPECT_THAT(problems(with("void stop() { terminateRayEXT; }\n")), IsEmpty());
  EXPECT_THAT(problems(with("float wrong() { return gl_HitTEXT + missing; }\n")),
              Contains(HasSubstr("demo.rt.glsl:7:37: error: 'missing'")));
}

TEST(Lecture, AcceptsConditionalsAndExtensionsAnywhere) {
  EXPECT_THAT(problems("#version 460\n#extension GL_EXT_ray_tracing : require\n" + std::string(kCommon) +
                       "#define WITH_MISS\n" + kRayGeneration +
                       "#ifdef WITH_MISS\n#extension GL_EXT_debug_printf : enable\nvoid main() { /**** MISS SHADER "
                       "****/ payload.color = vec3(1.0); }\n#else\n#endif\n"
                       "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(1.0); }\n"),
              IsEmpty());
}

TEST(Lecture, AllowsNamesOfTheLibrary) {
  EXPECT_THAT(problems(std::string(kCommon) +
                       "struct Ray { vec3 o; }; struct Frame { int x; }; struct Launch { int x; }; float "
                       "luminance(vec3 c) { return c.x; }\n"
                       "const float kPi = 3.0; int launch = 3; int frame = 4; int parameters = 5; int textures = 6; "
                       "struct InstanceData { int x; };\n" +
                       kRayGeneration),
              IsEmpty());
}

TEST(Lecture, DeclaresPiUnlessTheProgramDoes) {
  const std::string use = "void main() { /**** MISS SHADER ****/ payload.color = vec3(PI); }\n";
  for (const char* declaration :
       {"", "#define PI 3.14159\n", "const float PI = 3.14159;\n", "const float TAU = 6.28, PI = 3.14159;\n"})
    EXPECT_THAT(problems(std::string(kCommon) + declaration + kRayGeneration + use), IsEmpty()) << declaration;
}

TEST(Lecture, AcceptsCarriageReturns) {
  std::string text = wholeProgram(3, "  float wrong = missing;");
  const auto lineNumber =
      std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("missing")), '\n') + 1;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  EXPECT_EQ(problems("\xEF\xBB\xBF" + text),
            std::vector<std::string>{
                fmt::format("here/demo.rt.glsl:{}:17: error: 'missing' : undeclared identifier [GLSL]", lineNumber)});
}

TEST(Lecture, AcceptsAnyFileName) {
  const Program program =
      parseLecture(std::string(kRayGeneration) + "int x = missing;\n", "a \"b\\ : 3.rt.glsl", "c'd");
  const std::vector<std::string> lines = messages(compile(program, compiler(), {}).diagnostics);
  EXPECT_THAT(lines, Contains(HasSubstr(":5:")));
}

TEST(Lecture, TurnsUniformsIntoParameters) {
  const Program p =
      lecture(std::string(kCommon) +
              "layout(binding = 3) uniform float a; // defaultval=\"0.5\" min=\"0\" max=\"2\" unit=\"m\" "
              "help=\"Height\"\n"
              "uniform vec3 wallColour, up = vec3(0, 1, 0);\nuniform bool on = true; // a comment\n"
              "uniform sampler2D wood;\n" +
              kRayGeneration + "void main() { /**** MISS SHADER ****/ payload.color = vec3(a + userParam2); }\n");
  EXPECT_THAT(messages(compile(p, compiler(), {}).diagnostics), IsEmpty());
  ASSERT_EQ(p.parameters.size(), 6u);
  EXPECT_EQ(p.parameters[0].defaultValue[0], 0.5);
  EXPECT_EQ(p.parameters[0].max, 2.0);
  EXPECT_EQ(p.parameters[0].unit, "m");
  EXPECT_EQ(p.parameters[0].help, "Height");
  EXPECT_EQ(p.parameters[0].line, 6);
  EXPECT_EQ(p.parameters[1].type, ParameterType::color);
  EXPECT_EQ(p.parameters[2].defaultValue[1], 1.0);
  EXPECT_EQ(p.parameters[3].type, ParameterType::boolean);
  EXPECT_EQ(p.parameters[4].type, ParameterType::image);
  EXPECT_EQ(p.parameters[5].name, "userParam2");
}

// Text processors replace the quotes, also in comments.
TEST(Lecture, AcceptsTypographicQuotesInComments) {
  const Program p = lecture(
      "//“Glow” shows the sun’s light. It has parameters\n"
      "uniform float a; // defaultval=“0.5” max = ”2“ unit='m' help=“The sun’s radius”\n"
      "uniform float b; // the moon’s radius, defaultval=‘3’ help=\"The “new” moon\"\n"
      "uniform float c; // defaultval=“1\n" +
      std::string(kRayGeneration));
  EXPECT_THAT(p.diagnostics, IsEmpty());
  EXPECT_EQ(p.description, "“Glow” shows the sun’s light. It has parameters");
  ASSERT_EQ(p.parameters.size(), 3u);
  EXPECT_EQ(p.parameters[0].defaultValue[0], 0.5);
  EXPECT_EQ(p.parameters[0].max, 2.0);
  EXPECT_EQ(p.parameters[0].unit, "m");
  EXPECT_EQ(p.parameters[0].help, "The sun’s radius");
  EXPECT_EQ(p.parameters[1].defaultValue[0], 3.0);
  EXPECT_EQ(p.parameters[1].help, "The “new” moon");
  EXPECT_EQ(p.parameters[2].defaultValue[0], 0.0) << "the quote is not closed";
}

TEST(Lecture, RejectsInvalidUniforms) {
  struct Case {
    const char* line;
    const char* position;
    const char* word;
  };
  for (const auto& [line, position, word] :
       {Case{"uniform mat4 m;", "1:9", "'mat4'"}, Case{"uniform float a[3];", "1:16", "array"},
        Case{"uniform Block { float a; };", "1:", "'uniform TYPE NAME;'"},
        Case{"uniform float a; // defaultval=\"x\"", "1:15", "a number"},
        Case{"uniform vec3 a; // defaultval=\"1, 2\"", "1:", "3 numbers"},
        Case{"uniform int a; // defaultval=\"0.5\"", "1:", "integer"},
        Case{"uniform float a; // min=\"1\" defaultval=\"0\"", "1:", "1 to"},
        Case{"uniform float frame;", "1:1", "'frame'"},
        Case{"uniform float a = “0.5”; // help=“Size”", "1:19", "“ is a typographic quote; type \" instead"},
        Case{"uniform ‘float’ a;", "1:9", "‘ is a typographic quote; type ' instead"},
        Case{"uniform float a; uniform int a;", "1:", "different types"},
        Case{"uniform sampler2D a; // defaultval=\"none.png\"", "1:1", "'none.png'"}})
    EXPECT_THAT(problems(line + std::string("\n") + kRayGeneration), Contains(isError(position, "Q015", word))) << line;
}

// Uniforms after the error are still found, so the compiler reports no errors about them.
TEST(Lecture, ReportsOnlyAMissingParenthesis) {
  const std::string uniforms = "uniform float size; // defaultval=\"2\"\nuniform vec3 tint;\n";
  const std::string use = "void main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(vec4(size * tint, 1.0)); }\n";
  for (const std::string broken : {"float atLeast(float x) { return max(x, 0.5; }\n",
                                   "const float kMost = max(1.0, 2.0;\n", "float most(float x { return x; }\n"}) {
    const std::vector<std::string> found = problems(broken + uniforms + use);
    ASSERT_EQ(found.size(), 1u) << broken << testing::PrintToString(found);
    EXPECT_THAT(found[0], StartsWith("here/demo.rt.glsl:1"));
    EXPECT_THAT(found[0], HasSubstr("syntax error"));
    EXPECT_EQ(lecture(broken + uniforms + use).parameters.size(), 2u) << broken;
  }
}

TEST(Lecture, IncludesFilesOfItsFolder) {
  EXPECT_THAT(problems("#include \"types.glsl\"\n" + std::string(kRayGeneration) +
                           "void main() { /**** MISS SHADER ****/ payload.color = gray(); }\n",
                       {{"types.glsl",
                         "struct RayPayloadType { vec3 color; };\nvec3 gray() { return vec3(0.5) * userParam0; }\n"}}),
              IsEmpty());
  EXPECT_THAT(problems("#include \"types.glsl\"\n" + std::string(kRayGeneration),
                       {{"types.glsl", "struct RayPayloadType { vec3 color; };\nfloat f() { return missing; }\n"}}),
              Contains("here/types.glsl:2:20: error: 'missing' : undeclared identifier [GLSL]"));
}

TEST(Lecture, CanIncludeTheLibrary) {
  EXPECT_THAT(problems(std::string(kCommon) + "#include <quintet/sampling/pcg.glsl>\n" + kRayGeneration +
                       "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(kPi); }\n"),
              IsEmpty());
}

TEST(Lecture, ReadsTheDeclaredRecursion) {
  const std::string trace = "traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0), 0.0, vec3(1.0), 1.0, 0);";
  EXPECT_EQ(lecture(std::string(kCommon) + kRayGeneration).declaredRecursion, std::nullopt);
  const std::string hit = "void main() { /**** CLOSEST-HIT SHADER ****/ " + trace + " }\n";
  EXPECT_EQ(lecture(std::string(kCommon) + kRayGeneration + hit).declaredRecursion, std::nullopt);
  const std::string options = "// gsnShaderOptions: precompiler=\"GL_EXT_ray_tracing, recursion: 5, app: 1\"\n";
  EXPECT_EQ(lecture(options + kCommon + kRayGeneration + hit).declaredRecursion, 5u);
}

}  // namespace
}  // namespace quintet::program
