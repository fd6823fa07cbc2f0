// SPDX-License-Identifier: Apache-2.0
#include "spirv/value_flow.h"

#include <algorithm>
#include <set>
#include <unordered_set>

#include "spirv/access.h"

namespace quintet::spirv {
namespace {

using Indices = std::vector<std::size_t>;

bool isLocalOrParameter(const Module& module, Id variable) {
  const Instruction* definition = module.definition(variable);
  return isLocal(module, variable) || (definition && definition->op == spv::Op::OpFunctionParameter);
}

// Adds the instructions that use the variable or a pointer into it.
void addAccesses(const Module& module, Id pointer, Indices& result) {
  std::vector<Id> open{pointer};
  std::unordered_set<Id> seen{pointer};
  while (!open.empty()) {
    const Id next = open.back();
    open.pop_back();
    for (const std::size_t user : module.users(next)) {
      const Instruction& instruction = module.instructions()[user];
      if (!isAccessChain(instruction.op) && instruction.op != spv::Op::OpCopyObject)
        result.push_back(user);
      else if (seen.insert(instruction.result).second)
        open.push_back(instruction.result);
    }
  }
}

// Adds the instructions whose values flow into this one, other than its operands.
void addIndirectSources(const Module& module, const Instruction& instruction, Indices& result) {
  using spv::Op;
  if (instruction.op == Op::OpLoad) {
    const Id variable = module.access(instruction.at(0)).variable;
    if (variable == 0 || !isLocalOrParameter(module, variable)) return;
    Indices accesses;
    addAccesses(module, variable, accesses);
    for (const std::size_t i : accesses)
      if (module.instructions()[i].op != Op::OpLoad) result.push_back(i);
  } else if (instruction.op == Op::OpFunctionCall) {
    const Function* callee = module.function(instruction.at(0));
    for (const Block& block : callee ? callee->blocks : std::vector<Block>{})
      if (module.instructions()[block.end - 1].op == Op::OpReturnValue) result.push_back(block.end - 1);
  } else if (instruction.op == Op::OpFunctionParameter) {
    for (const Function& function : module.functions()) {
      if (std::ranges::find(function.parameters, instruction.result) == function.parameters.end()) continue;
      for (std::size_t i = 0; i < module.instructions().size(); ++i)
        if (module.instructions()[i].op == Op::OpFunctionCall && module.instructions()[i].at(0) == function.id)
          result.push_back(i);
    }
  }
}

// Adds the instructions into which a value flows other than through its result: loads of the stored variable, uses of
// the parameters of a called function.
void addIndirectUses(const Module& module, const Instruction& instruction, Indices& result) {
  using spv::Op;
  if (instruction.op == Op::OpStore) {
    const Id variable = module.access(instruction.at(0)).variable;
    if (variable == 0 || !isLocalOrParameter(module, variable)) return;
    Indices accesses;
    addAccesses(module, variable, accesses);
    for (const std::size_t i : accesses)
      if (module.instructions()[i].op != Op::OpStore) result.push_back(i);
  } else if (instruction.op == Op::OpFunctionCall) {
    const Function* callee = module.function(instruction.at(0));
    if (callee)
      for (const Id parameter : callee->parameters)
        result.insert(result.end(), module.users(parameter).begin(), module.users(parameter).end());
  }
}

// Adds the stores to the variable or to parts of it. `escapes` becomes true for any use other than loads and stores.
void addStores(const Module& module, Id pointer, std::vector<const Instruction*>& stores, bool& escapes) {
  for (const std::size_t user : module.users(pointer)) {
    const Instruction& instruction = module.instructions()[user];
    if (instruction.op == spv::Op::OpStore && instruction.at(0) == pointer)
      stores.push_back(&instruction);
    else if (instruction.op == spv::Op::OpAccessChain || instruction.op == spv::Op::OpInBoundsAccessChain)
      addStores(module, instruction.result, stores, escapes);
    else if (instruction.op != spv::Op::OpLoad)
      escapes = true;
  }
}

// Returns the part of a stored value that the load of a smaller part sees.
Id partOf(const Module& module, Id value, const Access& store, const Access& load) {
  for (std::size_t i = store.indices.size(); i < load.indices.size(); ++i) {
    const Instruction* definition = module.definition(value);
    if (!definition || definition->op != spv::Op::OpCompositeConstruct || !load.indices[i]) break;
    if (*load.indices[i] >= definition->operands.size()) break;
    value = definition->at(*load.indices[i]);
  }
  return value;
}

}  // namespace

const Instruction* Slices::find(Id value, const InstructionTest& test, const InstructionTest& stop) {
  const Module& module = *module_;
  const std::size_t start = module.definitionIndex(value);
  if (start == Module::kNone || seen_[start]) return nullptr;
  Indices open{start};
  seen_[start] = true;
  while (!open.empty()) {
    const Instruction& instruction = module.instructions()[open.back()];
    open.pop_back();
    if (test(instruction)) return &instruction;
    if (stop && stop(instruction)) continue;
    Indices sources;
    for (const Id id : valueOperands(instruction))
      if (module.definitionIndex(id) != Module::kNone) sources.push_back(module.definitionIndex(id));
    addIndirectSources(module, instruction, sources);
    for (const std::size_t i : sources) {
      if (seen_[i]) continue;
      seen_[i] = true;
      open.push_back(i);
    }
  }
  return nullptr;
}

const Instruction* findInSlice(const Module& module, Id value, const InstructionTest& test,
                               const InstructionTest& stop) {
  return Slices(module).find(value, test, stop);
}

InstructionTest sourcesOf(const Module& module, Id value) {
  static constexpr Id kBuffers = 0;
  const auto sourceOf = [&module](const Instruction& i) -> std::optional<Id> {
    if (i.op == spv::Op::OpPhi) return i.result;
    if (i.op != spv::Op::OpLoad) return {};
    const Id base = module.access(i.at(0)).base;
    const Instruction* definition = module.definition(base);
    return definition && definition->op == spv::Op::OpVariable ? base : kBuffers;
  };
  std::set<Id> sources;
  (void)dependsOn(module, value, [&](const Instruction& i) {
    if (const auto source = sourceOf(i)) sources.insert(*source);
    return false;
  });
  if (sources.empty()) return {};
  return [sourceOf, sources = std::move(sources)](const Instruction& i) {
    const auto source = sourceOf(i);
    return source && sources.contains(*source);
  };
}

const Instruction* findInUses(const Module& module, Id value, const InstructionTest& test,
                              const InstructionTest& stop) {
  Indices open = module.users(value);
  std::unordered_set<std::size_t> seen(open.begin(), open.end());
  while (!open.empty()) {
    const Instruction& instruction = module.instructions()[open.back()];
    open.pop_back();
    if (test(instruction)) return &instruction;
    if (stop && stop(instruction)) continue;
    Indices uses = instruction.result != 0 ? module.users(instruction.result) : Indices{};
    addIndirectUses(module, instruction, uses);
    for (const std::size_t i : uses)
      if (seen.insert(i).second) open.push_back(i);
  }
  return nullptr;
}

std::optional<spv::BuiltIn> loadedBuiltIn(const Module& module, const Instruction& instruction) {
  if (instruction.op != spv::Op::OpLoad) return {};
  const Variable* variable = module.variable(module.access(instruction.at(0)).variable);
  return variable ? variable->builtIn : std::nullopt;
}

bool loadsBuiltIn(const Module& module, const Instruction& instruction, spv::BuiltIn builtIn) {
  return loadedBuiltIn(module, instruction) == builtIn;
}

bool loadsBuiltIn(const Module& module, Id value, spv::BuiltIn builtIn) {
  const Instruction* const instruction = module.definition(value);
  return instruction && loadsBuiltIn(module, *instruction, builtIn);
}

bool isExtended(const Module& module, const Instruction& instruction, std::uint32_t number) {
  return instruction.op == spv::Op::OpExtInst && instruction.at(1) == number &&
         module.extendedSet(instruction.at(0)) == "GLSL.std.450";
}

bool canRunAfter(const Module& module, std::size_t later, std::size_t earlier) {
  const auto from = module.position(earlier), to = module.position(later);
  if (!from || !to || from->function != to->function) return from && to;  // not inlined: assumed
  if (from->block == to->block && later > earlier) return true;
  const auto& blocks = module.functions()[from->function].blocks;
  std::vector<bool> seen(blocks.size(), false);
  Indices open = blocks[from->block].successors;
  while (!open.empty()) {
    const std::size_t block = open.back();
    open.pop_back();
    if (block == to->block) return true;
    if (seen[block]) continue;
    seen[block] = true;
    open.insert(open.end(), blocks[block].successors.begin(), blocks[block].successors.end());
  }
  return false;
}

bool isLocal(const Module& module, Id variable) {
  const Instruction* definition = module.definition(variable);
  if (!definition || definition->op != spv::Op::OpVariable) return false;
  const auto storage = static_cast<spv::StorageClass>(definition->at(0));
  return storage == spv::StorageClass::Function || storage == spv::StorageClass::Private;
}

std::optional<std::vector<Id>> storedValues(const Module& module, const Instruction& load) {
  const Access access = module.access(load.at(0));
  std::vector<const Instruction*> stores;
  bool escapes = false;
  addStores(module, access.variable, stores, escapes);
  if (escapes) return {};
  std::vector<Id> values;
  for (const Instruction* store : stores) {
    const Access target = module.access(store->at(0));
    if (overlap(target.indices, access.indices)) values.push_back(partOf(module, store->at(1), target, access));
  }
  return values;
}

}  // namespace quintet::spirv
