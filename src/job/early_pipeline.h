// SPDX-License-Identifier: Apache-2.0
// The pipeline of a program, created while its scene is still being loaded. Linking the program then finds it
// (gpu::PipelineStore). Drivers take more than a second for a large pipeline that is not in their cache.
#ifndef QUINTET_JOB_EARLY_PIPELINE_H
#define QUINTET_JOB_EARLY_PIPELINE_H

#include <memory>

#include "gpu/descriptors.h"
#include "program/linked/linked_program.h"

namespace quintet::job {

// True if the depth of nested traces is 1 whatever the scene is, as far as the stages show.
bool tracesOnlyFromRayGeneration(const program::Program& program, const program::CompiledProgram& compiled);

class EarlyPipeline {
 public:
  // Returns null if the program is not built in, since the check must come first; if stages other than ray generation trace
  // rays, since the check finds the depth; and if the pipeline cannot be created: linking then reports why. Keep the result
  // until the program is linked.
  static std::unique_ptr<EarlyPipeline> make(gpu::Context& context, const program::Program& program,
                                             const program::CompiledProgram& compiled, const gpu::PipelineCache& cache);

  EarlyPipeline(gpu::Context& context, const program::Program& program, const program::CompiledProgram& compiled,
                const gpu::PipelineCache& cache);

  const program::LinkedProgram& linked() const { return linked_; }

 private:
  gpu::BindlessSet set_;  // its layout is compatible with that of the scene
  program::LinkedProgram linked_;
};

}  // namespace quintet::job
#endif
