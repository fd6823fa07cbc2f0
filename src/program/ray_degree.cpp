#include "program/ray_degree.h"

#include <algorithm>
#include <map>
#include <unordered_set>

#include "program/check_shader_rules.h"
#include "program/stored_values.h"

namespace quintet::program {
namespace {

using shader::SpirvId;
using shader::SpirvInstruction;
using shader::SpirvModule;
using spv::Op;

constexpr std::size_t kMaxDegrees = 6;
constexpr int kMaxRounds = 24;
constexpr std::size_t kMaxBranches = 16;  // of which alternatives are tried

const RayDegree kUnknown{true, {}};
const RayDegree kConstant{};
const RayDegree kZero{false, {0.0}};

RayDegree make(std::vector<double> values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values.size() > kMaxDegrees ? kUnknown : RayDegree{false, std::move(values)};
}

// One or the other: phi, select, min, the members of a vector.
RayDegree either(const RayDegree& a, const RayDegree& b) {
  if (a.unknown || b.unknown) return kUnknown;
  std::vector<double> values = a.values;
  values.insert(values.end(), b.values.begin(), b.values.end());
  return make(std::move(values));
}

// A sum has a degree only if both sides have the same.
RayDegree sum(const RayDegree& a, const RayDegree& b) {
  if (a.unknown || b.unknown) return kUnknown;
  if (a.constant()) return b;
  return b.constant() || a == b ? a : kUnknown;
}

RayDegree product(const RayDegree& a, const RayDegree& b, double sign = 1.0) {
  if (a.unknown || b.unknown) return kUnknown;
  if (a.constant() && b.constant()) return kConstant;
  std::vector<double> values;
  for (const double x : a.constant() ? kZero.values : a.values)
    for (const double y : b.constant() ? kZero.values : b.values) values.push_back(x + sign * y);
  return make(std::move(values));
}

RayDegree power(const RayDegree& a, double exponent) {
  if (a.unknown || a.constant()) return a;
  std::vector<double> values;
  for (const double x : a.values) values.push_back(x * exponent);
  return make(std::move(values));
}

// Of any other function: fine for what does not depend on the direction's length.
RayDegree onlyZero(const RayDegree& a) { return a.constant() || a.is(0.0) ? a : kUnknown; }

SpirvId labelOf(const SpirvModule& module, const SpirvInstruction& phi) {
  const auto at = module.position(module.definitionIndex(phi.result));
  return at ? module.functions()[at->function].blocks[at->block].label : 0;
}

}  // namespace

bool RayDegree::may(double degree) const { return !unknown && std::ranges::find(values, degree) != values.end(); }

RayDegree RayDegrees::get(SpirvId value) const {
  if (module_.isConstant(value)) return kConstant;
  const auto found = degrees_.find(value);
  return found == degrees_.end() ? kUnknown : found->second;
}

std::optional<SpirvId> RayDegrees::chosen(const SpirvInstruction& instruction) const {
  if (choice_.key == 0) return {};
  if (instruction.op == Op::OpSelect && instruction.at(0) == choice_.key) return instruction.at(1 + choice_.side);
  if (instruction.op == Op::OpPhi && labelOf(module_, instruction) == choice_.key)
    return instruction.at(2 * choice_.side);
  return {};
}

std::vector<SpirvId> RayDegrees::sources(const SpirvInstruction& instruction) const {
  if (const auto only = chosen(instruction)) return {*only};
  if (instruction.op == Op::OpLoad) {
    if (!isLocal(module_, module_.access(instruction.at(0)).variable)) return {};
    return storedValues(module_, instruction).value_or(std::vector<SpirvId>{});
  }
  return valueOperands(instruction);
}

std::vector<std::size_t> RayDegrees::slice(std::size_t start) const {
  std::vector<std::size_t> result, open{start};
  std::unordered_set<std::size_t> seen{start};
  while (!open.empty()) {
    const std::size_t next = open.back();
    open.pop_back();
    result.push_back(next);
    for (const SpirvId id : sources(module_.instructions()[next])) {
      const std::size_t index = module_.definitionIndex(id);
      if (index != SpirvModule::kNone && !module_.isConstant(id) && seen.insert(index).second) open.push_back(index);
    }
  }
  std::ranges::sort(result);
  return result;
}

void RayDegrees::alternatives(SpirvId value, const std::function<void(const RayDegree&)>& visit) {
  const std::size_t start = module_.definitionIndex(value);
  if (start == SpirvModule::kNone) return;
  std::map<SpirvId, std::size_t> sides;  // key of a choice -> sides
  for (const std::size_t i : slice(start)) {
    const SpirvInstruction& instruction = module_.instructions()[i];
    if (instruction.op == Op::OpSelect) sides[instruction.at(0)] = 2;
    if (instruction.op == Op::OpPhi) sides[labelOf(module_, instruction)] = instruction.operands.size() / 2;
  }
  if (sides.size() > kMaxBranches) return;
  for (const auto& [key, count] : sides) {
    for (std::size_t side = 0; side < count; ++side) {
      choice_ = {key, side};
      visit(of(value));
    }
  }
  choice_ = {};
}

RayDegree RayDegrees::of(SpirvId value) {
  if (module_.isConstant(value)) return kConstant;
  const std::size_t start = module_.definitionIndex(value);
  if (start == SpirvModule::kNone) return kUnknown;
  // A fixed point, from "constant" upwards: what a loop carries settles after a few rounds, or is unknown.
  const std::vector<std::size_t> order = slice(start);
  degrees_.clear();
  for (const std::size_t i : order) degrees_[module_.instructions()[i].result] = kConstant;
  for (int round = 0; round < kMaxRounds; ++round) {
    bool changed = false;
    for (const std::size_t i : order) {
      const SpirvInstruction& instruction = module_.instructions()[i];
      RayDegree degree = evaluate(instruction);
      RayDegree& old = degrees_[instruction.result];
      changed = changed || !(degree == old);
      old = std::move(degree);
    }
    if (!changed) return degrees_[value];
  }
  return kUnknown;
}

RayDegree RayDegrees::evaluateLoad(const SpirvInstruction& instruction) const {
  const auto builtIn = loadedBuiltIn(module_, instruction);
  if (builtIn == spv::BuiltIn::ObjectRayDirectionKHR || builtIn == spv::BuiltIn::WorldRayDirectionKHR)
    return {false, {1.0}};
  if (builtIn == spv::BuiltIn::RayTminKHR || builtIn == spv::BuiltIn::RayTmaxKHR) return {false, {-1.0}};
  if (!isLocal(module_, module_.access(instruction.at(0)).variable)) return kZero;
  const auto stored = storedValues(module_, instruction);
  if (!stored) return kUnknown;
  RayDegree result = kConstant;
  for (const SpirvId value : *stored) result = either(result, get(value));
  return result;
}

RayDegree RayDegrees::evaluate(const SpirvInstruction& instruction) const {
  const auto operand = [&](std::size_t i) { return get(instruction.at(i)); };
  const auto allOf = [&](auto&& combine, RayDegree result) {
    for (const SpirvId id : valueOperands(instruction)) result = combine(result, get(id));
    return result;
  };
  switch (instruction.op) {
    case Op::OpLoad: return evaluateLoad(instruction);
    case Op::OpExtInst:
      return module_.extendedSet(instruction.at(0)) == "GLSL.std.450" ? evaluateExtended(instruction) : kUnknown;
    case Op::OpFNegate:
    case Op::OpCopyObject:
    case Op::OpTranspose:
    case Op::OpVectorExtractDynamic: return operand(0);
    case Op::OpCompositeExtract: {
      const SpirvInstruction* whole = module_.definition(instruction.at(0));
      const bool direct = whole && whole->op == Op::OpCompositeConstruct &&
                          instruction.at(1) < whole->operands.size() &&
                          whole->operands.size() == module_.types().get(whole->type).count;
      return direct ? get(whole->at(instruction.at(1))) : operand(0);
    }
    case Op::OpCompositeConstruct:
    case Op::OpVectorShuffle:
    case Op::OpCompositeInsert: return allOf(either, kConstant);
    case Op::OpPhi: {
      const auto only = chosen(instruction);
      return only ? get(*only) : allOf(either, kConstant);
    }
    case Op::OpSelect: {
      const auto only = chosen(instruction);
      return only ? get(*only) : either(operand(1), operand(2));
    }
    case Op::OpFAdd:
    case Op::OpFSub: return sum(operand(0), operand(1));
    case Op::OpFMul:
    case Op::OpVectorTimesScalar:
    case Op::OpMatrixTimesScalar:
    case Op::OpVectorTimesMatrix:
    case Op::OpMatrixTimesVector:
    case Op::OpMatrixTimesMatrix:
    case Op::OpOuterProduct:
    case Op::OpDot: return product(operand(0), operand(1));
    case Op::OpFDiv: return product(operand(0), operand(1), -1.0);
    case Op::OpFunctionCall:
    case Op::OpFunctionParameter: return kUnknown;
    default: return allOf([](const RayDegree& a, const RayDegree& b) { return either(a, onlyZero(b)); }, kConstant);
  }
}

RayDegree RayDegrees::evaluateExtended(const SpirvInstruction& instruction) const {
  using namespace glsl450;
  const auto operand = [&](std::size_t i) { return get(instruction.at(2 + i)); };
  switch (instruction.at(1)) {
    case kFAbs:
    case kLength:
    case kReflect: return operand(0);
    case kFaceForward: return operand(0);
    case kFSign:
    case kStep:
    case kSmoothStep:
    case kNormalize: return operand(0).constant() ? kConstant : kZero;
    case kSqrt: return power(operand(0), 0.5);
    case kInverseSqrt: return power(operand(0), -0.5);
    case kPow: {
      const auto exponent = module_.constantFloat(instruction.at(3));
      return exponent ? power(operand(0), *exponent) : onlyZero(either(operand(0), operand(1)));
    }
    case kFMin:
    case kFMax:
    case kNMin:
    case kNMax:
    case kFMix: return either(operand(0), operand(1));
    case kFClamp:
    case kNClamp: return either(either(operand(0), operand(1)), operand(2));
    case kDistance: return sum(operand(0), operand(1));
    case kCross: return product(operand(0), operand(1));
    case kFma: return sum(product(operand(0), operand(1)), operand(2));
    default: {
      RayDegree result = kConstant;
      for (const SpirvId id : valueOperands(instruction)) result = either(result, onlyZero(get(id)));
      return result;
    }
  }
}

}  // namespace quintet::program
