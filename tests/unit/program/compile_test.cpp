// SPDX-License-Identifier: Apache-2.0
// Compiling a program to SPIR-V: library stages, defines, errors.
#include "program/compile.h"

#include <gmock/gmock.h>

#include "program/program_test_support.h"

namespace quintet::program {
namespace {

using testing::Contains;
using testing::HasSubstr;

std::string problems(const CompiledProgram& compiled) {
  std::string text;
  for (const Diagnostic& d : compiled.diagnostics) text += d.format() + "\n";
  return text;
}

// A program of its own files and of library stages, with an included file.
TEST(CompileProgram, CompilesOwnAndLibraryStages) {
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

TEST(CompileProgram, PassesDefinesToEveryStage) {
  const Files files = {
      {"main.rgen", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() { int i = VALUE; }\n"},
      {"sky.rmiss", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() { int i = VALUE; }\n"}};
  EXPECT_FALSE(compile(parse(kSmall, files), compiler(), {}).ok);
  EXPECT_TRUE(compile(parse(kSmall, files), compiler(), {{"VALUE", "3"}}).ok);
}

TEST(CompileProgram, ReportsTheErrorsOfEveryStage) {
  const Files files = {
      {"main.rgen", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {\n  int i = nothing;\n}\n"},
      {"sky.rmiss",
       "#version 460\n#extension GL_EXT_ray_tracing : require\n#include \"broken.glsl\"\nvoid main() {}\n"},
      {"broken.glsl", "\n\nint f( { }\n"}};
  const CompiledProgram compiled = compile(parse(kSmall, files), compiler(), {});
  EXPECT_FALSE(compiled.ok);
  std::vector<std::string> locations;
  for (const Diagnostic& d : compiled.diagnostics) locations.push_back(d.file + ":" + std::to_string(d.line));
  EXPECT_THAT(locations, Contains("folder/demo/main.rgen:4")) << problems(compiled);
  EXPECT_THAT(locations, Contains(HasSubstr("broken.glsl:3"))) << problems(compiled);
}

TEST(CompileProgram, ReportsAnUnknownLibraryStage) {
  Files files = someFiles();
  files["main.rgen"] = "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n";
  const CompiledProgram compiled =
      compile(parse(changed(kSmall, "sky.rmiss", "<quintet/stages/none.rmiss>"), files), compiler(), {});
  EXPECT_FALSE(compiled.ok);
  EXPECT_THAT(problems(compiled), HasSubstr("quintet/stages/none.rmiss"));
}

}  // namespace
}  // namespace quintet::program
