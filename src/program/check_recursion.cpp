// Q401, Q402, and what the pipeline needs: the depth of nested traces and the least stack.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "program/check_parts.h"

namespace quintet::program {
namespace {

// Longest chains of traces over the stages. A stage without traces has depth 0, ray generation usually 1.
class Chains {
 public:
  explicit Chains(const LinkModel& model)
      : model_(model),
        state_(model.stages.size(), 0),
        depth_(model.stages.size(), 0),
        next_(model.stages.size(), nullptr),
        bytes_(model.stages.size(), 0) {
    for (std::size_t i = 0; i < model.stages.size(); ++i)
      if (model.stages[i].kind == shader::Stage::rayGeneration) visit(i);
  }

  struct Cycle {
    const TraceSite* site = nullptr;  // the trace that closes it
    std::vector<std::size_t> stages;
    const Edge* edge = nullptr;
  };
  const std::vector<Cycle>& cycles() const { return cycles_; }

  std::uint32_t depth(std::size_t stage) const { return depth_[stage]; }
  std::uint64_t bytes(std::size_t stage) const { return bytes_[stage]; }

  // "a.rgen:12 -> b.rchit:20 -> sky.rmiss"
  std::string chain(std::size_t stage) const {
    std::string text;
    for (std::size_t steps = 0; next_[stage] && steps < model_.stages.size(); ++steps) {
      const TraceSite& site = *next_[stage];
      text += fmt::format("{}:{} -> ", model_.stages[stage].file, site.trace->place.line);
      stage = deepest(site);
    }
    return text + model_.stages[stage].file;
  }

  // The place of the innermost trace of the longest chain.
  shader::Place lastTrace(std::size_t stage) const {
    shader::Place place = model_.at(model_.stages[stage], {});
    for (; next_[stage]; stage = deepest(*next_[stage])) {
      place = model_.at(model_.stages[stage], next_[stage]->trace->place);
      if (deepest(*next_[stage]) == stage) break;
    }
    return place;
  }

 private:
  static bool traces(Role role) { return role == Role::miss || role == Role::closestHit; }

  std::size_t deepest(const TraceSite& site) const {
    const Edge* best = nullptr;
    for (const Edge& edge : site.edges)
      if (traces(edge.role) && (!best || depth_[edge.stage] > depth_[best->stage])) best = &edge;
    return best ? best->stage : site.stage;
  }

  // Depth first; as deep as there are stages.
  void visit(std::size_t stage) {
    state_[stage] = 1;
    path_.push_back(stage);
    std::uint64_t below = 0;
    for (const TraceSite& site : model_.traces) {
      if (site.stage != stage) continue;
      std::uint32_t depth = 1;
      for (const Edge& edge : site.edges) {
        below = std::max(below, bytesOf(edge));
        if (!traces(edge.role)) continue;
        if (state_[edge.stage] == 1) {
          const auto start = std::ranges::find(path_, edge.stage);
          cycles_.push_back({&site, {start, path_.end()}, &edge});
          continue;
        }
        if (state_[edge.stage] == 0) visit(edge.stage);
        below = std::max(below, bytes_[edge.stage]);
        depth = std::max(depth, 1 + depth_[edge.stage]);
      }
      if (depth > depth_[stage]) depth_[stage] = depth, next_[stage] = site.edges.empty() ? nullptr : &site;
    }
    for (const CallSite& site : model_.calls)
      for (const Edge& edge : site.edges)
        if (site.stage == stage) below = std::max(below, bytesOf(edge));
    bytes_[stage] = model_.stages[stage].facts->frameBytes() + below;
    path_.pop_back();
    state_[stage] = 2;
  }

  std::uint64_t bytesOf(const Edge& edge) const { return model_.stages[edge.stage].facts->frameBytes(); }

  const LinkModel& model_;
  std::vector<int> state_;  // 0: not seen, 1: on the path, 2: done
  std::vector<std::uint32_t> depth_;
  std::vector<const TraceSite*> next_;  // the trace of the longest chain
  std::vector<std::uint64_t> bytes_;
  std::vector<std::size_t> path_;
  std::vector<Cycle> cycles_;
};

std::string cycleText(const LinkModel& model, const Chains::Cycle& cycle) {
  if (cycle.stages.size() == 1)
    return fmt::format("this trace can run its own stage again, the {}", model.describe(*cycle.edge));
  std::vector<std::string> names;
  for (const std::size_t stage : cycle.stages) names.push_back(model.stages[stage].file);
  return fmt::format("this trace closes a cycle: {} -> {}", fmt::join(names, " -> "), names.front());
}

// Calls of callable shaders from callable shaders. The stack that Vulkan gives a pipeline has room for two of them
// ("Ray Tracing Pipeline Stack" in the specification).
class Calls {
 public:
  Calls(const LinkModel& model, Report& report) : model_(model), report_(report), depth_(model.stages.size(), -1) {
    for (std::size_t i = 0; i < model.stages.size(); ++i) visit(i);
  }

 private:
  static constexpr int kOpen = -2, kMaxDepth = 2;

  // How deep calls nest below a stage; as deep as there are stages.
  int visit(std::size_t stage) {
    if (depth_[stage] != -1) return depth_[stage];
    depth_[stage] = kOpen;
    int depth = 0;
    for (const CallSite& site : model_.calls) {
      if (site.stage != stage) continue;
      const shader::Place place = model_.at(model_.stages[stage], site.call->place);
      for (const Edge& edge : site.edges) {
        const int below = visit(edge.stage);
        if (below == kOpen)
          report_.add("Q401", place,
                      fmt::format("this call closes a cycle: the {} can call itself again", model_.describe(edge)));
        if (below == kMaxDepth)
          report_.add("Q402", place,
                      fmt::format("calls nest {} deep from here, over the {}; the stack has room for {}", below + 1,
                                  model_.describe(edge), kMaxDepth));
        depth = std::max(depth, below + 1);
      }
    }
    return depth_[stage] = depth;
  }

  const LinkModel& model_;
  Report& report_;
  std::vector<int> depth_;  // -1: not seen
};

}  // namespace

void checkRecursion(const CheckInput& input, Report& report, CheckResult& result) {
  const LinkModel& model = input.model;
  const LinkStage* start = model.stage(model.program.rayGeneration);
  if (!start || !start->facts) return;
  const Chains chains(model);
  Calls(model, report);
  const auto stage = static_cast<std::size_t>(start - model.stages.data());
  const std::uint32_t derived = std::max(1u, chains.depth(stage));
  const auto& declared = model.program.declaredRecursion;
  const std::string device = input.limits.name.empty() ? "Vulkan devices allow" : input.limits.name + " allows";
  result.stackBytes = chains.bytes(stage);
  if (!chains.cycles().empty()) {
    result.recursionDepth = std::max(derived, declared.value_or(input.limits.maxRecursion));
    result.stackBytes =
        chains.bytes(stage) + (result.recursionDepth - derived) * chains.bytes(chains.cycles().front().stages.front());
    for (const Chains::Cycle& cycle : chains.cycles()) {
      if (declared) break;
      report.add("Q401", model.at(model.stages[cycle.site->stage], cycle.site->trace->place),
                 cycleText(model, cycle) + "; nothing says how deep that goes");
    }
  } else {
    result.recursionDepth = derived;
  }
  if (declared && *declared < derived)
    report.add(
        "Q402", chains.lastTrace(stage),
        fmt::format("traces nest {} deep ({}), but the program declares {}", derived, chains.chain(stage), *declared));
  if ((chains.cycles().empty() || declared) && result.recursionDepth > input.limits.maxRecursion)
    report.add(
        "Q402", chains.lastTrace(stage),
        fmt::format("traces nest {} deep ({}); {} {}", result.recursionDepth,
                    chains.cycles().empty() ? chains.chain(stage) : "declared", device, input.limits.maxRecursion));
}

}  // namespace quintet::program
