// SPDX-License-Identifier: Apache-2.0
// Q702, Q708, Q709: points, directions and normals in the wrong space, or transformed as one another.
//
// The rules look at the tags (flow/space_tag.h) of operands, and at what a value is used for. Instructions of the
// library are not reported, but its functions are followed: the location is then that of the caller.
#include <fmt/format.h>
#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>

#include "base/parallel.h"
#include "check/flow/pipeline_spaces.h"
#include "check/rules/rules.h"
#include "check/rules/user_location.h"
#include "spirv/source_text.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;
using Kind = SpaceTag::Kind;
using W = SpaceTag::W;

class SpaceRules {
 public:
  SpaceRules(const PipelineSpaces& spaces, std::size_t stage, bool transformed, Report& report)
      : spaces_(spaces),
        tags_(*spaces.stage(stage)),
        module_(tags_.module()),
        stage_(stage),
        transformed_(transformed),
        report_(report) {}

  void check() {
    for (const spirv::Instruction& i : module_.instructions()) {
      if (const auto product = tags_.product(i)) checkProduct(i, *product);
      checkMixture(i);
    }
  }

 private:
  void add(std::string_view id, const spirv::Instruction& instruction, std::string_view token, std::string text) {
    if (const auto location = userLocation(module_, instruction, token))
      report_.addOncePerLine(id, *location, std::move(text));
  }

  ValueUses uses(const spirv::Instruction& instruction) const { return spaces_.uses(stage_, instruction.result); }

  // The name of the matrix as the source has it, if the line has it.
  std::string matrixName(const Transform& transform) const {
    const Space from = transform.covariant ? transform.map.to : transform.map.from;
    if (from == Space::object) return "gl_ObjectToWorldEXT";
    return from == Space::world ? "gl_WorldToObjectEXT" : "the camera's matrix";
  }
  std::string_view tokenOf(const Transform& transform) const {
    const Space from = transform.covariant ? transform.map.to : transform.map.from;
    return from == Space::object ? "gl_ObjectToWorldEXT" : from == Space::world ? "gl_WorldToObjectEXT" : "";
  }

  void checkProduct(const spirv::Instruction& i, const SpaceTags::Product& product) {
    if (product.vector.kind == Kind::undefined) return;
    if (product.vector.geometric() && product.vector.space != product.transform.map.from) {
      checkDirectionOfMatrix(i, product);
      return;
    }
    const bool toWorld = product.transform.map == SpaceMap{Space::object, Space::world};
    const bool asPoint = product.transform.affine && product.vector.w == W::one;
    const bool asVector = !product.transform.affine || product.vector.w == W::zero;
    if (!product.transform.covariant && asPoint) checkVectorAsPoint(i, product);
    if (!product.transform.covariant && asVector && (checkPointAsVector(i, product) || !toWorld)) return;
    if (!product.transform.covariant && asVector && toWorld && isTransformedNormal(i, product)) {
      add("Q702", i, "gl_ObjectToWorldEXT",
          "a normal is multiplied by gl_ObjectToWorldEXT; with non-uniform scale the result is not perpendicular to "
          "the surface");
    }
  }

  // A matrix of one space that is applied to a value of a different space.
  void checkDirectionOfMatrix(const spirv::Instruction& i, const SpaceTags::Product& product) {
    add("Q709", i, tokenOf(product.transform),
        fmt::format("{} is multiplied by {}, which here maps {} to {}", describe(product.vector),
                    product.transform.covariant ? "the transposed matrix " + matrixName(product.transform)
                                                : matrixName(product.transform),
                    nameOf(product.transform.map.from), nameOf(product.transform.map.to)));
  }

  bool isTransformedNormal(const spirv::Instruction& i, const SpaceTags::Product& product) const {
    const ValueUses use = uses(i);
    if (use.truncated) return false;
    switch (product.vector.kind) {
      case Kind::normal:
        // An offset along a normal does not have to be perpendicular to the surface.
        return use.asNormal || use.dot || use.shown || use.traceDirection || (use.stored && !use.moves) ||
               (use.normalized && !use.moves);
      case Kind::point:
        // The normal of a sphere at the origin of object space.
        if (use.translated || use.traceOrigin || use.difference) return false;
        return use.asNormal || (product.vector.onRay && use.normalizedDirectly);
      case Kind::radial: return use.asNormal || use.shown;
      case Kind::direction: return false;
      case Kind::neutral:
        return use.asNormal && product.operand != 0 && !module_.isConstant(product.operand) &&
               !isFixed(product.operand);
      default: return use.asNormal;
    }
  }

  // True for vec4(constants, 0) and vectors of parameters: axes.
  bool isFixed(Id value) const {
    return !spirv::dependsOn(module_, value, [&](const spirv::Instruction& i) {
      if (i.op == Op::OpPhi || i.op == Op::OpSelect) return true;
      if (i.op != Op::OpLoad) return false;
      const spirv::Access pointer = module_.access(i.at(0));
      return module_.variable(pointer.base) != nullptr &&
             module_.variable(pointer.base)->storage != spv::StorageClass::PushConstant;
    });
  }

  bool checkPointAsVector(const spirv::Instruction& i, const SpaceTags::Product& product) {
    if (product.vector.kind != Kind::point) return false;
    const ValueUses use = uses(i);
    if (use.truncated || use.translated || use.relative || use.asNormal || use.normalizedDirectly) return false;
    // vec4(position, 0.0) of vertices is not meant as a direction.
    const bool explicitly = product.vector.w == W::zero && product.vector.fromMesh && !use.measured;
    if (!explicitly && !use.traceOrigin && !use.difference && !isPattern(product, use)) return false;
    const std::string text =
        product.vector.w == W::zero
            ? fmt::format("{} is transformed with w = 0, like a direction, so it is not translated",
                          describe(product.vector))
            : fmt::format("{} is multiplied by the 3x3 part of {}, so it is not translated", describe(product.vector),
                          matrixName(product.transform));
    const auto call = product.vector.w == W::zero ? callWithW(i, product.operand) : std::nullopt;
    if (call)
      report_.addOncePerLine("Q708", *call, text);
    else
      add("Q708", i, tokenOf(product.transform), text);
    return true;
  }

  // A hit position with w = 0 that is only used as coordinates of a pattern.
  static bool isPattern(const SpaceTags::Product& product, const ValueUses& use) {
    return product.vector.w == W::zero && product.vector.onRay && use.pattern && !use.normalized && !use.measured &&
           !use.dot && !use.crossed && !use.shown && !use.traceDirection;
  }

  // The call that passes w to the function of the product; nullopt if the product has it as a number.
  std::optional<SourceLocation> callWithW(const spirv::Instruction& i, Id vector) const {
    const SourceLocation own = module_.location(i);
    if (isLibrary(own) || spirv::findToken(spirv::lineOf(module_.source(own.file), own.line), "0") != std::string::npos)
      return {};
    return callLocation(module_, i, vector);
  }

  void checkVectorAsPoint(const spirv::Instruction& i, const SpaceTags::Product& product) {
    const SpaceTag& vector = product.vector;
    const bool certain =
        (vector.kind == Kind::normal && !vector.scaled) || (vector.kind == Kind::direction && vector.onRay);
    if (vector.kind == Kind::point || vector.kind == Kind::neutral || vector.kind == Kind::undefined) return;
    const ValueUses use = uses(i);
    if (use.truncated || use.difference || use.traceOrigin) return;
    const bool directed = use.asNormal || use.traceDirection || use.crossed || (use.normalizedDirectly && use.dot);
    if (!certain && (!directed || vector.kind == Kind::radial)) return;
    add("Q708", i, tokenOf(product.transform),
        fmt::format("{} is transformed with w = 1, like a position, so it is translated",
                    vector.geometric() ? describe(vector) : std::string("a vector that is used as a direction")));
  }

  void checkMixture(const spirv::Instruction& i) {
    switch (i.op) {
      case Op::OpFAdd: return checkPair(i, i.at(0), i.at(1), "sum", "");
      case Op::OpFSub: return checkPair(i, i.at(0), i.at(1), "difference", "");
      case Op::OpDot: return checkPair(i, i.at(0), i.at(1), "dot product", "dot");
      case Op::OpTraceRayKHR:
      case Op::OpHitObjectTraceRayNV:
        checkTraced(i, spirv::rayOperands(i)->origin, "origin");
        checkTraced(i, spirv::rayOperands(i)->direction, "direction");
        return;
      case Op::OpExtInst: return checkExtended(i);
      default: return;
    }
  }

  void checkExtended(const spirv::Instruction& i) {
    if (module_.extendedSet(i.at(0)) != "GLSL.std.450") return;
    switch (i.at(1)) {
      case GLSLstd450Cross: return checkPair(i, i.at(2), i.at(3), "cross product", "cross");
      case GLSLstd450Distance: return checkPair(i, i.at(2), i.at(3), "distance", "distance");
      case GLSLstd450Reflect: return checkPair(i, i.at(2), i.at(3), "reflection", "reflect");
      case GLSLstd450Refract: return checkPair(i, i.at(2), i.at(3), "refraction", "refract");
      case GLSLstd450FMix: return checkPair(i, i.at(2), i.at(3), "mixture", "mix");
      case GLSLstd450FaceForward:
        checkPair(i, i.at(2), i.at(3), "comparison", "faceforward");
        return checkPair(i, i.at(3), i.at(4), "comparison", "faceforward");
      default: return;
    }
  }

  void checkPair(const spirv::Instruction& i, Id first, Id second, std::string_view operation, std::string_view token) {
    const SpaceTag a = tags_.of(first), b = tags_.of(second);
    if (a.geometric() && b.geometric() && a.component == b.component && a.space != b.space) {
      if (!differs(a) || !differs(b)) return;
      add("Q709", i, token, fmt::format("{} of {} and {}", operation, describe(a), describe(b)));
      return;
    }
    // A constant that is also the direction of a ray is in world space.
    if (i.op != Op::OpDot || !(a.kind == Kind::neutral ? b : a).geometric()) return;
    if ((a.kind == Kind::neutral) == (b.kind == Kind::neutral)) return;
    const SpaceTag& known = a.kind == Kind::neutral ? b : a;
    const Id neutral = a.kind == Kind::neutral ? first : second;
    if (known.space != Space::object || !known.whole() || !differs(known) || !isTraced(neutral)) return;
    add("Q709", i, token,
        fmt::format("{} of {} and the direction of a ray, which is in world space", operation, describe(known)));
  }

  // False for values of object space in programs that can assume that instances have no transform: nothing is
  // transformed, and the values come from the object-space ray or from boxes. An intersection shader must not assume it.
  bool differs(const SpaceTag& tag) const {
    return tag.space != Space::object || tag.fromMesh || transformed_ || isIntersection();
  }
  bool isIntersection() const { return module_.stage() == spv::ExecutionModel::IntersectionKHR; }

  bool isTraced(Id value) const {
    return std::ranges::any_of(module_.users(value), [&](std::size_t user) {
      const auto ray = spirv::rayOperands(module_.instructions()[user]);
      return ray && ray->direction == value;
    });
  }

  void checkTraced(const spirv::Instruction& trace, Id value, std::string_view argument) {
    const SpaceTag tag = tags_.of(value);
    if (!tag.geometric() || !tag.whole() || tag.space == Space::world || !differs(tag)) return;
    const bool whole = trace.op == Op::OpTraceRayKHR;
    add("Q709", trace, whole ? "traceRayEXT" : "hitObjectTraceRayNV",
        fmt::format("the {} of the ray is {}, but {} expects world space", argument, describe(tag),
                    whole ? "traceRayEXT" : "the trace"));
  }

  const PipelineSpaces& spaces_;
  const SpaceTags& tags_;
  const spirv::Module& module_;
  std::size_t stage_;
  bool transformed_;  // object space differs from world space
  Report& report_;
};

}  // namespace

void checkSpaces(const PipelineSpaces& spaces, std::size_t stage, bool transformed, Report& report) {
  if (spaces.stage(stage)) SpaceRules(spaces, stage, transformed, report).check();
}

void checkSpaces(const spirv::Module& module, Report& report) {
  const PipelineSpaces spaces(module);
  checkSpaces(spaces, 0, spaces.transforms(), report);
}

void checkSpaces(const CheckInput& input, const PipelineSpaces& spaces, Report& report) {
  const PipelineGraph& graph = input.graph;
  const bool transformed =
      spaces.transforms() ||
      (input.scene && std::ranges::any_of(input.scene->instances, &program::InstanceFacts::transformed));
  std::vector<std::vector<Diagnostic>> found(graph.stages.size());
  parallelFor(graph.stages.size(), [&](std::size_t i) {
    Report ofStage;
    checkSpaces(spaces, i, transformed, ofStage);
    checkBarycentrics(spaces, i, ofStage);
    found[i] = ofStage.take();
  });
  for (std::size_t i = 0; i < found.size(); ++i)
    for (Diagnostic& d : found[i])
      report.addOncePerLine(d.id, graph.location(graph.stages[i], {d.file, d.line, d.column}), std::move(d.text));
}

}  // namespace quintet::check
