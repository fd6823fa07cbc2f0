#include "program/device_stages.h"

#include "shader/mend_builtins.h"
#include "shader/spirv_module.h"

namespace quintet::program {

DeviceStages::DeviceStages(const Program& program, const CompiledProgram& compiled, const gpu::Quirks& quirks)
    : compiled_(compiled), copies_(quirks.sharesAnyHit) {
  own_.reserve(compiled.stages.size());  // stages_ points into its elements
  for (const CompiledProgram::Stage& stage : compiled.stages) {
    std::vector<std::uint32_t>& spirv = own_.emplace_back(shader::withoutDebugInfo(stage.spirv));
    if (quirks.changesNestedBuiltIns && stage.kind == shader::Stage::closestHit)
      spirv = shader::mendNestedBuiltIns(spirv);
    stages_.push_back({stage.kind, spirv, program.path(stage.file)});
  }
}

int DeviceStages::index(const std::string& file) const {
  return file.empty() ? rt::kNoStage : static_cast<int>(&compiled_.stage(file) - compiled_.stages.data());
}

int DeviceStages::intersection(const std::string& file, const std::string& anyHit) {
  const int first = index(file);
  if (file.empty() || !copies_) return first;
  auto& known = byAnyHit_[file];
  const auto found = known.find(anyHit);
  if (found != known.end()) return found->second;
  int stage = first;
  if (!known.empty()) {
    stage = static_cast<int>(stages_.size());
    stages_.push_back(stages_[static_cast<std::size_t>(first)]);
  }
  return known[anyHit] = stage;
}

}  // namespace quintet::program
