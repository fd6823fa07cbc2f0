// SPDX-License-Identifier: Apache-2.0
// Q710: values of the three vertices of a triangle are interpolated with the wrong weights.
//
// The rule follows sums of values that are loaded with the three indices of a triangle. Each vertex has a weight that is
// linear in the barycentrics x and y: 1 - x - y, x and y are correct.
#include <fmt/format.h>
#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "check/flow/pipeline_spaces.h"
#include "check/rules/rules.h"
#include "check/rules/user_location.h"
#include "spirv/value_part.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;

constexpr int kMaxWeightDepth = 64;

// constant + x * barycentric.x + y * barycentric.y
struct Weight {
  double constant = 0, x = 0, y = 0;
  bool varies() const { return x != 0.0 || y != 0.0; }
  bool isZero() const { return constant == 0.0 && !varies(); }
  bool operator==(const Weight&) const = default;
};

Weight operator+(const Weight& a, const Weight& b) { return {a.constant + b.constant, a.x + b.x, a.y + b.y}; }
Weight operator*(const Weight& a, double s) { return {a.constant * s, a.x * s, a.y * s}; }

std::optional<Weight> product(const Weight& a, const Weight& b) {
  if (a.varies() && b.varies()) return {};
  return a.varies() ? a * b.constant : b * a.constant;
}

const Weight kFirst{1, -1, -1}, kSecond{0, 1, 0}, kThird{0, 0, 1};

std::string textOf(const Weight& weight) {
  std::string text;
  const auto add = [&](double factor, std::string_view name) {
    if (factor == 0.0) return;
    const bool negative = factor < 0.0;
    text += text.empty() ? (negative ? "-" : "") : (negative ? " - " : " + ");
    const double size = std::abs(factor);
    text += name.empty()  ? fmt::format("{:g}", size)
            : size == 1.0 ? std::string(name)
                          : fmt::format("{:g} {}", size, name);
  };
  add(weight.constant, "");
  add(weight.x, "x");
  add(weight.y, "y");
  return text.empty() ? "0" : text;
}

// How a value depends on the vertices of a triangle.
struct Form {
  enum class Kind { none, weight, vertex, sum, unknown };
  Kind kind = Kind::none;  // none: it does not depend on them
  Weight weight;           // weight: the value itself, which can be a constant
  std::size_t vertex = 0;
  std::array<Weight, 3> weights;  // sum: of the vertices
};

Form ofVertex(std::size_t vertex) {
  Form form;
  form.kind = Form::Kind::vertex;
  form.vertex = vertex;
  form.weights[vertex] = {1, 0, 0};
  return form;
}

Form ofWeight(const Weight& weight) {
  Form form;
  form.kind = Form::Kind::weight;
  form.weight = weight;
  return form;
}

Form unknownForm() {
  Form form;
  form.kind = Form::Kind::unknown;
  return form;
}

using FormKind = Form::Kind;

bool hasVertices(const Form& form) { return form.kind == FormKind::vertex || form.kind == FormKind::sum; }

class Interpolations {
 public:
  explicit Interpolations(const SpaceTags& tags) : tags_(tags), module_(tags.module()) {}

  void check(Report& report) {
    for (const spirv::Instruction& i : module_.instructions()) {
      if (i.op != Op::OpFAdd && i.op != Op::OpFSub && !isExtended(i, GLSLstd450Fma) && !isExtended(i, GLSLstd450FMix))
        continue;
      const Form& form = of(i.result);
      if (form.kind != FormKind::sum || isPartOfSum(i.result)) continue;
      if (const std::string text = mistake(form); !text.empty()) {
        const SourceLocation location = module_.location(i);
        if (!isLibrary(location)) report.addOncePerLine("Q710", location, text);
      }
    }
  }

 private:
  bool isExtended(const spirv::Instruction& i, std::uint32_t number) const {
    return spirv::isExtended(module_, i, number);
  }

  static std::string mistake(const Form& form) {
    const auto& w = form.weights;
    if (w[0].isZero() || w[1].isZero() || w[2].isZero()) return {};
    if (!w[0].varies() && !w[1].varies() && !w[2].varies()) return {};
    const Weight total = w[0] + w[1] + w[2];
    const std::string weights = fmt::format("{}, {} and {}", textOf(w[0]), textOf(w[1]), textOf(w[2]));
    if (total.varies())
      return fmt::format("the weights {} of the three vertices do not sum to 1 (x and y are the barycentrics)",
                         weights);
    if (total.isZero()) return {};
    const std::array<Weight, 3> unit{w[0] * (1 / total.constant), w[1] * (1 / total.constant),
                                     w[2] * (1 / total.constant)};
    const std::array<Weight, 3> right{kFirst, kSecond, kThird};
    if (unit == right || !std::ranges::is_permutation(unit, right)) return {};
    return fmt::format(
        "the weights of the vertices 0, 1 and 2 are {}, but must be 1 - x - y, x and y (x and y are the barycentrics)",
        weights);
  }

  bool isPartOfSum(Id value) {
    return std::ranges::any_of(module_.users(value), [&](std::size_t user) {
      const spirv::Instruction& i = module_.instructions()[user];
      if (i.result == 0 || of(i.result).kind != FormKind::sum) return false;
      const bool scales = i.op == Op::OpVectorTimesScalar || i.op == Op::OpFMul || i.op == Op::OpFNegate;
      return !scales || isPartOfSum(i.result);
    });
  }

  const Form& of(Id value) {
    const auto found = forms_.find(value);
    if (found != forms_.end()) return found->second;
    forms_[value] = {};  // for loops
    if (depth_ > kMaxWeightDepth) return forms_[value] = unknownForm();
    ++depth_;
    Form form = evaluate(value);
    --depth_;
    return forms_[value] = form;
  }

  Form evaluate(Id value) {
    const spirv::Instruction* i = module_.definition(value);
    if (!i) return {};
    if (const auto constant = spirv::splatConstant(module_, value)) return ofWeight({*constant, 0, 0});
    if (module_.isConstant(value)) return {};
    const SpaceTag tag = tags_.of(value);
    if (tag.kind == SpaceTag::Kind::barycentric && tag.component < 2)
      return ofWeight(tag.component == 0 ? kSecond : kThird);
    switch (i->op) {
      case Op::OpLoad: return evaluateLoad(*i);
      case Op::OpFAdd: return sum(of(i->at(0)), of(i->at(1)), 1.0);
      case Op::OpFSub: return sum(of(i->at(0)), of(i->at(1)), -1.0);
      case Op::OpFNegate: return scaled(of(i->at(0)), ofWeight({-1, 0, 0}));
      case Op::OpVectorTimesScalar:
      case Op::OpFMul: return scaled(of(i->at(0)), of(i->at(1)));
      case Op::OpCompositeConstruct:
        if (spirv::isSplat(module_, value)) return of(i->at(0));
        return common(*i);
      case Op::OpCompositeExtract: return evaluateExtract(*i);
      case Op::OpPhi: return choice(*i);
      case Op::OpDot: return evaluateDot(*i);
      default: break;
    }
    if (isExtended(*i, GLSLstd450Fma)) return sum(scaled(of(i->at(2)), of(i->at(3))), of(i->at(4)), 1.0);
    if (isExtended(*i, GLSLstd450FMix)) {
      const Form t = of(i->at(4));
      if (t.kind != FormKind::weight) return common(*i);
      return sum(scaled(of(i->at(2)), ofWeight(Weight{1, 0, 0} + t.weight * -1.0)), scaled(of(i->at(3)), t), 1.0);
    }
    return common(*i);
  }

  // A value of one vertex, or something else, such as a default or the normal of the face.
  Form choice(const spirv::Instruction& phi) {
    Form result;
    for (std::size_t k = 0; k < phi.operands.size(); k += 2) {
      const Form form = of(phi.at(k));
      if (form.kind != FormKind::vertex) continue;
      if (result.kind == FormKind::vertex && result.vertex != form.vertex) return unknownForm();
      result = form;
    }
    return result.kind == FormKind::vertex ? result : common(phi);
  }

  // A component of a vector of weights.
  Form evaluateExtract(const spirv::Instruction& i) {
    const spirv::Instruction* vector = module_.definition(i.at(0));
    if (vector && vector->op == Op::OpCompositeConstruct && i.operands.size() == 2) {
      std::uint32_t at = i.at(1);
      for (const Id id : vector->operands) {
        const spirv::Instruction* part = module_.definition(id);
        const spirv::Type& type = module_.types().get(part ? part->type : 0);
        const std::uint32_t count = type.kind == spirv::Type::Kind::vector ? type.count : 1;
        if (at < count) return count == 1 ? of(id) : common(i);
        at -= count;
      }
    }
    return common(i);
  }

  // dot(barycentrics, vec2(1.0))
  Form evaluateDot(const spirv::Instruction& i) {
    for (const std::size_t k : {0u, 1u}) {
      const SpaceTag tag = tags_.of(i.at(k));
      const auto factor = spirv::splatConstant(module_, i.at(1 - k));
      if (tag.kind == SpaceTag::Kind::barycentric && tag.whole() && factor) return ofWeight({0, *factor, *factor});
    }
    return common(i);
  }

  // A value that depends on one vertex at most.
  Form common(const spirv::Instruction& i) {
    Form result;
    for (const Id id : spirv::valueOperands(i)) {
      const Form form = of(id);
      if (form.kind == FormKind::none || (form.kind == FormKind::weight && !form.weight.varies())) continue;
      const bool same =
          form.kind == FormKind::vertex && (result.kind == FormKind::none || result.vertex == form.vertex);
      if (!same) return unknownForm();
      result = form;
    }
    return result;
  }

  static Form sum(const Form& a, const Form& b, double sign) {
    if (a.kind == FormKind::unknown || b.kind == FormKind::unknown) return unknownForm();
    if (a.kind == FormKind::weight && b.kind == FormKind::weight) return ofWeight(a.weight + b.weight * sign);
    if (hasVertices(a) && hasVertices(b)) {
      if (a.kind == FormKind::vertex && b.kind == FormKind::vertex && a.vertex == b.vertex) return a;
      Form result;
      result.kind = FormKind::sum;
      for (std::size_t k = 0; k < 3; ++k) result.weights[k] = a.weights[k] + b.weights[k] * sign;
      return result;
    }
    // An offset, such as 1 - uv.y of one vertex.
    const Form& other = hasVertices(a) ? b : a;
    const bool fixed = other.kind == FormKind::none || (other.kind == FormKind::weight && !other.weight.varies());
    if (a.kind == FormKind::vertex && fixed) return a;
    if (b.kind == FormKind::vertex && fixed) return b;
    if (hasVertices(a) || hasVertices(b)) return unknownForm();
    const bool varies =
        (a.kind == FormKind::weight && a.weight.varies()) || (b.kind == FormKind::weight && b.weight.varies());
    return varies ? unknownForm() : Form{};
  }

  static Form scaled(const Form& a, const Form& b) {
    if (a.kind == FormKind::unknown || b.kind == FormKind::unknown) return unknownForm();
    if (a.kind == FormKind::weight && b.kind == FormKind::weight) {
      const auto weight = product(a.weight, b.weight);
      return weight ? ofWeight(*weight) : unknownForm();
    }
    const Form& vertices = hasVertices(a) ? a : b;
    const Form& factor = hasVertices(a) ? b : a;
    if (!hasVertices(vertices)) {
      const bool varies =
          (a.kind == FormKind::weight && a.weight.varies()) || (b.kind == FormKind::weight && b.weight.varies());
      return varies ? unknownForm() : Form{};
    }
    if (factor.kind == FormKind::none) return vertices.kind == FormKind::vertex ? vertices : unknownForm();
    if (factor.kind != FormKind::weight) return unknownForm();
    Form result;
    result.kind = FormKind::sum;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto weight = product(vertices.weights[k], factor.weight);
      if (!weight) return unknownForm();
      result.weights[k] = *weight;
    }
    return result;
  }

  Form evaluateLoad(const spirv::Instruction& load) {
    const spirv::Access pointer = module_.access(load.at(0));
    if (spirv::isLocal(module_, pointer.base)) {
      const auto stored = spirv::storedValues(module_, load);
      return stored && stored->size() == 1 ? of(stored->front()) : Form{};
    }
    // The index of the vertex data itself, not that of the list of indices.
    if (module_.types().get(load.type).kind == spirv::Type::Kind::integer || isIntegerVector(load.type)) return {};
    for (const Id index : pointer.indexIds)
      if (const auto vertex = vertexOf(index)) return ofVertex(*vertex);
    return {};
  }

  bool isIntegerVector(Id type) const {
    const spirv::Type& t = module_.types().get(type);
    return t.kind == spirv::Type::Kind::vector && module_.types().get(t.element).kind == spirv::Type::Kind::integer;
  }

  // The vertex of the triangle to which an index belongs: component of a uvec3 of indices, or 3 * triangle + vertex, or
  // an index that is loaded from there.
  std::optional<std::size_t> vertexOf(Id index) const {
    const spirv::Instruction* i = module_.definition(index);
    for (int depth = 0;
         i && (i->op == Op::OpBitcast || i->op == Op::OpUConvert || i->op == Op::OpCopyObject) && depth < 4; ++depth)
      i = module_.definition(i->at(0));
    if (!i) return {};
    if (const auto corner = cornerOf(*i)) return corner;
    if (i->op == Op::OpCompositeExtract && i->operands.size() == 2 && i->at(1) < 3) {
      const spirv::Instruction* vector = module_.definition(i->at(0));
      if (vector && isIntegerVector(vector->type) && module_.types().get(vector->type).count == 3 &&
          (vector->op == Op::OpLoad || vector->op == Op::OpPhi))
        return i->at(1);
    }
    if (i->op != Op::OpLoad) return {};
    const spirv::Access pointer = module_.access(i->at(0));
    if (pointer.indexIds.empty() || spirv::isLocal(module_, pointer.base) || module_.variable(pointer.base)) return {};
    const spirv::Instruction* last = module_.definition(pointer.indexIds.back());
    if (last && !module_.isConstant(pointer.indexIds.back())) return cornerOf(*last);
    // uvec3 indices[]: indices[triangle].y
    const auto component = pointer.indices.back();
    const bool ofVector =
        pointer.indices.size() >= 2 && !pointer.indices[pointer.indices.size() - 2] && component && *component < 3;
    return ofVector ? std::optional<std::size_t>(*component) : std::nullopt;
  }

  // 3 * triangle + vertex
  std::optional<std::size_t> cornerOf(const spirv::Instruction& i) const {
    const auto isTriple = [&](Id id) {
      const spirv::Instruction* product = module_.definition(id);
      while (product && product->op == Op::OpBitcast) product = module_.definition(product->at(0));
      return product && product->op == Op::OpIMul &&
             (module_.constantBits(product->at(0)) == 3u || module_.constantBits(product->at(1)) == 3u);
    };
    if (i.op == Op::OpIMul && isTriple(i.result)) return 0;
    if (i.op != Op::OpIAdd) return {};
    for (const std::size_t k : {0u, 1u}) {
      const auto corner = module_.constantBits(i.at(k));
      if (corner && *corner < 3 && isTriple(i.at(1 - k))) return *corner;
    }
    return {};
  }

  const SpaceTags& tags_;
  const spirv::Module& module_;
  std::map<Id, Form> forms_;
  int depth_ = 0;
};

bool hasBarycentrics(const SpaceTags& tags) {
  for (const spirv::Instruction& i : tags.module().instructions())
    if (i.op == Op::OpLoad || i.op == Op::OpCompositeExtract)
      if (tags.of(i.result).kind == SpaceTag::Kind::barycentric) return true;
  return false;
}

}  // namespace

void checkBarycentrics(const PipelineSpaces& spaces, std::size_t stage, Report& report) {
  const SpaceTags* tags = spaces.stage(stage);
  if (tags && hasBarycentrics(*tags)) Interpolations(*tags).check(report);
}

}  // namespace quintet::check
