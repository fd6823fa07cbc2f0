// SPDX-License-Identifier: Apache-2.0
#include "check/pipeline_graph.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"
#include "check/swapped_arguments.h"
#include "spirv/glsl_declaration.h"
#include "spirv/source_text.h"

namespace quintet::check {
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

PipelineGraph::PipelineGraph(const program::Program& given, const program::CompiledProgram& compiled)
    : program(given), misses(program::missShaders(given)) {
  stages.resize(compiled.stages.size());
  defaults_.resize(stages.size());
  std::vector<std::string> errors(stages.size());
  parallelFor(stages.size(), [&](std::size_t i) {
    stages[i].file = compiled.stages[i].file;
    stages[i].kind = compiled.stages[i].kind;
    auto module = spirv::Module::read(compiled.stages[i].spirv, &errors[i]);
    if (!module) return;
    for (const auto& [file, text] : program.files) module->addSource(program.path(file), text);
    stages[i].facts =
        std::make_unique<spirv::StageFacts>(std::move(*module), valueContext(given, stages[i].file, nullptr));
  });
  for (std::size_t i = 0; i < stages.size(); ++i) {
    if (!stages[i].facts && error.empty()) error = fmt::format("{}: {}", stages[i].file, errors[i]);
    if (stages[i].facts) addTraces(i), addCalls(i);
  }
}

const PipelineStage* PipelineGraph::stage(const std::string& file) const {
  const auto found = std::ranges::find(stages, file, &PipelineStage::file);
  return found == stages.end() || file.empty() ? nullptr : &*found;
}

const program::HitShaders& PipelineGraph::shaders(HitGroupRay hit) const {
  static const program::HitShaders kNoShaders;
  const auto& all = program.hitGroups[hit.group].shaders;
  const auto found = all.find(program.rays[hit.ray].name);
  return found == all.end() ? kNoShaders : found->second;
}

bool PipelineGraph::hasIntersection(std::size_t group) const {
  return program::hasIntersection(program.hitGroups[group]);
}

const DefaultRanges& PipelineGraph::defaults(std::size_t stage) const {
  if (!defaults_[stage])
    defaults_[stage] = std::make_unique<DefaultRanges>(program, stages[stage].file, stages[stage].facts->module());
  return *defaults_[stage];
}

std::vector<std::size_t> PipelineGraph::rayTypes(const spirv::TraceFacts& trace) const {
  std::vector<std::size_t> rays;
  for (std::size_t ray = 0; ray < rayCount(); ++ray)
    if (!trace.offset.known || std::ranges::find(trace.offset.values, ray) != trace.offset.values.end())
      rays.push_back(ray);
  return rays;
}

void PipelineGraph::addEdge(std::vector<Edge>& edges, const std::string& file, Edge edge) const {
  const PipelineStage* found = stage(file);
  if (!found || !found->facts) return;
  edge.stage = static_cast<std::size_t>(found - stages.data());
  edges.push_back(edge);
}

void PipelineGraph::addTraces(std::size_t stage) {
  for (const spirv::TraceFacts& trace : stages[stage].facts->traces()) {
    TraceSite site{stage, &trace, {}, {}, {}};
    if (auto swapped = findSwappedArguments(*stages[stage].facts, trace, rayCount()); !swapped.texts.empty()) {
      site.swapped = std::move(swapped.texts);
      site.trace = &intended_.emplace_back(std::move(swapped.intended));
    }
    for (std::size_t i = 0; i < misses.size(); ++i) {
      const bool reached = !trace.miss.known ||
                           std::ranges::any_of(trace.miss.values, [&](std::uint32_t v) { return (v & 0xFFFFu) == i; });
      if (reached) addEdge(site.edges, misses[i].file, {0, Role::miss, trace.miss.certain(), {}, i});
    }
    addHits(site);
    traces.push_back(std::move(site));
  }
}

void PipelineGraph::addHits(TraceSite& site) {
  const spirv::TraceFacts& trace = *site.trace;
  for (std::size_t group = 0; group < program.hitGroups.size(); ++group) {
    if (trace.flags.mustHave(hasIntersection(group) ? kFlagSkipAabbs : kFlagSkipTriangles)) continue;
    for (const std::size_t ray : rayTypes(trace)) {
      const HitGroupRay hit{group, ray};
      site.hits.push_back(hit);
      const bool exact = trace.offset.certain();
      const program::HitShaders& files = shaders(hit);
      if (!site.skipsClosestHit()) addEdge(site.edges, files.closestHit, {0, Role::closestHit, exact, hit, 0});
      if (!trace.flags.mustHave(kFlagOpaque)) addEdge(site.edges, files.anyHit, {0, Role::anyHit, exact, hit, 0});
      addEdge(site.edges, files.intersection, {0, Role::intersection, exact, hit, 0});
    }
  }
}

void PipelineGraph::addCalls(std::size_t stage) {
  for (const spirv::CallFacts& call : stages[stage].facts->calls()) {
    CallSite site{stage, &call, {}};
    for (std::size_t i = 0; i < program.callables.size(); ++i) {
      const bool reached = !call.index.known || std::ranges::find(call.index.values, i) != call.index.values.end();
      if (reached) addEdge(site.edges, program.callables[i].file, {0, Role::callable, call.index.certain(), {}, i});
    }
    calls.push_back(std::move(site));
  }
}

std::string PipelineGraph::describe(HitGroupRay hit) const {
  const std::string group = fmt::format("hit group '{}'", program.hitGroups[hit.group].name);
  return rayCount() > 1 ? fmt::format("{}, ray type '{}'", group, program.rays[hit.ray].name) : group;
}

const std::string& PipelineGraph::nameOf(const std::string& file) const {
  return file.starts_with(program.descriptionFile + ".") ? program.descriptionFile : file;
}

bool PipelineGraph::areVariants(const PipelineStage& a, const PipelineStage& b) const {
  const auto isPart = [&](const PipelineStage& stage) { return nameOf(stage.file) != stage.file; };
  const bool hit = a.kind == shader::Stage::closestHit || a.kind == shader::Stage::anyHit;
  return hit && a.kind == b.kind && isPart(a) && isPart(b);
}

std::string PipelineGraph::describe(const Edge& edge) const {
  const std::string& file = nameOf(stages[edge.stage].file);
  if (edge.role == Role::miss || edge.role == Role::callable)
    return fmt::format("{} shader '{}' ({} index {})", roleName(edge.role), file,
                       edge.role == Role::miss ? "miss" : "callable", edge.index);
  return fmt::format("{} shader '{}' ({})", roleName(edge.role), file, describe(edge.hit));
}

SourceLocation PipelineGraph::descriptionLocation(int line) const {
  return {program.path(program.descriptionFile), line, 0};
}

SourceLocation PipelineGraph::location(const PipelineStage& stage, const SourceLocation& location) const {
  return location.line > 0 ? location : SourceLocation{program.path(nameOf(stage.file)), 0, 0};
}

SourceLocation PipelineGraph::declarationOf(const PipelineStage& stage, const spirv::SharedVariable& variable) const {
  const SourceLocation declared = location(stage, variable.declaration);
  const auto source = program.files.find(program.descriptionFile);
  if (nameOf(stage.file) == stage.file || source == program.files.end()) return declared;
  // The text of a stage of the lecture form has declarations that the user's file does not have.
  const std::string_view line = spirv::lineOf(source->second, declared.line);
  if (declared.column > 0 && static_cast<std::size_t>(declared.column) <= line.size() &&
      line.substr(static_cast<std::size_t>(declared.column) - 1).starts_with(variable.name))
    return declared;
  const auto start = spirv::findWord(program.files.at(stage.file), "main");
  return {program.path(program.descriptionFile), start ? start->line : 0, start ? start->column : 0};
}

SourceLocation PipelineGraph::location(const TraceSite& site) const {
  return location(stages[site.stage], site.trace->location);
}

SourceLocation PipelineGraph::location(const CallSite& site) const {
  return location(stages[site.stage], site.call->location);
}

std::set<std::size_t> PipelineGraph::reachableStages() const {
  std::set<std::size_t> reached;
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < stages.size(); ++i)
    if (stages[i].kind == shader::Stage::rayGeneration) open.push_back(i);
  const auto follow = [&](std::size_t from, const auto& sites) {
    for (const auto& site : sites)
      if (site.stage == from)
        for (const Edge& edge : site.edges) open.push_back(edge.stage);
  };
  while (!open.empty()) {
    const std::size_t next = open.back();
    open.pop_back();
    if (!reached.insert(next).second) continue;
    follow(next, traces);
    follow(next, calls);
    for (const TraceSite& site : traces) {
      if (site.stage != next) continue;
      for (const HitGroupRay hit : site.hits)
        if (const PipelineStage* anyHit = stage(shaders(hit).anyHit))
          open.push_back(static_cast<std::size_t>(anyHit - stages.data()));
    }
  }
  return reached;
}

}  // namespace quintet::check
