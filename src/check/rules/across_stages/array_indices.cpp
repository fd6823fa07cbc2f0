// SPDX-License-Identifier: Apache-2.0
// Q711: indices beyond an array of constant size. With a scene, the numbers of its instances and geometries count.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/parallel.h"
#include "check/rules/rules.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spirv::Type;
using spirv::ValueRange;
using spv::Op;

class IndexRule {
 public:
  IndexRule(const spirv::Module& module, const spirv::ValueRanges& ranges, const program::SceneFacts* scene,
            Report& report)
      : module_(module), ranges_(ranges), scene_(scene), report_(report) {}

  void check() {
    for (std::size_t i = 0; i < module_.instructions().size(); ++i) {
      const spirv::Instruction& chain = module_.instructions()[i];
      if (module_.position(i) && (chain.op == Op::OpAccessChain || chain.op == Op::OpInBoundsAccessChain))
        checkChain(chain);
    }
  }

 private:
  void checkChain(const spirv::Instruction& chain) {
    const spirv::Instruction* base = module_.definition(chain.at(0));
    spirv::Id type = module_.types().get(base ? base->type : 0).element;
    std::string name = module_.name(chain.at(0));
    for (std::size_t i = 1; i < chain.operands.size(); ++i) {
      const Type& composite = module_.types().get(type);
      const std::optional<std::uint32_t> literal = module_.constantBits(chain.at(i));
      const bool counted = composite.kind == Type::Kind::array || composite.kind == Type::Kind::vector ||
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

  // Checks the index where a load or store uses the pointer.
  void checkIndex(const spirv::Instruction& chain, spirv::Id index, const Type& array, const std::string& name) {
    for (const std::size_t user : module_.users(chain.result)) {
      const spirv::Instruction& use = module_.instructions()[user];
      if (use.op != Op::OpLoad && use.op != Op::OpStore) continue;
      const ValueRange range = ranges_.rangeAt(user, index);
      if (range.empty()) continue;
      const bool negative = range.max < 0.0;
      const std::optional<double> value = negative ? std::optional(range.max) : range.atLeast(array.count);
      if (!value) continue;
      const bool always = negative || range.min >= array.count;
      if (!always && (ranges_.guarded(user, index) || isSelected(use, index))) continue;
      // Without debug information, glslang calls a constant array "indexable".
      const bool named = !name.empty() && name != "indexable";
      report_.addOncePerLine("Q711", module_.location(use),
                             fmt::format("the index of {} {} {:.0f}{}, but it has {} {} (index 0 to {})",
                                         named ? "'" + name + "'" : "this array",
                                         range.constant() ? "is"
                                         : always         ? (negative ? "is at most" : "is at least")
                                                          : "can be",
                                         *value, causeText(index), array.count,
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

  // " (gl_InstanceCustomIndexEXT in scene.toml)"
  std::string causeText(spirv::Id index) const {
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
  const program::SceneFacts* scene_;
  Report& report_;
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
    IndexRule(module, ranges, input.scene, ofStage).check();
    found[i] = ofStage.take();
  });
  for (std::size_t i = 0; i < found.size(); ++i)
    for (Diagnostic& d : found[i])
      report.add(d.id, graph.location(graph.stages[i], {d.file, d.line, d.column}), std::move(d.text));
}

}  // namespace quintet::check
