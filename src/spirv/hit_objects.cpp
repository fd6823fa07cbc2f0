// SPDX-License-Identifier: Apache-2.0
#include "spirv/hit_objects.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "spirv/trace_instruction.h"

namespace quintet::spirv {
namespace {

using spv::Op;

// The variable that is the hit object; 0 for elements of arrays and parameters.
Id hitObject(const Module& module, Id pointer) {
  const Instruction* definition = module.definition(pointer);
  return definition && definition->op == Op::OpVariable ? pointer : 0;
}

bool onlyReads(const Module& module, const Instruction& use) {
  return queriesHitObject(module, use) || use.op == Op::OpHitObjectExecuteShaderNV ||
         use.op == Op::OpReorderThreadWithHitObjectNV || use.op == Op::OpHitObjectGetAttributesNV;
}

class ContentSearch {
 public:
  ContentSearch(const Module& module, const std::vector<ControlFlow>& flows, std::size_t execution)
      : module_(module),
        flows_(flows),
        execution_(execution),
        object_(hitObject(module, module.instructions()[execution].at(0))) {}

  HitObjectContent find() {
    const auto sources = object_ == 0 ? std::nullopt : sourcesOf(execution_);
    if (!sources) return {};
    HitObjectContent result;
    for (const std::size_t source : *sources) {
      switch (module_.instructions()[source].op) {
        case Op::OpHitObjectTraceRayNV: result.traces.push_back(source); break;
        case Op::OpHitObjectRecordHitNV:
        case Op::OpHitObjectRecordHitWithIndexNV: result.hits.push_back(source); break;
        case Op::OpHitObjectRecordMissNV: result.misses.push_back(source); break;
        default: return {};  // it can be empty, or have any content
      }
    }
    // Which of several sources is executed can depend on what the first one found: `if (miss) record a different miss`.
    result.known = sources->size() == 1 && result.hits.empty();
    result.mayBeHit = !result.traces.empty() || !result.hits.empty();
    result.mayBeMiss = !result.traces.empty() || !result.misses.empty();
    for (const std::size_t source : *sources) applyConditions(source, *sources, result);
    result.known = result.known && (result.mayBeHit || result.mayBeMiss);
    return result;
  }

 private:
  // The instructions that can have filled the object before the instruction runs; nullopt if it can be without content or in
  // use by another function.
  std::optional<std::set<std::size_t>> sourcesOf(std::size_t instruction) const {
    const auto at = module_.position(instruction);
    if (!at) return {};
    const auto& blocks = module_.functions()[at->function].blocks;
    std::vector<std::vector<std::size_t>> writers(blocks.size());
    for (const std::size_t user : module_.users(object_)) {
      const auto position = module_.position(user);
      if (!position || position->function != at->function) return {};
      if (!onlyReads(module_, module_.instructions()[user])) writers[position->block].push_back(user);
    }
    const auto before = std::ranges::lower_bound(writers[at->block], instruction);
    if (before != writers[at->block].begin()) return std::set{*std::prev(before)};
    std::set<std::size_t> found;
    std::vector<bool> seen(blocks.size(), false);
    std::vector<std::size_t> open{at->block};
    while (!open.empty()) {
      const std::size_t block = open.back();
      open.pop_back();
      if (block == 0) return {};
      for (const std::size_t previous : blocks[block].predecessors) {
        if (seen[previous] || !flows_[at->function].reachable(previous)) continue;
        seen[previous] = true;
        if (writers[previous].empty())
          open.push_back(previous);
        else
          found.insert(writers[previous].back());
      }
    }
    return found;
  }

  // The conditions between a source of the content and the execution.
  void applyConditions(std::size_t source, const std::set<std::size_t>& sources, HitObjectContent& content) const {
    const ControlFlow& flow = flows_[module_.position(execution_)->function];
    const auto& blocks = flow.function().blocks;
    const PathsAfter paths(module_, flow, source);
    for (const std::size_t guard : paths.guards(execution_)) {
      const Instruction& branch = module_.instructions()[blocks[guard].end - 1];
      std::optional<bool> holds;
      if (branch.op == Op::OpBranchConditional) {
        const auto leads = [&](Id label) {
          const auto target = std::ranges::find(blocks, label, &Block::label);
          return target != blocks.end() && paths.leadsTo(static_cast<std::size_t>(target - blocks.begin()), execution_);
        };
        const bool ifTrue = leads(branch.at(1)), ifFalse = leads(branch.at(2));
        if (ifTrue != ifFalse) holds = ifTrue;
      }
      applyCondition(flow.condition(guard), holds, source, sources, content);
    }
  }

  // What is known where a condition has a value.
  void applyCondition(Id condition, std::optional<bool> holds, std::size_t source, const std::set<std::size_t>& sources,
                      HitObjectContent& content) const {
    constexpr std::size_t kMaxParts = 64;
    std::vector<Fact> open{{condition, holds}};
    for (std::size_t k = 0; k < open.size(); ++k) {
      const Fact fact = open[k];
      const std::vector<Fact> parts = fact.holds && open.size() < kMaxParts ? impliedBy(fact) : std::vector<Fact>{};
      open.insert(open.end(), parts.begin(), parts.end());
      const Instruction* i = module_.definition(fact.condition);
      const bool asksForHit = i && i->op == Op::OpHitObjectIsHitNV, asksForMiss = i && i->op == Op::OpHitObjectIsMissNV;
      if (fact.holds && (asksForHit || asksForMiss) && i->at(0) == object_ &&
          sourcesOf(module_.definitionIndex(fact.condition)) == sources)
        (asksForHit == *fact.holds ? content.mayBeMiss : content.mayBeHit) = false;
      else if (parts.empty() && dependsOnContent(fact.condition, source))
        content.known = false;
    }
  }

  struct Fact {
    Id condition = 0;
    std::optional<bool> holds;
  };

  // The facts that together are the same as this one; none if it has no parts.
  std::vector<Fact> impliedBy(const Fact& fact) const {
    const Instruction* i = module_.definition(fact.condition);
    const bool holds = *fact.holds;
    if (!i) return {};
    switch (i->op) {
      case Op::OpLogicalNot: return {{i->at(0), !holds}};
      case Op::OpLogicalAnd:
        if (!holds) return {};
        return {{i->at(0), true}, {i->at(1), true}};
      case Op::OpLogicalOr:
        if (holds) return {};
        return {{i->at(0), false}, {i->at(1), false}};
      case Op::OpSelect:
        if (isConstant(i->at(2), !holds)) return {{i->at(0), true}, {i->at(1), holds}};
        if (isConstant(i->at(1), !holds)) return {{i->at(0), false}, {i->at(2), holds}};
        return {};
      case Op::OpPhi: return impliedByPhi(*i, holds);
      default: return {};
    }
  }

  bool isConstant(Id id, bool value) const {
    const auto bits = module_.constantBits(id);
    return bits && (*bits != 0) == value;
  }

  // The value without the negations around it, and whether their number is odd.
  std::pair<Id, bool> withoutNot(Id id) const {
    constexpr int kMaxNots = 8;
    bool negated = false;
    for (int k = 0; k < kMaxNots; ++k) {
      const Instruction* i = module_.definition(id);
      if (!i || i->op != Op::OpLogicalNot) break;
      id = i->at(0), negated = !negated;
    }
    return {id, negated};
  }

  // `a && b`: a block with the condition `a` leads to the one that computes `b`, and else to the phi.
  std::vector<Fact> impliedByPhi(const Instruction& phi, bool holds) const {
    const auto position = module_.position(module_.definitionIndex(phi.result));
    if (!position || phi.operands.size() != 4) return {};
    const auto& blocks = module_.functions()[position->function].blocks;
    const Id ownLabel = blocks[position->block].label;
    for (const std::size_t k : {0u, 2u}) {
      const auto first = std::ranges::find(blocks, phi.at(k + 1), &Block::label);
      const auto second = std::ranges::find(blocks, phi.at(3 - k), &Block::label);
      if (first == blocks.end() || second == blocks.end()) return {};
      const Instruction& branch = module_.instructions()[first->end - 1];
      const auto at = static_cast<std::size_t>(first - blocks.begin());
      if (branch.op != Op::OpBranchConditional || second->predecessors != std::vector{at}) continue;
      const bool skips = branch.at(1) == ownLabel;  // the value with which the branch leads to the phi
      if ((skips ? branch.at(2) : branch.at(1)) != second->label || branch.at(skips ? 1 : 2) != ownLabel) continue;
      const auto [value, negated] = withoutNot(phi.at(k));
      const auto [condition, opposite] = withoutNot(branch.at(0));
      const bool isCondition = value == condition;  // the edge has the value of the condition, or its opposite
      if (isCondition ? (skips != (negated != opposite)) != holds : isConstant(phi.at(k), !holds))
        return {{branch.at(0), !skips}, {phi.at(2 - k), holds}};
    }
    return {};
  }

  // True if the condition depends on a hit object, or on what any-hit shaders can have written.
  bool dependsOnContent(Id condition, std::size_t source) const {
    if (condition == 0) return true;
    const auto ray = rayOperands(module_.instructions()[source]);
    const Id payload = ray ? module_.access(ray->payload).variable : 0;
    const ControlFlow& flow = flows_[module_.position(execution_)->function];
    return dependsOnDataOrControl(module_, flow, condition, [&](const Instruction& i) {
      if (queriesHitObject(module_, i)) return true;
      return payload != 0 && i.op == Op::OpLoad && module_.access(i.at(0)).variable == payload;
    });
  }

  const Module& module_;
  const std::vector<ControlFlow>& flows_;
  std::size_t execution_;
  Id object_;
};

}  // namespace

HitObjectContent contentAt(const Module& module, const std::vector<ControlFlow>& flows, std::size_t execution) {
  return ContentSearch(module, flows, execution).find();
}

}  // namespace quintet::spirv
