// SPDX-License-Identifier: Apache-2.0
#include "spirv/copy_builtins.h"

#include <algorithm>
#include <map>
#include <utility>

#include "spirv/module_writer.h"
#include "spirv/value_flow.h"

namespace quintet::spirv {
namespace {

using spv::Op;

// Returns the variable of an overwritten built-in if the instruction loads it or a part of it.
const Variable* overwrittenVariable(const Module& module, const Instruction& instruction) {
  const auto builtIn = loadedBuiltIn(module, instruction);
  return builtIn && isOverwrittenByTrace(*builtIn) ? module.variable(module.access(instruction.at(0)).variable)
                                                   : nullptr;
}

bool runsAfterTrace(const Module& module, std::size_t load, const std::vector<std::size_t>& traces) {
  return std::ranges::any_of(traces, [&](std::size_t trace) { return canRunAfter(module, load, trace); });
}

using Loads = std::map<std::size_t, const Variable*>;  // by instruction

// Returns the loads to replace.
Loads findLoads(const Module& module) {
  Loads loads;
  std::vector<std::size_t> traces;
  for (std::size_t i = 0; i < module.instructions().size(); ++i)
    if (module.instructions()[i].op == Op::OpTraceRayKHR) traces.push_back(i);
  if (traces.empty()) return loads;
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const Variable* variable = overwrittenVariable(module, module.instructions()[i]);
    if (variable && canCopyBuiltIn(module, i) && runsAfterTrace(module, i, traces)) loads[i] = variable;
  }
  return loads;
}

// Replaces the load by the copied value or a part of it. The result id stays, so users do not change.
void replaceLoad(ModuleWriter& out, const Module& module, const Instruction& load, Id value) {
  std::vector<std::uint32_t> operands{load.type, load.result, value};
  for (const auto& index : module.access(load.at(0)).indices) operands.push_back(*index);
  out.emit(operands.size() == 3 ? Op::OpCopyObject : Op::OpCompositeExtract, operands);
}

}  // namespace

bool isOverwrittenByTrace(spv::BuiltIn builtIn) {
  using spv::BuiltIn;
  return builtIn == BuiltIn::PrimitiveId || builtIn == BuiltIn::InstanceId ||
         builtIn == BuiltIn::InstanceCustomIndexKHR || builtIn == BuiltIn::RayGeometryIndexKHR ||
         builtIn == BuiltIn::HitKindKHR || builtIn == BuiltIn::ObjectToWorldKHR || builtIn == BuiltIn::WorldToObjectKHR;
}

bool canCopyBuiltIn(const Module& module, std::size_t load) {
  const Function* entry = module.entry();
  const auto position = module.position(load);
  if (!entry || !position || &module.functions()[position->function] != entry) return false;
  return std::ranges::all_of(module.access(module.instructions()[load].at(0)).indices,
                             [](const auto& index) { return index.has_value(); });
}

std::vector<std::uint32_t> copyBuiltIns(std::vector<std::uint32_t> words) {
  const auto module = Module::read(words);
  if (!module || !module->entry() || module->entry()->blocks.empty()) return words;
  const Loads loads = findLoads(*module);
  if (loads.empty()) return words;

  std::map<Id, const Instruction*> loadByResult;
  for (const auto& [i, variable] : loads) loadByResult[module->instructions()[i].result] = &module->instructions()[i];
  ModuleWriter out(words);
  std::map<Id, Id> copies;  // variable -> id of its copy
  for (const auto& [i, variable] : loads)
    if (!copies.contains(variable->id)) copies[variable->id] = out.newId();
  // The variables of a function come first in its first block; the copies follow them.
  const Id entryLabel = module->entry()->blocks.front().label;
  bool inEntryBlock = false;
  while (!out.atEnd()) {
    const Op op = out.next();
    if (inEntryBlock && op != Op::OpVariable && op != Op::OpLine && op != Op::OpNoLine) {
      for (const auto& [variable, value] : copies)
        out.emit(Op::OpLoad, {module->variable(variable)->type, value, variable});
      inEntryBlock = false;
    }
    const bool isLoad = op == Op::OpLoad && loadByResult.contains(out.word(2));
    if (isLoad) {
      const Instruction& load = *loadByResult.at(out.word(2));
      replaceLoad(out, *module, load, copies.at(module->access(load.at(0)).variable));
      out.skip();
    } else {
      if (op == Op::OpLabel && out.word(1) == entryLabel) inEntryBlock = true;
      out.copy();
    }
  }
  return out.take();
}

}  // namespace quintet::spirv
