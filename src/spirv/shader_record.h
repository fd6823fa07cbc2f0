// SPDX-License-Identifier: Apache-2.0
// The shader record of a stage: the size of its block, and where the block has a value. Offsets are those that the module is
// decorated with.
#ifndef QUINTET_SPIRV_SHADER_RECORD_H
#define QUINTET_SPIRV_SHADER_RECORD_H

#include <array>
#include <cstdint>
#include <map>
#include <optional>

#include "spirv/access.h"
#include "spirv/module.h"

namespace quintet::spirv {

class BlockLayout {
 public:
  // `module` must outlive this object.
  explicit BlockLayout(const Module& module);

  std::uint64_t bytesOf(Id type) const;
  // Bytes from the start of a value of the type to the part that the indices select. Nullopt if an index is dynamic or beyond the
  // type, or if the way leads through a matrix.
  std::optional<std::uint64_t> offsetOf(Id type, IndexPath indices) const;

 private:
  std::uint64_t bytesOf(Id type, std::uint32_t matrixStride, int depth) const;
  std::uint32_t decoration(Id type, std::uint32_t member, spv::Decoration decoration) const;

  const Module& module_;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> members_;  // of type, member and decoration
};

// The end of the last member of the blocks that the stage uses; 0 if it uses none. An array without a size counts one
// element.
std::uint64_t shaderRecordBytes(const Module& module);

bool loadsRecord(const Module& module, const Instruction& instruction);
// True if the index of an access chain depends on the data of the shader record.
bool indexesByRecord(const Module& module);

}  // namespace quintet::spirv
#endif
