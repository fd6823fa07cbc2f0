// The compiled stages as the pipeline of one device gets them: mended where its driver has a defect that a change of
// the shader or of the list of stages avoids (docs/design/quirks.md).
#ifndef QUINTET_PROGRAM_DEVICE_STAGES_H
#define QUINTET_PROGRAM_DEVICE_STAGES_H

#include <map>

#include "gpu/context.h"
#include "program/link.h"

namespace quintet::program {

class DeviceStages {
 public:
  // `compiled` must outlive this object.
  DeviceStages(const Program& program, const CompiledProgram& compiled, const gpu::Quirks& quirks);
  DeviceStages(const DeviceStages&) = delete;
  DeviceStages& operator=(const DeviceStages&) = delete;

  const std::vector<rt::PipelineStage>& stages() const { return stages_; }
  // Index in stages(); rt::kNoStage for an empty name.
  int index(const std::string& file) const;
  // Of the intersection shader in a hit group with this any-hit shader. Where groups that share the stage would run
  // the first group's any-hit shader, each any-hit shader gets an entry of its own.
  int intersection(const std::string& file, const std::string& anyHit);

 private:
  const CompiledProgram& compiled_;
  bool copies_;
  std::vector<std::vector<std::uint32_t>> own_;                 // SPIR-V, without sources, lines and names
  std::vector<rt::PipelineStage> stages_;                       // those of `compiled` first, in its order
  std::map<std::string, std::map<std::string, int>> byAnyHit_;  // intersection -> any-hit -> stage
};

}  // namespace quintet::program
#endif
