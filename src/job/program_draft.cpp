// SPDX-License-Identifier: Apache-2.0
#include "job/program_draft.h"

#include <exception>
#include <utility>

#include "gpu/commands.h"
#include "gpu/context.h"

namespace quintet::job {

PendingPipeline::PendingPipeline(gpu::Context& context, const gpu::BindlessSet& set, program::Program program,
                                 program::CompiledProgram compiled, const gpu::PipelineCache& cache, Launch launch)
    : program_(std::move(program)), compiled_(std::move(compiled)) {
  created_ = std::async(std::launch::async, [this, &context, &set, &cache, launch] {
               try {
                 create(context, set, cache, launch);
                 return true;
               } catch (const std::exception&) {
                 return false;
               }
             }).share();
}

void PendingPipeline::create(gpu::Context& context, const gpu::BindlessSet& set, const gpu::PipelineCache& cache,
                             Launch launch) {
  linked_ = std::make_unique<program::LinkedProgram>(context, set, program_, compiled_, 1, &cache);
  if (launch == Launch::none) return;
  table_ = linked_->makeTable({});
  context.submit([&](gpu::Commands& commands) { rt::traceNothing(commands, linked_->pipeline(), *table_); });
}

bool PendingPipeline::ready() { return created_.get(); }

}  // namespace quintet::job
