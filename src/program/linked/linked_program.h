// SPDX-License-Identifier: Apache-2.0
// A program on a device: its ray tracing pipeline, and shader binding tables for the geometry of scenes.
#ifndef QUINTET_PROGRAM_LINKED_LINKED_PROGRAM_H
#define QUINTET_PROGRAM_LINKED_LINKED_PROGRAM_H

#include <memory>

#include "program/compile.h"
#include "program/scene_facts.h"
#include "rt/pipeline.h"

namespace quintet::program {

class LinkedProgram {
 public:
  // `compiled.ok` must be true. `recursionDepth` is the depth of nested traces that check() derives (check/check.h).
  LinkedProgram(gpu::Context& context, const gpu::BindlessSet& set, const Program& program,
                const CompiledProgram& compiled, std::uint32_t recursionDepth, const gpu::PipelineCache* cache,
                bool captureStatistics = false);

  const Program& program() const { return program_; }
  const rt::Pipeline& pipeline() const { return *pipeline_; }
  std::uint32_t rayTypeCount() const { return static_cast<std::uint32_t>(program_.rays.size()); }
  double pipelineSeconds() const { return pipelineSeconds_; }  // wall-clock time to create the pipeline
  std::uint32_t recursionDepth() const { return recursionDepth_; }

  // Returns a table in which geometry k has the hit records k · rayTypeCount … + rayTypeCount - 1, one per ray type.
  rt::ShaderBindingTable makeTable(std::span<const GeometryFacts> geometries) const;

 private:
  std::vector<std::byte> recordData(const RecordValues& values) const;

  gpu::Context& context_;
  Program program_;
  std::unique_ptr<rt::Pipeline> pipeline_;
  std::uint32_t firstMissGroup_ = 0;
  std::uint32_t firstHitGroup_ = 0;  // hit group h for ray type r is group first + h · rayTypeCount + r
  std::uint32_t firstCallableGroup_ = 0;
  double pipelineSeconds_ = 0;
  std::uint32_t recursionDepth_ = 1;
};

}  // namespace quintet::program
#endif
