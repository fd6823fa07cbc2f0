// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/trace_location.h"

#include "spirv/module.h"

namespace quintet::render {

SourceLocation traceLocation(const program::RunnableProgram& runnable, std::size_t stage, std::uint32_t line) {
  const program::Program& program = runnable.description;
  if (stage >= runnable.compiled.stages.size() || line == 0) return {};
  std::optional<spirv::Module> module = spirv::Module::read(runnable.compiled.stages[stage].spirv);
  if (!module) return {};
  for (const auto& [file, text] : program.files) module->addSource(program.path(file), text);
  SourceLocation found;
  for (const spirv::Instruction& instruction : module->instructions()) {
    if (instruction.op != spv::Op::OpTraceRayKHR) continue;
    // The line of the instruction is that where the call ends.
    SourceLocation location = module->location(instruction, "traceRayEXT");
    if (location.line > static_cast<int>(line) || instruction.line < line) continue;
    location.file = program::userFile(program, location.file);
    if (!found.file.empty() && (found.file != location.file || found.line != location.line)) return {};
    found = location;
  }
  return found;
}

}  // namespace quintet::render
