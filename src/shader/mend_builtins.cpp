#include "shader/mend_builtins.h"

#include <algorithm>
#include <map>

#include "shader/spirv_flow.h"

namespace quintet::shader {
namespace {

using spv::Op;

std::uint32_t opWord(Op op, std::size_t words) {
  return static_cast<std::uint32_t>(words) << 16 | static_cast<std::uint32_t>(op);
}

// The variable of a built-in that changes, if the instruction loads it or a part of it.
const SpirvVariable* changingVariable(const SpirvModule& module, const SpirvInstruction& instruction) {
  if (instruction.op != Op::OpLoad) return nullptr;
  const SpirvVariable* variable = module.variable(module.access(instruction.at(0)).variable);
  return variable && variable->builtIn && changesInNestedTrace(*variable->builtIn) ? variable : nullptr;
}

bool runsAfterTrace(const SpirvModule& module, std::size_t load, const std::vector<std::size_t>& traces) {
  return std::ranges::any_of(traces, [&](std::size_t trace) { return mayRunAfter(module, load, trace); });
}

struct Mend {
  std::map<std::size_t, const SpirvVariable*> loads;  // by instruction
  std::map<SpirvId, SpirvId> values;                  // variable -> id of the value loaded at the start
};

Mend findLoads(const SpirvModule& module) {
  Mend mend;
  std::vector<std::size_t> traces;
  for (std::size_t i = 0; i < module.instructions().size(); ++i)
    if (module.instructions()[i].op == Op::OpTraceRayKHR) traces.push_back(i);
  if (traces.empty()) return mend;
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const SpirvVariable* variable = changingVariable(module, module.instructions()[i]);
    if (variable && canMendLoad(module, i) && runsAfterTrace(module, i, traces)) mend.loads[i] = variable;
  }
  return mend;
}

// Word offset of each instruction: they follow the header in order.
class Writer {
 public:
  explicit Writer(const std::vector<std::uint32_t>& words)
      : words_(words), result_(words.begin(), words.begin() + 5), at_(5) {}
  SpirvId newId() { return result_[3]++; }
  void copy() {
    const std::size_t count = words_[at_] >> 16;
    result_.insert(result_.end(), words_.begin() + static_cast<std::ptrdiff_t>(at_),
                   words_.begin() + static_cast<std::ptrdiff_t>(at_ + count));
    at_ += count;
  }
  void skip() { at_ += words_[at_] >> 16; }
  void emit(Op op, const std::vector<std::uint32_t>& operands) {
    result_.push_back(opWord(op, operands.size() + 1));
    result_.insert(result_.end(), operands.begin(), operands.end());
  }
  bool atEnd() const { return at_ >= words_.size(); }
  Op next() const { return static_cast<Op>(words_[at_] & 0xFFFFu); }
  std::uint32_t word(std::size_t i) const { return words_[at_ + i]; }
  std::vector<std::uint32_t> take() { return std::move(result_); }

 private:
  const std::vector<std::uint32_t>& words_;
  std::vector<std::uint32_t> result_;
  std::size_t at_;
};

// The load becomes a copy of the value from the start, or a part of it. Same result id, so no user changes.
void replaceLoad(Writer& out, const SpirvModule& module, const SpirvInstruction& load, SpirvId value) {
  std::vector<std::uint32_t> operands{load.type, load.result, value};
  for (const auto& index : module.access(load.at(0)).indices) operands.push_back(*index);
  out.emit(operands.size() == 3 ? Op::OpCopyObject : Op::OpCompositeExtract, operands);
}

}  // namespace

bool changesInNestedTrace(spv::BuiltIn builtIn) {
  using spv::BuiltIn;
  return builtIn == BuiltIn::PrimitiveId || builtIn == BuiltIn::InstanceId ||
         builtIn == BuiltIn::InstanceCustomIndexKHR || builtIn == BuiltIn::RayGeometryIndexKHR ||
         builtIn == BuiltIn::HitKindKHR || builtIn == BuiltIn::ObjectToWorldKHR || builtIn == BuiltIn::WorldToObjectKHR;
}

bool canMendLoad(const SpirvModule& module, std::size_t load) {
  const SpirvFunction* entry = module.entry();
  const auto position = module.position(load);
  if (!entry || !position || &module.functions()[position->function] != entry) return false;
  return std::ranges::all_of(module.access(module.instructions()[load].at(0)).indices,
                             [](const auto& index) { return index.has_value(); });
}

std::vector<std::uint32_t> mendNestedBuiltIns(std::vector<std::uint32_t> words) {
  const auto module = SpirvModule::read(words);
  if (!module || !module->entry() || module->entry()->blocks.empty()) return words;
  Mend mend = findLoads(*module);
  if (mend.loads.empty()) return words;

  std::map<SpirvId, const SpirvInstruction*> loadByResult;
  for (const auto& [i, variable] : mend.loads)
    loadByResult[module->instructions()[i].result] = &module->instructions()[i];
  Writer out(words);
  for (const auto& [i, variable] : mend.loads)
    if (!mend.values.contains(variable->id)) mend.values[variable->id] = out.newId();
  // Variables of a function come first in its first block; the values are loaded behind them.
  const SpirvId entryLabel = module->entry()->blocks.front().label;
  bool inEntryBlock = false;
  while (!out.atEnd()) {
    const Op op = out.next();
    if (inEntryBlock && op != Op::OpVariable && op != Op::OpLine && op != Op::OpNoLine) {
      for (const auto& [variable, value] : mend.values)
        out.emit(Op::OpLoad, {module->variable(variable)->type, value, variable});
      inEntryBlock = false;
    }
    const bool isLoad = op == Op::OpLoad && loadByResult.contains(out.word(2));
    if (isLoad) {
      const SpirvInstruction& load = *loadByResult.at(out.word(2));
      replaceLoad(out, *module, load, mend.values.at(module->access(load.at(0)).variable));
      out.skip();
    } else {
      if (op == Op::OpLabel && out.word(1) == entryLabel) inEntryBlock = true;
      out.copy();
    }
  }
  return out.take();
}

}  // namespace quintet::shader
