// SPDX-License-Identifier: Apache-2.0
#include "spirv/shader_record.h"

#include <algorithm>

#include "spirv/value_flow.h"

namespace quintet::spirv {
namespace {

constexpr int kMaxDepth = 32;
constexpr std::uint64_t kAddressBytes = 8;

}  // namespace

BlockLayout::BlockLayout(const Module& module) : module_(module) {
  for (const Instruction& i : module.instructions())
    if (i.op == spv::Op::OpMemberDecorate) members_[{i.at(0), i.at(1), i.at(2)}] = i.at(3);
}

std::uint64_t BlockLayout::bytesOf(Id type) const { return bytesOf(type, 0, 0); }

// `matrixStride` is that of the member with the type.
std::uint64_t BlockLayout::bytesOf(Id id, std::uint32_t matrixStride, int depth) const {
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
        end = std::max(end, decoration(id, k, spv::Decoration::Offset) +
                                bytesOf(type.members[k], decoration(id, k, spv::Decoration::MatrixStride), depth + 1));
      return end;
    }
    default: return type.bytes;
  }
}

std::optional<std::uint64_t> BlockLayout::offsetOf(Id id, IndexPath indices) const {
  std::uint64_t offset = 0;
  for (const std::optional<std::uint32_t>& index : indices) {
    const Type& type = module_.types().get(id);
    if (!index) return {};
    switch (type.kind) {
      case Type::Kind::structure:
        if (*index >= type.members.size()) return {};
        offset += decoration(id, *index, spv::Decoration::Offset);
        break;
      case Type::Kind::array:
      case Type::Kind::runtimeArray: {
        const auto stride = module_.decoration(id, spv::Decoration::ArrayStride);
        if (!stride || (type.count > 0 && *index >= type.count)) return {};
        offset += std::uint64_t{*stride} * *index;
        break;
      }
      case Type::Kind::vector:
        if (*index >= type.count) return {};
        offset += *index * (module_.types().get(type.element).width / 8);
        break;
      default: return {};
    }
    id = type.part(*index);
  }
  return offset;
}

std::uint32_t BlockLayout::decoration(Id type, std::uint32_t member, spv::Decoration decoration) const {
  const auto found = members_.find({type, member, static_cast<std::uint32_t>(decoration)});
  return found == members_.end() ? 0 : found->second;
}

std::uint64_t shaderRecordBytes(const Module& module) {
  std::uint64_t bytes = 0;
  for (const Variable& variable : module.variables())
    if (variable.storage == spv::StorageClass::ShaderRecordBufferKHR && !module.users(variable.id).empty())
      bytes = std::max(bytes, BlockLayout(module).bytesOf(variable.type));
  return bytes;
}

bool loadsRecord(const Module& module, const Instruction& i) {
  const Variable* variable = i.op == spv::Op::OpLoad ? module.variable(module.access(i.at(0)).variable) : nullptr;
  return variable && variable->storage == spv::StorageClass::ShaderRecordBufferKHR;
}

bool indexesByRecord(const Module& module) {
  constexpr auto kRecord = spv::StorageClass::ShaderRecordBufferKHR;
  if (std::ranges::find(module.variables(), kRecord, &Variable::storage) == module.variables().end()) return false;
  const auto isRecord = [&](const Instruction& i) { return loadsRecord(module, i); };
  return std::ranges::any_of(module.instructions(), [&](const Instruction& chain) {
    if (!isAccessChain(chain.op) || chain.operands.empty()) return false;
    return std::ranges::any_of(chain.operands.subspan(1), [&](Id index) { return dependsOn(module, index, isRecord); });
  });
}

}  // namespace quintet::spirv
