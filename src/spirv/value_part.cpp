// SPDX-License-Identifier: Apache-2.0
#include "spirv/value_part.h"

#include <algorithm>
#include <span>

#include "spirv/comparison.h"

namespace quintet::spirv {
namespace {

using spv::Op;

constexpr int kMaxChain = 1024;  // a malformed module can have cycles

const Type& typeOf(const Module& module, Id id) {
  const Instruction* value = module.definition(id);
  return module.types().get(value ? value->type : 0);
}

// Each of these functions replaces the part by that of the operand that holds it. They return false if no single operand
// does.

bool enterConstruct(const Module& module, const Instruction& construct, ValuePart& part) {
  if (part.path.empty()) return false;
  const bool vector = module.types().get(construct.type).kind == Type::Kind::vector;
  std::uint32_t index = part.path.front();
  for (std::size_t i = 0; i < construct.operands.size(); ++i) {
    const Type& type = typeOf(module, construct.at(i));
    const bool several = vector && type.kind == Type::Kind::vector;
    const std::uint32_t count = several ? type.count : 1;
    if (index < count) {
      part.id = construct.at(i);
      part.path.erase(part.path.begin());
      if (several) part.path.insert(part.path.begin(), index);
      return true;
    }
    index -= count;
  }
  return false;
}

bool enterInsert(const Instruction& insert, ValuePart& part) {
  const auto inserted = insert.operands.subspan(std::min<std::size_t>(2, insert.operands.size()));
  const auto differ = std::ranges::mismatch(inserted, part.path);
  if (differ.in1 == inserted.end()) {  // a part of the object
    part.id = insert.at(0);
    part.path.erase(part.path.begin(), part.path.begin() + static_cast<std::ptrdiff_t>(inserted.size()));
    return true;
  }
  if (differ.in2 == part.path.end()) return false;  // partly of the object
  part.id = insert.at(1);
  return true;
}

bool enterShuffle(const Module& module, const Instruction& shuffle, ValuePart& part) {
  if (part.path.size() != 1 || std::size_t{part.path[0]} + 2 >= shuffle.operands.size()) return false;
  const std::uint32_t component = shuffle.operands[part.path[0] + 2];
  constexpr std::uint32_t kUndefined = ~0u;
  if (component == kUndefined) return false;
  const std::uint32_t first = typeOf(module, shuffle.at(0)).count;
  part = component < first ? ValuePart{shuffle.at(0), {component}} : ValuePart{shuffle.at(1), {component - first}};
  return true;
}

bool enter(const Module& module, const Instruction& value, ValuePart& part) {
  switch (value.op) {
    case Op::OpCopyObject:
    case Op::OpCopyLogical: part.id = value.at(0); return true;
    case Op::OpCompositeExtract:
      if (value.operands.empty()) return false;
      part.id = value.at(0);
      part.path.insert(part.path.begin(), value.operands.begin() + 1, value.operands.end());
      return true;
    case Op::OpCompositeConstruct:
    case Op::OpConstantComposite:
    case Op::OpSpecConstantComposite: return enterConstruct(module, value, part);
    case Op::OpCompositeInsert: return enterInsert(value, part);
    case Op::OpVectorShuffle: return enterShuffle(module, value, part);
    default: return false;
  }
}

}  // namespace

ValuePart originOf(const Module& module, ValuePart part) {
  for (int step = 0; step < kMaxChain; ++step) {
    const Instruction* value = module.definition(part.id);
    if (!value || !enter(module, *value, part)) break;
  }
  return part;
}

std::optional<double> constantNumber(const Module& module, const ValuePart& value) {
  const Instruction* constant = module.definition(value.id);
  if (!constant) return {};
  if (constant->op == Op::OpConstantNull) return 0.0;
  if (!value.path.empty()) return {};
  if (const auto number = module.constantFloat(value.id)) return number;
  const auto bits = module.constantBits(value.id);
  if (!bits) return {};
  const Type& type = module.types().get(constant->type);
  return type.isSigned ? static_cast<double>(static_cast<std::int32_t>(*bits)) : static_cast<double>(*bits);
}

bool isSplat(const Module& module, Id value) {
  const Instruction* i = module.definition(value);
  if (!i || (i->op != Op::OpCompositeConstruct && i->op != Op::OpConstantComposite) || i->operands.empty())
    return false;
  return std::ranges::all_of(i->operands, [&](Id id) { return id == i->operands.front(); });
}

std::optional<double> splatConstant(const Module& module, Id value) {
  if (const auto scalar = module.constantFloat(value)) return scalar;
  return isSplat(module, value) ? module.constantFloat(module.definition(value)->at(0)) : std::nullopt;
}

std::optional<double> evaluate(const Module& module, Id value, const std::function<std::optional<double>(Id)>& known,
                               int depth) {
  if (const auto number = known(value)) return number;
  if (const auto number = constantNumber(module, {value, {}})) return number;
  const Instruction* i = module.definition(value);
  if (!i || depth > 16) return {};
  const auto operand = [&](std::size_t k) { return evaluate(module, i->at(k), known, depth + 1); };
  switch (i->op) {
    case Op::OpLogicalNot:
      if (const auto a = operand(0)) return *a == 0.0 ? 1.0 : 0.0;
      return {};
    case Op::OpLogicalAnd:
    case Op::OpLogicalOr: {
      const double decides = i->op == Op::OpLogicalAnd ? 0.0 : 1.0;
      const auto a = operand(0), b = operand(1);
      if (a == decides || b == decides) return decides;
      return a && b ? std::optional(1.0 - decides) : std::nullopt;
    }
    default: break;
  }
  const std::optional<Comparison> comparison = comparisonOf(i->op);
  if (!comparison || i->operands.size() != 2 || !hasSignOf(*comparison, typeOf(module, i->at(0)))) return {};
  const auto a = operand(0), b = operand(1);
  return a && b ? std::optional(holds(*comparison, *a, *b) ? 1.0 : 0.0) : std::nullopt;
}

}  // namespace quintet::spirv
