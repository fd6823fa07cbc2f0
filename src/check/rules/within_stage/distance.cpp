// SPDX-License-Identifier: Apache-2.0
// Q701: an intersection shader reports a t that does not depend on the length of the ray direction, because the
// direction was normalized.
//
// The rule computes degrees: by which power of s a value changes if the ray direction is scaled by s. A position on the
// ray has degree 0, the direction has degree 1, and a t in units of the direction's length has degree -1. A reported t
// of degree 0 is a distance.
#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "check/rules/rules.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::Op;

// The degrees that a value can have, one per path. Empty for a constant, which takes the degree of any value that is
// added to it.
struct RayDegree {
  bool unknown = false;        // not a power of s, or it cannot be followed
  std::vector<double> values;  // sorted

  bool constant() const { return !unknown && values.empty(); }
  bool is(double degree) const { return !unknown && values.size() == 1 && values.front() == degree; }
  bool mayBe(double degree) const { return !unknown && std::ranges::find(values, degree) != values.end(); }
  bool operator==(const RayDegree&) const = default;
};

constexpr std::size_t kMaxDegrees = 6;
constexpr int kMaxUnitRounds = 24;        // of the fixed-point iteration
constexpr std::size_t kMaxBranches = 16;  // for alternatives()

const RayDegree kUnknown{true, {}};
const RayDegree kConstant{};
const RayDegree kZero{false, {0.0}};

RayDegree make(std::vector<double> values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values.size() > kMaxDegrees ? kUnknown : RayDegree{false, std::move(values)};
}

// The degree of a choice between two values: phi, select, min, components of a vector.
RayDegree either(const RayDegree& a, const RayDegree& b) {
  if (a.unknown || b.unknown) return kUnknown;
  std::vector<double> values = a.values;
  values.insert(values.end(), b.values.begin(), b.values.end());
  return make(std::move(values));
}

// A sum has a degree only if both operands have the same degree.
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

// The degree of any other function: known only if the argument does not depend on the length of the direction.
RayDegree onlyZero(const RayDegree& a) { return a.constant() || a.is(0.0) ? a : kUnknown; }

spirv::Id labelOf(const spirv::Module& module, const spirv::Instruction& phi) {
  const auto at = module.position(module.definitionIndex(phi.result));
  return at ? module.functions()[at->function].blocks[at->block].label : 0;
}

class RayDegrees {
 public:
  explicit RayDegrees(const spirv::Module& module) : module_(module) {}

  // Evaluates the degree of a value.
  RayDegree of(spirv::Id value);
  // Evaluates the degree separately for each side of each branch on the way, for a value that is computed in one of
  // several ways whose degrees would otherwise mix. While `visit` runs, met() refers to that side.
  void alternatives(spirv::Id value, const std::function<void(const RayDegree&)>& visit);
  // Degree of a value that the last evaluation passed.
  RayDegree met(spirv::Id value) const;

 private:
  std::vector<std::size_t> slice(std::size_t start) const;
  RayDegree evaluate(const spirv::Instruction& instruction) const;
  RayDegree evaluateExtended(const spirv::Instruction& instruction) const;
  RayDegree evaluateLoad(const spirv::Instruction& instruction) const;
  std::vector<spirv::Id> sources(const spirv::Instruction& instruction) const;

  // The operand of a phi or select that choice_ selects; nullopt if it selects none.
  std::optional<spirv::Id> chosen(const spirv::Instruction& instruction) const;

  const spirv::Module& module_;
  // Selects one side for the phis in a block or for the selects with a condition.
  struct Choice {
    spirv::Id key = 0;  // label of the block, or the condition; 0 disables the choice
    std::size_t side = 0;
  } choice_;
  std::unordered_map<spirv::Id, RayDegree> degrees_;
};

RayDegree RayDegrees::met(spirv::Id value) const {
  if (module_.isConstant(value)) return kConstant;
  const auto found = degrees_.find(value);
  return found == degrees_.end() ? kUnknown : found->second;
}

std::optional<spirv::Id> RayDegrees::chosen(const spirv::Instruction& instruction) const {
  if (choice_.key == 0) return {};
  if (instruction.op == Op::OpSelect && instruction.at(0) == choice_.key) return instruction.at(1 + choice_.side);
  if (instruction.op == Op::OpPhi && labelOf(module_, instruction) == choice_.key)
    return instruction.at(2 * choice_.side);
  return {};
}

std::vector<spirv::Id> RayDegrees::sources(const spirv::Instruction& instruction) const {
  if (const auto only = chosen(instruction)) return {*only};
  if (instruction.op == Op::OpLoad) {
    if (!spirv::isLocal(module_, module_.access(instruction.at(0)).variable)) return {};
    return spirv::storedValues(module_, instruction).value_or(std::vector<spirv::Id>{});
  }
  return spirv::valueOperands(instruction);
}

std::vector<std::size_t> RayDegrees::slice(std::size_t start) const {
  std::vector<std::size_t> result, open{start};
  std::unordered_set<std::size_t> seen{start};
  while (!open.empty()) {
    const std::size_t next = open.back();
    open.pop_back();
    result.push_back(next);
    for (const spirv::Id id : sources(module_.instructions()[next])) {
      const std::size_t index = module_.definitionIndex(id);
      if (index != spirv::Module::kNone && !module_.isConstant(id) && seen.insert(index).second) open.push_back(index);
    }
  }
  std::ranges::sort(result);
  return result;
}

void RayDegrees::alternatives(spirv::Id value, const std::function<void(const RayDegree&)>& visit) {
  const std::size_t start = module_.definitionIndex(value);
  if (start == spirv::Module::kNone) return;
  std::map<spirv::Id, std::size_t> sides;  // key of a choice -> number of sides
  for (const std::size_t i : slice(start)) {
    const spirv::Instruction& instruction = module_.instructions()[i];
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

RayDegree RayDegrees::of(spirv::Id value) {
  if (module_.isConstant(value)) return kConstant;
  const std::size_t start = module_.definitionIndex(value);
  if (start == spirv::Module::kNone) return kUnknown;
  // Fixed-point iteration that starts with "constant": values in a loop converge in a few rounds or are unknown.
  const std::vector<std::size_t> order = slice(start);
  degrees_.clear();
  for (const std::size_t i : order) degrees_[module_.instructions()[i].result] = kConstant;
  for (int round = 0; round < kMaxUnitRounds; ++round) {
    bool changed = false;
    for (const std::size_t i : order) {
      const spirv::Instruction& instruction = module_.instructions()[i];
      RayDegree degree = evaluate(instruction);
      RayDegree& old = degrees_[instruction.result];
      changed = changed || !(degree == old);
      old = std::move(degree);
    }
    if (!changed) return degrees_[value];
  }
  return kUnknown;
}

RayDegree RayDegrees::evaluateLoad(const spirv::Instruction& instruction) const {
  const auto builtIn = spirv::loadedBuiltIn(module_, instruction);
  if (builtIn == spv::BuiltIn::ObjectRayDirectionKHR || builtIn == spv::BuiltIn::WorldRayDirectionKHR)
    return {false, {1.0}};
  if (builtIn == spv::BuiltIn::RayTminKHR || builtIn == spv::BuiltIn::RayTmaxKHR) return {false, {-1.0}};
  if (!spirv::isLocal(module_, module_.access(instruction.at(0)).variable)) return kZero;
  const auto stored = spirv::storedValues(module_, instruction);
  if (!stored) return kUnknown;
  RayDegree result = kConstant;
  for (const spirv::Id value : *stored) result = either(result, met(value));
  return result;
}

RayDegree RayDegrees::evaluate(const spirv::Instruction& instruction) const {
  const auto operand = [&](std::size_t i) { return met(instruction.at(i)); };
  const auto allOf = [&](auto&& combine, RayDegree result) {
    for (const spirv::Id id : spirv::valueOperands(instruction)) result = combine(result, met(id));
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
      const spirv::Instruction* whole = module_.definition(instruction.at(0));
      const bool direct = whole && whole->op == Op::OpCompositeConstruct &&
                          instruction.at(1) < whole->operands.size() &&
                          whole->operands.size() == module_.types().get(whole->type).count;
      return direct ? met(whole->at(instruction.at(1))) : operand(0);
    }
    case Op::OpCompositeConstruct:
    case Op::OpVectorShuffle:
    case Op::OpCompositeInsert: return allOf(either, kConstant);
    case Op::OpPhi: {
      const auto only = chosen(instruction);
      return only ? met(*only) : allOf(either, kConstant);
    }
    case Op::OpSelect: {
      const auto only = chosen(instruction);
      return only ? met(*only) : either(operand(1), operand(2));
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

RayDegree RayDegrees::evaluateExtended(const spirv::Instruction& instruction) const {
  const auto operand = [&](std::size_t i) { return met(instruction.at(2 + i)); };
  switch (instruction.at(1)) {
    case GLSLstd450FAbs:
    case GLSLstd450Length:
    case GLSLstd450Reflect: return operand(0);
    case GLSLstd450FaceForward: return operand(0);
    case GLSLstd450FSign:
    case GLSLstd450Step:
    case GLSLstd450SmoothStep:
    case GLSLstd450Normalize: return operand(0).constant() ? kConstant : kZero;
    case GLSLstd450Sqrt: return power(operand(0), 0.5);
    case GLSLstd450InverseSqrt: return power(operand(0), -0.5);
    case GLSLstd450Pow: {
      const auto exponent = module_.constantFloat(instruction.at(3));
      return exponent ? power(operand(0), *exponent) : onlyZero(either(operand(0), operand(1)));
    }
    case GLSLstd450FMin:
    case GLSLstd450FMax:
    case GLSLstd450NMin:
    case GLSLstd450NMax:
    case GLSLstd450FMix: return either(operand(0), operand(1));
    case GLSLstd450FClamp:
    case GLSLstd450NClamp: return either(either(operand(0), operand(1)), operand(2));
    case GLSLstd450Distance: return sum(operand(0), operand(1));
    case GLSLstd450Cross: return product(operand(0), operand(1));
    case GLSLstd450Fma: return sum(product(operand(0), operand(1)), operand(2));
    default: {
      RayDegree result = kConstant;
      for (const spirv::Id id : spirv::valueOperands(instruction)) result = either(result, onlyZero(met(id)));
      return result;
    }
  }
}

// True for normalize(d), length(d) and inversesqrt(dot(d, d)) of a value that depends on the object-space direction.
bool takesLength(const spirv::Module& module, const spirv::Instruction& instruction, const RayDegrees& degrees) {
  if (!spirv::isExtended(module, instruction, GLSLstd450Normalize) &&
      !spirv::isExtended(module, instruction, GLSLstd450Length) &&
      !spirv::isExtended(module, instruction, GLSLstd450InverseSqrt))
    return false;
  const spirv::Id argument = instruction.at(2);
  const RayDegree degree = degrees.met(argument);
  if (degree.unknown || degree.constant() || degree.is(0.0)) return false;
  return spirv::dependsOn(module, argument, [&](const spirv::Instruction& i) {
    return spirv::loadsBuiltIn(module, i, spv::BuiltIn::ObjectRayDirectionKHR);
  });
}

// Returns the instruction that makes `t` a distance according to the degrees of the last evaluation, or null.
const spirv::Instruction* causeOf(const spirv::Module& module, spirv::Id t, const RayDegree& degree,
                                  const RayDegrees& degrees) {
  if (!degree.mayBe(0.0)) return nullptr;
  const auto find = [&](std::uint32_t number) {
    return spirv::findInSlice(module, t, [&](const spirv::Instruction& i) {
      return (number == 0 || spirv::isExtended(module, i, number)) && takesLength(module, i, degrees);
    });
  };
  const spirv::Instruction* cause = find(GLSLstd450Normalize);
  // A length counts only if t is a distance on all paths.
  return cause || !degree.is(0.0) ? cause : find(0);
}

}  // namespace

void checkDistance(const spirv::Module& module, Report& report) {
  RayDegrees degrees(module);
  for (const spirv::Instruction& instruction : module.instructions()) {
    if (instruction.op != Op::OpReportIntersectionKHR) continue;
    const spirv::Id t = instruction.at(0);
    const RayDegree degree = degrees.of(t);
    const spirv::Instruction* cause = causeOf(module, t, degree, degrees);
    if (degree.unknown)
      degrees.alternatives(t, [&](const RayDegree& side) {
        if (!cause && side.is(0.0)) cause = causeOf(module, t, side, degrees);
      });
    if (!cause) continue;
    const std::string_view token = spirv::isExtended(module, *cause, GLSLstd450Normalize) ? "normalize"
                                   : spirv::isExtended(module, *cause, GLSLstd450Length)  ? "length"
                                                                                          : "inversesqrt";
    report.addOncePerLine(
        "Q701", module.location(*cause, token),
        "the reported t is computed with the normalized gl_ObjectRayDirectionEXT, so it is a distance "
        "in object space and wrong in scaled instances");
  }
}

}  // namespace quintet::check
