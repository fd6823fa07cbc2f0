// SPDX-License-Identifier: Apache-2.0
#include "spirv/shader_record.h"

#include <algorithm>
#include <array>
#include <map>

namespace quintet::spirv {
namespace {

constexpr int kMaxDepth = 32;
constexpr std::uint64_t kAddressBytes = 8;

class BlockSizes {
 public:
  explicit BlockSizes(const Module& module) : module_(module) {
    for (const Instruction& i : module.instructions())
      if (i.op == spv::Op::OpMemberDecorate) members_[{i.at(0), i.at(1), i.at(2)}] = i.at(3);
  }

  // `matrixStride` is that of the member with the type.
  std::uint64_t bytesOf(Id id, std::uint32_t matrixStride = 0, int depth = 0) const {
    const Type& type = module_.types().get(id);
    if (depth > kMaxDepth) return 0;
    switch (type.kind) {
      case Type::Kind::pointer: return kAddressBytes;
      case Type::Kind::matrix: {
        const std::uint64_t column = bytesOf(type.element, 0, depth + 1);
        return std::uint64_t{type.count - 1} * (matrixStride != 0 ? matrixStride : column) + column;
      }
      case Type::Kind::array:
      case Type::Kind::runtimeArray: {
        const std::uint64_t element = bytesOf(type.element, matrixStride, depth + 1);
        const std::uint64_t stride = module_.decoration(id, spv::Decoration::ArrayStride).value_or(0);
        const std::uint64_t count = std::max<std::uint64_t>(type.count, 1);
        return (count - 1) * std::max(stride, element) + element;
      }
      case Type::Kind::structure: {
        std::uint64_t end = 0;
        for (std::uint32_t k = 0; k < type.members.size(); ++k)
          end =
              std::max(end, decoration(id, k, spv::Decoration::Offset) +
                                bytesOf(type.members[k], decoration(id, k, spv::Decoration::MatrixStride), depth + 1));
        return end;
      }
      default: return type.bytes;
    }
  }

 private:
  std::uint32_t decoration(Id type, std::uint32_t member, spv::Decoration decoration) const {
    const auto found = members_.find({type, member, static_cast<std::uint32_t>(decoration)});
    return found == members_.end() ? 0 : found->second;
  }

  const Module& module_;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> members_;  // of type, member and decoration
};

}  // namespace

std::uint64_t shaderRecordBytes(const Module& module) {
  std::uint64_t bytes = 0;
  for (const Variable& variable : module.variables())
    if (variable.storage == spv::StorageClass::ShaderRecordBufferKHR && !module.users(variable.id).empty())
      bytes = std::max(bytes, BlockSizes(module).bytesOf(variable.type));
  return bytes;
}

}  // namespace quintet::spirv
