// SPDX-License-Identifier: Apache-2.0
#include "spirv/constant_choices.h"

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "spirv/trace_instruction.h"

namespace quintet::spirv {
namespace {

using spv::Op;

class ConstantChoices {
 public:
  explicit ConstantChoices(const Module& module) : module_(module) {}

  bool any() {
    const auto& all = module_.instructions();
    if (std::ranges::none_of(all, [](const Instruction& i) { return isSpecialization(i.op); })) return false;
    const auto isSpecialized = [&](Id value) { return kindOf(value, 0) == Kind::specialization; };
    return std::ranges::any_of(all, [&](const Instruction& i) {
      return isConstantSelect(i) || std::ranges::any_of(choosers(i), isSpecialized);
    });
  }

 private:
  enum class Kind { constant, specialization, variable };

  static bool isSpecialization(Op op) {
    return op == Op::OpSpecConstant || op == Op::OpSpecConstantTrue || op == Op::OpSpecConstantFalse;
  }

  static bool isConstantSelect(const Instruction& i) {
    return i.op == Op::OpSpecConstantOp && static_cast<Op>(i.at(0)) == Op::OpSelect;
  }

  bool isBoolean(Id value) const {
    const Instruction* i = module_.definition(value);
    return i && module_.types().get(i->type).kind == Type::Kind::boolean;
  }

  // The operands that decide what the instruction does. A stored boolean decides what a later one does.
  std::vector<Id> choosers(const Instruction& i) const {
    switch (i.op) {
      case Op::OpBranchConditional:
      case Op::OpSwitch:
      case Op::OpSelect:
      case Op::OpExecuteCallableKHR: return {i.at(0)};
      case Op::OpLogicalAnd:
      case Op::OpLogicalOr: return {i.at(0), i.at(1)};
      case Op::OpStore: return isBoolean(i.at(1)) ? std::vector{i.at(1)} : std::vector<Id>{};
      default: break;
    }
    if (const auto ray = rayOperands(i)) return {ray->flags, ray->mask, ray->offset, ray->stride, ray->miss};
    return {};
  }

  // What a value is computed from. A local variable is not followed.
  Kind kindOf(Id value, int depth) {
    constexpr int kMaxDepth = 64;
    const Instruction* i = module_.definition(value);
    if (!i || depth > kMaxDepth) return Kind::variable;
    if (isSpecialization(i->op)) return Kind::specialization;
    if (i->op == Op::OpSpecConstantOp || i->op == Op::OpSpecConstantComposite) return Kind::specialization;
    if (module_.isConstant(value)) return Kind::constant;
    switch (i->op) {
      case Op::OpLoad:
      case Op::OpPhi:
      case Op::OpFunctionCall:
      case Op::OpFunctionParameter:
      case Op::OpVariable: return Kind::variable;
      default: break;
    }
    const auto [known, isNew] = kinds_.try_emplace(value, Kind::variable);
    if (!isNew) return known->second;
    const std::vector<Id> operands = valueOperands(*i);
    Kind result = operands.empty() ? Kind::variable : Kind::constant;
    for (const Id operand : operands) {
      const Kind kind = kindOf(operand, depth + 1);
      if (kind == Kind::variable) {
        result = kind;
        break;
      }
      if (kind == Kind::specialization) result = kind;
    }
    return kinds_[value] = result;
  }

  const Module& module_;
  std::unordered_map<Id, Kind> kinds_;
};

}  // namespace

bool constantsChoose(const Module& module) { return ConstantChoices(module).any(); }

}  // namespace quintet::spirv
