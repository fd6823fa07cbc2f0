// SPDX-License-Identifier: Apache-2.0
// Two versions of an edited program, for front ends in which the first image after an edit must appear early. The draft has few
// optimizations (shader::draft). Its pipeline is created while the complete program is still compiled and checked, and lavapipe,
// which compiles at the first launch, gets a launch without invocations. No shader runs before the check has passed. The
// complete program then replaces the draft: only with it, images have the values of other renders, bit for bit.
#ifndef QUINTET_JOB_PROGRAM_DRAFT_H
#define QUINTET_JOB_PROGRAM_DRAFT_H

#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "program/linked/linked_program.h"
#include "program/runnable_program.h"
#include "rt/pipeline.h"

namespace quintet::job {

// Creates a pipeline for traces of depth 1 on a thread of its own. Linking the program then finds it (gpu::PipelineStore). The
// arguments outlive the object, whose destructor waits for the thread.
class PendingPipeline {
 public:
  enum class Launch { none, empty };  // empty: the driver compiles for the first launch
  PendingPipeline(gpu::Context& context, const gpu::BindlessSet& set, program::Program program,
                  program::CompiledProgram compiled, const gpu::PipelineCache& cache, Launch launch);

  PendingPipeline(const PendingPipeline&) = delete;
  PendingPipeline& operator=(const PendingPipeline&) = delete;

  // Waits for the pipeline. Returns false if it cannot be created; linking then reports why.
  bool ready();
  const program::CompiledProgram& compiled() const { return compiled_; }

 private:
  void create(gpu::Context& context, const gpu::BindlessSet& set, const gpu::PipelineCache& cache, Launch launch);

  const program::Program program_;
  const program::CompiledProgram compiled_;
  std::unique_ptr<program::LinkedProgram> linked_;
  std::optional<rt::ShaderBindingTable> table_;  // of the launch
  std::shared_future<bool> created_;             // last: its thread uses the members above
};

// The complete program of a draft that is shown.
struct CompleteProgram {
  program::RunnableProgram program;
  PendingPipeline pipeline;
};

}  // namespace quintet::job
#endif
