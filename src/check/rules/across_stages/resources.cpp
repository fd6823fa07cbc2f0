// SPDX-License-Identifier: Apache-2.0
// Q651 to Q654: descriptors, push constants and shader records of the stages, compared with what Quintet provides:
// shared::kBindings, shared::Launch and the program's [[record]] fields. Only resources that a stage uses count.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <span>

#include "check/rules/rules.h"
#include "quintet/shared/bindings.h"
#include "quintet/shared/frame.h"
#include "spirv/glsl_declaration.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spirv::Type;
using spv::StorageClass;

// A scalar or vector of a block.
struct Leaf {
  std::string name;  // of the innermost structure member
  std::uint64_t offset = 0;
  std::uint32_t width = 32;  // bits of a component; an address has 64
  std::uint32_t count = 1;   // components
  bool isFloat = false;

  std::uint64_t end() const { return offset + std::uint64_t{width / 8} * count; }
  std::string type() const {
    if (width == 64 && !isFloat) return count == 1 ? "uint64_t" : fmt::format("u64vec{}", count);
    const char* scalar = isFloat ? (width == 64 ? "double" : "float") : "uint";
    if (count == 1) return width >= 32 ? scalar : fmt::format("{}-bit number", width);
    return fmt::format("{}vec{}", isFloat ? "" : "u", count);
  }
};

// ---- What Quintet provides ----

template <class T>
Leaf leafOf(const char* name, std::size_t offset);
template <>
Leaf leafOf<shared::Address>(const char* name, std::size_t offset) {
  return {name, offset, 64, 1, false};
}
template <>
Leaf leafOf<shared::uint>(const char* name, std::size_t offset) {
  return {name, offset, 32, 1, false};
}
template <>
Leaf leafOf<shared::uvec2>(const char* name, std::size_t offset) {
  return {name, offset, 32, 2, false};
}

// The members of shared::Launch. A new member does not compile until it is listed here.
#define LAUNCH_MEMBER(name) leafOf<decltype(shared::Launch::name)>(#name, offsetof(shared::Launch, name))
const std::vector<Leaf>& launchMembers() {
  static const std::vector<Leaf> kMembers = {LAUNCH_MEMBER(frameAddress), LAUNCH_MEMBER(parameterAddress),
                                             LAUNCH_MEMBER(offset),       LAUNCH_MEMBER(firstSample),
                                             LAUNCH_MEMBER(sampleCount),  LAUNCH_MEMBER(tiles)};
  static_assert(
      sizeof(shared::Launch) == 3 * sizeof(shared::Address) + sizeof(shared::uvec2) + 2 * sizeof(shared::uint),
      "list all members of Launch");
  return kMembers;
}
#undef LAUNCH_MEMBER

// The fields of the program's record in scalar layout, as ParameterValues::pack() writes them.
std::vector<Leaf> recordFields(const program::Program& program) {
  std::vector<Leaf> fields;
  std::uint64_t offset = 0;
  for (const program::Parameter& field : program.record) {
    const std::string_view glsl = program::glslType(field.type);
    const auto count = static_cast<std::uint32_t>(program::componentCount(field.type));
    fields.push_back({field.name, offset, 32, count, glsl != "uint" && glsl != "int"});
    offset = fields.back().end();
  }
  return fields;
}

// "frame (uint64_t at byte 0), parameters (uint64_t at byte 8)"
std::string listText(std::span<const Leaf> leaves) {
  std::string text;
  for (const Leaf& leaf : leaves)
    text += fmt::format("{}{} ({} at byte {})", text.empty() ? "" : ", ", leaf.name, leaf.type(), leaf.offset);
  return text;
}

std::string bindingsText() {
  std::string text;
  for (const shared::Binding& binding : shared::kBindings)
    text +=
        fmt::format("{}binding {} {} ({})", text.empty() ? "" : ", ", binding.number, binding.glsl, binding.constant);
  return "set 0 has: " + text;
}

// ---- What a stage declares ----

// The scalars and vectors of a block in the order of their declaration.
class BlockReader {
 public:
  explicit BlockReader(const spirv::Module& module) : module_(module) {
    for (const spirv::Instruction& i : module.instructions())
      if (i.op == spv::Op::OpMemberDecorate) members_[{i.at(0), i.at(1), i.at(2)}] = i.at(3);
  }

  // Returns false if a part cannot be followed.
  bool read(Id type, std::vector<Leaf>& leaves) const { return add(type, 0, "", 0, leaves); }

 private:
  static constexpr std::size_t kMaxLeaves = 4096;

  std::uint32_t decoration(Id type, std::uint32_t member, spv::Decoration decoration) const {
    const auto found = members_.find({type, member, static_cast<std::uint32_t>(decoration)});
    return found == members_.end() ? 0 : found->second;
  }

  bool add(Id id, std::uint64_t offset, const std::string& name, std::uint32_t matrixStride,
           std::vector<Leaf>& leaves) const {
    const Type& type = module_.types().get(id);
    if (leaves.size() >= kMaxLeaves) return false;
    switch (type.kind) {
      case Type::Kind::boolean:
      case Type::Kind::integer: leaves.push_back({name, offset, type.width, 1, false}); return true;
      case Type::Kind::floating: leaves.push_back({name, offset, type.width, 1, true}); return true;
      case Type::Kind::pointer: leaves.push_back({name, offset, 64, 1, false}); return true;
      case Type::Kind::vector: {
        const Type& element = module_.types().get(type.element);
        leaves.push_back({name, offset, element.width, type.count, element.kind == Type::Kind::floating});
        return true;
      }
      case Type::Kind::matrix: return addElements(type, offset, name, matrixStride, 0, leaves);
      case Type::Kind::array:
        return addElements(type, offset, name, module_.decoration(id, spv::Decoration::ArrayStride).value_or(0),
                           matrixStride, leaves);
      case Type::Kind::structure:
        for (std::uint32_t k = 0; k < type.members.size(); ++k) {
          const std::string member = k < type.memberNames.size() ? type.memberNames[k] : std::string();
          if (!add(type.members[k], offset + decoration(id, k, spv::Decoration::Offset), member,
                   decoration(id, k, spv::Decoration::MatrixStride), leaves))
            return false;
        }
        return true;
      default: return false;
    }
  }

  bool addElements(const Type& type, std::uint64_t offset, const std::string& name, std::uint32_t stride,
                   std::uint32_t matrixStride, std::vector<Leaf>& leaves) const {
    if (stride == 0) return false;
    for (std::uint32_t k = 0; k < type.count; ++k)
      if (!add(type.element, offset + std::uint64_t{k} * stride, name, matrixStride, leaves)) return false;
    return true;
  }

  const spirv::Module& module_;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> members_;  // of type, member and decoration
};

std::string imageName(const spirv::Module& module, const spirv::Instruction& image, bool sampled) {
  static constexpr std::array<std::string_view, 7> kDimensions{"1D", "2D", "3D", "Cube", "2DRect", "Buffer", "pass"};
  const Type& type = module.types().get(image.at(0));
  const bool integer = type.kind == Type::Kind::integer;
  const std::string_view prefix = !integer ? "" : type.isSigned ? "i" : "u";
  const std::uint32_t dimension = image.at(1);
  if (dimension == static_cast<std::uint32_t>(spv::Dim::SubpassData)) return fmt::format("{}subpassInput", prefix);
  const std::string_view kind = sampled ? "sampler" : image.at(5) == 2 ? "image" : "texture";
  return fmt::format(
      "{}{}{}{}{}{}", prefix, kind, dimension < kDimensions.size() ? kDimensions[dimension] : std::string_view("?"),
      image.at(4) != 0 ? "MS" : "", image.at(3) != 0 ? "Array" : "", sampled && image.at(2) == 1 ? "Shadow" : "");
}

// GLSL type of a descriptor: "sampler2D", "uniform block 'Camera'".
std::string descriptorName(const spirv::Module& module, Id id, StorageClass storage) {
  const spirv::Instruction* type = module.definition(id);
  if (!type) return "?";
  switch (type->op) {
    case spv::Op::OpTypeAccelerationStructureKHR: return "accelerationStructureEXT";
    case spv::Op::OpTypeSampler: return "sampler";
    case spv::Op::OpTypeImage: return imageName(module, *type, false);
    case spv::Op::OpTypeSampledImage:
      if (const spirv::Instruction* image = module.definition(type->at(0))) return imageName(module, *image, true);
      return "?";
    case spv::Op::OpTypeStruct: {
      const bool buffer =
          storage == StorageClass::StorageBuffer || module.decoration(id, spv::Decoration::BufferBlock).has_value();
      return fmt::format("{} block '{}'", buffer ? "buffer" : "uniform", module.name(id));
    }
    default: return module.types().nameOf(id);
  }
}

class ResourceRule {
 public:
  ResourceRule(const ProgramInput& input, const PipelineStage& stage, Report& report)
      : graph_(input.graph), program_(input.program), stage_(stage), module_(stage.facts->module()), report_(report) {}

  void check() {
    for (const spirv::Variable& variable : module_.variables()) {
      if (module_.users(variable.id).empty()) continue;
      switch (variable.storage) {
        case StorageClass::UniformConstant:
        case StorageClass::Uniform:
        case StorageClass::StorageBuffer: checkDescriptor(variable); break;
        case StorageClass::PushConstant: checkPushConstants(variable); break;
        case StorageClass::ShaderRecordBufferKHR: checkRecord(variable); break;
        default: break;
      }
    }
  }

 private:
  void checkDescriptor(const spirv::Variable& variable) {
    const std::uint32_t set = module_.decoration(variable.id, spv::Decoration::DescriptorSet).value_or(0);
    const std::uint32_t number = module_.decoration(variable.id, spv::Decoration::Binding).value_or(0);
    const Type& declared = module_.types().get(variable.type);
    const bool array = declared.kind == Type::Kind::array || declared.kind == Type::Kind::runtimeArray;
    const std::string element = descriptorName(module_, array ? declared.element : variable.type, variable.storage);
    const std::string suffix = !array                               ? ""
                               : declared.kind == Type::Kind::array ? fmt::format("[{}]", declared.count)
                                                                    : "[]";
    const auto* provided = std::ranges::find(shared::kBindings, number, &shared::Binding::number);
    const bool exists = set == 0 && provided != std::end(shared::kBindings);
    if (exists) {
      const bool wantsArray = provided->type == shared::BindingType::textures;
      const bool sameShape = wantsArray ? array : !array || declared.count == 1;
      const std::string_view wanted = wantsArray ? std::string_view("sampler2D") : provided->glsl;
      if (sameShape && element == wanted) return;
    }
    const std::string name = variable.name.empty() ? "this stage uses " : fmt::format("'{}' is ", variable.name);
    report_.add("Q651", location(variable),
                fmt::format("{}{}{} at set {}, binding {}, {}; {}", name, element, suffix, set, number,
                            exists ? fmt::format("where Quintet provides {}", provided->glsl)
                                   : std::string("which Quintet does not provide"),
                            bindingsText()));
  }

  void checkPushConstants(const spirv::Variable& variable) {
    std::vector<Leaf> leaves;
    if (!BlockReader(module_).read(variable.type, leaves)) return;
    for (const Leaf& leaf : leaves) {
      if (std::ranges::any_of(launchMembers(), [&](const Leaf& member) { return isPart(leaf, member); })) continue;
      report_.add("Q652", location(variable),
                  fmt::format("push constant '{}' is {} at byte {}, which Quintet does not provide; push constants are "
                              "Launch of <quintet/frame.glsl>: {}",
                              leaf.name, leaf.type(), leaf.offset, listText(launchMembers())));
      return;
    }
  }

  // A uvec2 can hold an address (GL_EXT_buffer_reference_uvec2).
  static bool isPart(const Leaf& leaf, const Leaf& provided) {
    if (leaf.isFloat != provided.isFloat || leaf.offset < provided.offset || leaf.end() > provided.end()) return false;
    if (provided.width == 64) return leaf.offset == provided.offset && leaf.end() == provided.end();
    return leaf.width == provided.width && (leaf.offset - provided.offset) % (provided.width / 8) == 0;
  }

  void checkRecord(const spirv::Variable& variable) {
    const std::vector<Leaf> fields = recordFields(program_);
    if (fields.empty()) {
      report_.add("Q654", location(variable),
                  fmt::format("this stage reads the shader record, but {} declares no [[record]] fields",
                              program_.descriptionFile));
      return;
    }
    std::vector<Leaf> leaves;
    if (!BlockReader(module_).read(variable.type, leaves)) return;
    for (const Leaf& leaf : leaves) {
      const auto part = std::ranges::find_if(fields, [&](const Leaf& field) { return isPart(leaf, field); });
      const auto named = std::ranges::find(fields, leaf.name, &Leaf::name);
      if (part != fields.end() && (named == fields.end() || named == part)) continue;
      std::string text =
          fmt::format("member '{}' of the shader record is {} at byte {}", leaf.name, leaf.type(), leaf.offset);
      const auto at = std::ranges::find_if(
          fields, [&](const Leaf& field) { return leaf.offset >= field.offset && leaf.offset < field.end(); });
      text += at == fields.end() ? fmt::format(", but the record of the program ends at byte {}", fields.back().end())
                                 : fmt::format(", but the program declares '{}' there ({} at byte {})", at->name,
                                               at->type(), at->offset);
      report_.add("Q653", location(variable), text + "; its fields are " + listText(fields));
      return;
    }
  }

  // Of the declaration: SPIR-V has no lines for variables.
  SourceLocation location(const spirv::Variable& variable) const {
    const std::string block = module_.types().get(variable.type).name;
    const auto findIn = [&](const std::string& file, std::string_view text) -> std::optional<SourceLocation> {
      const auto found =
          block.empty() ? spirv::findDeclaration(text, "uniform", variable.name) : spirv::findWord(text, block);
      if (!found) return {};
      return SourceLocation{found->file.empty() ? file : found->file, found->line, found->column};
    };
    for (const auto& [file, text] : module_.sources())
      if (const auto found = findIn(file, text)) return *found;
    for (const auto& [file, text] : program_.files)
      if (const auto found = findIn(program_.path(file), text)) return *found;
    return graph_.location(stage_, {});
  }

  const PipelineGraph& graph_;
  const program::Program& program_;
  const PipelineStage& stage_;
  const spirv::Module& module_;
  Report& report_;
};

}  // namespace

void checkResources(const ProgramInput& input, Report& report) {
  for (const PipelineStage& stage : input.graph.stages)
    if (stage.facts) ResourceRule(input, stage, report).check();
}

}  // namespace quintet::check
