// SPDX-License-Identifier: Apache-2.0
#include "check/output_access.h"

#include "spirv/access.h"

namespace quintet::check {

using spv::Op;

OutputAccess outputOf(const spirv::Module& module, spirv::Id pointer) {
  const spirv::Instruction* definition = module.definition(pointer);
  const spirv::Type& type = module.types().get(definition ? definition->type : 0);
  if (static_cast<spv::StorageClass>(type.storage) != spv::StorageClass::PhysicalStorageBuffer) return {};
  const spirv::Instruction* address = module.definition(module.access(pointer).base);
  for (int depth = 0; depth < 8 && address; ++depth) {
    if (address->op != Op::OpConvertUToPtr && address->op != Op::OpBitcast && address->op != Op::OpCopyObject) break;
    address = module.definition(address->at(0));
  }
  if (!address || address->op != Op::OpLoad) return {OutputTarget::unknown, 0};
  const spirv::Access access = module.access(address->at(0));
  const auto members = spirv::selectedMembers(module, access);
  if (members.empty() || members.back().name() != "outputs") return {};
  const std::optional<std::uint32_t> slot = access.indices.back();
  const bool known = members.back().position + 2 == access.indices.size() && slot;
  return known ? OutputAccess{OutputTarget::output, *slot} : OutputAccess{OutputTarget::unknown, 0};
}

}  // namespace quintet::check
