// SPDX-License-Identifier: Apache-2.0
#include "spirv/trace_instruction.h"

#include <array>
#include <string_view>

namespace quintet::spirv {

using spv::Op;

std::optional<RayOperands> rayOperands(const Instruction& instruction) {
  if (instruction.op != Op::OpTraceRayKHR && instruction.op != Op::OpHitObjectTraceRayNV) return {};
  const std::size_t first = instruction.op == Op::OpTraceRayKHR ? 1 : 2;  // after the hit object and the structure
  const auto at = [&](std::size_t i) { return instruction.at(first + i); };
  return RayOperands{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9)};
}

bool runsShaders(Op op) {
  return op == Op::OpTraceRayKHR || op == Op::OpHitObjectTraceRayNV || op == Op::OpHitObjectExecuteShaderNV;
}

bool queriesHitObject(const Module& module, const Instruction& instruction) {
  switch (instruction.op) {
    case Op::OpHitObjectGetWorldToObjectNV:
    case Op::OpHitObjectGetObjectToWorldNV:
    case Op::OpHitObjectGetObjectRayDirectionNV:
    case Op::OpHitObjectGetObjectRayOriginNV:
    case Op::OpHitObjectGetShaderRecordBufferHandleNV:
    case Op::OpHitObjectGetShaderBindingTableRecordIndexNV:
    case Op::OpHitObjectGetCurrentTimeNV:
    case Op::OpHitObjectGetHitKindNV:
    case Op::OpHitObjectGetPrimitiveIndexNV:
    case Op::OpHitObjectGetGeometryIndexNV:
    case Op::OpHitObjectGetInstanceIdNV:
    case Op::OpHitObjectGetInstanceCustomIndexNV:
    case Op::OpHitObjectGetWorldRayDirectionNV:
    case Op::OpHitObjectGetWorldRayOriginNV:
    case Op::OpHitObjectGetRayTMaxNV:
    case Op::OpHitObjectGetRayTMinNV:
    case Op::OpHitObjectIsEmptyNV:
    case Op::OpHitObjectIsHitNV:
    case Op::OpHitObjectIsMissNV: return true;
    case Op::OpLoad: {
      const Variable* variable = module.variable(module.access(instruction.at(0)).variable);
      return variable && variable->storage == spv::StorageClass::HitObjectAttributeNV;
    }
    default: return false;
  }
}

SourceLocation traceLocation(const Module& module, const Instruction& instruction) {
  if (instruction.op == Op::OpTraceRayKHR) return module.location(instruction, "traceRayEXT");
  constexpr std::array<std::string_view, 6> kTraces{"hitObjectTraceRayNV",
                                                    "hitObjectTraceRayEXT",
                                                    "hitObjectTraceRayMotionNV",
                                                    "hitObjectTraceRayMotionEXT",
                                                    "hitObjectTraceReorderExecuteEXT",
                                                    "hitObjectTraceMotionReorderExecuteEXT"};
  constexpr std::array<std::string_view, 5> kExecutions{"hitObjectExecuteShaderNV", "hitObjectExecuteShaderEXT",
                                                        "hitObjectReorderExecuteEXT", "hitObjectTraceReorderExecuteEXT",
                                                        "hitObjectTraceMotionReorderExecuteEXT"};
  SourceLocation best = module.location(instruction);
  if (best.column > 0) return best;
  const auto nearest = [&](const auto& names) {
    for (const std::string_view name : names)
      if (const SourceLocation found = module.location(instruction, name);
          found.column > 0 && (best.column == 0 || found.line > best.line))
        best = found;
    return best;
  };
  return instruction.op == Op::OpHitObjectTraceRayNV ? nearest(kTraces) : nearest(kExecutions);
}

}  // namespace quintet::spirv
