// SPDX-License-Identifier: Apache-2.0
// SPIR-V modules: the reader, the facts of a stage, and the rules of the check within one stage.
#include <cstdint>
#include <cstring>
#include <vector>

#include "check/check.h"
#include "check/rules/rules.h"
#include "spirv/module.h"
#include "spirv/stage_facts.h"
#include "target.h"

namespace quintet::fuzz {

void readInput(Input input) {
  std::vector<std::uint32_t> words(input.size() / sizeof(std::uint32_t));
  if (words.empty()) return;
  std::memcpy(words.data(), input.data(), words.size() * sizeof(std::uint32_t));
  std::string why;
  std::optional<spirv::Module> module = spirv::Module::read(words, &why);
  if (!module) return checkMessage(why);
  (void)spirv::withoutDebugInfo(words);
  check::StageContext context;
  context.hasAnyHit = true;
  context.defects = {true, true, true, true};
  context.usesLibrary = true;
  std::vector<Diagnostic> found = check::checkStage(*module, context);
  for (Diagnostic& diagnostic : check::checkProgramStage(*module, {})) found.push_back(std::move(diagnostic));
  for (const Diagnostic& diagnostic : found)
    if (diagnostic.id.empty()) reportFinding("a diagnostic has no id");
  const spirv::StageFacts facts(std::move(*module));
  (void)facts.frameBytes();
  for (const spirv::SharedVariable& variable : facts.variables())
    for (std::uint32_t leaf = 0; leaf < facts.leaves(variable.id).count(); ++leaf) {
      (void)facts.writesAlways(variable.id, leaf);
      (void)facts.inputReads(variable.id, leaf);
    }
}

}  // namespace quintet::fuzz
