// SPDX-License-Identifier: Apache-2.0
// The instructions that run shaders with a ray. OpTraceRayKHR does all of it. With hit objects (shader invocation reorder),
// OpHitObjectTraceRayNV only finds the hit or miss, and OpHitObjectExecuteShaderNV runs the closest-hit or miss shader of it. The
// other forms become these three (plain_code.h).
#ifndef QUINTET_SPIRV_TRACE_INSTRUCTION_H
#define QUINTET_SPIRV_TRACE_INSTRUCTION_H

#include <optional>

#include "spirv/module.h"

namespace quintet::spirv {

// The arguments of a ray.
struct RayOperands {
  Id flags = 0, mask = 0, offset = 0, stride = 0, miss = 0;
  Id origin = 0, tmin = 0, direction = 0, tmax = 0;
  Id payload = 0;
};
// Nullopt if the instruction does not trace a ray: other instructions, and executions of a hit object.
std::optional<RayOperands> rayOperands(const Instruction& instruction);

// True for instructions that read or write a payload by running shaders.
bool runsShaders(spv::Op op);

// True if the instruction returns a fact about a hit object, or loads attributes that come from one.
bool queriesHitObject(const Module& module, const Instruction& instruction);

// Location of the call in the source, with its column if the function has its name in GLSL.
SourceLocation traceLocation(const Module& module, const Instruction& instruction);

}  // namespace quintet::spirv
#endif
