// SPDX-License-Identifier: Apache-2.0
#include "job/early_pipeline.h"

#include <algorithm>
#include <cstdint>
#include <exception>

#include "program/load.h"
#include "quintet/shared/pass.h"
#include "spirv/module.h"

namespace quintet::job {
namespace {

bool traces(const program::CompiledProgram::Stage& stage) {
  const std::optional<spirv::Module> module = spirv::Module::read(stage.spirv);
  return !module || std::ranges::any_of(module->instructions(), [](const spirv::Instruction& instruction) {
    return instruction.op == spv::Op::OpTraceRayKHR;
  });
}

}  // namespace

bool tracesOnlyFromRayGeneration(const program::Program& program, const program::CompiledProgram& compiled) {
  return !program.declaredRecursion &&
         std::ranges::none_of(compiled.stages, [](const program::CompiledProgram::Stage& stage) {
           return stage.kind != shader::Stage::rayGeneration && traces(stage);
         });
}

std::unique_ptr<EarlyPipeline> EarlyPipeline::make(gpu::Context& context, const program::Program& program,
                                                   const program::CompiledProgram& compiled,
                                                   const gpu::PipelineCache& cache) {
  // The check has found no error in built-in programs. Those of users must be checked first: a wrong pipeline can crash a driver.
  if (!compiled.ok || !program::isBuiltIn(program) || !tracesOnlyFromRayGeneration(program, compiled)) return nullptr;
  try {
    return std::make_unique<EarlyPipeline>(context, program, compiled, cache);
  } catch (const std::exception&) {
    return nullptr;
  }
}

EarlyPipeline::EarlyPipeline(gpu::Context& context, const program::Program& program,
                             const program::CompiledProgram& compiled, const gpu::PipelineCache& cache)
    : set_(context, 1, shared::kPushConstantBytes), linked_(context, set_, program, compiled, 1, &cache) {}

}  // namespace quintet::job
