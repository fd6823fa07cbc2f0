#include "program/stored_values.h"

#include <algorithm>

namespace quintet::program {
namespace {

using shader::SpirvAccess;
using shader::SpirvId;
using shader::SpirvInstruction;
using shader::SpirvModule;
using spv::Op;

// Stores into the variable, or into parts of it.
void addStores(const SpirvModule& module, SpirvId pointer, std::vector<const SpirvInstruction*>& stores, bool& lost) {
  for (const std::size_t user : module.users(pointer)) {
    const SpirvInstruction& instruction = module.instructions()[user];
    if (instruction.op == Op::OpStore && instruction.at(0) == pointer)
      stores.push_back(&instruction);
    else if (instruction.op == Op::OpAccessChain || instruction.op == Op::OpInBoundsAccessChain)
      addStores(module, instruction.result, stores, lost);
    else if (instruction.op != Op::OpLoad)
      lost = true;  // handed to a function, copied
  }
}

bool overlap(const SpirvAccess& a, const SpirvAccess& b) {
  for (std::size_t i = 0; i < std::min(a.indices.size(), b.indices.size()); ++i)
    if (a.indices[i] && b.indices[i] && *a.indices[i] != *b.indices[i]) return false;
  return true;
}

// The part of a stored value that a load of something smaller sees.
SpirvId partOf(const SpirvModule& module, SpirvId value, const SpirvAccess& store, const SpirvAccess& load) {
  for (std::size_t i = store.indices.size(); i < load.indices.size(); ++i) {
    const SpirvInstruction* definition = module.definition(value);
    if (!definition || definition->op != Op::OpCompositeConstruct || !load.indices[i]) break;
    if (*load.indices[i] >= definition->operands.size()) break;
    value = definition->at(*load.indices[i]);
  }
  return value;
}

}  // namespace

bool isLocal(const SpirvModule& module, SpirvId variable) {
  const SpirvInstruction* definition = module.definition(variable);
  if (!definition || definition->op != Op::OpVariable) return false;
  const auto storage = static_cast<spv::StorageClass>(definition->at(0));
  return storage == spv::StorageClass::Function || storage == spv::StorageClass::Private;
}

std::optional<std::vector<SpirvId>> storedValues(const SpirvModule& module, const SpirvInstruction& load) {
  const SpirvAccess access = module.access(load.at(0));
  std::vector<const SpirvInstruction*> stores;
  bool lost = false;
  addStores(module, access.variable, stores, lost);
  if (lost) return {};
  std::vector<SpirvId> values;
  for (const SpirvInstruction* store : stores) {
    const SpirvAccess target = module.access(store->at(0));
    if (overlap(target, access)) values.push_back(partOf(module, store->at(1), target, access));
  }
  return values;
}

}  // namespace quintet::program
