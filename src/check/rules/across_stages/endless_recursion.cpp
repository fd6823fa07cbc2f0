// SPDX-License-Identifier: Apache-2.0
// Q403: recursion that no condition ends. A stage counts if it traces on each path, if nothing that its caller passes
// can disable the trace, and if each hit, or a miss, runs such a stage again.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "check/rules/rules.h"
#include "spirv/access.h"

namespace quintet::check {
namespace {

using spv::Op;

// True if the instruction runs on each path from the start of the entry function to its end.
bool runsAlways(const spirv::StageFacts& facts, std::size_t instruction) {
  const spirv::Module& module = facts.module();
  const auto position = module.position(instruction);
  const spirv::Function* entry = module.entry();
  if (!position || !entry || &module.functions()[position->function] != entry) return false;
  std::vector<bool> seen(entry->blocks.size(), false);
  std::vector<std::size_t> open{0};
  while (!open.empty()) {
    const std::size_t block = open.back();
    open.pop_back();
    if (block == position->block || seen[block]) continue;
    seen[block] = true;
    if (entry->blocks[block].successors.empty()) return false;
    open.insert(open.end(), entry->blocks[block].successors.begin(), entry->blocks[block].successors.end());
  }
  return true;
}

// True if the value can depend on the caller: on the payload, on the incoming ray, or on an image. Shaders do not write
// the buffers that they read.
bool dependsOnCaller(const spirv::StageFacts& facts, std::size_t function, spirv::Id value) {
  const spirv::Module& module = facts.module();
  return spirv::dependsOnDataOrControl(module, facts.flow(function), value, [&](const spirv::Instruction& i) {
    if (i.op == Op::OpImageRead || i.op == Op::OpFunctionCall || i.op == Op::OpAtomicIAdd) return true;
    if (i.op != Op::OpLoad) return false;
    const spirv::Variable* variable = module.variable(module.access(i.at(0)).variable);
    if (variable && variable->builtIn) {
      // The interval and flags of the incoming ray can count its depth, too.
      return *variable->builtIn == spv::BuiltIn::RayTminKHR || *variable->builtIn == spv::BuiltIn::RayTmaxKHR ||
             *variable->builtIn == spv::BuiltIn::IncomingRayFlagsKHR || *variable->builtIn == spv::BuiltIn::CullMaskKHR;
    }
    return !spirv::isLocal(module, module.access(i.at(0)).variable) && !spirv::bufferMember(module, i);
  });
}

class EndlessRecursion {
 public:
  explicit EndlessRecursion(const CheckInput& input) : input_(input), graph_(input.graph) {
    for (const TraceSite& site : graph_.traces)
      if (isUnconditional(site)) sites_.push_back(&site);
    // The largest set of traces of which each leads to a stage with another one.
    for (bool changed = true; changed;) {
      noteStages();
      changed = std::erase_if(sites_, [&](const TraceSite* site) { return !next(*site); }) > 0;
    }
  }

  // Returns the traces of which each closes a cycle, with the stage that it runs.
  std::vector<std::pair<const TraceSite*, const Edge*>> cycles() {
    std::vector<std::pair<const TraceSite*, const Edge*>> result;
    for (const TraceSite* site : sites_) {
      const Edge* edge = next(*site);
      if (edge && reaches(edge->stage, site->stage)) result.emplace_back(site, edge);
    }
    return result;
  }

 private:
  bool isUnconditional(const TraceSite& site) {
    const shader::Stage kind = graph_.stages[site.stage].kind;
    if (kind != shader::Stage::closestHit && kind != shader::Stage::miss) return false;
    const spirv::StageFacts& facts = graph_.facts(site);
    const std::size_t at = site.trace->instruction;
    const auto position = facts.module().position(at);
    if (!position || !runsAlways(facts, at) || !site.trace->mask.known) return false;
    if (std::ranges::any_of(site.trace->mask.values, [](std::uint32_t mask) { return (mask & 0xFFu) == 0; }))
      return false;
    const auto ray = graph_.ray(site);
    if (!ray || site.isSearch()) return false;
    for (const spirv::Id argument : {ray->flags, ray->mask, ray->offset, ray->stride, ray->miss, ray->tmin, ray->tmax})
      if (dependsOnCaller(facts, position->function, argument)) return false;
    // An any-hit shader can end the recursion by ignoring hits.
    const auto [ignores, isNew] = ignores_.try_emplace(site.targets, false);
    if (isNew)
      ignores->second = std::ranges::any_of(site.hits, [&](HitGroupRay hit) {
        const PipelineStage* anyHit = graph_.stage(graph_.shaders(hit).anyHit);
        return anyHit && anyHit->facts && anyHit->facts->ignores();
      });
    return !ignores->second;
  }

  // Notes the stages of `sites_`, on which next() depends.
  void noteStages() {
    hasSite_.assign(graph_.stages.size(), false);
    for (const TraceSite* site : sites_) hasSite_[site->stage] = true;
    next_.clear();
  }

  bool isUsed(std::size_t group) const { return !input_.usedGroups || input_.usedGroups->contains(group); }

  // A single surface can be convex: then no ray that leaves it hits it again. An unknown scene can be such a surface.
  bool canBeConvex() const {
    return !input_.scene || (input_.scene->instances.size() == 1 && input_.scene->instances[0].geometryCount == 1);
  }

  // Returns the edge to a stage with such a trace if each hit of the trace, or its miss, runs one; else null.
  const Edge* next(const TraceSite& site) {
    const auto [known, isNew] = next_.try_emplace(site.targets, nullptr);
    if (isNew) known->second = findNext(site);
    return known->second;
  }

  const Edge* findNext(const TraceSite& site) const {
    const Edge* found = nullptr;
    bool allHits = !site.skipsClosestHit() && !canBeConvex() && !site.assumesHits;
    for (const HitGroupRay hit : site.hits) {
      if (!allHits) break;
      if (!isUsed(hit.group)) continue;
      const std::span<const Edge> edges = edgesOf(site.edges, hit);
      const auto edge = std::ranges::find_if(
          edges, [&](const Edge& e) { return e.role == Role::closestHit && e.exact && hasSite_[e.stage]; });
      allHits = edge != edges.end();
      if (allHits) found = &*edge;
    }
    if (allHits && found) return found;
    for (const Edge& edge : site.edges) {
      if (edge.role != Role::miss) break;  // they come first
      if (edge.exact && hasSite_[edge.stage]) return &edge;
    }
    return nullptr;
  }

  bool reaches(std::size_t from, std::size_t to) const {
    std::vector<bool> seen(graph_.stages.size(), false), followed(graph_.targets.size(), false);
    std::vector<std::size_t> open{from};
    while (!open.empty()) {
      const std::size_t stage = open.back();
      open.pop_back();
      if (stage == to) return true;
      if (seen[stage]) continue;
      seen[stage] = true;
      const auto first = std::ranges::lower_bound(sites_, stage, {}, &TraceSite::stage);
      for (auto next = first; next != sites_.end() && (*next)->stage == stage; ++next) {
        const TraceSite* site = *next;
        if (followed[site->targets]) continue;
        followed[site->targets] = true;
        for (const Edge& edge : site->edges)
          if ((edge.role == Role::closestHit || edge.role == Role::miss) && !seen[edge.stage])
            open.push_back(edge.stage);
      }
    }
    return false;
  }

  const CheckInput& input_;
  const PipelineGraph& graph_;
  std::vector<const TraceSite*> sites_;      // in the order of their stages
  std::vector<bool> hasSite_;                // by stage
  std::map<std::size_t, const Edge*> next_;  // by targets
  std::map<std::size_t, bool> ignores_;      // by targets: an any-hit shader ignores hits
};

}  // namespace

void checkEndlessRecursion(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  if (!graph.groups.declaredRecursion) return;  // Q401
  const std::set<std::size_t> reachable = graph.reachableStages();
  for (const auto& [site, edge] : EndlessRecursion(input).cycles()) {
    if (!reachable.contains(site->stage)) continue;
    report.add(
        "Q403", graph.location(*site),
        fmt::format("this trace always runs and its {} runs the {}, which traces again: no condition ends the "
                    "recursion at the declared depth {}",
                    edge->role == Role::miss ? "miss" : "hit", graph.describe(*edge), *graph.groups.declaredRecursion));
  }
}

}  // namespace quintet::check
