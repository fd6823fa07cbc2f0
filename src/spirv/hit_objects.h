// SPDX-License-Identifier: Apache-2.0
// What a hit object contains where an instruction executes it: which traces or records can have filled it, and what the
// conditions on the way say about it. If that cannot be followed, the content is unknown.
#ifndef QUINTET_SPIRV_HIT_OBJECTS_H
#define QUINTET_SPIRV_HIT_OBJECTS_H

#include <cstddef>
#include <vector>

#include "spirv/control_flow.h"
#include "spirv/module.h"

namespace quintet::spirv {

struct HitObjectContent {
  std::vector<std::size_t> traces;  // OpHitObjectTraceRayNV, sorted
  std::vector<std::size_t> hits;    // OpHitObjectRecordHitNV and OpHitObjectRecordHitWithIndexNV, sorted
  std::vector<std::size_t> misses;  // OpHitObjectRecordMissNV, sorted
  // False if no such content is executed. With neither traces nor records, all shaders are possible.
  bool mayBeHit = true, mayBeMiss = true;
  // True if it is what a single trace found, or a recorded miss, and each hit or miss that may be executed is executed. False if
  // the object can be empty, or if a condition that is not understood selects contents.
  bool known = false;
};

// `flows` are those of all functions of the module. `execution` is an OpHitObjectExecuteShaderNV.
HitObjectContent contentAt(const Module& module, const std::vector<ControlFlow>& flows, std::size_t execution);

}  // namespace quintet::spirv
#endif
