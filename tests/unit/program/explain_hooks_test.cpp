// SPDX-License-Identifier: Apache-2.0
// What the hooks of quintet/explain_hooks.glsl cost without instrumentation: nothing. And each built-in program compiles with
// Instrumentation::explain, with the data of each call.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "base/embedded.h"
#include "program/compile.h"
#include "program/description/generated_glsl.h"
#include "program/hit_shaders.h"
#include "program/load.h"
#include "program/program_test_support.h"
#include "shader/library.h"
#include "spirv/module.h"

namespace quintet::program {
namespace {

// The text without calls of the hooks.
std::string withoutHooks(const std::string& text) {
  return std::regex_replace(text, std::regex(R"((^|\n)[ ]*explain[A-Z]\w*\([^;{]*\);)"), "$1");
}

std::vector<std::uint32_t> compileRayGeneration(const Program& program, bool hooks) {
  shader::Source source;
  source.stage = shader::Stage::rayGeneration;
  source.name = program.path(program.rayGeneration);
  source.text = program.files.at(program.rayGeneration);
  source.virtualFiles = generatedFiles(program);
  for (const auto& [name, text] : program.files)
    source.virtualFiles[program.path(name)] = hooks ? text : withoutHooks(text);
  if (!hooks) {
    source.text = withoutHooks(source.text);
    for (const EmbeddedFile& file : embeddedShaderLibrary())
      if (file.path != "quintet/explain_hooks.glsl")
        source.virtualFiles[std::string(file.path)] = withoutHooks(std::string(file.data));
  }
  const shader::Result result = compiler().compile(source);
  for (const Diagnostic& d : result.diagnostics) ADD_FAILURE() << d.format();
  return spirv::withoutDebugInfo(result.spirv);
}

class ExplainHooks : public testing::TestWithParam<const char*> {};

TEST_P(ExplainHooks, AddNothingToTheProgram) {
  const Program program = loadProgram(GetParam());
  const std::string text = program.files.at(program.rayGeneration);
  ASSERT_NE(withoutHooks(text), text) << "the program has hooks";
  EXPECT_EQ(compileRayGeneration(program, true), compileRayGeneration(program, false));
}

INSTANTIATE_TEST_SUITE_P(Programs, ExplainHooks, testing::Values("pathtracer", "naive"));

TEST(ExplainedProgram, LogsThePayloadOfEachTrace) {
  for (const char* name :
       {"pathtracer", "naive", "ao", "normals", "07_mirror_recursion", "16_callable", "17_records"}) {
    const Program program = withHitShaders(loadProgram(name), Instrumentation::explain);
    const CompiledProgram compiled = compile(program, compiler(), {}, Instrumentation::explain);
    for (const Diagnostic& d : compiled.diagnostics) ADD_FAILURE() << name << ": " << d.format();
    ASSERT_TRUE(compiled.ok) << name;
    for (const CompiledProgram::Stage& stage : compiled.stages) {
      const auto module = spirv::Module::read(stage.spirv);
      ASSERT_TRUE(module) << name << ": " << stage.file;
      const auto calls = std::ranges::count_if(module->instructions(), [](const spirv::Instruction& i) {
        return i.op == spv::Op::OpTraceRayKHR || i.op == spv::Op::OpExecuteCallableKHR;
      });
      EXPECT_EQ(std::ssize(stage.calls), calls) << name << ": " << stage.file;
      for (const spirv::CallSite& call : stage.calls) {
        EXPECT_FALSE(call.fields.empty()) << name << ": " << stage.file;
        EXPECT_TRUE(call.complete) << name << ": " << call.type;
        EXPECT_GT(call.location.line, 0) << name << ": " << stage.file;
      }
    }
  }
}

}  // namespace
}  // namespace quintet::program
