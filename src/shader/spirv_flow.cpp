#include "shader/spirv_flow.h"

#include <algorithm>
#include <unordered_set>

namespace quintet::shader {
namespace {

using Indices = std::vector<std::size_t>;

bool isLocal(const SpirvModule& module, SpirvId variable) {
  const SpirvInstruction* definition = module.definition(variable);
  if (!definition || definition->op != spv::Op::OpVariable)
    return definition && definition->op == spv::Op::OpFunctionParameter;
  const auto storage = static_cast<spv::StorageClass>(definition->at(0));
  return storage == spv::StorageClass::Function || storage == spv::StorageClass::Private;
}

// Instructions that use the variable or a pointer into it.
void addAccesses(const SpirvModule& module, SpirvId pointer, Indices& result) {
  std::vector<SpirvId> open{pointer};
  std::unordered_set<SpirvId> seen{pointer};
  while (!open.empty()) {
    const SpirvId next = open.back();
    open.pop_back();
    for (const std::size_t user : module.users(next)) {
      const SpirvInstruction& instruction = module.instructions()[user];
      const bool chain = instruction.op == spv::Op::OpAccessChain || instruction.op == spv::Op::OpInBoundsAccessChain ||
                         instruction.op == spv::Op::OpCopyObject;
      if (!chain)
        result.push_back(user);
      else if (seen.insert(instruction.result).second)
        open.push_back(instruction.result);
    }
  }
}

// Instructions whose values flow into this one, apart from its operands.
void addHiddenSources(const SpirvModule& module, const SpirvInstruction& instruction, Indices& result) {
  using spv::Op;
  if (instruction.op == Op::OpLoad) {
    const SpirvId variable = module.access(instruction.at(0)).variable;
    if (variable == 0 || !isLocal(module, variable)) return;
    Indices accesses;
    addAccesses(module, variable, accesses);
    for (const std::size_t i : accesses)
      if (module.instructions()[i].op != Op::OpLoad) result.push_back(i);
  } else if (instruction.op == Op::OpFunctionCall) {
    const SpirvFunction* callee = module.function(instruction.at(0));
    for (const SpirvBlock& block : callee ? callee->blocks : std::vector<SpirvBlock>{})
      if (module.instructions()[block.end - 1].op == Op::OpReturnValue) result.push_back(block.end - 1);
  } else if (instruction.op == Op::OpFunctionParameter) {
    for (const SpirvFunction& function : module.functions()) {
      if (std::ranges::find(function.parameters, instruction.result) == function.parameters.end()) continue;
      for (std::size_t i = 0; i < module.instructions().size(); ++i)
        if (module.instructions()[i].op == Op::OpFunctionCall && module.instructions()[i].at(0) == function.id)
          result.push_back(i);
    }
  }
}

// Instructions into which a store's value flows: loads of the same variable.
void addHiddenUses(const SpirvModule& module, const SpirvInstruction& instruction, Indices& result) {
  using spv::Op;
  if (instruction.op == Op::OpStore) {
    const SpirvId variable = module.access(instruction.at(0)).variable;
    if (variable == 0 || !isLocal(module, variable)) return;
    Indices accesses;
    addAccesses(module, variable, accesses);
    for (const std::size_t i : accesses)
      if (module.instructions()[i].op != Op::OpStore) result.push_back(i);
  } else if (instruction.op == Op::OpFunctionCall) {
    const SpirvFunction* callee = module.function(instruction.at(0));
    if (callee)
      for (const SpirvId parameter : callee->parameters)
        result.insert(result.end(), module.users(parameter).begin(), module.users(parameter).end());
  }
}

}  // namespace

const SpirvInstruction* findInSlice(const SpirvModule& module, SpirvId value, const InstructionTest& test,
                                    const InstructionTest& stop) {
  const std::size_t start = module.definitionIndex(value);
  if (start == SpirvModule::kNone) return nullptr;
  Indices open{start};
  std::unordered_set<std::size_t> seen{start};
  while (!open.empty()) {
    const SpirvInstruction& instruction = module.instructions()[open.back()];
    open.pop_back();
    if (test(instruction)) return &instruction;
    if (stop && stop(instruction)) continue;
    Indices sources;
    for (const SpirvId id : valueOperands(instruction))
      if (module.definitionIndex(id) != SpirvModule::kNone) sources.push_back(module.definitionIndex(id));
    addHiddenSources(module, instruction, sources);
    for (const std::size_t i : sources)
      if (seen.insert(i).second) open.push_back(i);
  }
  return nullptr;
}

const SpirvInstruction* findInUses(const SpirvModule& module, SpirvId value, const InstructionTest& test,
                                   const InstructionTest& stop) {
  Indices open = module.users(value);
  std::unordered_set<std::size_t> seen(open.begin(), open.end());
  while (!open.empty()) {
    const SpirvInstruction& instruction = module.instructions()[open.back()];
    open.pop_back();
    if (test(instruction)) return &instruction;
    if (stop && stop(instruction)) continue;
    Indices uses = instruction.result != 0 ? module.users(instruction.result) : Indices{};
    addHiddenUses(module, instruction, uses);
    for (const std::size_t i : uses)
      if (seen.insert(i).second) open.push_back(i);
  }
  return nullptr;
}

bool loadsBuiltIn(const SpirvModule& module, const SpirvInstruction& instruction, spv::BuiltIn builtIn) {
  if (instruction.op != spv::Op::OpLoad) return false;
  const SpirvVariable* variable = module.variable(module.access(instruction.at(0)).variable);
  return variable && variable->builtIn == builtIn;
}

bool isExtended(const SpirvModule& module, const SpirvInstruction& instruction, std::uint32_t number) {
  return instruction.op == spv::Op::OpExtInst && instruction.at(1) == number &&
         module.extendedSet(instruction.at(0)) == "GLSL.std.450";
}

bool mayRunAfter(const SpirvModule& module, std::size_t later, std::size_t earlier) {
  const auto from = module.position(earlier), to = module.position(later);
  if (!from || !to || from->function != to->function) return from && to;  // functions are inlined; else: perhaps
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

}  // namespace quintet::shader
