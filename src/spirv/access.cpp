// SPDX-License-Identifier: Apache-2.0
#include "spirv/access.h"

#include <algorithm>

namespace quintet::spirv {

using spv::Op;

bool overlap(IndexPath a, IndexPath b) {
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    if (a[i] && b[i] && *a[i] != *b[i]) return false;
  return true;
}

std::vector<SelectedMember> selectedMembers(const Module& module, Id type, IndexPath indices) {
  std::vector<SelectedMember> result;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const Type& composite = module.types().get(type);
    if (composite.kind == Type::Kind::structure) {
      if (!indices[i] || *indices[i] >= composite.members.size()) break;
      result.push_back({composite, *indices[i], i});
    }
    type = composite.part(indices[i].value_or(0));
  }
  return result;
}

std::vector<SelectedMember> selectedMembers(const Module& module, const Access& access) {
  return selectedMembers(module, access.type, access.indices);
}

std::optional<BufferMember> bufferMember(const Module& module, const Instruction& instruction, const Path& path) {
  if (instruction.op != Op::OpLoad && instruction.op != Op::OpStore) return {};
  const Access access = module.access(instruction.at(0));
  const Instruction* base = module.definition(access.base);
  const Type& pointer = module.types().get(base ? base->type : 0);
  if (pointer.kind != Type::Kind::pointer) return {};
  switch (static_cast<spv::StorageClass>(pointer.storage)) {
    case spv::StorageClass::PhysicalStorageBuffer:
    case spv::StorageClass::StorageBuffer:
    case spv::StorageClass::Uniform:
    case spv::StorageClass::PushConstant:
    case spv::StorageClass::ShaderRecordBufferKHR: break;
    default: return {};
  }
  std::vector<std::optional<std::uint32_t>> indices = access.indices;
  indices.insert(indices.end(), path.begin(), path.end());
  const std::vector<SelectedMember> members = selectedMembers(module, access.type, indices);
  if (members.empty()) return {};
  BufferMember result{members.back().structure.name, members.back().name(), 0};
  Id type = members.back().structure.part(members.back().member);
  for (std::size_t i = members.back().position + 1; i < indices.size(); ++i) {
    const Type& composite = module.types().get(type);
    if (composite.kind == Type::Kind::structure) return {};  // any member
    if (composite.kind == Type::Kind::vector) {
      if (!indices[i]) return {};
      result.component = *indices[i];
    }
    type = composite.part(0);
    if (type == 0) return {};
  }
  return result.structure.empty() ? std::nullopt : std::optional(result);
}

}  // namespace quintet::spirv
