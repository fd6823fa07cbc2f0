#include "program/link_model.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"

namespace quintet::program {
namespace {

std::string_view roleName(Role role) {
  switch (role) {
    case Role::miss: return "miss";
    case Role::closestHit: return "closest-hit";
    case Role::anyHit: return "any-hit";
    case Role::intersection: return "intersection";
    case Role::callable: break;
  }
  return "callable";
}

}  // namespace

LinkModel::LinkModel(const Program& given, const CompiledProgram& compiled)
    : program(given), misses(missShaders(given)) {
  stages.resize(compiled.stages.size());
  std::vector<std::string> problems(stages.size());
  parallelFor(stages.size(), [&](std::size_t i) {
    stages[i].file = compiled.stages[i].file;
    stages[i].kind = compiled.stages[i].kind;
    auto module = shader::SpirvModule::read(compiled.stages[i].spirv, &problems[i]);
    if (!module) return;
    for (const auto& [file, text] : program.files) module->addSource(program.path(file), text);
    stages[i].facts = std::make_unique<shader::StageFacts>(std::move(*module));
  });
  for (std::size_t i = 0; i < stages.size(); ++i) {
    if (!stages[i].facts && problem.empty()) problem = fmt::format("{}: {}", stages[i].file, problems[i]);
    if (stages[i].facts) addTraces(i), addCalls(i);
  }
}

const LinkStage* LinkModel::stage(const std::string& file) const {
  const auto found = std::ranges::find(stages, file, &LinkStage::file);
  return found == stages.end() || file.empty() ? nullptr : &*found;
}

const shader::StageFacts* LinkModel::facts(const std::string& file) const {
  const LinkStage* found = stage(file);
  return found ? found->facts.get() : nullptr;
}

const HitShaders& LinkModel::shaders(HitRow row) const {
  static const HitShaders kNothing;
  const auto& all = program.hitGroups[row.group].shaders;
  const auto found = all.find(program.rays[row.ray].name);
  return found == all.end() ? kNothing : found->second;
}

bool LinkModel::hasIntersection(std::size_t group) const {
  return std::ranges::any_of(program.hitGroups[group].shaders,
                             [](const auto& entry) { return !entry.second.intersection.empty(); });
}

std::vector<std::size_t> LinkModel::rayTypes(const shader::TraceFacts& trace) const {
  std::vector<std::size_t> rays;
  for (std::size_t ray = 0; ray < rayCount(); ++ray)
    if (!trace.offset.known || std::ranges::find(trace.offset.values, ray) != trace.offset.values.end())
      rays.push_back(ray);
  return rays;
}

void LinkModel::addEdge(std::vector<Edge>& edges, const std::string& file, Edge edge) const {
  const LinkStage* found = stage(file);
  if (!found || !found->facts) return;
  edge.stage = static_cast<std::size_t>(found - stages.data());
  edges.push_back(edge);
}

void LinkModel::addTraces(std::size_t stage) {
  for (const shader::TraceFacts& trace : stages[stage].facts->traces()) {
    TraceSite site{stage, &trace, {}, {}};
    for (std::size_t i = 0; i < misses.size(); ++i) {
      const bool reached = !trace.miss.known ||
                           std::ranges::any_of(trace.miss.values, [&](std::uint32_t v) { return (v & 0xFFFFu) == i; });
      if (reached) addEdge(site.edges, misses[i].file, {0, Role::miss, trace.miss.known, {}, i});
    }
    reachHits(site);
    traces.push_back(std::move(site));
  }
}

void LinkModel::reachHits(TraceSite& site) {
  const shader::TraceFacts& trace = *site.trace;
  for (std::size_t group = 0; group < program.hitGroups.size(); ++group) {
    if (trace.flags.must(hasIntersection(group) ? kFlagSkipBoxes : kFlagSkipTriangles)) continue;
    for (const std::size_t ray : rayTypes(trace)) {
      const HitRow row{group, ray};
      site.hits.push_back(row);
      const Edge edge{0, Role::closestHit, trace.offset.known, row, 0};
      const HitShaders& files = shaders(row);
      if (!site.skipsClosestHit()) addEdge(site.edges, files.closestHit, edge);
      if (!trace.flags.must(kFlagOpaque)) addEdge(site.edges, files.anyHit, {0, Role::anyHit, edge.exact, row, 0});
      addEdge(site.edges, files.intersection, {0, Role::intersection, edge.exact, row, 0});
    }
  }
}

void LinkModel::addCalls(std::size_t stage) {
  for (const shader::CallFacts& call : stages[stage].facts->calls()) {
    CallSite site{stage, &call, {}};
    for (std::size_t i = 0; i < program.callables.size(); ++i) {
      const bool reached = !call.index.known || std::ranges::find(call.index.values, i) != call.index.values.end();
      if (reached) addEdge(site.edges, program.callables[i].file, {0, Role::callable, call.index.known, {}, i});
    }
    calls.push_back(std::move(site));
  }
}

std::string LinkModel::describe(HitRow row) const {
  const std::string group = fmt::format("hit group '{}'", program.hitGroups[row.group].name);
  return rayCount() > 1 ? fmt::format("{}, ray type '{}'", group, program.rays[row.ray].name) : group;
}

std::string LinkModel::describe(const Edge& edge) const {
  const std::string& file = stages[edge.stage].file;
  if (edge.role == Role::miss || edge.role == Role::callable)
    return fmt::format("{} shader '{}' ({} index {})", roleName(edge.role), file,
                       edge.role == Role::miss ? "miss" : "callable", edge.index);
  return fmt::format("{} shader '{}' ({})", roleName(edge.role), file, describe(edge.row));
}

shader::Place LinkModel::at(int line) const { return {program.path(program.descriptionFile), line, 0}; }

shader::Place LinkModel::at(const LinkStage& stage, const shader::Place& place) const {
  return place.line > 0 ? place : shader::Place{program.path(stage.file), 0, 0};
}

}  // namespace quintet::program
