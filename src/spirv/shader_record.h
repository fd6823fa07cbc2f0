// SPDX-License-Identifier: Apache-2.0
// The size of a stage's shader record block (shaderRecordEXT): the bytes after the handle in its record of the shader
// binding table.
#ifndef QUINTET_SPIRV_SHADER_RECORD_H
#define QUINTET_SPIRV_SHADER_RECORD_H

#include <cstdint>

#include "spirv/module.h"

namespace quintet::spirv {

// The end of the last member of the blocks that the stage uses; 0 if it uses none. An array without a size counts one
// element.
std::uint64_t shaderRecordBytes(const Module& module);

}  // namespace quintet::spirv
#endif
