// SPDX-License-Identifier: Apache-2.0
#include "check/rules/across_stages/shared_data.h"

#include <fmt/format.h>

#include <algorithm>

#include "spirv/glsl_declaration.h"

namespace quintet::check {

using spv::Op;

void addTo(std::vector<LeafGroup>& groups, LeafText text, std::uint32_t leaf, std::size_t read) {
  const auto found = std::ranges::find(groups, text, &LeafGroup::text);
  if (found == groups.end()) {
    groups.push_back({std::move(text), {leaf}, read});
  } else {
    found->leaves.push_back(leaf);
    found->read = std::min(found->read, read);
  }
}

std::string nameOf(const spirv::SharedVariable& variable, const std::string& part) {
  if (variable.name.empty())
    return part.empty() ? "the variable" : fmt::format("'{}'", part.starts_with('.') ? part.substr(1) : part);
  return fmt::format("'{}{}'", variable.name, part);
}

SourceLocation locationOf(const spirv::StageFacts& facts, const spirv::AccessFacts& access) {
  return facts.module().location(facts.module().instructions()[access.instruction]);
}

std::string readLine(const spirv::StageFacts& facts, std::size_t access, const std::string& file) {
  const SourceLocation location = locationOf(facts, facts.accesses()[access]);
  if (location.line == 0) return {};
  return location.file == file ? fmt::format(" (line {})", location.line)
                               : fmt::format(" ({}:{})", location.file, location.line);
}

std::vector<bool> sameTypes(const PipelineGraph& graph, std::span<const Edge> edges, const spirv::StageFacts& sender,
                            const spirv::SharedVariable& sent, spv::StorageClass incoming) {
  std::vector<bool> result;
  for (const Edge& edge : edges) {
    const spirv::StageFacts& facts = graph.facts(edge);
    const spirv::SharedVariable* received = facts.incoming(incoming);
    // Without values of specialization constants, one of two equal types can have fewer leaves.
    const auto agree = [&] {
      return !differenceOf(sender.module().types(), sent.type, facts.module().types(), received->type) &&
             sender.leaves(sent.id).count() == facts.leaves(received->id).count();
    };
    result.push_back(!received || agree());
  }
  return result;
}

bool hasEffects(const spirv::StageFacts& facts) {
  if (!facts.traces().empty() || !facts.calls().empty()) return true;
  const spirv::Module& module = facts.module();
  return std::ranges::any_of(module.instructions(), [&](const spirv::Instruction& i) {
    if (i.op >= Op::OpAtomicStore && i.op <= Op::OpAtomicXor) return true;
    if (i.op == Op::OpImageWrite || i.op == Op::OpFunctionCall) return true;
    if (i.op != Op::OpStore) return false;
    const spirv::Id variable = module.access(i.at(0)).variable;
    const spirv::Instruction* definition = module.definition(variable);
    const auto storage = definition && definition->op == Op::OpVariable
                             ? static_cast<spv::StorageClass>(definition->at(0))
                             : spv::StorageClass::Max;
    return storage != spv::StorageClass::Function && storage != spv::StorageClass::Private && !facts.variable(variable);
  });
}

SourceLocation mainLocation(const PipelineGraph& graph, const PipelineStage& stage) {
  if (stage.facts && !graph.usesLibrary) {
    const spirv::Module& module = stage.facts->module();
    const spirv::Function* entry = module.entry();
    const SourceLocation declared = entry ? module.declaration(entry->id) : SourceLocation{};
    if (declared.line > 0) return declared;
    for (const auto& [file, text] : module.sources())
      if (const auto found = spirv::findWord(text, "main"))
        return {found->file.empty() ? file : found->file, found->line, found->column};
    return graph.location(stage, {});
  }
  if (stage.facts) {
    const std::string own = graph.groups.path(stage.file);
    for (const auto& [file, text] : stage.facts->module().sources()) {
      const auto found = spirv::findWord(text, "main");
      if (!found) continue;
      const std::string& name = found->file.empty() ? file : found->file;
      // A file that is included can have a main() too.
      if (found->file.empty() && stage.facts->module().sources().size() > 1 && !file.ends_with(own)) continue;
      return {name, found->line, found->column};
    }
  }
  return graph.location(stage, {});
}

}  // namespace quintet::check
