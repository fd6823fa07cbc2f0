// SPDX-License-Identifier: Apache-2.0
// Q715: a color is encoded (gamma, sRGB) before it is stored to an output that holds linear color, which Quintet encodes;
// or the color of a texture is decoded, which Quintet has decoded.
//
// The rule follows the stored value back through sums, scaling by scalars, selection and payloads, to pow with an exponent
// near 1 / 2.2 or the square root of a color.
#include <fmt/format.h>
#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "check/flow/pipeline_spaces.h"
#include "check/library_names.h"
#include "check/output_access.h"
#include "check/rules/rules.h"
#include "check/rules/user_location.h"
#include "spirv/access.h"
#include "spirv/value_part.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;

constexpr double kSmallestExponent = 1.0 / 2.6, kLargestExponent = 1.0 / 1.8;
constexpr double kSmallestDecoding = 2.0, kLargestDecoding = 2.6;
constexpr std::size_t kMaxColorValues = 2000;

// The arrays of textures of the library, in both forms of programs.
bool isTextures(const std::string& name) { return name == "textures" || name == lectureName("Textures"); }

class ColorEncoding {
 public:
  ColorEncoding(const ProgramInput& input, const PipelineSpaces& spaces, Report& report)
      : graph_(input.graph), program_(input.program), spaces_(spaces), report_(report) {}

  void check() {
    for (std::size_t stage = 0; stage < graph_.stages.size(); ++stage) {
      if (!graph_.stages[stage].facts) continue;
      const spirv::Module& module = graph_.stages[stage].facts->module();
      for (const spirv::Instruction& i : module.instructions()) {
        if (spirv::isExtended(module, i, GLSLstd450Pow)) checkDecoding(stage, i);
        if (i.op != Op::OpStore) continue;
        const OutputAccess access = outputOf(module, i.at(0));
        const auto& outputs = program_.outputs;
        if (access.target == OutputTarget::output && access.slot < outputs.size() &&
            outputs[access.slot].kind == program::OutputKind::color)
          follow(stage, i.at(1), outputs[access.slot]);
      }
    }
  }

 private:
  using Path = std::vector<std::uint32_t>;
  struct Open {
    std::size_t stage;
    Id id;
    Path path;
  };

  void follow(std::size_t stage, Id value, const program::Output& output) {
    open_ = {{stage, value, {}}};
    seen_.clear();
    while (!open_.empty() && seen_.size() < kMaxColorValues) {
      const Open next = open_.back();
      open_.pop_back();
      if (seen_.emplace(next.stage, next.id, next.path).second) visit(next, output);
    }
  }

  void push(const Open& from, Id id) { open_.push_back({from.stage, id, from.path}); }

  void visit(const Open& open, const program::Output& output) {
    const spirv::Module& module = graph_.stages[open.stage].facts->module();
    const spirv::Instruction* i = module.definition(open.id);
    if (!i || module.isConstant(open.id)) return;
    const auto all = [&](std::size_t first) {
      for (std::size_t k = first; k < i->operands.size(); ++k) push(open, i->at(k));
    };
    switch (i->op) {
      case Op::OpPhi:
        for (std::size_t k = 0; k < i->operands.size(); k += 2) push(open, i->at(k));
        return;
      case Op::OpSelect: return all(1);
      case Op::OpFAdd:
      case Op::OpFSub: return all(0);
      case Op::OpCopyObject:
      case Op::OpCopyLogical:
      case Op::OpFNegate:
      case Op::OpVectorTimesScalar: return push(open, i->at(0));
      case Op::OpFMul:
      case Op::OpFDiv: {
        const auto isFactor = [&](Id id) { return module.isConstant(id) || spirv::isSplat(module, id); };
        if (isFactor(i->at(1))) push(open, i->at(0));
        if (i->op == Op::OpFMul && isFactor(i->at(0))) push(open, i->at(1));
        return;
      }
      case Op::OpVectorShuffle: push(open, i->at(0)); return push(open, i->at(1));
      case Op::OpCompositeConstruct: return construct(open, module, *i);
      case Op::OpCompositeExtract: {
        Open next{open.stage, i->at(0), open.path};
        const spirv::Instruction* from = module.definition(i->at(0));
        if (from && module.types().get(from->type).kind != spirv::Type::Kind::vector)
          next.path.insert(next.path.begin(), i->operands.begin() + 1, i->operands.end());
        open_.push_back(std::move(next));
        return;
      }
      case Op::OpCompositeInsert:
        push(open, i->at(1));
        if (open.path.empty()) push(open, i->at(0));
        return;
      case Op::OpLoad: return load(open, module, *i);
      case Op::OpExtInst: return extended(open, module, *i, output);
      default: return;
    }
  }

  void construct(const Open& open, const spirv::Module& module, const spirv::Instruction& i) {
    const bool vector = module.types().get(i.type).kind == spirv::Type::Kind::vector;
    if (vector || open.path.empty()) {
      for (const Id id : i.operands) push(open, id);
    } else if (open.path.front() < i.operands.size()) {
      open_.push_back({open.stage, i.at(open.path.front()), Path(open.path.begin() + 1, open.path.end())});
    }
  }

  // The values that are stored to a local variable or, in any stage, to a payload.
  void load(const Open& open, const spirv::Module& module, const spirv::Instruction& i) {
    const spirv::Access pointer = module.access(i.at(0));
    if (!spirv::isLocal(module, pointer.base) && !graph_.stages[open.stage].facts->variable(pointer.base)) return;
    Path wanted;
    for (const auto& index : pointer.indices) wanted.push_back(index.value_or(kAnyIndex));
    wanted.insert(wanted.end(), open.path.begin(), open.path.end());
    for (const auto& [stage, variable] : spaces_.linked({open.stage, pointer.base})) {
      const spirv::Module& writer = graph_.stages[stage].facts->module();
      for (const spirv::Instruction& store : writer.instructions()) {
        if (store.op != Op::OpStore) continue;
        const spirv::Access target = writer.access(store.at(0));
        if (target.base != variable) continue;
        const std::size_t common = std::min(wanted.size(), target.indices.size());
        if (overlaps(target, wanted))
          open_.push_back(
              {stage, store.at(1), Path(wanted.begin() + static_cast<std::ptrdiff_t>(common), wanted.end())});
      }
    }
  }

  void extended(const Open& open, const spirv::Module& module, const spirv::Instruction& i,
                const program::Output& output) {
    if (module.extendedSet(i.at(0)) != "GLSL.std.450") return;
    switch (i.at(1)) {
      case GLSLstd450Pow: {
        const auto exponent = constantOf(module, i.at(3));
        if (exponent && *exponent >= kSmallestExponent && *exponent <= kLargestExponent)
          found(open.stage, i, "pow", fmt::format("pow(color, {:.3g})", *exponent), output);
        return;
      }
      case GLSLstd450Sqrt:
        if (module.types().get(i.type).count >= 3) found(open.stage, i, "sqrt", "sqrt(color)", output);
        return;
      case GLSLstd450FMix: push(open, i.at(2)); return push(open, i.at(3));
      case GLSLstd450FMin:
      case GLSLstd450FMax:
      case GLSLstd450NMin:
      case GLSLstd450NMax: push(open, i.at(2)); return push(open, i.at(3));
      case GLSLstd450FClamp:
      case GLSLstd450NClamp: return push(open, i.at(2));
      case GLSLstd450Fma:
        if (module.isConstant(i.at(2)) || spirv::isSplat(module, i.at(2))) push(open, i.at(3));
        if (module.isConstant(i.at(3)) || spirv::isSplat(module, i.at(3))) push(open, i.at(2));
        return push(open, i.at(4));
      default: return;
    }
  }

  // pow(texture color, 2.2)
  void checkDecoding(std::size_t stage, const spirv::Instruction& pow) {
    const spirv::Module& module = graph_.stages[stage].facts->module();
    const auto exponent = constantOf(module, pow.at(3));
    if (!exponent || *exponent <= kSmallestDecoding || *exponent > kLargestDecoding) return;
    const auto samples = [&](const spirv::Instruction& i) {
      return (i.op == Op::OpImageSampleExplicitLod || i.op == Op::OpImageFetch) && isDecoded(module, i.at(0));
    };
    const auto stops = [&](const spirv::Instruction& i) {
      return i.op != Op::OpCompositeExtract && i.op != Op::OpCompositeConstruct && i.op != Op::OpVectorShuffle &&
             i.op != Op::OpPhi && !spirv::isExtended(module, i, GLSLstd450FMax) &&
             !spirv::isExtended(module, i, GLSLstd450FClamp) && !spirv::isExtended(module, i, GLSLstd450NMax) &&
             !spirv::isExtended(module, i, GLSLstd450NClamp);
    };
    if (!spirv::dependsOn(module, pow.at(2), samples, stops)) return;
    const SourceLocation location = module.location(pow, "pow");
    if (isLibrary(location)) return;
    report_.addOncePerLine(
        "Q715", graph_.location(graph_.stages[stage], location),
        fmt::format("pow(color, {:.3g}) decodes the color of a texture, but Quintet has decoded it", *exponent));
  }

  // True if the image is a texture that Quintet decodes: an image parameter, or a color texture of a material.
  bool isDecoded(const spirv::Module& module, Id image) const {
    const spirv::Instruction* load = module.definition(image);
    while (load && load->op == Op::OpImage) load = module.definition(load->at(0));
    if (!load || load->op != Op::OpLoad) return false;
    const spirv::Access texture = module.access(load->at(0));
    if (texture.indexIds.size() != 1 || !isTextures(module.name(texture.base))) return false;
    const spirv::Instruction* index = module.definition(texture.indexIds[0]);
    while (index && index->op == Op::OpCopyObject) index = module.definition(index->at(0));
    if (!index) return false;
    std::vector<std::optional<std::uint32_t>> path;
    while (index && index->op == Op::OpCompositeExtract) {
      path.insert(path.begin(), index->operands.begin() + 1, index->operands.end());
      index = module.definition(index->at(0));
      while (index && index->op == Op::OpCopyLogical) index = module.definition(index->at(0));
    }
    if (!index || index->op != Op::OpLoad) return false;
    spirv::Access from = module.access(index->at(0));
    from.indices.insert(from.indices.end(), path.begin(), path.end());
    for (const spirv::SelectedMember& selected : spirv::selectedMembers(module, from)) {
      const std::string_view structure = libraryName(selected.structure.name);
      if (structure == "Parameters")
        return std::ranges::any_of(program_.parameters, [&](const program::Parameter& p) {
          return p.name == selected.name() && p.type == program::ParameterType::image && p.sRgb;
        });
      if (structure == "MaterialData")
        return selected.name() == "baseColorTexture" || selected.name() == "emissiveTexture";
    }
    return false;
  }

  // A constant, a quotient of constants, or the default of a parameter.
  std::optional<double> constantOf(const spirv::Module& module, Id value, int depth = 0) const {
    const spirv::Instruction* i = module.definition(value);
    if (!i || depth > 8) return {};
    if (const auto scalar = module.constantFloat(value)) return scalar;
    if (spirv::isSplat(module, value)) return constantOf(module, i->at(0), depth + 1);
    if (i->op == Op::OpFDiv) {
      const auto a = constantOf(module, i->at(0), depth + 1), b = constantOf(module, i->at(1), depth + 1);
      return a && b && *b != 0.0 ? std::optional(*a / *b) : std::nullopt;
    }
    return i->op == Op::OpLoad ? defaultOf(module, i->at(0)) : std::nullopt;
  }

  std::optional<double> defaultOf(const spirv::Module& module, Id pointer) const {
    for (const spirv::SelectedMember& selected : spirv::selectedMembers(module, module.access(pointer)))
      if (libraryName(selected.structure.name) == "Parameters")
        for (const program::Parameter& p : program_.parameters)
          if (p.name == selected.name()) return p.defaultValue[0];
    return {};
  }

  void found(std::size_t stage, const spirv::Instruction& i, std::string_view token, const std::string& what,
             const program::Output& output) {
    const spirv::Module& module = graph_.stages[stage].facts->module();
    const SourceLocation location = module.location(i, token);
    if (isLibrary(location)) return;
    report_.addOncePerLine("Q715", graph_.location(graph_.stages[stage], location),
                           fmt::format("{} encodes the color for a display, but Quintet encodes the output '{}' itself",
                                       what, output.name));
  }

  const PipelineGraph& graph_;
  const program::Program& program_;
  const PipelineSpaces& spaces_;
  Report& report_;
  std::vector<Open> open_;
  std::set<std::tuple<std::size_t, Id, Path>> seen_;
};

}  // namespace

void checkColorEncoding(const ProgramInput& input, const PipelineSpaces& spaces, Report& report) {
  ColorEncoding(input, spaces, report).check();
}

}  // namespace quintet::check
