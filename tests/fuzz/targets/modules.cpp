// SPDX-License-Identifier: Apache-2.0
// SPIR-V modules of other applications as `quintet check --spirv` and the layer read them: validated and optimized, and, to
// reach the rules without the validator, as they are. All entry points form one pipeline.
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "check/check.h"
#include "check/modules/stage_groups.h"
#include "check/modules/stage_module.h"
#include "spirv/plain_lines.h"
#include "spirv/shader_record.h"
#include "target.h"

namespace quintet::fuzz {
namespace {

void checkAll(const std::vector<check::ModuleStage>& stages) {
  const check::CheckResult result = check::checkModules(check::groupsOfStages(stages), stages, {});
  for (const Diagnostic& diagnostic : result.diagnostics) {
    if (diagnostic.text.find(spirv::kIdMark) != std::string::npos) reportFinding("a text has the mark of an id");
    if (diagnostic.file.find(spirv::kIdMark) != std::string::npos) reportFinding("a file has the mark of an id");
  }
}

}  // namespace

void readInput(Input input) {
  std::vector<std::uint32_t> words(input.size() / sizeof(std::uint32_t));
  if (words.empty()) return;
  std::memcpy(words.data(), input.data(), words.size() * sizeof(std::uint32_t));
  std::string why;
  const auto summary = check::summarize(words, why);
  if (!summary) return checkMessage(why);
  std::vector<check::ModuleStage> optimized, raw;
  for (const spirv::EntryPoint& entry : summary->entryPoints) {
    const std::string name = "module " + std::to_string(raw.size());
    optimized.push_back(check::stageModule(name, words, entry, shader::SpecializationValues{}));
    raw.push_back({name, *check::stageOf(entry.stage), spirv::withEntryPoint(words, entry), {}});
    if (raw.size() == 8) break;
  }
  checkAll(optimized);
  checkAll(raw);
  (void)spirv::withPlainLines(words);
  if (const auto module = spirv::Module::read(words)) (void)spirv::shaderRecordBytes(*module);
}

}  // namespace quintet::fuzz
