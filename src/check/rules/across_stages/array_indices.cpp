// SPDX-License-Identifier: Apache-2.0
// Q711: indices beyond an array of constant size, or beyond an array of descriptors whose length the pipeline layout has. With a
// scene, the numbers of its instances and geometries count; with a shader binding table, the data of its records.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "check/rules/rules.h"
#include "spirv/control_flow.h"
#include "spirv/shader_record.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spirv::Type;
using spirv::ValueRange;
using spv::Op;

// What a buffer, an image or a built-in of the hit says: it can be related to the data of the record, or to the instance.
bool loadsOfHit(const spirv::Module& module, const spirv::Instruction& i) {
  if (i.op == Op::OpImageRead || i.op == Op::OpImageFetch || i.op == Op::OpFunctionCall) return true;
  if (i.op != Op::OpLoad) return false;
  if (const auto builtIn = spirv::loadedBuiltIn(module, i))
    return builtIn == spv::BuiltIn::PrimitiveId || builtIn == spv::BuiltIn::InstanceId ||
           builtIn == spv::BuiltIn::InstanceCustomIndexKHR || builtIn == spv::BuiltIn::RayGeometryIndexKHR;
  const spirv::Instruction* base = module.definition(module.access(i.at(0)).base);
  const Type& pointer = module.types().get(base ? base->type : 0);
  if (pointer.kind != Type::Kind::pointer) return true;
  switch (static_cast<spv::StorageClass>(pointer.storage)) {
    case spv::StorageClass::Uniform:
    case spv::StorageClass::UniformConstant:
    case spv::StorageClass::StorageBuffer:
    case spv::StorageClass::PhysicalStorageBuffer:
    case spv::StorageClass::PushConstant:
    case spv::StorageClass::ShaderRecordBufferKHR: return true;
    default: return false;
  }
}

class IndexRule {
 public:
  IndexRule(const spirv::Module& module, const spirv::ValueRanges& ranges, const CheckInput& input, Report& report)
      : module_(module),
        ranges_(ranges),
        counts_(input.graph.groups.descriptorCounts),
        scene_(input.scene),
        isRaw_(!input.graph.usesLibrary),
        report_(report) {}

  void check() {
    for (std::size_t i = 0; i < module_.instructions().size(); ++i) {
      const spirv::Instruction& chain = module_.instructions()[i];
      if (module_.position(i) && (chain.op == Op::OpAccessChain || chain.op == Op::OpInBoundsAccessChain))
        checkChain(chain);
    }
  }

  // Only the indices that depend on the data of the record, which `name` is.
  void checkRecord(const std::string& name) {
    record_ = name;
    check();
  }

 private:
  // The length of an array of descriptors that has none in the module; 0 if it is unknown.
  std::uint32_t lengthOf(spirv::Id variable) const {
    if (!module_.variable(variable)) return 0;
    const auto set = module_.decoration(variable, spv::Decoration::DescriptorSet);
    const auto binding = module_.decoration(variable, spv::Decoration::Binding);
    if (!set || !binding) return 0;
    const auto found = counts_.find({*set, *binding});
    return found == counts_.end() ? 0 : found->second;
  }

  void checkChain(const spirv::Instruction& chain) {
    const spirv::Instruction* base = module_.definition(chain.at(0));
    spirv::Id type = module_.types().get(base ? base->type : 0).element;
    std::string name = module_.name(chain.at(0));
    for (std::size_t i = 1; i < chain.operands.size(); ++i) {
      Type composite = module_.types().get(type);
      const std::optional<std::uint32_t> literal = module_.constantBits(chain.at(i));
      const bool isUnsized = composite.kind == Type::Kind::runtimeArray && i == 1;
      if (isUnsized) composite.count = lengthOf(chain.at(0));
      const bool counted = isUnsized || composite.kind == Type::Kind::array || composite.kind == Type::Kind::vector ||
                           composite.kind == Type::Kind::matrix;
      if (counted && composite.count > 0 && (!literal || *literal >= composite.count))
        checkIndex(chain, chain.at(i), composite, name);
      if (composite.kind == Type::Kind::structure) {
        if (!literal || *literal >= composite.members.size()) return;
        name = composite.memberNames[*literal];
        type = composite.members[*literal];
      } else {
        type = composite.element;
      }
    }
  }

  // The loads, stores and texel accesses through the pointer, also through further chains.
  std::vector<std::size_t> usesOf(const spirv::Instruction& chain) const {
    std::vector<std::size_t> uses;
    std::vector<spirv::Id> pointers{chain.result};
    for (std::size_t k = 0; k < pointers.size(); ++k)
      for (const std::size_t user : module_.users(pointers[k])) {
        const spirv::Instruction& use = module_.instructions()[user];
        if (use.op == Op::OpLoad || use.op == Op::OpStore || use.op == Op::OpImageTexelPointer)
          uses.push_back(user);
        else if ((spirv::isAccessChain(use.op) || use.op == Op::OpCopyObject) && use.at(0) == pointers[k])
          pointers.push_back(use.result);
      }
    return uses;
  }

  // Checks the index where an instruction uses the pointer.
  void checkIndex(const spirv::Instruction& chain, spirv::Id index, const Type& array, const std::string& name) {
    const auto isRecord = [&](const spirv::Instruction& i) { return spirv::loadsRecord(module_, i); };
    if (!record_.empty() && !spirv::dependsOn(module_, index, isRecord)) return;
    for (const std::size_t user : usesOf(chain)) {
      const spirv::Instruction& use = module_.instructions()[user];
      const ValueRange range = ranges_.rangeAt(user, index);
      if (range.empty()) continue;
      const bool negative = range.max < 0.0;
      const std::optional<double> value = negative ? std::optional(range.max) : range.atLeast(array.count);
      if (!value) continue;
      const bool always = negative || range.min >= array.count;
      if (!always && (ranges_.guarded(user, index) || isSelected(use, index))) continue;
      const std::string cause = causeText(index);
      if (isRaw_ && !cause.empty() && dependsOnHit(user)) continue;
      // Without debug information, glslang calls a constant array "indexable".
      const bool named = !name.empty() && name != "indexable";
      report_.addOncePerLine("Q711", module_.location(use),
                             fmt::format("the index of {} {} {:.0f}{}, but it has {} {} (index 0 to {})",
                                         named ? "'" + name + "'" : "this array",
                                         range.constant() ? "is"
                                         : always         ? (negative ? "is at most" : "is at least")
                                                          : "can be",
                                         *value, cause, array.count,
                                         array.kind == Type::Kind::vector   ? "components"
                                         : array.kind == Type::Kind::matrix ? "columns"
                                                                            : "elements",
                                         array.count - 1));
      return;
    }
  }

  // True if a condition that depends on what the index is computed from selects the loaded value: the optimizer replaces
  // branches by selects.
  bool isSelected(const spirv::Instruction& load, spirv::Id index) const {
    const spirv::InstructionTest isSource = spirv::sourcesOf(module_, index);
    if (load.op != Op::OpLoad || !isSource) return false;
    const auto isLoad = [&](const spirv::Instruction& i) { return &i == &load; };
    return spirv::findInUses(
               module_, load.result,
               [&](const spirv::Instruction& i) {
                 return i.op == Op::OpSelect && spirv::dependsOn(module_, i.at(0), isSource, isLoad);
               },
               [](const spirv::Instruction& i) { return i.op == Op::OpStore; }) != nullptr;
  }

  // True if a condition that is related to the hit decides whether the instruction runs, or whether its value is used. The index can
  // be valid wherever the condition holds.
  bool dependsOnHit(std::size_t user) {
    const auto isOfHit = [&](const spirv::Instruction& i) { return loadsOfHit(module_, i); };
    const auto position = module_.position(user);
    if (!position) return true;
    const auto [flow, isNew] = flows_.try_emplace(position->function, module_, position->function);
    for (const std::size_t block : flow->second.controllers(position->block)) {
      const spirv::Id condition = flow->second.condition(block);
      if (!ranges_.range(condition).constant() &&
          spirv::dependsOnDataOrControl(module_, flow->second, condition, isOfHit))
        return true;
    }
    const spirv::Instruction& load = module_.instructions()[user];
    const auto isLoad = [&](const spirv::Instruction& i) { return &i == &load; };
    return load.op == Op::OpLoad && spirv::findInUses(
                                        module_, load.result,
                                        [&](const spirv::Instruction& i) {
                                          return i.op == Op::OpSelect &&
                                                 spirv::dependsOn(module_, i.at(0), isOfHit, isLoad);
                                        },
                                        [](const spirv::Instruction& i) { return i.op == Op::OpStore; }) != nullptr;
  }

  // " (gl_InstanceCustomIndexEXT in scene.toml)", " (data of hit record 3)"
  std::string causeText(spirv::Id index) const {
    if (!record_.empty()) return fmt::format(" (data of {})", record_);
    if (!scene_) return {};
    const spirv::Instruction* found = spirv::findInSlice(module_, index, [&](const spirv::Instruction& i) {
      const auto builtIn = spirv::loadedBuiltIn(module_, i);
      return builtIn == spv::BuiltIn::InstanceCustomIndexKHR || builtIn == spv::BuiltIn::InstanceId ||
             builtIn == spv::BuiltIn::RayGeometryIndexKHR;
    });
    if (!found) return {};
    return fmt::format(" ({} in {})", spirv::glslName(*spirv::loadedBuiltIn(module_, *found)), scene_->name);
  }

  const spirv::Module& module_;
  const spirv::ValueRanges& ranges_;
  const DescriptorCounts& counts_;
  const program::SceneFacts* scene_;
  const bool isRaw_;
  Report& report_;
  std::string record_;                               // empty for all records
  std::map<std::size_t, spirv::ControlFlow> flows_;  // by function
};

}  // namespace

void checkArrayIndices(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  std::vector<std::vector<Diagnostic>> found(graph.stages.size());
  parallelFor(graph.stages.size(), [&](std::size_t i) {
    const PipelineStage& stage = graph.stages[i];
    if (!stage.facts) return;
    const spirv::Module& module = stage.facts->module();
    const spirv::ValueRanges ranges(module, graph.context(stage.file, input.scene));
    Report ofStage;
    IndexRule(module, ranges, input, ofStage).check();
    if (spirv::indexesByRecord(module))
      for (const RecordRuns& runs : graph.recordRuns(stage.file))
        IndexRule(module, spirv::ValueRanges(module, runs.context), input, ofStage).checkRecord(runs.record);
    found[i] = ofStage.take();
  });
  for (std::size_t i = 0; i < found.size(); ++i)
    for (Diagnostic& d : found[i])
      report.add(d.id, graph.location(graph.stages[i], {d.file, d.line, d.column}), std::move(d.text));
}

}  // namespace quintet::check
