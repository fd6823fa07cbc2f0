// SPDX-License-Identifier: Apache-2.0
#include "check/pipeline_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "check/swapped_arguments.h"
#include "spirv/glsl_declaration.h"
#include "spirv/plain_code.h"
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

// Quintet launches one invocation per pixel. Of other applications, the launch can have any size and three dimensions.
void addLaunch(spirv::ValueContext& context) {
  constexpr double kMostInvocations = 1073741824.0;  // Vulkan's limit of most devices
  context.builtIns[spv::BuiltIn::LaunchIdKHR] = spirv::ValueRange::between(0.0, kMostInvocations - 1.0);
  context.builtIns[spv::BuiltIn::LaunchSizeKHR] = spirv::ValueRange::between(1.0, kMostInvocations);
}

// The records that a geometry of an instance uses with the known values of a trace.
std::set<std::size_t> recordsOfGeometry(const InstanceRecords& instance, std::uint32_t geometry,
                                        const spirv::TraceFacts& trace) {
  std::set<std::size_t> records;
  for (const std::uint32_t offset : trace.offset.values)
    for (const std::uint32_t stride : trace.stride.values)
      records.insert(std::size_t{instance.recordOffset} + std::size_t{geometry} * (stride & 0xFu) + (offset & 0xFu));
  return records;
}

// The sites of a stage; the list is in the order of the stages.
template <class Site>
std::span<const Site> sitesOf(const std::vector<Site>& sites, std::size_t stage) {
  const auto first = std::ranges::lower_bound(sites, stage, {}, &Site::stage);
  const auto last = std::ranges::upper_bound(sites, stage, {}, &Site::stage);
  return {first, last};
}

}  // namespace

PipelineGraph::PipelineGraph(const program::Program& program, const program::CompiledProgram& compiled)
    : groups(groupsOf(program)), usesLibrary(true), mergesEqual(true), hasParameters_(true) {
  context_ = [&program](const std::string& file, const program::SceneFacts* scene, ParameterUse use) {
    return valueContext(program, file, scene, use);
  };
  for (const program::CompiledProgram::Stage& stage : compiled.stages)
    stages.push_back({stage.file, stage.kind, {}, {}, false});
  readStages([&](std::size_t i) { return compiled.stages[i].spirv; }, std::vector<std::string>(stages.size()));
}

PipelineGraph::PipelineGraph(PipelineGroups given, std::span<const ModuleStage> modules, bool merges)
    : groups(std::move(given)), usesLibrary(false), mergesEqual(merges) {
  context_ = [this](const std::string& file, const program::SceneFacts* scene, ParameterUse) {
    spirv::ValueContext context =
        groups.groupsKnown || !groups.hasIntersections ? groupContext(groups.hitGroups, file) : spirv::ValueContext{};
    addLaunch(context);
    if (scene) addCustomIndices(file, context);
    return context;
  };
  std::vector<std::string> problems;
  for (const ModuleStage& module : modules) {
    stages.push_back({module.name, module.kind, {}, {}, module.isStub});
    problems.push_back(module.problem);
    hasVariants = hasVariants || module.isVariant;
  }
  readStages([&](std::size_t i) { return modules[i].spirv; }, std::move(problems));
}

void PipelineGraph::readStages(const std::function<std::vector<std::uint32_t>(std::size_t)>& words,
                               std::vector<std::string> errors) {
  for (std::size_t i = 0; i < stages.size(); ++i) index_.try_emplace(stages[i].file, i);
  defaults_.resize(stages.size());
  parallelFor(stages.size(), [&](std::size_t i) {
    if (!errors[i].empty()) return;
    auto module = spirv::Module::read(words(i), &errors[i]);
    if (!module) return;
    for (const auto& [file, text] : groups.files) module->addSource(groups.path(file), text);
    if (!usesLibrary) module->locateByIds(stages[i].file);
    stages[i].facts = std::make_unique<spirv::StageFacts>(std::move(*module), context(stages[i].file, nullptr));
  });
  for (std::size_t i = 0; i < stages.size(); ++i) {
    if (!stages[i].facts) stages[i].problem = errors[i];
    if (stages[i].facts && !usesLibrary)
      if (const std::string_view trace = spirv::otherTrace(stages[i].facts->module()); !trace.empty())
        stages[i].problem = errors[i] = fmt::format("the shaders that {} runs are unknown", trace);
    if (!errors[i].empty() && error.empty()) error = fmt::format("{}: {}", stages[i].file, errors[i]);
  }
  compareRecords();
  TargetsOfArguments known;
  for (std::size_t i = 0; i < stages.size(); ++i)
    if (stages[i].facts) addTraces(i, known), addCalls(i);
}

// Of the instances whose hits run the stage.
void PipelineGraph::addCustomIndices(const std::string& file, spirv::ValueContext& context) const {
  if (groups.hitRecords != HitRecords::byRecord || !groups.instances || !groups.tablesKnown || !error.empty() ||
      !std::ranges::all_of(*groups.instances, &InstanceRecords::hasCustomIndex))
    return;
  std::vector<bool> runs;  // by hit group
  for (const program::HitGroup& group : groups.hitGroups)
    runs.push_back(std::ranges::any_of(group.shaders, [&](const auto& entry) {
      const program::HitShaders& shaders = entry.second;
      return shaders.closestHit == file || shaders.anyHit == file || shaders.intersection == file;
    }));
  const PipelineStage* found = stage(file);
  if (!found) return;
  const auto index = static_cast<std::size_t>(found - stages.data());
  std::set<double> indices;
  bool each = found->kind != shader::Stage::anyHit;  // opaque geometry does not run it
  for (const TraceTargets& selected : targets) {
    const auto runsIt = [&](const Edge& edge) { return edge.stage == index && edge.role != Role::miss; };
    if (std::ranges::none_of(selected.edges, runsIt)) continue;
    const spirv::TraceFacts& trace = *traces[selected.traces.front()].trace;
    if (selected.mayRunNothing) each = false;
    if (!trace.offset.certain() || !trace.stride.certain() || !trace.mask.certain()) each = false;
    for (const InstanceRecords& instance : *groups.instances) {
      if (!trace.mask.mayHave(instance.facts.mask & 0xFFu)) continue;
      for (std::uint32_t k = 0; k < instance.facts.geometryCount; ++k) {
        const bool procedural = groups.geometries[instance.facts.firstGeometry + k].procedural();
        if (trace.flags.mustHave(procedural ? kFlagSkipAabbs : kFlagSkipTriangles)) continue;
        const bool used = !trace.offset.known || !trace.stride.known ||
                          std::ranges::any_of(recordsOfGeometry(instance, k, trace),
                                              [&](std::size_t record) { return record < runs.size() && runs[record]; });
        if (used) indices.insert(instance.facts.customIndex);
      }
    }
  }
  check::addCustomIndices(indices, each, context);
}

std::map<std::size_t, PipelineGraph::HitBuiltIns> PipelineGraph::certainHits(std::size_t stage) const {
  std::map<std::size_t, HitBuiltIns> hits;
  if (groups.hitRecords != HitRecords::byRecord || !groups.instances) return hits;
  const bool anyHit = stages[stage].kind == shader::Stage::anyHit;
  for (const TraceTargets& selected : targets) {
    const auto runsIt = [&](const Edge& edge) { return edge.stage == stage && edge.role != Role::miss; };
    std::set<std::size_t> groupsWithIt;
    for (const Edge& edge : selected.edges)
      if (runsIt(edge)) groupsWithIt.insert(edge.hit.group);
    if (groupsWithIt.empty() || selected.mayRunNothing) continue;
    const spirv::TraceFacts& trace = *traces[selected.traces.front()].trace;
    if (!trace.offset.certain() || !trace.stride.certain() || !trace.mask.certain()) continue;
    for (const InstanceRecords& instance : *groups.instances) {
      if (!trace.mask.mayHave(instance.facts.mask & 0xFFu)) continue;
      for (std::uint32_t k = 0; k < instance.facts.geometryCount; ++k) {
        const program::GeometryFacts& geometry = groups.geometries[instance.facts.firstGeometry + k];
        if (trace.flags.mayHave(geometry.procedural() ? kFlagSkipAabbs : kFlagSkipTriangles)) continue;
        const bool opaque = instance.facts.forceOpaque || (geometry.opaque() && !instance.facts.forceNoOpaque);
        if (trace.flags.mayHave(opaque ? kFlagCullOpaque : kFlagCullNoOpaque)) continue;
        if (anyHit && (trace.flags.mayHave(kFlagOpaque) || (opaque && !trace.flags.mustHave(kFlagNoOpaque)))) continue;
        for (const std::size_t record : recordsOfGeometry(instance, k, trace)) {
          if (!groupsWithIt.contains(record)) continue;
          HitBuiltIns& found = hits[record];
          found.customIndices.insert(instance.facts.customIndex);
          found.geometries.insert(k);
          found.allCustomIndices = found.allCustomIndices && instance.hasCustomIndex;
        }
      }
    }
  }
  return hits;
}

std::set<std::size_t> PipelineGraph::certainMisses(std::size_t stage) const {
  std::set<std::size_t> records;
  for (const TraceTargets& selected : targets)
    for (const Edge& edge : selected.edges)
      if (edge.stage == stage && edge.role == Role::miss && edge.exact && !selected.mayRunNothing)
        records.insert(edge.index);
  return records;
}

std::set<std::size_t> PipelineGraph::certainCallables(std::size_t stage) const {
  std::set<std::size_t> records;
  for (const CallSite& site : calls)
    for (const Edge& edge : site.edges)
      if (edge.stage == stage && edge.exact) records.insert(edge.index);
  return records;
}

std::vector<RecordRuns> PipelineGraph::recordRuns(const std::string& file) const {
  const PipelineStage* found = stage(file);
  if (!found || !groups.tablesKnown || !error.empty()) return {};
  const auto index = static_cast<std::size_t>(found - stages.data());
  std::vector<RecordRuns> runs;
  std::set<std::tuple<RecordData, std::set<double>, std::set<double>>> known;
  const auto add = [&](std::string_view table, std::size_t record, const std::vector<RecordData>& data,
                       const HitBuiltIns& builtIns) {
    if (record >= data.size() || data[record].empty()) return;
    const std::set<double> none;
    const std::set<double>& indices = builtIns.allCustomIndices ? builtIns.customIndices : none;
    if (!known.insert({data[record], indices, builtIns.geometries}).second) return;
    RecordRuns& added = runs.emplace_back();
    added.record = fmt::format("{} record {}", table, record);
    added.context = groupContext(groups.hitGroups, file);
    addLaunch(added.context);
    added.context.record = data[record];
    check::addCustomIndices(indices, true, added.context);
    addGeometryIndices(builtIns.geometries, added.context);
  };
  const TableData& data = groups.recordData;
  if (const auto own = data.rayGeneration.find(file); own != data.rayGeneration.end()) {
    RecordRuns& added = runs.emplace_back();
    added.record = "the ray generation record";
    addLaunch(added.context);
    added.context.record = own->second;
  }
  for (const std::size_t record : data.misses.empty() ? std::set<std::size_t>{} : certainMisses(index))
    add("miss", record, data.misses, {});
  for (const std::size_t record : data.callables.empty() ? std::set<std::size_t>{} : certainCallables(index))
    add("callable", record, data.callables, {});
  if (!data.hits.empty())
    for (const auto& [record, builtIns] : certainHits(index)) add("hit", record, data.hits, builtIns);
  return runs;
}

void PipelineGraph::compareRecords() {
  const spirv::TraceFacts* first = nullptr;
  const auto same = [](const spirv::ArgumentValues& a, const spirv::ArgumentValues& b) {
    return a.exact() && b.exact() && a.values == b.values;
  };
  for (const PipelineStage& stage : stages) {
    if (!stage.facts) continue;
    for (const spirv::TraceFacts& trace : stage.facts->traces()) {
      // The search counts.
      if (trace.part == spirv::TracePart::execution && trace.ray != spirv::Module::kNone) continue;
      if (!first) first = &trace;
      if (first == &trace) continue;
      if (!same(first->offset, trace.offset) || !same(first->stride, trace.stride)) sameHitRecords_ = false;
      if (!same(first->miss, trace.miss)) sameMissRecord_ = false;
    }
  }
}

spirv::ValueContext PipelineGraph::context(const std::string& file, const program::SceneFacts* scene) const {
  return context_(file, scene, ParameterUse::any);
}

const PipelineStage* PipelineGraph::stage(const std::string& file) const {
  const auto found = index_.find(file);
  return found == index_.end() || file.empty() ? nullptr : &stages[found->second];
}

std::span<const TraceSite> PipelineGraph::tracesOf(std::size_t stage) const { return sitesOf(traces, stage); }

std::optional<spirv::RayOperands> PipelineGraph::ray(const TraceSite& site) const {
  const std::size_t instruction = site.trace->ray;
  if (instruction == spirv::Module::kNone) return {};
  return spirv::rayOperands(facts(site).module().instructions()[instruction]);
}

std::span<const CallSite> PipelineGraph::callsOf(std::size_t stage) const { return sitesOf(calls, stage); }

const program::HitShaders& PipelineGraph::shaders(HitGroupRay hit) const {
  static const program::HitShaders kNoShaders;
  const auto& all = groups.hitGroups[hit.group].shaders;
  const auto found = all.find(groups.rays[hit.ray]);
  return found == all.end() ? kNoShaders : found->second;
}

bool PipelineGraph::hasIntersection(std::size_t group) const {
  return program::hasIntersection(groups.hitGroups[group]);
}

const DefaultRanges* PipelineGraph::defaults(std::size_t stage) const {
  if (!hasParameters_) return nullptr;
  if (!defaults_[stage])
    defaults_[stage] = std::make_unique<DefaultRanges>(context_(stages[stage].file, nullptr, ParameterUse::defaults),
                                                       stages[stage].facts->module());
  return defaults_[stage].get();
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

void PipelineGraph::addTraces(std::size_t stage, TargetsOfArguments& known) {
  for (const spirv::TraceFacts& trace : stages[stage].facts->traces()) {
    TraceSite site{stage, &trace, 0, {}, {}, false, false, false, {}};
    if (auto swapped = findSwappedArguments(*stages[stage].facts, trace, rayCount()); !swapped.texts.empty()) {
      if (!site.isExecution()) site.swapped = std::move(swapped.texts);  // the search reports it
      site.trace = &intended_.emplace_back(std::move(swapped.intended));
    }
    site.targets = targetsOf(*site.trace, known);
    TraceTargets& found = targets[site.targets];
    found.traces.push_back(traces.size());
    site.edges = found.edges;
    site.hits = found.hits;
    site.assumesHits = found.assumesHits;
    site.assumesMisses = found.assumesMisses;
    site.mayRunNothing = found.mayRunNothing;
    traces.push_back(std::move(site));
  }
}

std::size_t PipelineGraph::targetsOf(const spirv::TraceFacts& trace, TargetsOfArguments& known) {
  const auto [found, isNew] = known.try_emplace({{trace.flags, trace.mask, trace.offset, trace.stride, trace.miss},
                                                 trace.part,
                                                 trace.mayHit,
                                                 trace.mayMiss,
                                                 trace.runsAll},
                                                targets.size());
  if (!isNew && mergesEqual) return found->second;
  TraceTargets& added = targets.emplace_back();
  if (trace.mayMiss && trace.part != spirv::TracePart::search) addMisses(trace, added);
  if (trace.mayHit) addHits(trace, added);
  if (!trace.runsAll) assume(added);
  return targets.size() - 1;
}

// Of an execution of a hit object: any of the shaders may run, or none.
void PipelineGraph::assume(TraceTargets& assumed) const {
  for (Edge& edge : assumed.edges) edge.exact = false;
  assumed.assumesHits = !assumed.hits.empty();
  assumed.assumesMisses = std::ranges::any_of(assumed.edges, [](const Edge& edge) { return edge.role == Role::miss; });
  assumed.mayRunNothing = true;
}

void PipelineGraph::addMisses(const spirv::TraceFacts& trace, TraceTargets& added) const {
  const spirv::ArgumentValues& miss = trace.miss;
  const std::vector<program::MissShader>& misses = groups.misses;
  const bool only = !groups.tablesKnown && misses.size() == 1 && sameMissRecord_;
  added.assumesMisses = !groups.tablesKnown && !misses.empty() && !only;
  for (std::size_t i = 0; i < misses.size(); ++i) {
    const bool reached =
        !groups.tablesKnown ||
        (miss.known ? std::ranges::any_of(miss.values, [&](std::uint32_t v) { return (v & 0xFFFFu) == i; })
                    : miss.mayBe(static_cast<std::uint32_t>(i)));
    if (reached)
      addEdge(added.edges, misses[i].file, {0, Role::miss, only || (groups.tablesKnown && miss.certain()), {}, i});
  }
}

void PipelineGraph::addHits(const spirv::TraceFacts& trace, TraceTargets& added) const {
  if (groups.hitRecords == HitRecords::byRecord) return addHitsByRecord(trace, added);
  const std::vector<std::size_t> rays = rayTypes(trace);
  for (std::size_t group = 0; group < groups.hitGroups.size(); ++group)
    for (const std::size_t ray : rays) addHit(trace, {group, ray}, trace.offset.certain(), added);
}

void PipelineGraph::addHit(const spirv::TraceFacts& trace, HitGroupRay hit, bool exact, TraceTargets& added) const {
  if (groups.groupsKnown && trace.flags.mustHave(hasIntersection(hit.group) ? kFlagSkipAabbs : kFlagSkipTriangles))
    return;
  added.hits.push_back(hit);
  const program::HitShaders& files = shaders(hit);
  if (!trace.flags.mustHave(kFlagSkipClosestHit) && trace.part != spirv::TracePart::search)
    addEdge(added.edges, files.closestHit, {0, Role::closestHit, exact, hit, 0});
  if (trace.part == spirv::TracePart::execution) return;  // the search runs the others
  if (!trace.flags.mustHave(kFlagOpaque)) addEdge(added.edges, files.anyHit, {0, Role::anyHit, exact, hit, 0});
  addEdge(added.edges, files.intersection, {0, Role::intersection, exact, hit, 0});
}

// With instances and constant arguments, the records are known; otherwise any group can be hit.
void PipelineGraph::addHitsByRecord(const spirv::TraceFacts& trace, TraceTargets& added) const {
  const std::set<std::size_t> records = recordsOf(trace);
  const bool known = groups.tablesKnown && groups.instances && trace.offset.known && trace.stride.known;
  for (std::size_t group = 0; group < groups.hitGroups.size(); ++group)
    if (!known || records.contains(group)) addHit(trace, {group, 0}, known ? trace.offset.certain() : true, added);
  const bool others = !groups.tablesKnown && !sameHitRecords_ && !added.hits.empty();  // records without shaders
  added.assumesHits = !known && (added.hits.size() > 1 || others);
  if (!added.assumesHits) return;
  for (Edge& edge : added.edges)
    if (edge.role != Role::miss) edge.exact = false;
}

std::span<const Edge> edgesOf(std::span<const Edge> edges, HitGroupRay hit) {
  const auto first = std::ranges::partition_point(edges, [](const Edge& edge) { return edge.role == Role::miss; });
  return {std::ranges::lower_bound(first, edges.end(), hit, {}, &Edge::hit),
          std::ranges::upper_bound(first, edges.end(), hit, {}, &Edge::hit)};
}

std::set<std::size_t> PipelineGraph::recordsOf(const spirv::TraceFacts& trace) const {
  std::set<std::size_t> records;
  if (!groups.instances) return records;
  for (const InstanceRecords& instance : *groups.instances) {
    if (!trace.mask.mayHave(instance.facts.mask & 0xFFu)) continue;
    for (std::uint32_t k = 0; k < instance.facts.geometryCount; ++k)
      records.merge(recordsOfGeometry(instance, k, trace));
  }
  return records;
}

void PipelineGraph::addCalls(std::size_t stage) {
  const std::vector<program::Callable>& callables = groups.callables;
  for (const spirv::CallFacts& call : stages[stage].facts->calls()) {
    CallSite site{stage, &call, {}};
    const bool only = !groups.tablesKnown && callables.size() == 1;
    for (std::size_t i = 0; i < callables.size(); ++i) {
      const bool reached = !groups.tablesKnown || !call.index.known ||
                           std::ranges::find(call.index.values, i) != call.index.values.end();
      const bool exact = only || (groups.tablesKnown && call.index.certain());
      if (reached) addEdge(site.edges, callables[i].file, {0, Role::callable, exact, {}, i});
    }
    calls.push_back(std::move(site));
  }
}

std::string PipelineGraph::describe(HitGroupRay hit) const {
  const std::string group = fmt::format("hit group '{}'", groups.hitGroups[hit.group].name);
  return rayCount() > 1 ? fmt::format("{}, ray type '{}'", group, groups.rays[hit.ray]) : group;
}

const std::string& PipelineGraph::nameOf(const std::string& file) const {
  return usesLibrary && file.starts_with(groups.descriptionFile + ".") ? groups.descriptionFile : file;
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

bool PipelineGraph::isOwnFile(const std::string& file) const {
  return !usesLibrary ||
         std::ranges::any_of(groups.files, [&](const auto& entry) { return groups.path(entry.first) == file; });
}

SourceLocation PipelineGraph::descriptionLocation(int line) const {
  return {groups.path(groups.descriptionFile), line, 0};
}

SourceLocation PipelineGraph::location(const PipelineStage& stage, const SourceLocation& location) const {
  const bool known = location.line > 0 || spirv::isIdLocation(location);
  return known ? location : SourceLocation{groups.path(nameOf(stage.file)), 0, 0};
}

SourceLocation PipelineGraph::declarationOf(const PipelineStage& stage, const spirv::SharedVariable& variable) const {
  const SourceLocation declared = location(stage, variable.declaration);
  const auto source = groups.files.find(groups.descriptionFile);
  if (nameOf(stage.file) == stage.file || source == groups.files.end()) return declared;
  // The text of a stage of the lecture form has declarations that the user's file does not have.
  const std::string_view line = spirv::lineOf(source->second, declared.line);
  if (declared.column > 0 && static_cast<std::size_t>(declared.column) <= line.size() &&
      line.substr(static_cast<std::size_t>(declared.column) - 1).starts_with(variable.name))
    return declared;
  const auto start = spirv::findWord(groups.files.at(stage.file), "main");
  return {groups.path(groups.descriptionFile), start ? start->line : 0, start ? start->column : 0};
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
  std::vector<bool> followed(targets.size(), false);
  while (!open.empty()) {
    const std::size_t next = open.back();
    open.pop_back();
    if (!reached.insert(next).second) continue;
    for (const CallSite& site : callsOf(next))
      for (const Edge& edge : site.edges) open.push_back(edge.stage);
    for (const TraceSite& site : tracesOf(next)) {
      if (followed[site.targets]) continue;
      followed[site.targets] = true;
      for (const Edge& edge : site.edges) open.push_back(edge.stage);
      for (const HitGroupRay hit : site.hits)
        if (const PipelineStage* anyHit = stage(shaders(hit).anyHit))
          open.push_back(static_cast<std::size_t>(anyHit - stages.data()));
    }
  }
  return reached;
}

}  // namespace quintet::check
