// The lecture form: which text becomes which stage, what is refused, and that every message of the compiler points
// at line and column of the user's file.
#include <gmock/gmock.h>

#include <fmt/format.h>

#include "program/lecture.h"
#include "program/link.h"
#include "program_test_support.h"

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

std::vector<std::string> messages(const std::vector<shader::Diagnostic>& diagnostics) {
  std::vector<std::string> lines;
  for (const shader::Diagnostic& d : diagnostics) lines.push_back(d.format());
  return lines;
}

// What the splitter says, or else the compiler.
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

// A whole program with `line` put into one of its parts: 0 common, then the stages in order.
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
  EXPECT_EQ(compiled.stages.size(), 8u);  // closest-hit and any-hit are there twice
}

TEST(Lecture, AnErrorIsAtItsLineAndColumn) {
  const std::string text = wholeProgram(-1, "");
  for (int part = 0; part <= 6; ++part) {
    const std::string line = part == 0 ? "float wrong() { return missing; }" : "  float wrong = missing;";
    const std::string broken = wholeProgram(part, line);
    const auto place =
        std::count(broken.begin(), broken.begin() + static_cast<std::ptrdiff_t>(broken.find(line)), '\n') + 1;
    EXPECT_EQ(problems(broken), std::vector<std::string>{fmt::format(
                                    "here/demo.rt.glsl:{}:{}: error: 'missing' : undeclared identifier [GLSL]", place,
                                    line.find("missing") + 1)})
        << "part " << part;
  }
}

TEST(Lecture, WithoutCommonSection) {
  EXPECT_THAT(
      problems(std::string("struct RayPayloadType { vec3 color; };\nvec3 red() { return vec3(1.0, 0.0, 0.0); }\n") +
               kRayGeneration + "void main()\n{\n  /* Miss Shader */\n  payload.color = red();\n}\n"),
      IsEmpty());
}

TEST(Lecture, MarkersMayVary) {
  for (const char* head :
       {"void main() { /**** RAY GENERATION SHADER ****/", "void main(void)\n{\n  /* ray-generation shader */",
        "/*** Raygen Shader ***/\nvoid main() {", "// RAY GENERATION SHADER\nvoid  main ( ) {",
        "void main() /**RAY_GENERATION SHADER**/ {", "void main() { int i = 0; /**** RAY GENERATION SHADER ****/"}) {
    const Program p = lecture(std::string(kCommon) + head + " gsnSetPixel(vec4(1.0)); }\n");
    EXPECT_THAT(messages(p.diagnostics), IsEmpty()) << head;
    EXPECT_THAT(p.rayGeneration, HasSubstr(".rgen"));
  }
}

std::vector<std::string> refusal(const std::string& text) {
  const std::vector<std::string> all = messages(lecture(text).diagnostics);
  EXPECT_FALSE(compile(lecture(text), compiler(), {}).ok);
  return all;
}

TEST(Lecture, RefusesWhatIsNoProgram) {
  EXPECT_THAT(refusal(""), Contains(HasSubstr("here/demo.rt.glsl:1:1: error: there is no ray generation shader")));
  EXPECT_THAT(refusal("void main() { /**** MISS SHADER ****/ }"), Contains(HasSubstr("[Q010]")));
  EXPECT_EQ(refusal(std::string(kRayGeneration) + "\n void main() { }").back(),
            "here/demo.rt.glsl:6:2: error: this main() has no marker that says its stage, such as /**** CLOSEST-HIT "
            "SHADER ****/ [Q011]");
  EXPECT_EQ(
      refusal(std::string(kRayGeneration) + "void main() { /**** CLOSEST-HITT SHADER ****/ }").back(),
      "here/demo.rt.glsl:5:15: error: this marker names no stage; did you mean /**** CLOSEST-HIT SHADER ****/? [Q012]");
  EXPECT_THAT(refusal(std::string(kRayGeneration) + "void main() { /**** XYZZY ****/ }").back(),
              HasSubstr("there are RAY GENERATION"));
  EXPECT_EQ(refusal(std::string(kRayGeneration) +
                    "void main() { /**** MISS SHADER ****/ }\nvoid main() { /**** MISS SHADER ****/ }")
                .back(),
            "here/demo.rt.glsl:6:1: error: a second miss shader; the first is in line 5 [Q013]");
}

TEST(Lecture, FindsTheBraceThatDoesNotMatch) {
  EXPECT_EQ(refusal("void main() { /**** RAY GENERATION SHADER ****/\n  if (true) {\n}\nvoid main() { /**** MISS "
                    "SHADER ****/ }\n"),
            std::vector<std::string>{
                "here/demo.rt.glsl:1:13: error: this '{' has no '}' before the main() in line 4 [Q014]"});
  EXPECT_EQ(refusal("struct A {\n  int b; };\n};\n"),
            std::vector<std::string>{"here/demo.rt.glsl:3:1: error: this '}' has no '{' [Q014]"});
  EXPECT_EQ(refusal("int f() {\n"),
            std::vector<std::string>{"here/demo.rt.glsl:1:9: error: this '{' has no '}' [Q014]"});
  // Braces in comments and in branches of a conditional do not count.
  const std::string branches =
      "#ifdef A\nvoid f() { // {\n#else\nvoid f() { /* { */\n#endif\n}\n#if 0\n}}} void main() {\n#endif\n";
  EXPECT_THAT(problems(std::string(kCommon) + branches + kRayGeneration), IsEmpty());
}

TEST(Lecture, HelpersBelongToTheStageThatFollows) {
  const std::string hit =
      "vec3 shade() { return vec3(gl_HitTEXT); }\nvoid main() { /**** CLOSEST-HIT SHADER ****/ payload.color = "
      "shade(); }\n";
  const std::string miss =
      "vec3 shade() { return vec3(0.5); }\nvoid main() { /**** MISS SHADER ****/ payload.color = shade(); }\n";
  EXPECT_THAT(problems(std::string(kCommon) + kRayGeneration + hit + miss), IsEmpty());
  // A COMMON section may stand anywhere.
  const std::string late = "/**** COMMON START ****/\nvec3 late() { return vec3(0.1); }\n/**** COMMON END ****/\n";
  EXPECT_THAT(problems(std::string(kCommon) + kRayGeneration + late + hit +
                       "void main() { /**** MISS SHADER ****/ payload.color = late(); }\n"),
              IsEmpty());
}

TEST(Lecture, CommonFunctionsAreGivenToTheStagesThatUseThem) {
  // shadow() traces, depth() reads a built-in of hits: neither compiles in every stage, and `payload` is not everywhere.
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
              Contains(HasSubstr("gl_HitTEXT is not readable in a miss shader")));
  // What nobody uses is seen by the compiler all the same.
  EXPECT_THAT(problems(std::string(kCommon) + "float unused() { return missing; }\n" + kRayGeneration),
              Contains(HasSubstr("demo.rt.glsl:6:25: error: 'missing'")));
}

TEST(Lecture, ConditionalsAndExtensionsMayStandAnywhere) {
  EXPECT_THAT(problems("#version 460\n#extension GL_EXT_ray_tracing : require\n" + std::string(kCommon) +
                       "#define WITH_MISS\n" + kRayGeneration +
                       "#ifdef WITH_MISS\n#extension GL_EXT_debug_printf : enable\nvoid main() { /**** MISS SHADER "
                       "****/ payload.color = vec3(1.0); }\n#else\n#endif\n"
                       "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(1.0); }\n"),
              IsEmpty());
}

TEST(Lecture, NamesOfTheLibraryAreFree) {
  EXPECT_THAT(problems(std::string(kCommon) +
                       "struct Ray { vec3 o; }; struct Frame { int x; }; struct Launch { int x; }; float "
                       "luminance(vec3 c) { return c.x; }\n"
                       "const float kPi = 3.0; int launch = 3; int frame = 4; int parameters = 5; int textures = 6; "
                       "struct InstanceData { int x; };\n" +
                       kRayGeneration),
              IsEmpty());
}

TEST(Lecture, PiIsThereUnlessDeclared) {
  const std::string use = "void main() { /**** MISS SHADER ****/ payload.color = vec3(PI); }\n";
  for (const char* declaration :
       {"", "#define PI 3.14159\n", "const float PI = 3.14159;\n", "const float TAU = 6.28, PI = 3.14159;\n"})
    EXPECT_THAT(problems(std::string(kCommon) + declaration + kRayGeneration + use), IsEmpty()) << declaration;
}

TEST(Lecture, LinesEndInAnyWay) {
  std::string text = wholeProgram(3, "  float wrong = missing;");
  const auto place =
      std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("missing")), '\n') + 1;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  EXPECT_EQ(problems("\xEF\xBB\xBF" + text),
            std::vector<std::string>{
                fmt::format("here/demo.rt.glsl:{}:17: error: 'missing' : undeclared identifier [GLSL]", place)});
}

TEST(Lecture, AnyFileNameWillDo) {
  const Program program =
      parseLecture(std::string(kRayGeneration) + "int x = missing;\n", "a \"b\\ : 3.rt.glsl", "c'd");
  const std::vector<std::string> lines = messages(compile(program, compiler(), {}).diagnostics);
  EXPECT_THAT(lines, Contains(HasSubstr(":5:")));
}

TEST(Lecture, UniformsBecomeParameters) {
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

TEST(Lecture, RefusesUniformsThatAreNoParameters) {
  for (const auto& [line, message] :
       {std::pair<const char*, const char*>{"uniform mat4 m;", "1:9: error: 'mat4' is no type of a uniform"},
        {"uniform float a[3];", "1:16: error: the uniform 'a' must not be an array"},
        {"uniform Block { float a; };", "a uniform is declared as 'uniform TYPE NAME;'"},
        {"uniform float a; // defaultval=\"x\"", "1:15: error: the default of 'a' must be a number"},
        {"uniform vec3 a; // defaultval=\"1, 2\"", "the default of 'a' must be 3 numbers"},
        {"uniform int a; // defaultval=\"0.5\"", "must be a whole number"},
        {"uniform float a; // min=\"1\" defaultval=\"0\"", "is outside 1"},
        {"uniform float frame;", "'frame' cannot be the name of a uniform"},
        {"uniform float a; uniform int a;", "the uniform 'a' is there twice, with two types"},
        {"uniform sampler2D a; // defaultval=\"none.png\"", "there is no file 'none.png' beside demo.rt.glsl"}})
    EXPECT_THAT(problems(line + std::string("\n") + kRayGeneration),
                Contains(testing::AllOf(HasSubstr(message), HasSubstr("[Q015]"))))
        << line;
}

TEST(Lecture, IncludesFilesBesideIt) {
  EXPECT_THAT(problems("#include \"types.glsl\"\n" + std::string(kRayGeneration) +
                           "void main() { /**** MISS SHADER ****/ payload.color = grey(); }\n",
                       {{"types.glsl",
                         "struct RayPayloadType { vec3 color; };\nvec3 grey() { return vec3(0.5) * userParam0; }\n"}}),
              IsEmpty());
  EXPECT_THAT(problems("#include \"types.glsl\"\n" + std::string(kRayGeneration),
                       {{"types.glsl", "struct RayPayloadType { vec3 color; };\nfloat f() { return missing; }\n"}}),
              Contains("here/types.glsl:2:20: error: 'missing' : undeclared identifier [GLSL]"));
}

TEST(Lecture, TheLibraryCanBeIncluded) {
  EXPECT_THAT(problems(std::string(kCommon) + "#include <quintet/sampling/pcg.glsl>\n" + kRayGeneration +
                       "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(kPi); }\n"),
              IsEmpty());
}

TEST(Lecture, RecursionIsDerivedUnlessDeclared) {
  const std::string trace = "traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0), 0.0, vec3(1.0), 1.0, 0);";
  EXPECT_EQ(lecture(std::string(kCommon) + kRayGeneration).declaredRecursion, std::nullopt);
  const std::string hit = "void main() { /**** CLOSEST-HIT SHADER ****/ " + trace + " }\n";
  EXPECT_EQ(lecture(std::string(kCommon) + kRayGeneration + hit).declaredRecursion, std::nullopt);
  const std::string options = "// gsnShaderOptions: precompiler=\"GL_EXT_ray_tracing, recursion: 5, app: 1\"\n";
  EXPECT_EQ(lecture(options + kCommon + kRayGeneration + hit).declaredRecursion, 5u);
}

}  // namespace
}  // namespace quintet::program
