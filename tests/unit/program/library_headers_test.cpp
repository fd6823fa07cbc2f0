// SPDX-License-Identifier: Apache-2.0
// Each header of the GLSL library includes what it uses: it compiles as the first include of each stage that it supports,
// before and after the generated constants.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/file.h"
#include "program/description/generated_glsl.h"
#include "shader/compiler.h"
#include "shader/library.h"

namespace quintet::program {
namespace {

using shader::Stage;

constexpr const char* kGenerated = "quintet/generated/program.glsl";

const std::vector<Stage> kHitStages{Stage::anyHit, Stage::closestHit};
const std::vector<Stage> kCandidateStages{Stage::intersection, Stage::anyHit, Stage::closestHit};
const std::vector<Stage> kRayTracingStages{Stage::rayGeneration, Stage::intersection, Stage::anyHit,
                                           Stage::closestHit,    Stage::miss,         Stage::callable};
const std::vector<Stage> kTracingStages{Stage::rayGeneration, Stage::closestHit, Stage::miss};

// Headers that do not support every stage, because of the built-ins that they use.
const std::map<std::string, std::vector<Stage>> kSupported{
    {"quintet/alpha.glsl", kHitStages},
    {"quintet/generated/record.glsl", kRayTracingStages},
    {"quintet/hit.glsl", kHitStages},
    {"quintet/hit_geometry.glsl", kCandidateStages},
    {"quintet/launch_pixel.glsl", kRayTracingStages},
    {"quintet/output.glsl", kRayTracingStages},
    {"quintet/passes/deform.glsl", {Stage::compute}},
    {"quintet/passes/pass_index.glsl", {Stage::compute}},
    {"quintet/procedural/alpha.glsl", kHitStages},
    {"quintet/procedural/hit.glsl", kHitStages},
    {"quintet/trace.glsl", kTracingStages},
};

// Not for programs: parts that the front end of the lecture form and the instrumentation insert, and whole shaders.
bool isInternal(const std::string& path) {
  return path.starts_with("quintet/gsn") || path.starts_with("quintet/names_") || path == "quintet/explain.glsl" ||
         path == "quintet/heat.glsl" || path == "quintet/instrument.glsl" || path == "quintet/log.glsl" ||
         path == "quintet/print.glsl" || path == "quintet/values.glsl" || path == "quintet/recursion.glsl" ||
         path.starts_with("quintet/stages/") || path.starts_with("quintet/passes/film_") ||
         path.starts_with("quintet/passes/deform_") || path == "quintet/passes/tree_cost.glsl";
}

std::vector<std::string> headers() {
  std::vector<std::string> found{kGenerated, "quintet/generated/record.glsl"};
  for (const EmbeddedFile& file : embeddedShaderLibrary())
    if (!isInternal(std::string(file.path))) found.emplace_back(file.path);
  return found;
}

std::vector<Stage> stagesOf(const std::string& header) {
  if (const auto found = kSupported.find(header); found != kSupported.end()) return found->second;
  std::vector<Stage> all = kRayTracingStages;
  all.push_back(Stage::compute);
  return all;
}

// The ray types that <quintet/trace.glsl> requires, an output, a parameter and a record field.
Program someProgram() {
  Program program;
  program.rays = {{.name = "radiance", .miss = "sky.rmiss"}, {.name = "shadow", .miss = "lit.rmiss"}};
  program.outputs = {{.name = "color"}};
  Parameter tint;
  tint.name = "tint";
  program.parameters = program.record = {tint};
  return program;
}

std::string errorsWith(const std::vector<std::string>& includes, Stage stage) {
  static const shader::Compiler kCompiler = [] {
    shader::CompilerOptions options;
    options.optimize = options.debugInfo = false;
    options.cacheFolder = cacheFolder() / "shaders";
    return shader::Compiler(options);
  }();
  shader::Source source;
  source.stage = stage;
  source.name = "first" + std::string(shader::stageExtension(stage));
  source.text = "#version 460\n";
  if (stage != Stage::compute) source.text += "#extension GL_EXT_ray_tracing : require\n";
  for (const std::string& include : includes) source.text += "#include <" + include + ">\n";
  source.text += "void main() {}\n";
  source.virtualFiles = generatedFiles(someProgram());
  std::string errors;
  for (const Diagnostic& d : kCompiler.compile(source).diagnostics) errors += d.format() + "\n";
  return errors;
}

class LibraryHeader : public testing::TestWithParam<std::string> {};

TEST_P(LibraryHeader, CompilesAsTheFirstInclude) {
  for (const Stage stage : stagesOf(GetParam()))
    EXPECT_EQ(errorsWith({GetParam()}, stage), "") << shader::stageName(stage);
}

TEST_P(LibraryHeader, CompilesBeforeAndAfterTheGeneratedConstants) {
  const Stage stage = stagesOf(GetParam()).front();
  EXPECT_EQ(errorsWith({kGenerated, GetParam()}, stage), "");
  EXPECT_EQ(errorsWith({GetParam(), kGenerated}, stage), "");
}

INSTANTIATE_TEST_SUITE_P(All, LibraryHeader, testing::ValuesIn(headers()), [](const auto& test) {
  std::string name = test.param.substr(std::string("quintet/").size());
  std::ranges::replace_if(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
});

// All headers of a stage in a few random orders, except pcg.glsl, which replaces sobol.glsl.
TEST(LibraryHeaders, CompileInAnyOrder) {
  std::mt19937 random(13);
  for (const Stage stage : kRayTracingStages) {
    std::vector<std::string> includes;
    for (const std::string& header : headers())
      if (const std::vector<Stage> stages = stagesOf(header);
          header != "quintet/sampling/pcg.glsl" && std::ranges::find(stages, stage) != stages.end())
        includes.push_back(header);
    for (int order = 0; order < 3; ++order) {
      std::ranges::shuffle(includes, random);
      EXPECT_EQ(errorsWith(includes, stage), "")
          << shader::stageName(stage) << ": " << testing::PrintToString(includes);
    }
  }
}

TEST(LibraryHeaders, AreAllTested) {
  const std::vector<std::string> all = headers();
  EXPECT_GT(all.size(), 50u);
  for (const auto& [header, stages] : kSupported) EXPECT_THAT(all, testing::Contains(header));
}

}  // namespace
}  // namespace quintet::program
