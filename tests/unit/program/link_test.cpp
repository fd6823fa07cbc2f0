// From a description to SPIR-V: generated constants, library stages, errors; every built-in program.
#include <gmock/gmock.h>

#include "program/generated.h"
#include "program/link.h"
#include "program_test_support.h"

namespace quintet::program {
namespace {

using testing::Contains;
using testing::HasSubstr;

const shader::Compiler& compiler() {
  static const shader::Compiler kCompiler{shader::CompilerOptions{}};
  return kCompiler;
}

std::string problems(const CompiledProgram& compiled) {
  std::string text;
  for (const shader::Diagnostic& d : compiled.diagnostics) text += d.format() + "\n";
  return text;
}

TEST(ProgramLink, GeneratesConstants) {
  const Program p = parse(
      std::string(kSmall) +
      "[[ray]]\nname = \"shadow\"\nmiss = \"dark.rmiss\"\n[[output]]\nname = \"color\"\n[[output]]\nname = \"depth\"\n"
      "[[parameter]]\nname = \"on\"\ntype = \"bool\"\ndefault = true\n"
      "[[parameter]]\nname = \"tint\"\ntype = \"color\"\ndefault = [1, 1, 1]\n");
  const std::string glsl = generatedConstants(p);
  for (const char* line :
       {"const uint kRayTypeCount = 2u;", "const uint kRay_radiance = 0u;", "const uint kRay_shadow = 1u;",
        "const uint kMiss_shadow = 1u;", "const uint kOutput_color = 0u;", "const uint kOutput_depth = 1u;", "uint on;",
        "vec3 tint;", "#define parameters "})
    EXPECT_THAT(glsl, HasSubstr(line));
}

TEST(ProgramLink, ABlockWithoutParametersHasAMember) {
  EXPECT_THAT(generatedConstants(parse(kSmall)), HasSubstr("uint unused_;"));
}

// A program of its own files and of library stages, which includes a file beside it.
TEST(ProgramLink, CompilesOwnAndLibraryStages) {
  Files files = {{"main.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include "more/helper.glsl"
#include <quintet/output.glsl>
#include <quintet/trace.glsl>
void main() {
  const HitPayload hit = traceClosest(vec3(0.0), helper(), parameters.far, 0u);
  storeOutput(kOutput_color, launchPixel(), vec4(hit.t));
}
)"},
                 {"more/helper.glsl", "vec3 helper() { return vec3(0.0, 0.0, -1.0); }\n"}};
  const std::string toml =
      changed(kSmall, "sky.rmiss", "<quintet/stages/radiance.rmiss>") +
      "[[hit_group]]\nname = \"all\"\nradiance = { closest_hit = \"<quintet/stages/surface.rchit>\" }\n"
      "[[parameter]]\nname = \"far\"\ntype = \"float\"\ndefault = 1\n";
  const CompiledProgram compiled = compile(parse(toml, files), compiler(), {});
  EXPECT_TRUE(compiled.ok) << problems(compiled);
  ASSERT_EQ(compiled.stages.size(), 3u);
  EXPECT_EQ(compiled.stage("main.rgen").kind, shader::Stage::rayGeneration);
  EXPECT_EQ(compiled.stage("<quintet/stages/radiance.rmiss>").kind, shader::Stage::miss);
  EXPECT_EQ(compiled.stage("<quintet/stages/surface.rchit>").kind, shader::Stage::closestHit);
}

TEST(ProgramLink, PassesDefinesToEveryStage) {
  const Files files = {
      {"main.rgen", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() { int i = VALUE; }\n"},
      {"sky.rmiss", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() { int i = VALUE; }\n"}};
  EXPECT_FALSE(compile(parse(kSmall, files), compiler(), {}).ok);
  EXPECT_TRUE(compile(parse(kSmall, files), compiler(), {{"VALUE", "3"}}).ok);
}

TEST(ProgramLink, PointsAtTheErrorsOfEveryStage) {
  const Files files = {
      {"main.rgen", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {\n  int i = nothing;\n}\n"},
      {"sky.rmiss",
       "#version 460\n#extension GL_EXT_ray_tracing : require\n#include \"broken.glsl\"\nvoid main() {}\n"},
      {"broken.glsl", "\n\nint f( { }\n"}};
  const CompiledProgram compiled = compile(parse(kSmall, files), compiler(), {});
  EXPECT_FALSE(compiled.ok);
  std::vector<std::string> places;
  for (const shader::Diagnostic& d : compiled.diagnostics) places.push_back(d.file + ":" + std::to_string(d.line));
  EXPECT_THAT(places, Contains("folder/demo/main.rgen:4")) << problems(compiled);
  EXPECT_THAT(places, Contains(HasSubstr("broken.glsl:3"))) << problems(compiled);
}

TEST(ProgramLink, ReportsALibraryStageThatDoesNotExist) {
  Files files = someFiles();
  files["main.rgen"] = "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n";
  const CompiledProgram compiled =
      compile(parse(changed(kSmall, "sky.rmiss", "<quintet/stages/none.rmiss>"), files), compiler(), {});
  EXPECT_FALSE(compiled.ok);
  EXPECT_THAT(problems(compiled), HasSubstr("quintet/stages/none.rmiss"));
}

TEST(BuiltInPrograms, AreThere) {
  EXPECT_THAT(builtInPrograms(), testing::IsSupersetOf({"ao", "naive", "normals", "pathtracer"}));
}

TEST(BuiltInPrograms, ParseAndCompile) {
  for (const std::string& name : builtInPrograms()) {
    SCOPED_TRACE(name);
    const Program p = loadProgram(name);
    EXPECT_EQ(p.name, name);
    EXPECT_EQ(p.origin, "<programs/" + name + ">");
    const bool isLecture = p.accumulation == Accumulation::program;
    EXPECT_FALSE(p.description.empty());
    ASSERT_FALSE(p.outputs.empty());
    EXPECT_EQ(p.outputs[0].name, isLecture ? "picture" : "color");
    for (const Parameter& parameter : p.parameters) EXPECT_FALSE(parameter.help.empty()) << parameter.name;
    // Both ways to find a hit's barycentrics (link of a scene with alpha).
    for (const std::vector<std::pair<std::string, std::string>>& defines :
         {std::vector<std::pair<std::string, std::string>>{}, {{"QUINTET_RECOMPUTE_BARYCENTRICS", "1"}}}) {
      const CompiledProgram compiled = compile(p, compiler(), defines);
      EXPECT_TRUE(compiled.ok) << problems(compiled);
      EXPECT_TRUE(compiled.diagnostics.empty()) << problems(compiled);
    }
  }
}

}  // namespace
}  // namespace quintet::program
