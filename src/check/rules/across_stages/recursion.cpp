// SPDX-License-Identifier: Apache-2.0
// Q401, Q402: depth of nested traces and calls; the depth and the minimum stack size that the pipeline needs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "check/rules/rules.h"

namespace quintet::check {
namespace {

// The longest chains of traces. A stage without traces has depth 0, ray generation usually 1.
class TraceChains {
 public:
  explicit TraceChains(const PipelineGraph& graph)
      : graph_(graph),
        state_(graph.stages.size(), 0),
        depth_(graph.stages.size(), 0),
        steps_(graph.stages.size()),
        bytes_(graph.stages.size(), 0) {
    for (const PipelineStage& stage : graph.stages) frame_.push_back(stage.facts ? stage.facts->frameBytes() : 0);
    for (std::size_t i = 0; i < graph.stages.size(); ++i)
      if (graph.stages[i].kind == shader::Stage::rayGeneration && graph.stages[i].facts) visit(i);
  }

  struct Cycle {
    const TraceSite* site = nullptr;  // the trace that closes the cycle
    std::vector<std::size_t> stages;
    const Edge* edge = nullptr;  // of that trace
  };
  const std::vector<Cycle>& cycles() const { return cycles_; }  // the first one, or all if Q401 reports them

  std::uint32_t depth(std::size_t stage) const { return depth_[stage]; }
  std::uint64_t bytes(std::size_t stage) const { return bytes_[stage]; }

  // "a.rgen:12 -> b.rchit:20 -> sky.rmiss"
  std::string chain(std::size_t stage) const {
    std::vector<std::string> names;
    std::size_t last = stage;
    for (const Step& step : longestChain(stage)) {
      const int line = step.site->trace->location.line;
      names.push_back(graph_.nameOf(graph_.stages[step.site->stage].file) + (line > 0 ? fmt::format(":{}", line) : ""));
      last = step.next;
    }
    names.push_back(graph_.nameOf(graph_.stages[last].file));
    return fmt::format("{}", fmt::join(names, " -> "));
  }

  // The stages of the longest chain.
  std::vector<std::size_t> stages(std::size_t stage) const {
    std::vector<std::size_t> result{stage};
    for (const Step& step : longestChain(stage))
      if (step.next != result.back()) result.push_back(step.next);
    return result;
  }

  // The outer traces of the longest chain, without the innermost one.
  std::vector<RelatedLocation> outerTraces(std::size_t stage) const {
    std::vector<RelatedLocation> result;
    for (const Step& step : longestChain(stage))
      result.push_back(relatedTo(graph_.location(*step.site), fmt::format("trace at depth {}", result.size() + 1)));
    if (!result.empty()) result.pop_back();
    return result;
  }

  // Location of the innermost trace of the longest chain.
  SourceLocation lastTrace(std::size_t stage) const {
    const std::vector<Step> steps = longestChain(stage);
    return steps.empty() ? graph_.location(graph_.stages[stage], {}) : graph_.location(*steps.back().site);
  }

 private:
  struct Step {
    const TraceSite* site = nullptr;
    std::size_t next = 0;  // the deepest stage that the trace runs
  };

  static bool traces(Role role) { return role == Role::miss || role == Role::closestHit; }

  // A trace that closes a cycle ends the chain, which has depth(stage) traces.
  std::vector<Step> longestChain(std::size_t stage) const {
    std::vector<Step> steps;
    for (std::size_t at = stage; steps.size() < depth_[stage] && steps_[at].site; at = steps.back().next)
      steps.push_back(steps_[at]);
    return steps;
  }

  // Depth-first search; its recursion is limited by the number of stages.
  void visit(std::size_t stage) {
    state_[stage] = 1;
    path_.push_back(stage);
    std::uint64_t below = 0;
    for (const TraceSite& site : graph_.tracesOf(stage)) {
      std::uint32_t depth = 1;
      Step step{site.edges.empty() && !site.isSearch() ? nullptr : &site, stage};
      for (const Edge& edge : site.edges) {
        below = std::max(below, bytesOf(edge));
        if (!traces(edge.role)) continue;
        if (edge.role == Role::miss ? site.assumesMisses : site.assumesHits) {
          if (state_[edge.stage] == 0) visit(edge.stage);
          continue;
        }
        if (state_[edge.stage] == 1) {
          addCycle(site, edge);
          if (step.next == stage) step.next = edge.stage;
          continue;
        }
        if (state_[edge.stage] == 0) visit(edge.stage);
        below = std::max(below, bytes_[edge.stage]);
        if (step.next == stage || 1 + depth_[edge.stage] > depth) step.next = edge.stage;
        depth = std::max(depth, 1 + depth_[edge.stage]);
      }
      addAssumed(site, Role::closestHit, depth, step);
      addAssumed(site, Role::miss, depth, step);
      if (depth > depth_[stage]) depth_[stage] = depth, steps_[stage] = step;
    }
    for (const CallSite& site : graph_.callsOf(stage))
      for (const Edge& edge : site.edges) below = std::max(below, bytesOf(edge));
    bytes_[stage] = frame_[stage] + below;
    path_.pop_back();
    state_[stage] = 2;
  }

  // Only Q401 needs all cycles: thousands of hit shaders can close millions.
  void addCycle(const TraceSite& site, const Edge& edge) {
    if (!cycles_.empty() && !(graph_.usesLibrary && !graph_.groups.declaredRecursion)) return;
    const auto start = std::ranges::find(path_, edge.stage);
    cycles_.push_back({&site, {start, path_.end()}, &edge});
  }

  // If it is unknown which of the shaders runs, the chain has at least the length of the shortest one.
  void addAssumed(const TraceSite& site, Role role, std::uint32_t& depth, Step& step) const {
    if (site.mayRunNothing || (role == Role::miss ? !site.assumesMisses : !site.assumesHits)) return;
    const auto is = [&](const Edge& edge) { return edge.role == role; };
    const auto count = std::ranges::count_if(site.edges, is);
    const std::size_t all = role == Role::miss ? graph_.groups.misses.size() : site.hits.size();
    if (count == 0 || static_cast<std::size_t>(count) < all) return;  // a hit without a closest-hit shader
    const Edge* shortest = nullptr;
    for (const Edge& edge : site.edges) {
      if (!is(edge)) continue;
      if (state_[edge.stage] == 1) return;
      if (!shortest || depth_[edge.stage] < depth_[shortest->stage]) shortest = &edge;
    }
    if (step.next == site.stage || 1 + depth_[shortest->stage] > depth) step.next = shortest->stage;
    depth = std::max(depth, 1 + depth_[shortest->stage]);
  }

  std::uint64_t bytesOf(const Edge& edge) const { return frame_[edge.stage]; }

  const PipelineGraph& graph_;
  std::vector<int> state_;  // 0 new, 1 on the current path, 2 done
  std::vector<std::uint32_t> depth_;
  std::vector<Step> steps_;  // first trace of the longest chain
  std::vector<std::uint64_t> bytes_, frame_;
  std::vector<std::size_t> path_;
  std::vector<Cycle> cycles_;
};

std::string cycleText(const PipelineGraph& graph, const TraceChains::Cycle& cycle) {
  if (cycle.stages.size() == 1)
    return fmt::format("this trace can run its own stage again: the {}", graph.describe(*cycle.edge));
  std::vector<std::string> names;
  for (const std::size_t stage : cycle.stages) names.push_back(graph.nameOf(graph.stages[stage].file));
  return fmt::format("this trace closes a cycle: {} -> {}", fmt::join(names, " -> "), names.front());
}

// The other traces of a cycle, and the shader that runs again.
std::vector<RelatedLocation> otherTraces(const PipelineGraph& graph, const TraceChains::Cycle& cycle) {
  std::vector<RelatedLocation> result;
  for (std::size_t i = 0; i + 1 < cycle.stages.size(); ++i) {
    const auto continues = [&](const TraceSite& site) {
      return site.stage == cycle.stages[i] &&
             std::ranges::find(site.edges, cycle.stages[i + 1], &Edge::stage) != site.edges.end();
    };
    const auto found = std::ranges::find_if(graph.traces, continues);
    if (found != graph.traces.end()) result.push_back(relatedTo(graph.location(*found), "trace of the cycle"));
  }
  const auto* payload = graph.facts(*cycle.edge).incoming(spv::StorageClass::IncomingRayPayloadKHR);
  if (payload)
    result.push_back(relatedTo(graph.declarationOf(graph.stages[cycle.edge->stage], *payload),
                               "payload of the shader that runs again"));
  return result;
}

// Checks nested calls of callable shaders. The default stack size of a Vulkan pipeline allows for two levels
// (specification, "Ray Tracing Pipeline Stack").
class CallChains {
 public:
  CallChains(const PipelineGraph& graph, Report& report)
      : graph_(graph), report_(report), depth_(graph.stages.size(), -1) {
    for (std::size_t i = 0; i < graph.stages.size(); ++i) visit(i);
  }

 private:
  static constexpr int kOpen = -2, kMaxDepth = 2;

  // Returns the depth of nested calls below a stage. The recursion is limited by the number of stages.
  int visit(std::size_t stage) {
    if (depth_[stage] != -1) return depth_[stage];
    depth_[stage] = kOpen;
    int depth = 0;
    for (const CallSite& site : graph_.callsOf(stage)) {
      const SourceLocation location = graph_.location(site);
      for (const Edge& edge : site.edges) {
        if (!graph_.usesLibrary && !edge.exact) continue;  // which shader runs is unknown
        const int below = visit(edge.stage);
        if (below == kOpen)
          report_.add("Q401", location,
                      fmt::format("this call closes a cycle: the {} can call itself", graph_.describe(edge)));
        if (below == kMaxDepth && graph_.usesLibrary)  // other applications can set the size of the stack
          report_.add("Q402", location,
                      fmt::format("calls are nested {} deep from here, through the {}; the stack allows {}", below + 1,
                                  graph_.describe(edge), kMaxDepth));
        depth = std::max(depth, below + 1);
      }
    }
    return depth_[stage] = depth;
  }

  const PipelineGraph& graph_;
  Report& report_;
  std::vector<int> depth_;  // by stage; -1 new, kOpen on the current path
};

}  // namespace

// The ray generation shader with the longest chain of traces.
std::optional<std::size_t> deepestStart(const PipelineGraph& graph, const TraceChains& chains) {
  std::optional<std::size_t> deepest;
  for (const std::string& file : graph.groups.rayGenerations) {
    const PipelineStage* start = graph.stage(file);
    if (!start || !start->facts) continue;
    const auto stage = static_cast<std::size_t>(start - graph.stages.data());
    if (!deepest || chains.depth(stage) > chains.depth(*deepest)) deepest = stage;
  }
  return deepest;
}

RecursionNeeds checkRecursion(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  const auto& declared = graph.groups.declaredRecursion;
  RecursionNeeds needs{declared.value_or(1), 0, false};
  const TraceChains chains(graph);
  const CallChains calls(graph, report);
  const std::optional<std::size_t> start = deepestStart(graph, chains);
  if (!start) return needs;
  const std::size_t stage = *start;
  const std::uint32_t derived = std::max(1u, chains.depth(stage));
  const bool cyclic = needs.cyclic = !chains.cycles().empty();
  needs.depth = derived;
  needs.stackBytes = chains.bytes(stage);
  needs.chain = chains.stages(stage);
  if (cyclic) {
    needs.depth = std::max(derived, declared.value_or(input.limits.maxRecursion));
    needs.stackBytes += (needs.depth - derived) * chains.bytes(chains.cycles().front().stages.front());
  }
  // A pipeline always declares a bound; a description of raw modules that has none does not say it.
  if (!declared && graph.usesLibrary)
    for (const TraceChains::Cycle& cycle : chains.cycles())
      report.add("Q401", graph.location(*cycle.site),
                 cycleText(graph, cycle) + fmt::format("; the {} declares no bound", graph.groups.noun),
                 otherTraces(graph, cycle));
  if (declared && *declared < derived)
    report.add("Q402", chains.lastTrace(stage),
               fmt::format("traces are nested {} deep ({}), but the {} declares {}", derived, chains.chain(stage),
                           graph.groups.noun, *declared),
               chains.outerTraces(stage));
  if ((!cyclic || declared) && needs.depth > input.limits.maxRecursion)
    report.add(
        "Q402", chains.lastTrace(stage),
        fmt::format("traces are nested {} deep ({}); {} {}", needs.depth, cyclic ? "declared" : chains.chain(stage),
                    input.limits.name.empty() ? "Vulkan devices allow" : input.limits.name + " allows",
                    input.limits.maxRecursion),
        chains.outerTraces(stage));
  return needs;
}

}  // namespace quintet::check
