// SPDX-License-Identifier: Apache-2.0
#include "spirv/interleave_rows.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include "spirv/module_writer.h"
#include "spirv/raw_instructions.h"

namespace quintet::spirv {
namespace {

using spv::Op;

// What the rewriting must know of a module.
struct LaunchUses {
  bool supported = true;
  Id launchId = 0;                        // variable; 0 if there is none
  Id launchSize = 0;                      // variable; 0 if there is none
  Id pointer = 0;                         // type of launchId
  Id vector = 0;                          // type of its value
  Id scalar = 0;                          // type of a component
  Id boolean = 0;                         // OpTypeBool; 0 if there is none
  std::size_t loads = 0;                  // of launchId or its components
  std::unordered_map<Id, Id> components;  // pointer to a component of launchId -> id of its index
};

bool isAccessChain(Op op) { return op == Op::OpAccessChain || op == Op::OpInBoundsAccessChain; }

// Declarations of launchId, which do not read it.
bool onlyNames(Op op) {
  return op == Op::OpName || op == Op::OpDecorate || op == Op::OpEntryPoint || op == Op::OpVariable;
}

void findVariables(Words words, LaunchUses& uses) {
  std::unordered_map<Id, Id> pointee, component;  // of pointer and vector types
  for (const RawInstruction& i : RawInstructions(words)) {
    if (i.op == Op::OpDecorate && i.at(1) == static_cast<std::uint32_t>(spv::Decoration::BuiltIn)) {
      if (i.at(2) == static_cast<std::uint32_t>(spv::BuiltIn::LaunchIdKHR)) uses.launchId = i.at(0);
      if (i.at(2) == static_cast<std::uint32_t>(spv::BuiltIn::LaunchSizeKHR)) uses.launchSize = i.at(0);
    }
    if (i.op == Op::OpTypeBool) uses.boolean = i.at(0);
    if (i.op == Op::OpTypePointer) pointee[i.at(0)] = i.at(2);
    if (i.op == Op::OpTypeVector) component[i.at(0)] = i.at(1);
    if (i.op == Op::OpVariable && i.at(1) == uses.launchId) uses.pointer = i.at(0);
  }
  if (uses.launchId == 0) return;
  uses.vector = pointee[uses.pointer];
  uses.scalar = component[uses.vector];
  uses.supported = uses.scalar != 0;
}

void findLoads(Words words, LaunchUses& uses) {
  for (const RawInstruction& i : RawInstructions(words)) {
    if (onlyNames(i.op)) continue;
    if (i.op == Op::OpLoad && (i.at(2) == uses.launchId || uses.components.contains(i.at(2)))) {
      ++uses.loads;
    } else if (isAccessChain(i.op) && i.at(2) == uses.launchId) {
      if (i.operands.size() == 4)
        uses.components[i.at(1)] = i.at(3);
      else
        uses.supported = false;
    } else if (i.op == Op::OpCopyObject || i.op == Op::OpFunctionCall || i.op == Op::OpSelect || i.op == Op::OpPhi ||
               i.op == Op::OpCopyMemory || i.op == Op::OpCopyLogical || isAccessChain(i.op)) {
      // The other instructions that can have a pointer to an input as operand.
      for (const std::uint32_t id : i.operands.subspan(std::min<std::size_t>(i.operands.size(), 2)))
        if (id == uses.launchId || uses.components.contains(id)) uses.supported = false;
    }
  }
}

LaunchUses usesOf(Words words) {
  LaunchUses uses;
  if (words.size() < kHeaderWords) return uses;
  findVariables(words, uses);
  if (uses.launchId != 0 && uses.supported) findLoads(words, uses);
  return uses;
}

class RowWriter {
 public:
  RowWriter(const std::vector<std::uint32_t>& words, LaunchUses uses, std::uint32_t parts)
      : out_(words), uses_(std::move(uses)), parts_(parts), ownsSize_(uses_.launchSize == 0) {
    if (ownsSize_) uses_.launchSize = out_.newId();
  }

  std::vector<std::uint32_t> write() {
    bool decorated = false, declared = false;
    while (!out_.atEnd()) {
      const Op op = out_.next();
      if (op == Op::OpEntryPoint && ownsSize_) {
        addToInterface();
        continue;
      }
      if (op == Op::OpDecorate && ownsSize_ && !std::exchange(decorated, true))
        out_.emit(Op::OpDecorate, {uses_.launchSize, static_cast<std::uint32_t>(spv::Decoration::BuiltIn),
                                   static_cast<std::uint32_t>(spv::BuiltIn::LaunchSizeKHR)});
      if (op == Op::OpFunction && !std::exchange(declared, true)) declare();
      if (op == Op::OpLoad && (out_.word(3) == uses_.launchId || uses_.components.contains(out_.word(3))))
        load();
      else
        out_.copy();
    }
    return out_.take();
  }

 private:
  void addToInterface() {
    std::vector<std::uint32_t> operands;
    const std::size_t count = out_.word(0) >> 16;
    for (std::size_t i = 1; i < count; ++i) operands.push_back(out_.word(i));
    operands.push_back(uses_.launchSize);
    out_.emit(Op::OpEntryPoint, operands);
    out_.skip();
  }

  void declare() {
    if (uses_.boolean == 0) {
      uses_.boolean = out_.newId();
      out_.emit(Op::OpTypeBool, {uses_.boolean});
    }
    const auto constant = [&](std::uint32_t value) {
      const Id id = out_.newId();
      out_.emit(Op::OpConstant, {uses_.scalar, id, value});
      return id;
    };
    zero_ = constant(0), one_ = constant(1), partCount_ = constant(parts_);
    if (ownsSize_)
      out_.emit(Op::OpVariable,
                {uses_.pointer, uses_.launchSize, static_cast<std::uint32_t>(spv::StorageClass::Input)});
  }

  Id emit(Op op, Id type, std::vector<std::uint32_t> operands, std::optional<Id> result = std::nullopt) {
    const Id id = result ? *result : out_.newId();
    operands.insert(operands.begin(), {type, id});
    out_.emit(op, operands);
    return id;
  }

  // Replaces the load. The id of its result stays.
  void load() {
    const Id result = out_.word(2), pointer = out_.word(3), uint = uses_.scalar;
    const Id place = emit(Op::OpLoad, uses_.vector, {uses_.launchId});
    const Id size = emit(Op::OpLoad, uses_.vector, {uses_.launchSize});
    const Id y = emit(Op::OpCompositeExtract, uint, {place, 1});
    const Id height = emit(Op::OpCompositeExtract, uint, {size, 1});
    const Id rows = emit(Op::OpUDiv, uint, {height, partCount_});  // of a part
    const Id none = emit(Op::OpIEqual, uses_.boolean, {rows, zero_});
    const Id divisor = emit(Op::OpSelect, uint, {none, one_, rows});
    const Id part = emit(Op::OpUDiv, uint, {y, divisor});
    const Id row = emit(Op::OpUMod, uint, {y, divisor});
    const Id first = emit(Op::OpIMul, uint, {row, partCount_});
    const Id permuted = emit(Op::OpIAdd, uint, {first, part});
    const Id end = emit(Op::OpIMul, uint, {rows, partCount_});
    const Id inside = emit(Op::OpULessThan, uses_.boolean, {y, end});
    const Id value = emit(Op::OpSelect, uint, {inside, permuted, y});
    if (pointer == uses_.launchId) {
      emit(Op::OpCompositeInsert, uses_.vector, {value, place, 1}, result);
    } else {
      const Id whole = emit(Op::OpCompositeInsert, uses_.vector, {value, place, 1});
      emit(Op::OpVectorExtractDynamic, uint, {whole, uses_.components.at(pointer)}, result);
    }
    out_.skip();
  }

  ModuleWriter out_;
  LaunchUses uses_;
  std::uint32_t parts_;
  bool ownsSize_;  // the module has no LaunchSize of its own
  Id zero_ = 0, one_ = 0, partCount_ = 0;
};

}  // namespace

bool canInterleaveRows(std::span<const std::uint32_t> words) { return usesOf(words).supported; }

std::vector<std::uint32_t> interleaveRows(std::vector<std::uint32_t> words, std::uint32_t parts) {
  LaunchUses uses = usesOf(words);
  if (!uses.supported || uses.loads == 0) return words;
  return RowWriter(words, std::move(uses), parts).write();
}

}  // namespace quintet::spirv
