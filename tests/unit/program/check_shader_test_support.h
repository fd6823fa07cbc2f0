// Compiles one stage as the check sees it and lists what checkShader finds: "Q701:12".
#ifndef QUINTET_TESTS_UNIT_PROGRAM_CHECK_SHADER_SUPPORT_H
#define QUINTET_TESTS_UNIT_PROGRAM_CHECK_SHADER_SUPPORT_H

#include <gtest/gtest.h>

#include "program/check_shader.h"

namespace quintet::program {

// The source is put behind two lines, so its first line is line 3.
inline std::optional<shader::SpirvModule> compileStage(shader::Stage stage, const std::string& text) {
  shader::CompilerOptions options;
  options.debugInfo = true;
  static const shader::Compiler compiler(options);
  shader::Source source;
  source.stage = stage;
  source.name = "test" + std::string(shader::stageExtension(stage));
  source.text = "#version 460\n#extension GL_EXT_ray_tracing : require\n" + text;
  shader::Result result = compiler.compile(source);
  for (const shader::Diagnostic& d : result.diagnostics) ADD_FAILURE() << d.format();
  if (!result.ok()) return {};
  std::string why;
  auto module = shader::SpirvModule::read(std::move(result.spirv), &why);
  EXPECT_TRUE(module) << why;
  return module;
}

inline ShaderSituation defectiveDevice() {
  ShaderSituation situation;
  situation.hasAnyHit = true;
  situation.quirks.changesNestedBuiltIns = true;
  situation.quirks.corruptsHitAttributes = true;
  situation.quirks.sharesLocalArrays = true;
  return situation;
}

inline std::vector<std::string> findingsOf(shader::Stage stage, const std::string& text,
                                           const ShaderSituation& situation = {}) {
  const auto module = compileStage(stage, text);
  EXPECT_TRUE(module);
  std::vector<std::string> result;
  if (!module) return result;
  for (const shader::Diagnostic& d : checkShader(*module, situation))
    result.push_back(d.id + ":" + std::to_string(d.line));
  return result;
}

}  // namespace quintet::program
#endif
