#include "program/check_shader.h"

#include <algorithm>

#include "program/check_shader_rules.h"
#include "program/diagnostic_catalog.h"

namespace quintet::program {

using shader::SpirvInstruction;
using shader::SpirvModule;

void Findings::add(std::string_view id, const SpirvInstruction& where, std::string text, std::string_view token) {
  const shader::Place place = module_.place(where, token);
  if (!seen_.insert(std::string(id) + " " + place.file + ":" + std::to_string(place.line)).second) return;
  const DiagnosticInfo* info = findDiagnostic(id);
  diagnostics_.push_back({info ? info->severity : shader::Severity::error, place.file, place.line, place.column,
                          std::string(id), std::move(text)});
}

std::string_view glslName(spv::BuiltIn builtIn) {
  using spv::BuiltIn;
  switch (builtIn) {
    case BuiltIn::LaunchIdKHR: return "gl_LaunchIDEXT";
    case BuiltIn::LaunchSizeKHR: return "gl_LaunchSizeEXT";
    case BuiltIn::PrimitiveId: return "gl_PrimitiveID";
    case BuiltIn::InstanceId: return "gl_InstanceID";
    case BuiltIn::InstanceCustomIndexKHR: return "gl_InstanceCustomIndexEXT";
    case BuiltIn::RayGeometryIndexKHR: return "gl_GeometryIndexEXT";
    case BuiltIn::WorldRayOriginKHR: return "gl_WorldRayOriginEXT";
    case BuiltIn::WorldRayDirectionKHR: return "gl_WorldRayDirectionEXT";
    case BuiltIn::ObjectRayOriginKHR: return "gl_ObjectRayOriginEXT";
    case BuiltIn::ObjectRayDirectionKHR: return "gl_ObjectRayDirectionEXT";
    case BuiltIn::RayTminKHR: return "gl_RayTminEXT";
    case BuiltIn::RayTmaxKHR: return "gl_RayTmaxEXT";
    case BuiltIn::IncomingRayFlagsKHR: return "gl_IncomingRayFlagsEXT";
    case BuiltIn::HitKindKHR: return "gl_HitKindEXT";
    case BuiltIn::ObjectToWorldKHR: return "gl_ObjectToWorldEXT";
    case BuiltIn::WorldToObjectKHR: return "gl_WorldToObjectEXT";
    default: return "a built-in";
  }
}

std::optional<spv::BuiltIn> loadedBuiltIn(const SpirvModule& module, const SpirvInstruction& instruction) {
  if (instruction.op != spv::Op::OpLoad) return {};
  const shader::SpirvVariable* variable = module.variable(module.access(instruction.at(0)).variable);
  return variable ? variable->builtIn : std::nullopt;
}

std::string_view lineOf(std::string_view text, int line) {
  for (int i = 1; i < line && !text.empty(); ++i) {
    const std::size_t end = text.find('\n');
    text = end == text.npos ? std::string_view() : text.substr(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

std::vector<shader::Diagnostic> checkShader(const SpirvModule& module, const ShaderSituation& situation) {
  using Model = spv::ExecutionModel;
  Findings findings(module);
  const auto stage = module.stage();
  if (!stage) return {};
  const bool hit = stage == Model::IntersectionKHR || stage == Model::AnyHitKHR || stage == Model::ClosestHitKHR;
  const bool traces = stage == Model::RayGenerationKHR || stage == Model::ClosestHitKHR || stage == Model::MissKHR;
  if (stage == Model::IntersectionKHR) {
    checkDistance(module, findings);
    checkRayTmaxReads(module, findings);
  }
  if (hit) checkNormals(module, findings);
  if (hit && !situation.keepsInstanceOrder) checkInstanceIndex(module, findings);
  checkDescriptorIndices(module, findings);
  if (traces) checkOrigins(module, findings);
  const gpu::Quirks& quirks = situation.quirks;
  if (quirks.changesNestedBuiltIns && stage == Model::ClosestHitKHR) checkNestedBuiltIns(module, findings);
  if (stage == Model::IntersectionKHR) {
    if (quirks.corruptsHitAttributes) checkAttributeWrites(module, findings);
    if (quirks.sharesLocalArrays && situation.hasAnyHit) checkLocalArrays(module, findings);
  }
  return findings.take();
}

}  // namespace quintet::program
