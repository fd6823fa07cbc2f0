// SPDX-License-Identifier: Apache-2.0
#include "spirv/same_value.h"

#include "spirv/value_flow.h"

namespace quintet::spirv {
namespace {

using spv::Op;

constexpr int kMaxExpressionDepth = 12;

bool same(const Module& module, Id a, Id b, int depth) {
  if (a == b) return true;
  const Instruction* left = module.definition(a);
  const Instruction* right = module.definition(b);
  if (!left || !right || depth > kMaxExpressionDepth || left->op != right->op || left->type != right->type)
    return false;
  if (left->operands.size() != right->operands.size() || left->operands.empty()) return false;
  const auto firstOperand = [&] { return same(module, left->at(0), right->at(0), depth + 1); };
  const auto sameFrom = [&](std::size_t first) {
    for (std::size_t i = first; i < left->operands.size(); ++i)
      if (left->at(i) != right->at(i)) return false;
    return true;
  };
  switch (left->op) {
    case Op::OpLoad: {
      // A variable can be stored to between two loads.
      const Variable* variable = module.variable(module.access(left->at(0)).variable);
      const bool constant = variable ? variable->builtIn || variable->storage == spv::StorageClass::PushConstant
                                     : !isLocal(module, module.access(left->at(0)).variable);
      return constant && firstOperand();
    }
    case Op::OpFAdd:
    case Op::OpFSub:
    case Op::OpFMul:
    case Op::OpFDiv:
    case Op::OpFNegate:
    case Op::OpVectorTimesScalar:
    case Op::OpMatrixTimesVector:
    case Op::OpCompositeConstruct:
    case Op::OpConvertUToPtr:
    case Op::OpAccessChain:
      for (std::size_t i = 0; i < left->operands.size(); ++i)
        if (!same(module, left->at(i), right->at(i), depth + 1)) return false;
      return true;
    case Op::OpCompositeExtract: return firstOperand() && sameFrom(1);
    default: return false;
  }
}

}  // namespace

bool sameValue(const Module& module, Id a, Id b) { return same(module, a, b, 0); }

}  // namespace quintet::spirv
