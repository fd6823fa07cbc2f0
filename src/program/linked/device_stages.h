// SPDX-License-Identifier: Apache-2.0
// The compiled stages as one device's pipeline gets them, with workarounds for driver defects that a change to a shader or
// to the list of stages avoids (docs/design/quirks.md).
#ifndef QUINTET_PROGRAM_LINKED_DEVICE_STAGES_H
#define QUINTET_PROGRAM_LINKED_DEVICE_STAGES_H

#include <string>
#include <vector>

#include "gpu/context.h"
#include "program/compile.h"
#include "rt/pipeline.h"

namespace quintet::program {

VkShaderStageFlagBits vulkanStage(shader::Stage stage);

class DeviceStages {
 public:
  // `compiled` must outlive this object.
  DeviceStages(const Program& program, const CompiledProgram& compiled, const gpu::Quirks& quirks);
  DeviceStages(const DeviceStages&) = delete;
  DeviceStages& operator=(const DeviceStages&) = delete;

  const std::vector<rt::PipelineStage>& stages() const { return stages_; }
  // Returns the index in stages(), or rt::kNoStage for an empty name.
  int index(const std::string& file) const;

 private:
  const CompiledProgram& compiled_;
  std::vector<std::vector<std::uint32_t>> own_;  // SPIR-V, without sources, lines and names
  std::vector<rt::PipelineStage> stages_;        // in the order of `compiled`
};

}  // namespace quintet::program
#endif
