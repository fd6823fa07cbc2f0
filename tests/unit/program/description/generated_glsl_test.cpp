// SPDX-License-Identifier: Apache-2.0
// The GLSL that Quintet generates for a program: constants, the parameter block and the shader record.
#include "program/description/generated_glsl.h"

#include <gmock/gmock.h>

#include "program/program_test_support.h"

namespace quintet::program {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(GeneratedGlsl, DefinesConstants) {
  const Program p = parse(
      kSmall +
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

TEST(GeneratedGlsl, AddsAMemberToAnEmptyParameterBlock) {
  EXPECT_THAT(generatedConstants(parse(kSmall)), HasSubstr("uint unused_;"));
}

TEST(GeneratedGlsl, NumbersMissShadersAfterThoseOfTheRays) {
  const std::string glsl = generatedConstants(parse(kSmall + R"([[ray]]
name = "shadow"
miss = "dark.rmiss"
[[miss]]
name = "black"
file = "dark.rmiss"
[[miss]]
name = "library"
file = "<quintet/stages/shadow.rmiss>"
)"));
  for (const char* line :
       {"const uint kMissCount = 4u;", "const uint kMiss_radiance = 0u;", "const uint kMiss_shadow = 1u;",
        "const uint kMiss_black = 2u;", "const uint kMiss_library = 3u;", "const uint kRayTypeCount = 2u;"})
    EXPECT_THAT(glsl, HasSubstr(line));
}

TEST(GeneratedGlsl, DefinesNoConstantForAnUnnamedCallable) {
  Files files = someFiles();
  files["2d noise.rcall"] = "";
  const std::string glsl = generatedConstants(
      parse(changed(kSmall, "description",
                    "callables = [\"noise.rcall\", \"2d noise.rcall\", \"noise.rcall\"]\ndescription") +
                "[[callable]]\nname = \"wood\"\nfile = \"noise.rcall\"\n",
            files));
  EXPECT_THAT(glsl, HasSubstr("const uint kCallable_noise = 0u;"));
  EXPECT_THAT(glsl, HasSubstr("const uint kCallable_wood = 3u;"));
  EXPECT_THAT(glsl, HasSubstr("const uint kCallableCount = 4u;"));
  EXPECT_THAT(glsl, Not(HasSubstr("kCallable_ ")));
}

TEST(GeneratedGlsl, DefinesTheValuesOfAChoice) {
  const std::string glsl = generatedConstants(parse(
      kSmall +
      "[[parameter]]\nname = \"mode\"\ntype = \"choice\"\nchoices = [\"plain\", \"heat\"]\ndefault = \"heat\"\n"));
  EXPECT_THAT(glsl, HasSubstr("const uint kChoice_mode_plain = 0u;\nconst uint kChoice_mode_heat = 1u;\n"));
  EXPECT_THAT(glsl, HasSubstr("  uint mode;\n"));
}

TEST(GeneratedGlsl, CountsOutputs) {
  const std::string outputs =
      "[[output]]\nname = \"color\"\n[[output]]\nname = \"far\"\n[[output]]\nname = \"other\"\n";
  EXPECT_THAT(generatedConstants(parse(kSmall + outputs)), HasSubstr("const uint kOutputCount = 3u;"));
}

TEST(GeneratedGlsl, DeclaresTheShaderRecord) {
  const std::string glsl = generatedRecord(parse(kSmall + R"(
[[record]]
name = "tint"
type = "color"
default = [1, 1, 1]
[[record]]
name = "weight"
type = "float"
default = 1
[[record]]
name = "on"
type = "bool"
default = false
[[record]]
name = "count"
type = "int"
default = 7
)"));
  EXPECT_THAT(glsl, HasSubstr("struct Record {\n  vec3 tint;\n  float weight;\n  uint on;\n  int count;\n};"));
  EXPECT_THAT(glsl, HasSubstr("layout(shaderRecordEXT, scalar) buffer RecordBlock { Record record; };"));
  EXPECT_THAT(generatedRecord(parse(kSmall)), HasSubstr("#error"));
}

}  // namespace
}  // namespace quintet::program
