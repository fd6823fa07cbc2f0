// SPDX-License-Identifier: Apache-2.0
#include "spirv/value_ranges.h"

#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>

#include "spirv/access.h"
#include "spirv/control_flow.h"
#include "spirv/shader_record.h"
#include "spirv/value_flow.h"
#include "spirv/value_part.h"

namespace quintet::spirv {
namespace {

using spv::Op;
using Kind = Type::Kind;

constexpr std::size_t kNone = Module::kNone;
constexpr int kMaxDepth = 100;             // nested evaluations; deeper values are unknown
constexpr std::size_t kMaxElements = 256;  // of an array whose elements are joined
constexpr double kMaxStep = 1 << 20;       // of a counted loop
constexpr double kSineError = 1.0 / 2048;  // absolute, of sin and cos: Vulkan's precision requirements

// Vulkan's limits of built-ins, for each component.
ValueRange builtInRange(spv::BuiltIn builtIn, const Type& type, const Path& path) {
  using spv::BuiltIn;
  const double most = isInteger(type) ? highest(type) : kInf;
  switch (builtIn) {
    case BuiltIn::LaunchIdKHR:
      if (path == Path{2}) return ValueRange::of(0.0);
      return ValueRange::between(0.0, 1073741823.0, Occurrence::many);
    case BuiltIn::LaunchSizeKHR:
      if (path == Path{2}) return ValueRange::of(1.0);
      return ValueRange::between(1.0, 1073741824.0);
    case BuiltIn::PrimitiveId: return ValueRange::between(0.0, 536870911.0, Occurrence::many);
    case BuiltIn::InstanceId:
    case BuiltIn::InstanceCustomIndexKHR:
    case BuiltIn::RayGeometryIndexKHR: return ValueRange::between(0.0, 16777215.0);
    case BuiltIn::HitKindKHR: return ValueRange::between(0.0, 255.0);
    case BuiltIn::IncomingRayFlagsKHR: return ValueRange::between(0.0, 1023.0);
    case BuiltIn::RayTminKHR:
    case BuiltIn::RayTmaxKHR: return ValueRange::between(0.0, most);
    default: return rangeOf(type);
  }
}

// A loop over an integer with a constant step: for (i = first; i < bound; i += step).
struct CountedLoop {
  ValueRange values;         // of the variable in the header: includes the value that ends the loop
  ValueRange inside;         // in the body
  std::vector<bool> blocks;  // of the loop, by block
  std::size_t function = 0, header = 0, latch = 0;
  bool complete = false;  // only the header ends the loop, so each value of `inside` occurs
};

// A variable that each round changes by the same operand, before anything is known about its values.
struct LoopShape {
  std::size_t function = 0, header = 0, latch = 0;
  Id first = 0;      // the value before the loop
  ValuePart next{};  // the value after a round
  Id by = 0;         // what a round adds or subtracts
  bool subtracts = false;
};

}  // namespace

struct ValueRanges::Impl {
  Impl(const Module& m, ValueContext c) : module(m), context(std::move(c)) {}

  using Key = ValuePart;
  struct Limits {
    double min = -kInf, max = kInf;
  };

  // Ranges in one block, or everywhere (base).
  struct Evaluator {
    std::map<Key, Limits> limits;  // from the conditions that lead to the block
    std::optional<Module::Position> block;
    bool dead = false;  // the conditions contradict each other
    std::map<Key, ValueRange> memo;
    std::set<Key> open;
  };

  const Module& module;
  ValueContext context;
  Evaluator base;
  std::map<std::pair<std::size_t, std::size_t>, Evaluator> byBlock;
  std::map<std::array<std::size_t, 3>, Evaluator> byEdge;  // function, from, to
  std::map<std::size_t, ControlFlow> flows;
  std::map<Id, std::optional<CountedLoop>> loops;
  std::set<Id> openLoops;
  std::optional<BlockLayout> layout;  // of the shader record
  int depth = 0;

  const ControlFlow& flow(std::size_t function) {
    const auto found = flows.find(function);
    return found != flows.end() ? found->second : flows.emplace(function, ControlFlow(module, function)).first->second;
  }

  const Type& typeOf(Id id, const Path& path = {}) const {
    const Instruction* value = module.definition(id);
    return module.types().get(value ? module.types().part(value->type, path) : 0);
  }

  Key canonical(Id id, Path path) const { return originOf(module, {id, std::move(path)}); }
  ValueRange evaluate(Evaluator& in, Id id, const Path& path);
  ValueRange compute(Evaluator& in, Id id, const Path& path);
  ValueRange constantRange(const Instruction& value, const Type& type) const;
  ValueRange loadRange(Evaluator& in, const Instruction& load, const Type& type, const Path& path);
  ValueRange localRange(Evaluator& in, const Access& access, const Type& type, const Path& path);
  std::optional<ValueRange> recordRange(const Access& access, const Type& type, const Path& path);
  ValueRange storedRange(const Access& access, const Type& type,
                         const std::vector<std::optional<std::uint32_t>>& wanted);
  ValueRange partRange(Evaluator& in, Id value, const std::vector<std::optional<std::uint32_t>>& rest, Path& path,
                       std::size_t& budget, const Type& type);
  ValueRange phiRange(Evaluator& in, const Instruction& phi, const Path& path);
  ValueRange extendedRange(Evaluator& in, const Instruction& value, const Type& type, const Path& path);
  ValueRange converted(const Instruction& value, const ValueRange& from, const Type& type);
  ValueRange sum(Evaluator& in, std::span<const std::uint32_t> operands, const Type& type, const Path& path);
  ValueRange operation(Evaluator& in, Op op, std::span<const std::uint32_t> operands, const Type& type,
                       const Path& path);

  const std::optional<CountedLoop>& countedLoop(Id phi);
  std::optional<LoopShape> loopShape(const Instruction& phi);
  std::optional<CountedLoop> findLoop(Id phi, const LoopShape& shape);
  Evaluator& at(std::size_t function, std::size_t block);
  const Evaluator& alongEdge(std::size_t function, std::size_t from, std::size_t to);
  void addConditions(Evaluator& in, std::size_t function, std::size_t block);
  // A value that a phi or select can have, and the conditions under which it has it.
  struct Choice {
    Id value;
    const Evaluator* when;
  };
  ValueRange choice(Evaluator& in, const Choice& choice, const Path& path, const Type& type);
  ValueRange chosenFrom(Evaluator& in, const Type& type, const std::vector<Choice>& choices, const Path& path,
                        const std::vector<Id>& conditions);
  void addCondition(Evaluator& in, Id condition, bool holds, int nesting = 0);
  void addLimit(Evaluator& in, Id value, const Path& path, double min, double max);
  void addEdge(Evaluator& in, const Function& function, std::size_t from, std::size_t to);
};

ValueRange ValueRanges::Impl::evaluate(Evaluator& in, Id id, const Path& given) {
  const Key key = canonical(id, given);
  if (const auto found = in.memo.find(key); found != in.memo.end()) return found->second;
  const Type& type = typeOf(key.id, key.path);
  if (depth >= kMaxDepth || !in.open.insert(key).second) return rangeOf(type);
  ++depth;
  ValueRange result = compute(in, key.id, key.path);
  --depth;
  in.open.erase(key);
  if (context.noNan && !result.onlyNan()) result.nan = false;
  if (const auto found = in.limits.find(key); found != in.limits.end())
    result = fitted(type, limited(std::move(result), found->second.min, found->second.max));
  return in.memo[key] = result;
}

ValueRange ValueRanges::Impl::constantRange(const Instruction& value, const Type& type) const {
  switch (value.op) {
    case Op::OpConstantTrue:
    case Op::OpSpecConstantTrue: return ValueRange::of(1.0);
    case Op::OpConstantFalse:
    case Op::OpSpecConstantFalse: return ValueRange::of(0.0);
    case Op::OpConstantNull:
      return type.kind == Kind::boolean || isInteger(type) || type.kind == Kind::floating
                 ? fitted(type, ValueRange::of(0.0))
                 : rangeOf(type);
    default: break;
  }
  if (isInteger(type)) return fitted(type, ValueRange::of(stored(type, value.at(0))));
  if (type.kind != Kind::floating) return rangeOf(type);
  std::optional<double> number;
  if (type.width == 32) number = std::bit_cast<float>(value.at(0));
  if (type.width == 64) number = std::bit_cast<double>(value.at(0) | std::uint64_t{value.at(1)} << 32);
  if (!number) return rangeOf(type);
  if (std::isnan(*number)) return onlyNan();
  return ValueRange::of(*number + 0.0);
}

ValueRange ValueRanges::Impl::compute(Evaluator& in, Id id, const Path& path) {
  const Instruction* value = module.definition(id);
  if (!value) return {};
  const Type& type = typeOf(id, path);
  if (type.kind != Kind::boolean && type.kind != Kind::integer && type.kind != Kind::floating) return {};
  switch (value->op) {
    case Op::OpConstant:
    case Op::OpSpecConstant:
    case Op::OpConstantNull:
    case Op::OpConstantTrue:
    case Op::OpConstantFalse:
    case Op::OpSpecConstantTrue:
    case Op::OpSpecConstantFalse: return constantRange(*value, type);
    case Op::OpSpecConstantOp:
      if (value->operands.empty()) return rangeOf(type);
      return operation(in, static_cast<Op>(value->at(0)), value->operands.subspan(1), type, path);
    case Op::OpLoad: return loadRange(in, *value, type, path);
    case Op::OpPhi: return phiRange(in, *value, path);
    case Op::OpExtInst: return extendedRange(in, *value, type, path);
    case Op::OpBitcast:
    case Op::OpUConvert:
    case Op::OpSConvert:
    case Op::OpFConvert:
    case Op::OpConvertUToF:
    case Op::OpConvertSToF:
    case Op::OpConvertFToU:
    case Op::OpConvertFToS:
      if (typeOf(value->at(0)).count != typeOf(id).count) return rangeOf(type);
      return converted(*value, evaluate(in, value->at(0), path), type);
    default: return operation(in, value->op, value->operands, type, path);
  }
}

ValueRange ValueRanges::Impl::converted(const Instruction& value, const ValueRange& from, const Type& type) {
  const Type& source =
      module.types().get(typeOf(value.at(0)).kind == Kind::vector
                             ? typeOf(value.at(0)).element
                             : (module.definition(value.at(0)) ? module.definition(value.at(0))->type : 0));
  const bool whole = isInteger(source), numbers = whole || isFloat(source);
  if (!numbers || from.empty()) return from.empty() ? from : rangeOf(type);
  ValueRange result = from;
  switch (value.op) {
    case Op::OpConvertUToF:
      if (from.min < 0.0 || !isFloat(type)) return rangeOf(type);
      break;
    case Op::OpConvertSToF:
      if (from.max > 2147483647.0 || !isFloat(type)) return rangeOf(type);
      break;
    case Op::OpConvertFToU:
    case Op::OpConvertFToS: {
      if (!isInteger(type) || from.nan || from.min <= lowest(type) - 1.0 || from.max >= highest(type) + 1.0)
        return rangeOf(type);
      return mapped(type, from, [](double v) { return std::trunc(v); });
    }
    case Op::OpBitcast:
      if (!whole || !isInteger(type) || source.width != type.width) return rangeOf(type);
      [[fallthrough]];
    case Op::OpUConvert:
    case Op::OpSConvert:
      if (!isInteger(type)) return rangeOf(type);
      // The conversion decides the sign of the source.
      if (value.op == Op::OpUConvert && from.min < 0.0) return rangeOf(type);
      if (value.op == Op::OpSConvert && from.max >= std::ldexp(1.0, static_cast<int>(source.width) - 1))
        return rangeOf(type);
      if (from.min >= lowest(type) && from.max <= highest(type)) return from;
      if (from.values.empty()) return rangeOf(type);
      for (double& v : result.values) v = stored(type, v);
      std::ranges::sort(result.values);
      result.values.erase(std::unique(result.values.begin(), result.values.end()), result.values.end());
      result.min = result.values.front(), result.max = result.values.back();
      return fitted(type, std::move(result));
    default: return rangeOf(type);
  }
  result.ones = result.zeros = 0;
  result.min = stored(type, result.min), result.max = stored(type, result.max);
  for (double& v : result.values) v = stored(type, v);
  return result;
}

// Consecutive integers plus a value that is the same in all invocations, such as gl_LaunchIDEXT.x + launch.offset.x, are
// consecutive.
ValueRange ValueRanges::Impl::sum(Evaluator& in, std::span<const std::uint32_t> operands, const Type& type,
                                  const Path& path) {
  if (operands.size() < 2) return rangeOf(type);
  const ValueRange a = evaluate(in, operands[0], path), b = evaluate(in, operands[1], path);
  ValueRange result = binary(type, Op::OpIAdd, a, b);
  const auto isUniform = [&](Id value) {
    const Key key = canonical(value, path);
    const Instruction* load = module.definition(key.id);
    const Access access = load && load->op == Op::OpLoad ? module.access(load->at(0)) : Access{};
    const Variable* variable = module.variable(access.variable);
    return variable && variable->storage == spv::StorageClass::PushConstant;
  };
  if ((a.occurrence == Occurrence::many && isUniform(operands[1])) ||
      (b.occurrence == Occurrence::many && isUniform(operands[0])))
    result.occurrence = Occurrence::many;
  return result;
}

ValueRange ValueRanges::Impl::operation(Evaluator& in, Op op, std::span<const std::uint32_t> operands, const Type& type,
                                        const Path& path) {
  const auto operand = [&](std::size_t i) {
    return i < operands.size() ? evaluate(in, operands[i], path) : ValueRange{};
  };
  if (const auto comparison = comparisonOf(op)) {
    const Id first = operands.empty() ? 0 : operands[0];
    return hasSignOf(*comparison, typeOf(first, path)) ? compared(*comparison, operand(0), operand(1)) : truth({});
  }
  switch (op) {
    case Op::OpIAdd:
    case Op::OpISub:
    case Op::OpIMul:
    case Op::OpUDiv:
    case Op::OpSDiv:
    case Op::OpUMod:
    case Op::OpSMod:
    case Op::OpSRem:
      if (!isInteger(type)) return rangeOf(type);
      if ((op == Op::OpUDiv || op == Op::OpUMod) && type.isSigned) return rangeOf(type);
      if (op == Op::OpIAdd) return sum(in, operands, type, path);
      return binary(type, op, operand(0), operand(1));
    case Op::OpFAdd:
    case Op::OpFSub:
    case Op::OpFMul:
    case Op::OpFDiv:
    case Op::OpFMod: return isFloat(type) ? binary(type, op, operand(0), operand(1)) : rangeOf(type);
    case Op::OpVectorTimesScalar:
      if (!isFloat(type) || operands.size() < 2) return rangeOf(type);
      return binary(type, Op::OpFMul, operand(0), evaluate(in, operands[1], {}));
    case Op::OpSNegate:
    case Op::OpFNegate:
      if (!isInteger(type) && !isFloat(type)) return rangeOf(type);
      return binary(type, op == Op::OpSNegate ? Op::OpISub : Op::OpFSub, ValueRange::of(0.0), operand(0));
    case Op::OpBitwiseAnd:
    case Op::OpBitwiseOr:
    case Op::OpBitwiseXor:
    case Op::OpShiftLeftLogical:
    case Op::OpShiftRightLogical:
    case Op::OpShiftRightArithmetic: return bitwise(type, op, operand(0), operand(1));
    case Op::OpLogicalNot: {
      const std::optional<double> value = operand(0).constant();
      return truth(value ? std::optional(*value == 0.0) : std::nullopt);
    }
    case Op::OpLogicalAnd:
    case Op::OpLogicalOr: {
      const bool stop = op == Op::OpLogicalOr;
      const std::optional<double> a = operand(0).constant(), b = operand(1).constant();
      if ((a && (*a != 0.0) == stop) || (b && (*b != 0.0) == stop)) return truth(stop);
      return truth(a && b ? std::optional(!stop) : std::nullopt);
    }
    case Op::OpSelect: {
      if (operands.size() < 3) return rangeOf(type);
      const bool vector = typeOf(operands[0]).kind == Kind::vector;
      const std::optional<double> chosenBy = evaluate(in, operands[0], vector ? path : Path{}).constant();
      if (chosenBy) return operand(*chosenBy != 0.0 ? 1 : 2);
      Evaluator ifTrue, ifFalse;
      if (!vector) addCondition(ifTrue, operands[0], true), addCondition(ifFalse, operands[0], false);
      return chosenFrom(in, type, {{operands[1], &ifTrue}, {operands[2], &ifFalse}}, path, {operands[0]});
    }
    case Op::OpVectorExtractDynamic: {
      if (operands.size() < 2) return rangeOf(type);
      const ValueRange index = evaluate(in, operands[1], {});
      ValueRange result = never();
      for (std::uint32_t i = 0; i < typeOf(operands[0]).count; ++i)
        if (index.contains(i)) result = joined(result, evaluate(in, operands[0], {i}));
      if (!result.constant()) result.occurrence = Occurrence::unknown;
      return result.empty() ? rangeOf(type) : fitted(type, std::move(result));
    }
    default: return rangeOf(type);
  }
}

ValueRange ValueRanges::Impl::extendedRange(Evaluator& in, const Instruction& value, const Type& type,
                                            const Path& path) {
  if (module.extendedSet(value.at(0)) != "GLSL.std.450") return rangeOf(type);
  const auto operand = [&](std::size_t i) { return evaluate(in, value.at(i + 2), path); };
  const auto orNan = [](double min, double max, bool nan = true) {
    ValueRange result = ValueRange::between(min, max);
    result.nan = nan;
    return result;
  };
  switch (value.at(1)) {
    case GLSLstd450FAbs:
    case GLSLstd450SAbs: return magnitude(type, operand(0));
    case GLSLstd450FSign:
    case GLSLstd450SSign: return signOf(type, operand(0));
    case GLSLstd450Floor: return mapped(type, operand(0), [](double v) { return std::floor(v); });
    case GLSLstd450Ceil: return mapped(type, operand(0), [](double v) { return std::ceil(v); });
    case GLSLstd450Trunc: return mapped(type, operand(0), [](double v) { return std::trunc(v); });
    case GLSLstd450RoundEven: return mapped(type, operand(0), [](double v) { return std::nearbyint(v); });
    case GLSLstd450Fract: {
      const ValueRange a = operand(0);
      if (const auto constant = a.constant()) return ValueRange::of(stored(type, *constant - std::floor(*constant)));
      return orNan(0.0, 1.0, a.nan || std::isinf(a.min) || std::isinf(a.max));
    }
    case GLSLstd450FMin:
    case GLSLstd450UMin:
    case GLSLstd450SMin:
    case GLSLstd450NMin: return chosen(type, operand(0), operand(1), false);
    case GLSLstd450FMax:
    case GLSLstd450UMax:
    case GLSLstd450SMax:
    case GLSLstd450NMax: return chosen(type, operand(0), operand(1), true);
    case GLSLstd450FClamp:
    case GLSLstd450UClamp:
    case GLSLstd450SClamp:
    case GLSLstd450NClamp: return clamped(type, operand(0), operand(1), operand(2));
    case GLSLstd450Step: return orNan(0.0, 1.0, operand(0).nan || operand(1).nan);
    case GLSLstd450SmoothStep: return orNan(0.0, 1.0);
    case GLSLstd450Sin:
    case GLSLstd450Cos: return orNan(-1.0 - kSineError, 1.0 + kSineError);  // NaN of infinity
    case GLSLstd450Sqrt: {
      const ValueRange a = operand(0);
      if (a.onlyNan() || a.max < 0.0) return onlyNan();
      return orNan(std::sqrt(std::max(a.min, 0.0)) * (1.0 - kRangeError), std::sqrt(a.max) * (1.0 + kRangeError),
                   a.nan || a.min < 0.0);
    }
    case GLSLstd450Exp:
    case GLSLstd450Exp2: return orNan(0.0, kInf, operand(0).nan);
    case GLSLstd450Length:
    case GLSLstd450Distance: return orNan(0.0, kInf);
    case GLSLstd450Normalize: return orNan(-1.0 - kRangeError, 1.0 + kRangeError);
    case GLSLstd450Fma: return binary(type, Op::OpFAdd, binary(type, Op::OpFMul, operand(0), operand(1)), operand(2));
    default: return rangeOf(type);
  }
}

ValueRange ValueRanges::Impl::phiRange(Evaluator& in, const Instruction& phi, const Path& path) {
  const Type& type = typeOf(phi.result, path);
  if (path.empty()) {
    if (const std::optional<CountedLoop>& loop = countedLoop(phi.result)) {
      const bool inside = in.block && in.block->function == loop->function && loop->blocks[in.block->block] &&
                          in.block->block != loop->header;
      if (!inside) return loop->values;
      ValueRange result = loop->inside;
      if (!loop->complete || !flow(loop->function).dominates(in.block->block, loop->latch))
        result.occurrence = Occurrence::unknown;
      return result;
    }
  }
  const auto position = module.position(module.definitionIndex(phi.result));
  if (!position) return rangeOf(type);
  // The values come from other blocks, where the conditions of this one need not hold: they are evaluated in `base`.
  const auto& blocks = module.functions()[position->function].blocks;
  std::vector<Choice> choices;
  for (std::size_t i = 0; i + 1 < phi.operands.size(); i += 2) {
    const auto from = std::ranges::find(blocks, phi.at(i + 1), &Block::label);
    if (from == blocks.end()) return rangeOf(type);
    choices.push_back(
        {phi.at(i), &alongEdge(position->function, static_cast<std::size_t>(from - blocks.begin()), position->block)});
  }
  return chosenFrom(base, type, choices, path, flow(position->function).phiConditions(position->block));
}

// One of several ranges. Values of a choice occur only if the conditions do not depend on the same inputs.
// The value is evaluated where the result is, and only then limited, so that each value is evaluated once.
ValueRange ValueRanges::Impl::choice(Evaluator& in, const Choice& choice, const Path& path, const Type& type) {
  if (choice.when->dead) return never();
  ValueRange result = evaluate(in, choice.value, path);
  const auto found = choice.when->limits.find(canonical(choice.value, path));
  if (found == choice.when->limits.end()) return result;
  return fitted(type, limited(std::move(result), found->second.min, found->second.max));
}

ValueRange ValueRanges::Impl::chosenFrom(Evaluator& in, const Type& type, const std::vector<Choice>& choices,
                                         const Path& path, const std::vector<Id>& conditions) {
  ValueRange result = never();
  bool constant = true, each = true, many = false;
  for (const Choice& one : choices) {
    const ValueRange range = choice(in, one, path, type);
    if (range.empty()) continue;
    result = joined(result, range);
    constant = constant && range.constant();
    each = each && range.occurrence == Occurrence::each;
    many = many || range.occurrence == Occurrence::many;
  }
  if (result.empty()) return rangeOf(type);
  const auto independent = [&] {
    // Variables, and members of buffers.
    const auto sourceOf = [&](const Instruction& load) -> std::pair<Id, std::string> {
      const auto member = bufferMember(module, load);
      return member ? std::pair(Id{0}, member->structure + '.' + member->member)
                    : std::pair(module.access(load.at(0)).base, std::string());
    };
    std::set<std::pair<Id, std::string>> sources;
    for (const Choice& one : choices) {
      if (choice(in, one, path, type).occurrence == Occurrence::unknown) continue;
      (void)dependsOn(module, one.value, [&](const Instruction& i) {
        if (i.op == Op::OpLoad) sources.insert(sourceOf(i));
        return false;
      });
    }
    return std::ranges::none_of(conditions, [&](Id condition) {
      return dependsOn(module, condition, [&](const Instruction& i) {
        return i.op == Op::OpPhi || i.op == Op::OpFunctionCall || (i.op == Op::OpLoad && sources.contains(sourceOf(i)));
      });
    });
  };
  if (constant || (each && independent()))
    result.occurrence = Occurrence::each;
  else if (many && independent())
    result.occurrence = Occurrence::many;
  else
    result.occurrence = Occurrence::unknown;
  return fitted(type, std::move(result));
}

// Ranges of a part of `value`. `rest` are the remaining indices; nullopt means any element.
ValueRange ValueRanges::Impl::partRange(Evaluator& in, Id value, const std::vector<std::optional<std::uint32_t>>& rest,
                                        Path& path, std::size_t& budget, const Type& type) {
  if (path.size() == rest.size()) return evaluate(in, value, path);
  const std::optional<std::uint32_t> index = rest[path.size()];
  if (index) {
    path.push_back(*index);
    const ValueRange result = partRange(in, value, rest, path, budget, type);
    path.pop_back();
    return result;
  }
  const std::size_t count = typeOf(value, path).partCount();
  if (count == 0 || count > budget) return rangeOf(type);
  budget -= count;
  ValueRange result = never();
  for (std::uint32_t i = 0; i < count; ++i) {
    path.push_back(i);
    result = joined(result, partRange(in, value, rest, path, budget, type));
    path.pop_back();
  }
  result.occurrence = Occurrence::unknown;
  return result;
}

ValueRange ValueRanges::Impl::localRange(Evaluator& in, const Access& access, const Type& type, const Path& path) {
  std::vector<std::optional<std::uint32_t>> wanted;
  std::size_t unknown = kNone;  // the last index that is not constant
  int count = 0;
  ValueRange indices;
  for (const Id index : access.indexIds) {
    const ValueRange range = evaluate(in, index, {});
    const std::optional<double> known = range.constant();
    if (!known) unknown = wanted.size(), indices = range, ++count;
    wanted.push_back(known && *known >= 0.0 ? std::optional(static_cast<std::uint32_t>(*known)) : std::nullopt);
  }
  for (const std::uint32_t index : path) wanted.emplace_back(index);
  if (count != 1 || indices.values.empty() || indices.min < 0.0) return storedRange(access, type, wanted);
  ValueRange result = never();
  bool each = indices.occurrence == Occurrence::each;
  for (const double index : indices.values) {
    wanted[unknown] = static_cast<std::uint32_t>(index);
    const ValueRange element = storedRange(access, type, wanted);
    each = each && element.constant();
    result = joined(result, element);
  }
  result.occurrence = each ? Occurrence::each : Occurrence::unknown;
  return fitted(type, std::move(result));
}

// Range of a part of a local variable, from all stores to it.
ValueRange ValueRanges::Impl::storedRange(const Access& access, const Type& type,
                                          const std::vector<std::optional<std::uint32_t>>& wanted) {
  ValueRange result = never();
  std::size_t budget = kMaxElements;
  const auto add = [&](Id value, std::size_t skip) {
    const std::vector<std::optional<std::uint32_t>> rest(wanted.begin() + static_cast<std::ptrdiff_t>(skip),
                                                         wanted.end());
    Path at;
    result = joined(result, partRange(base, value, rest, at, budget, type));
  };
  const Instruction* variable = module.definition(access.base);
  if (variable->operands.size() > 1) add(variable->at(1), 0);
  std::vector<Id> pointers{access.base};
  for (std::size_t next = 0; next < pointers.size(); ++next) {
    if (pointers.size() > 4096) return rangeOf(type);
    for (const std::size_t user : module.users(pointers[next])) {
      const Instruction& use = module.instructions()[user];
      if (isAccessChain(use.op) || use.op == Op::OpCopyObject) {
        pointers.push_back(use.result);
      } else if (use.op == Op::OpStore && use.at(0) == pointers[next]) {
        const Access target = module.access(use.at(0));
        if (target.base != access.base || target.indices.size() > wanted.size()) return rangeOf(type);
        if (overlap(target.indices, wanted)) add(use.at(1), target.indices.size());
      } else if (use.op != Op::OpLoad) {
        return rangeOf(type);
      }
    }
  }
  if (result.empty()) return rangeOf(type);
  const bool one = result.constant().has_value();
  if (!one) result.occurrence = Occurrence::unknown;
  return fitted(type, std::move(result));
}

ValueRange ValueRanges::Impl::loadRange(Evaluator& in, const Instruction& load, const Type& type, const Path& path) {
  const Access access = module.access(load.at(0));
  const Variable* shared = module.variable(access.base);
  if (shared && shared->builtIn) {
    Path component;
    for (const auto& index : access.indices) component.push_back(index.value_or(~0u));
    component.insert(component.end(), path.begin(), path.end());
    const auto known = context.builtIns.find(*shared->builtIn);
    return fitted(type,
                  known != context.builtIns.end() ? known->second : builtInRange(*shared->builtIn, type, component));
  }
  if (shared && shared->storage == spv::StorageClass::HitAttributeKHR && context.hitAttribute)
    return fitted(type, *context.hitAttribute);
  if (isLocal(module, access.base)) return localRange(in, access, type, path);
  if (shared && shared->storage == spv::StorageClass::ShaderRecordBufferKHR)
    if (const auto known = recordRange(access, type, path)) return *known;
  if (const auto member = bufferMember(module, load, path)) {
    const auto known = context.members.find({member->structure, member->member});
    if (known == context.members.end() || known->second.empty()) return rangeOf(type);
    const auto& components = known->second;
    return fitted(type, components[std::min<std::size_t>(member->component, components.size() - 1)]);
  }
  return rangeOf(type);
}

// The value in the shader record; nullopt if it is unknown.
std::optional<ValueRange> ValueRanges::Impl::recordRange(const Access& access, const Type& type, const Path& path) {
  if (context.record.empty() || (!isInteger(type) && !isFloat(type))) return {};
  if (!layout) layout.emplace(module);
  std::vector<std::optional<std::uint32_t>> indices = access.indices;
  indices.insert(indices.end(), path.begin(), path.end());
  const std::optional<std::uint64_t> offset = layout->offsetOf(access.type, indices);
  const std::size_t bytes = type.width / 8;
  if (!offset || *offset > context.record.size() || bytes > context.record.size() - *offset) return {};
  std::uint32_t bits = 0;
  std::memcpy(&bits, context.record.data() + *offset, std::min(bytes, sizeof bits));
  if (isInteger(type)) return fitted(type, ValueRange::of(stored(type, bits)));
  const float number = std::bit_cast<float>(bits);
  return std::isnan(number) ? onlyNan() : ValueRange::of(double{number} + 0.0);
}

void ValueRanges::Impl::addLimit(Evaluator& in, Id value, const Path& path, double min, double max) {
  for (int step = 0; step < 8; ++step) {
    const Key key = canonical(value, path);
    Limits& limits = in.limits[key];
    limits.min = std::max(limits.min, min), limits.max = std::min(limits.max, max);
    // The same bits as the other type of integer.
    const Instruction* definition = module.definition(key.id);
    if (!definition || definition->op != Op::OpBitcast) return;
    const Type& type = typeOf(key.id, key.path);
    const ValueRange known = evaluate(base, key.id, key.path);
    min = std::max(limits.min, known.min), max = std::min(limits.max, known.max);
    if (!isInteger(type) || !isInteger(typeOf(definition->at(0), key.path)) || min < 0.0 || max > 2147483647.0) return;
    value = definition->at(0);
  }
}

void ValueRanges::Impl::addCondition(Evaluator& in, Id condition, bool holds, int nesting) {
  const Instruction* value = module.definition(condition);
  if (!value || nesting > 16) return;
  const std::optional<double> known = evaluate(base, condition, {}).constant();
  if (known && (*known != 0.0) != holds) in.dead = true;
  addLimit(in, condition, {}, holds ? 1.0 : 0.0, holds ? 1.0 : 0.0);
  if (value->op == Op::OpLogicalNot) return addCondition(in, value->at(0), !holds, nesting + 1);
  if ((value->op == Op::OpLogicalAnd && holds) || (value->op == Op::OpLogicalOr && !holds)) {
    addCondition(in, value->at(0), holds, nesting + 1);
    return addCondition(in, value->at(1), holds, nesting + 1);
  }
  const std::optional<Comparison> comparison = comparisonOf(value->op);
  const Type& type = typeOf(value->at(0));
  if (!comparison || (!isInteger(type) && !isFloat(type))) return;
  if (!hasSignOf(*comparison, type)) return;
  // NaN makes ordered comparisons false: if one fails, nothing is known about the operands.
  if (isFloat(type) && holds == comparison->unordered &&
      (evaluate(base, value->at(0), {}).nan || evaluate(base, value->at(1), {}).nan))
    return;
  const Relation relation = holds ? comparison->relation : negated(comparison->relation);
  const double step = isInteger(type) ? 1.0 : 0.0;
  const auto limit = [&](Id a, Id b, Relation r) {
    const ValueRange other = evaluate(base, b, {});
    switch (r) {
      case Relation::equal: return addLimit(in, a, {}, other.min, other.max);
      case Relation::less: return addLimit(in, a, {}, -kInf, other.max - step);
      case Relation::lessOrEqual: return addLimit(in, a, {}, -kInf, other.max);
      case Relation::greater: return addLimit(in, a, {}, other.min + step, kInf);
      case Relation::greaterOrEqual: return addLimit(in, a, {}, other.min, kInf);
      case Relation::notEqual: return;
    }
  };
  limit(value->at(0), value->at(1), relation);
  limit(value->at(1), value->at(0), mirrored(relation));
}

// Adds the condition of the branch from one block to another.
void ValueRanges::Impl::addEdge(Evaluator& in, const Function& function, std::size_t from, std::size_t to) {
  const Instruction& end = module.instructions()[function.blocks[from].end - 1];
  if (end.op == Op::OpBranchConditional && end.at(1) != end.at(2))
    addCondition(in, end.at(0), function.blocks[to].label == end.at(1));
  if (end.op != Op::OpSwitch || end.at(1) == function.blocks[to].label) return;
  double min = kInf, max = -kInf;
  const Type& type = typeOf(end.at(0));
  for (std::size_t i = 2; i + 1 < end.operands.size(); i += 2) {
    if (end.at(i + 1) != function.blocks[to].label) continue;
    const double literal = stored(type, end.at(i));
    min = std::min(min, literal), max = std::max(max, literal);
  }
  if (isInteger(type) && type.width == 32 && min <= max) addLimit(in, end.at(0), {}, min, max);
}

ValueRanges::Impl::Evaluator& ValueRanges::Impl::at(std::size_t f, std::size_t block) {
  const auto [found, isNew] = byBlock.try_emplace({f, block});
  Evaluator& in = found->second;
  if (!isNew) return in;
  in.block = Module::Position{f, block};
  addConditions(in, f, block);
  return in;
}

const ValueRanges::Impl::Evaluator& ValueRanges::Impl::alongEdge(std::size_t f, std::size_t from, std::size_t to) {
  const auto [found, isNew] = byEdge.try_emplace({f, from, to});
  Evaluator& in = found->second;
  if (!isNew) return in;
  addConditions(in, f, from);
  addEdge(in, module.functions()[f], from, to);
  return in;
}

// Adds the conditions of the branches that lead to a block.
void ValueRanges::Impl::addConditions(Evaluator& in, std::size_t f, std::size_t block) {
  const Function& function = module.functions()[f];
  const ControlFlow& dominators = flow(f);
  for (std::size_t b = block; b != kNone; b = dominators.dominator(b)) {
    const auto& predecessors = function.blocks[b].predecessors;
    if (predecessors.size() == 1 && function.blocks[predecessors[0]].successors.size() > 1)
      addEdge(in, function, predecessors[0], b);
  }
}

const std::optional<CountedLoop>& ValueRanges::Impl::countedLoop(Id phi) {
  static const std::optional<CountedLoop> kNoLoop;
  if (const auto found = loops.find(phi); found != loops.end()) return found->second;
  const Instruction* value = module.definition(phi);
  const std::optional<LoopShape> shape = value && value->op == Op::OpPhi ? loopShape(*value) : std::nullopt;
  if (!shape) return loops[phi] = std::nullopt;
  if (!openLoops.insert(phi).second) return kNoLoop;
  // While the loop is searched, its variable counts as unknown. Values that were computed from it then are dropped.
  std::map<Key, ValueRange> memo = base.memo;
  const Key key{phi, {}};
  const bool opened = base.open.insert(key).second;
  std::optional<CountedLoop> result = findLoop(phi, *shape);
  if (opened) base.open.erase(key);
  base.memo = std::move(memo);
  openLoops.erase(phi);
  return loops[phi] = std::move(result);
}

std::optional<LoopShape> ValueRanges::Impl::loopShape(const Instruction& phi) {
  const auto position = module.position(module.definitionIndex(phi.result));
  if (!position || !isInteger(typeOf(phi.result)) || phi.operands.size() != 4) return {};
  const Function& function = module.functions()[position->function];
  const ControlFlow& dominators = flow(position->function);
  LoopShape shape{position->function, position->block};
  std::size_t entry = kNone;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto from = std::ranges::find(function.blocks, phi.at(2 * i + 1), &Block::label);
    const auto block = static_cast<std::size_t>(from - function.blocks.begin());
    if (from != function.blocks.end() && dominators.dominates(shape.header, block)) shape.latch = block, entry = 1 - i;
  }
  if (entry == kNone || function.blocks[shape.header].predecessors.size() != 2) return {};
  shape.first = phi.at(2 * entry);
  shape.next = canonical(phi.at(2 * (1 - entry)), {});
  const Key phiKey{phi.result, {}};
  const Instruction* advance = module.definition(shape.next.id);
  if (!advance || (advance->op != Op::OpIAdd && advance->op != Op::OpISub)) return {};
  shape.subtracts = advance->op == Op::OpISub;
  const bool swapped = !shape.subtracts && canonical(advance->at(1), {}) == phiKey;
  if (!swapped && canonical(advance->at(0), {}) != phiKey) return {};
  shape.by = advance->at(swapped ? 0 : 1);
  return shape;
}

std::optional<CountedLoop> ValueRanges::Impl::findLoop(Id phi, const LoopShape& shape) {
  const Type type = typeOf(phi);
  const Function& function = module.functions()[shape.function];
  const ControlFlow& dominators = flow(shape.function);
  const Key phiKey{phi, {}};
  CountedLoop loop;
  loop.function = shape.function, loop.header = shape.header, loop.latch = shape.latch;
  const std::optional<double> by = evaluate(base, shape.by, {}).constant();
  if (!by || *by == 0.0) return {};
  double step = shape.subtracts ? -*by : *by;
  if (!type.isSigned && std::abs(step) > highest(type) / 2)  // + 0xFFFFFFFF
    step -= std::copysign(highest(type) + 1.0, step);
  if (std::abs(step) > kMaxStep) return {};
  const ValueRange first = evaluate(base, shape.first, {});
  if (first.empty()) return {};

  // The conditions that hold when the loop continues.
  Evaluator continues;
  addConditions(continues, loop.function, loop.latch);
  addEdge(continues, function, loop.latch, loop.header);
  const auto limitsOf = [&](const Key& key) {
    const auto found = continues.limits.find(key);
    return found == continues.limits.end() ? Limits{} : found->second;
  };
  const Limits ofPhi = limitsOf(phiKey), ofNext = limitsOf(shape.next);
  double end = 0.0;  // the farthest value of `next` that returns to the header
  if (step > 0.0) {
    end = std::min(ofPhi.max + step, ofNext.max);
    if (std::max(first.max, end) + step > highest(type) && ofPhi.max + step > highest(type)) return {};
    loop.values = ValueRange::between(first.min, std::max(first.max, end));
  } else {
    end = std::max(ofPhi.min + step, ofNext.min);
    if (std::min(first.min, end) + step < lowest(type) && ofPhi.min + step < lowest(type)) return {};
    loop.values = ValueRange::between(std::min(first.min, end), first.max);
  }

  // Natural loop: the blocks that reach the latch without the header.
  loop.blocks.assign(function.blocks.size(), false);
  loop.blocks[loop.header] = true;
  std::vector<std::size_t> open{loop.latch};
  while (!open.empty()) {
    const std::size_t block = open.back();
    open.pop_back();
    if (loop.blocks[block]) continue;
    loop.blocks[block] = true;
    for (const std::size_t p : function.blocks[block].predecessors)
      if (dominators.reachable(p)) open.push_back(p);
  }
  loop.inside = loop.values;
  // With a condition in the header, the values in the body are known exactly.
  const auto& exits = function.blocks[loop.header].successors;
  const auto isIn = [&](std::size_t b) { return loop.blocks[b] && b != loop.header; };
  const std::optional<double> start = first.constant();
  if (loop.latch == loop.header || exits.size() != 2 || isIn(exits[0]) == isIn(exits[1]) || !start) return loop;
  Evaluator body;
  addEdge(body, function, loop.header, isIn(exits[0]) ? exits[0] : exits[1]);
  const auto found = body.limits.find(phiKey);
  const Instruction* condition = module.definition(dominators.condition(loop.header));
  if (found == body.limits.end() || !condition) return loop;
  const bool phiFirst = canonical(condition->at(0), {}) == phiKey;
  const bool exact = comparisonOf(condition->op) &&
                     evaluate(base, phiFirst ? condition->at(1) : condition->at(0), {}).constant().has_value();
  const double limit = step > 0.0 ? found->second.max : found->second.min;
  if (!exact || std::isinf(limit)) return loop;
  const double count = std::floor((limit - *start) / step);
  if (count < 0.0 || count > 1e9) return loop;
  const double last = *start + count * step;
  loop.inside = ValueRange::between(std::min(*start, last), std::max(*start, last), Occurrence::each);
  if (count < static_cast<double>(ValueRange::kMaxValues)) {
    for (double k = 0.0; k <= count; ++k) loop.inside.values.push_back(*start + k * step);
    std::ranges::sort(loop.inside.values);
  }
  loop.inside = fitted(type, loop.inside);
  loop.complete = true;
  for (std::size_t b = 0; b < function.blocks.size(); ++b)
    if (isIn(b))
      for (const std::size_t successor : function.blocks[b].successors)
        loop.complete = loop.complete && loop.blocks[successor];
  return loop;
}

ValueRanges::ValueRanges(const Module& module, ValueContext context)
    : impl_(std::make_unique<Impl>(module, std::move(context))) {}
ValueRanges::~ValueRanges() = default;
ValueRanges::ValueRanges(ValueRanges&&) noexcept = default;
ValueRanges& ValueRanges::operator=(ValueRanges&&) noexcept = default;

ValueRange ValueRanges::range(Id value, const Path& path) const { return impl_->evaluate(impl_->base, value, path); }

ValueRange ValueRanges::rangeAt(std::size_t instruction, Id value, const Path& path) const {
  const auto position = impl_->module.position(instruction);
  if (!position) return range(value, path);
  Impl::Evaluator& in = impl_->at(position->function, position->block);
  return in.dead ? never() : impl_->evaluate(in, value, path);
}

bool ValueRanges::guarded(std::size_t instruction, Id value) const {
  const Module& module = impl_->module;
  const auto position = module.position(instruction);
  if (!position) return true;
  const InstructionTest isSource = sourcesOf(module, value);
  if (!isSource) return false;
  const ControlFlow& flow = impl_->flow(position->function);
  const auto& blocks = flow.function().blocks;
  const auto from = [&](std::size_t start, std::size_t without) {
    std::vector<bool> seen(blocks.size(), false);
    std::vector<std::size_t> open{start};
    while (!open.empty()) {
      const std::size_t block = open.back();
      open.pop_back();
      if (block == without || seen[block]) continue;
      seen[block] = true;
      open.insert(open.end(), blocks[block].successors.begin(), blocks[block].successors.end());
    }
    return seen;
  };
  const auto isCountedHeader = [&](std::size_t block) {
    return dependsOn(module, value, [&](const Instruction& i) {
      const auto& loop = impl_->countedLoop(i.op == Op::OpPhi ? i.result : 0);
      return loop && loop->function == position->function && loop->header == block && loop->complete;
    });
  };
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Id condition = flow.condition(b);
    if (b == position->block || condition == 0 || !flow.reachable(b)) continue;
    bool leads = false, avoids = false;
    for (const std::size_t successor : blocks[b].successors) {
      leads = leads || from(successor, b)[position->block];
      const std::vector<bool> around = from(successor, position->block);
      for (std::size_t end = 0; end < blocks.size(); ++end)
        avoids = avoids || (around[end] && (blocks[end].successors.empty() || end == b));
    }
    if (!leads || !avoids || isCountedHeader(b)) continue;
    if (dependsOnDataOrControl(module, flow, condition, isSource)) return true;
  }
  return false;
}

}  // namespace quintet::spirv
