// SPDX-License-Identifier: Apache-2.0
// Q717: a hit position that is computed with a direction of a different length than that of the ray.
//
// The unit of t is the length of the ray direction. So origin + t * normalize(d) is wrong if the ray has the direction d,
// and origin + t * d is wrong if the ray has the direction normalize(d), unless d is a unit vector. The rule reports only
// directions that are certainly none, such as vec3(x, y, -2.0) or the difference of two points.
#include <fmt/format.h>
#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "check/rules/rules.h"
#include "check/rules/user_location.h"
#include "spirv/same_value.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;

constexpr int kMaxPositionDepth = 12;
constexpr double kUnitTolerance = 1e-3;
constexpr double kOffset = 0.1;  // of a factor of t that only moves the position off the surface

const spirv::Type& typeOf(const spirv::Module& module, Id value) {
  const spirv::Instruction* definition = module.definition(value);
  return module.types().get(definition ? definition->type : 0);
}

// True if the value is the length of v, or with `inverse` 1 / length(v). A vector of equal components counts.
bool isLengthOf(const spirv::Module& module, Id value, Id v, bool inverse) {
  const spirv::Instruction* i = module.definition(value);
  if (!i) return false;
  if (i->op == Op::OpCompositeConstruct && std::ranges::all_of(i->operands, [&](Id id) { return id == i->at(0); }))
    return isLengthOf(module, i->at(0), v, inverse);
  if (inverse && i->op == Op::OpFDiv) return isLengthOf(module, i->at(1), v, false);
  if (!inverse && spirv::isExtended(module, *i, GLSLstd450Length)) return spirv::sameValue(module, i->at(2), v);
  if (!spirv::isExtended(module, *i, inverse ? GLSLstd450InverseSqrt : GLSLstd450Sqrt)) return false;
  const spirv::Instruction* square = module.definition(i->at(2));
  return square && square->op == Op::OpDot && square->at(0) == square->at(1) &&
         spirv::sameValue(module, square->at(0), v);
}

// Returns v if the value is normalize(v), v / length(v) or v * inversesqrt(dot(v, v)), else 0.
Id normalizedOf(const spirv::Module& module, Id value) {
  const spirv::Instruction* i = module.definition(value);
  if (!i) return 0;
  if (spirv::isExtended(module, *i, GLSLstd450Normalize)) return i->at(2);
  if (i->op == Op::OpVectorTimesScalar && isLengthOf(module, i->at(1), i->at(0), true)) return i->at(0);
  if (i->op == Op::OpFDiv && isLengthOf(module, i->at(1), i->at(0), false)) return i->at(0);
  return 0;
}

// A direction that is certainly not a unit vector, at least on one path.
class Lengths {
 public:
  // `origin`: that of the ray.
  Lengths(const spirv::Module& module, Id origin) : module_(module), origin_(origin) {}

  bool differs(Id direction, int depth = 0) const {
    const spirv::Instruction* i = module_.definition(direction);
    if (!i || depth > kMaxPositionDepth) return false;
    const auto operand = [&](std::size_t k) { return differs(i->at(k), depth + 1); };
    switch (i->op) {
      case Op::OpPhi:
        for (std::size_t k = 0; k < i->operands.size(); k += 2)
          if (i->at(k) != direction && differs(i->at(k), depth + 4)) return true;
        return false;
      case Op::OpSelect: return operand(1) || operand(2);
      case Op::OpCopyObject:
      case Op::OpFNegate: return operand(0);
      case Op::OpMatrixTimesVector: return operand(1);
      case Op::OpConstantComposite: return std::abs(lengthOf(*i).value_or(1.0) - 1.0) > kUnitTolerance;
      case Op::OpCompositeConstruct: return hasLargeComponent(*i);
      case Op::OpVectorTimesScalar: {
        const auto scale = module_.constantFloat(i->at(1));
        return scale && std::abs(std::abs(*scale) - 1.0) > kUnitTolerance && isUnit(i->at(0));
      }
      case Op::OpFSub: return spirv::sameValue(module_, i->at(1), origin_) || isImagePlane(*i);
      case Op::OpFAdd: return isSumOfUnits(*i) || isImagePlane(*i);
      default: return false;
    }
  }

 private:
  bool isUnit(Id value) const { return normalizedOf(module_, value) != 0; }

  // The length of a constant vector.
  std::optional<double> lengthOf(const spirv::Instruction& vector) const {
    double square = 0.0;
    if (vector.op != Op::OpConstantComposite) return {};
    for (const Id id : vector.operands) {
      const auto component = module_.constantFloat(id);
      if (!component) return {};
      square += *component * *component;
    }
    return std::sqrt(square);
  }

  // vec3(x, y, -1.0): only the center of the image has length 1.
  bool hasLargeComponent(const spirv::Instruction& vector) const {
    bool large = false, varies = false;
    for (const Id id : vector.operands) {
      const auto component = module_.constantFloat(id);
      large = large || (component && std::abs(*component) >= 1.0);
      varies = varies || !module_.isConstant(id);
    }
    return large && varies;
  }

  // normal + randomUnit()
  bool isSumOfUnits(const spirv::Instruction& sum) const {
    const auto isConstructed = [&](Id id) {
      const spirv::Instruction* i = module_.definition(id);
      return i && i->op == Op::OpCompositeConstruct;
    };
    return (isUnit(sum.at(0)) && (isUnit(sum.at(1)) || isConstructed(sum.at(1)))) ||
           (isUnit(sum.at(1)) && isConstructed(sum.at(0)));
  }

  // forward + x * right + y * up with coordinates of the image: a term without a factor and one that varies.
  bool isImagePlane(const spirv::Instruction& sum) const {
    bool plain = false, scaled = false;
    addTerms(sum, plain, scaled, 0);
    return plain && scaled;
  }

  void addTerms(const spirv::Instruction& term, bool& plain, bool& scaled, int depth) const {
    if ((term.op == Op::OpFAdd || term.op == Op::OpFSub) && depth < kMaxPositionDepth) {
      for (const std::size_t k : {0u, 1u})
        if (const spirv::Instruction* part = module_.definition(term.at(k))) addTerms(*part, plain, scaled, depth + 1);
    } else if (term.op == Op::OpVectorTimesScalar) {
      const auto factor = module_.constantFloat(term.at(1));
      plain = plain || (factor && std::abs(*factor) >= 1.0);
      scaled = scaled || isImageCoordinate(term.at(1));
    } else {
      plain = plain || isUnit(term.result) || lengthOf(term).value_or(0.0) >= 1.0 - kUnitTolerance;
    }
  }

  bool isImageCoordinate(Id value) const {
    const auto loadsId = [&](const spirv::Instruction& i) {
      return spirv::loadsBuiltIn(module_, i, spv::BuiltIn::LaunchIdKHR);
    };
    const auto curves = [&](const spirv::Instruction& i) {
      return i.op == Op::OpExtInst && !spirv::isExtended(module_, i, GLSLstd450Tan) &&
             !spirv::isExtended(module_, i, GLSLstd450Fma) && !spirv::isExtended(module_, i, GLSLstd450Radians);
    };
    return spirv::dependsOn(module_, value, loadsId) && !spirv::dependsOn(module_, value, curves);
  }

  const spirv::Module& module_;
  Id origin_;
};

// origin + t * direction
struct Position {
  const spirv::Instruction* sum = nullptr;
  Id origin = 0, direction = 0, t = 0;
};

// Returns the two ways to read a sum as origin + t * direction.
std::vector<Position> positionsOf(const spirv::Module& module, const spirv::Instruction& i) {
  std::vector<Position> result;
  if (i.op != Op::OpFAdd || typeOf(module, i.result).count != 3) return result;
  for (const std::size_t k : {0u, 1u}) {
    const spirv::Instruction* step = module.definition(i.at(k));
    if (step && step->op == Op::OpVectorTimesScalar) result.push_back({&i, i.at(1 - k), step->at(0), step->at(1)});
  }
  return result;
}

// A distance without a small constant offset: t - 0.001, 0.999 * t.
Id withoutOffset(const spirv::Module& module, Id t) {
  const spirv::Instruction* i = module.definition(t);
  if (!i || (i->op != Op::OpFAdd && i->op != Op::OpFSub && i->op != Op::OpFMul)) return t;
  for (const std::size_t k : {0u, 1u}) {
    const auto constant = module.constantFloat(i->at(k));
    const bool difference = i->op == Op::OpFSub && k == 0;
    const bool factor = i->op == Op::OpFMul && constant && std::abs(*constant - 1.0) > kOffset;
    if (constant && !difference && !factor) return i->at(1 - k);
  }
  return t;
}

class HitPositions {
 public:
  HitPositions(const CheckInput& input, Report& report) : graph_(input.graph), report_(report) {
    tracesTo_.resize(graph_.stages.size());
    for (std::size_t targets = 0; targets < graph_.targets.size(); ++targets)
      for (const Edge& edge : graph_.targets[targets].edges)
        if (edge.role == Role::closestHit) tracesTo_[edge.stage].insert(targets);
  }

  void check() {
    for (std::size_t stage = 0; stage < graph_.stages.size(); ++stage) {
      if (!graph_.stages[stage].facts) continue;
      const spirv::Module& module = graph_.stages[stage].facts->module();
      for (const spirv::Instruction& i : module.instructions())
        for (const Position& position : positionsOf(module, i)) {
          if (graph_.stages[stage].kind == shader::Stage::closestHit) checkIncoming(stage, position);
          checkTraced(stage, position);
        }
    }
  }

 private:
  // gl_WorldRayOriginEXT + gl_HitTEXT * normalize(gl_WorldRayDirectionEXT)
  void checkIncoming(std::size_t stage, const Position& position) {
    const spirv::Module& module = graph_.stages[stage].facts->module();
    if (!spirv::loadsBuiltIn(module, withoutOffset(module, position.t), spv::BuiltIn::RayTmaxKHR)) return;
    if (!spirv::loadsBuiltIn(module, position.origin, spv::BuiltIn::WorldRayOriginKHR)) return;
    const Id direction = normalizedOf(module, position.direction);
    if (direction == 0 || !spirv::loadsBuiltIn(module, direction, spv::BuiltIn::WorldRayDirectionKHR)) return;
    const TraceSite* first = nullptr;
    for (const std::size_t targets : tracesTo_[stage])
      if (const TraceSite* site = firstWithOtherLength(targets); site && (!first || site < first)) first = site;
    if (!first) return;
    add(stage, position,
        "the hit position is computed with the normalized direction, but the ray was traced with a direction that is "
        "not normalized",
        *first);
  }

  const TraceSite* firstWithOtherLength(std::size_t targets) {
    const auto [known, isNew] = otherLength_.try_emplace(targets, nullptr);
    if (!isNew) return known->second;
    for (const std::size_t trace : graph_.targets[targets].traces) {
      if (!hasOtherLength(graph_.traces[trace])) continue;
      known->second = &graph_.traces[trace];
      break;
    }
    return known->second;
  }

  // The shader that traced the ray gets t in the payload.
  void checkTraced(std::size_t stage, const Position& position) {
    const spirv::Module& module = graph_.stages[stage].facts->module();
    const auto sum = module.definitionIndex(position.sum->result);
    for (const TraceSite& site : graph_.tracesOf(stage)) {
      if (!spirv::canRunAfter(module, sum, site.trace->instruction)) continue;
      const auto ray = graph_.ray(site);
      if (!ray || !spirv::sameValue(module, position.origin, ray->origin)) continue;
      const std::string text = differenceOf(module, *ray, position.direction);
      if (text.empty() || !isPlainT(site, withoutOffset(module, position.t))) continue;
      return add(stage, position, text, site);
    }
  }

  // Says how the direction of a position differs in length from the one of the trace; empty if it does not.
  static std::string differenceOf(const spirv::Module& module, const spirv::RayOperands& ray, Id direction) {
    const Lengths lengths(module, ray.origin);
    const Id unit = normalizedOf(module, direction), unitOfRay = normalizedOf(module, ray.direction);
    if (unit != 0 && spirv::sameValue(module, unit, ray.direction) && lengths.differs(unit))
      return "the hit position is computed with the normalized direction, but the ray was traced with a direction that "
             "is not normalized";
    if (unitOfRay != 0 && spirv::sameValue(module, unitOfRay, direction) && lengths.differs(unitOfRay))
      return "the hit position is computed with a direction that is not normalized, but the ray was traced with the "
             "normalized direction";
    if (isMultiple(module, ray.direction, direction))
      return "the ray was traced with a multiple of the direction with which the hit position is computed";
    return {};
  }

  // True if the vector is c * base with a constant other than 1 and -1.
  static bool isMultiple(const spirv::Module& module, Id vector, Id base) {
    const spirv::Instruction* product = module.definition(vector);
    if (!product || product->op != Op::OpVectorTimesScalar || !spirv::sameValue(module, product->at(0), base))
      return false;
    const auto factor = module.constantFloat(product->at(1));
    return factor && std::abs(std::abs(*factor) - 1.0) > kUnitTolerance;
  }

  bool hasOtherLength(const TraceSite& site) const {
    const auto ray = graph_.ray(site);
    return ray && Lengths(graph_.facts(site).module(), ray->origin).differs(ray->direction);
  }

  // True if the value is a member of the payload to which all closest-hit shaders of the trace store gl_HitTEXT as it is.
  bool isPlainT(const TraceSite& site, Id t) {
    const spirv::StageFacts& facts = graph_.facts(site);
    const auto read = std::ranges::find_if(facts.accesses(), [&](const spirv::AccessFacts& access) {
      return access.reads && access.variable == site.trace->payload && access.value == t &&
             access.leaves.count() == 1 && access.leaves.exact;
    });
    if (read == facts.accesses().end()) return false;
    const auto [known, isNew] = storesPlainT_.try_emplace({site.targets, read->leaves.first}, false);
    if (isNew) known->second = storesPlainT(site, read->leaves.first);
    return known->second;
  }

  bool storesPlainT(const TraceSite& site, std::uint32_t leaf) const {
    bool stored = false;
    for (const Edge& edge : site.edges) {
      if (edge.role != Role::closestHit) continue;
      const spirv::StageFacts& hit = graph_.facts(edge);
      const spirv::SharedVariable* payload = hit.incoming(spv::StorageClass::IncomingRayPayloadKHR);
      if (!payload) continue;
      for (const spirv::AccessFacts& write : hit.accesses()) {
        if (!write.writes || write.variable != payload->id || !write.leaves.covers(leaf)) continue;
        const spirv::ValuePart value = spirv::originOf(hit.module(), hit.storedValue(write, leaf));
        if (value.id == 0 || !spirv::loadsBuiltIn(hit.module(), value.id, spv::BuiltIn::RayTmaxKHR)) return false;
        stored = true;
      }
    }
    return stored;
  }

  void add(std::size_t stage, const Position& position, const std::string& text, const TraceSite& site) {
    const spirv::Module& module = graph_.stages[stage].facts->module();
    const auto location = userLocation(module, *position.sum);
    if (!location) return;
    report_.add("Q717", graph_.location(graph_.stages[stage], *location),
                fmt::format("{}, and t is in units of its length", text),
                {relatedTo(graph_.location(site), "traced here")});
  }

  const PipelineGraph& graph_;
  Report& report_;
  std::vector<std::set<std::size_t>> tracesTo_;                         // targets by closest-hit stage
  std::map<std::size_t, const TraceSite*> otherLength_;                 // by targets
  std::map<std::pair<std::size_t, std::uint32_t>, bool> storesPlainT_;  // by targets and leaf
};

}  // namespace

void checkHitPositions(const CheckInput& input, Report& report) { HitPositions(input, report).check(); }

}  // namespace quintet::check
