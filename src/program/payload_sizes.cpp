#include "program/payload_sizes.h"

#include "shader/spirv_module.h"

namespace quintet::program {

std::vector<PayloadSize> payloadSizes(const CompiledProgram& compiled) {
  std::vector<PayloadSize> sizes;
  for (const CompiledProgram::Stage& stage : compiled.stages) {
    const std::optional<shader::SpirvModule> module = shader::SpirvModule::read(stage.spirv);
    if (!module) continue;
    for (const shader::SpirvVariable& variable : module->variables())
      if (variable.storage == spv::StorageClass::RayPayloadKHR ||
          variable.storage == spv::StorageClass::IncomingRayPayloadKHR)
        sizes.push_back({stage.file, module->types().nameOf(variable.type), module->types().get(variable.type).bytes});
  }
  return sizes;
}

}  // namespace quintet::program
