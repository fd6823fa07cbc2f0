// SPDX-License-Identifier: Apache-2.0
// Compiles one stage and lists the diagnostics of the rules within a stage as "Q701:12".
#ifndef QUINTET_TESTS_UNIT_CHECK_STAGE_TEST_SUPPORT_H
#define QUINTET_TESTS_UNIT_CHECK_STAGE_TEST_SUPPORT_H

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "check/check.h"
#include "check/rules/rules.h"

namespace quintet::check {

// Two lines precede the source, so its first line is line 3.
inline std::optional<spirv::Module> compileStage(shader::Stage stage, const std::string& text) {
  shader::CompilerOptions options;
  options.cacheFolder = cacheFolder() / "shaders";
  static const shader::Compiler compiler(options);
  shader::Source source;
  source.stage = stage;
  source.name = "test" + std::string(shader::stageExtension(stage));
  source.text = "#version 460\n#extension GL_EXT_ray_tracing : require\n" + text;
  shader::Result result = compiler.compile(source);
  for (const Diagnostic& d : result.diagnostics) ADD_FAILURE() << d.format();
  if (!result.ok()) return {};
  std::string why;
  auto module = spirv::Module::read(std::move(result.spirv), &why);
  EXPECT_TRUE(module) << why;
  return module;
}

inline StageContext defectiveDevice() {
  StageContext context;
  context.hasAnyHit = true;
  context.defects.changesNestedBuiltIns = true;
  context.defects.corruptsHitAttributes = true;
  context.defects.sharesLocalArrays = true;
  return context;
}

inline std::vector<std::string> linesOf(const std::vector<Diagnostic>& diagnostics) {
  std::vector<std::string> lines;
  for (const Diagnostic& d : diagnostics) lines.push_back(d.id + ":" + std::to_string(d.line));
  return lines;
}

// The diagnostics of a stage of a program.
inline std::vector<std::string> checkText(shader::Stage stage, const std::string& text, StageContext context = {},
                                          const ProgramStageContext& program = {}) {
  const auto module = compileStage(stage, text);
  EXPECT_TRUE(module);
  if (!module) return {};
  context.usesLibrary = true;
  std::vector<Diagnostic> found = checkStage(*module, context);
  for (Diagnostic& d : checkProgramStage(*module, program)) found.push_back(std::move(d));
  std::ranges::stable_sort(found, {}, &Diagnostic::id);
  return linesOf(found);
}

}  // namespace quintet::check
#endif
