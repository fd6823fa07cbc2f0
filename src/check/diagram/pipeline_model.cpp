// SPDX-License-Identifier: Apache-2.0
#include "check/diagram/pipeline_model.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "check/diagnostic_text.h"

namespace quintet::check {
namespace {

using spirv::ArgumentValues;

std::string valuesText(const ArgumentValues& argument, const auto& toText) {
  if (!argument.known) return "not constant";
  std::vector<std::string> texts;
  for (const std::uint32_t value : argument.values) texts.push_back(toText(value));
  return fmt::format("{}", fmt::join(texts, " or "));
}

std::string decimal(std::uint32_t value) { return fmt::format("{}", value); }
std::string hexadecimal(std::uint32_t value) { return fmt::format("{:#04x}", value); }

std::string flagsText(std::uint32_t flags) {
  constexpr std::array<std::string_view, 10> kNames{"Opaque",
                                                    "NoOpaque",
                                                    "TerminateOnFirstHit",
                                                    "SkipClosestHitShader",
                                                    "CullBackFacingTriangles",
                                                    "CullFrontFacingTriangles",
                                                    "CullOpaque",
                                                    "CullNoOpaque",
                                                    "SkipTriangles",
                                                    "SkipAABB"};
  std::vector<std::string> names;
  for (std::size_t bit = 0; bit < 32; ++bit)
    if ((flags >> bit & 1u) != 0)
      names.push_back(bit < kNames.size() ? std::string(kNames[bit]) : fmt::format("{:#x}", 1u << bit));
  return names.empty() ? "None" : fmt::format("{}", fmt::join(names, " | "));
}

std::string recordText(const program::Program& program, const program::RecordValues& values) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < program.record.size(); ++i) {
    program::Parameter field = program.record[i];
    if (i < values.size()) field.defaultValue = values[i];
    texts.push_back(fmt::format("{}={}", field.name, program::formatDefault(field)));
  }
  return fmt::format("{}", fmt::join(texts, " "));
}

std::string quotedList(std::string_view label, const std::vector<std::string>& names) {
  return fmt::format("{} '{}'", label, fmt::join(names, "', '"));
}

class ModelBuilder {
 public:
  // Of a program, or of raw modules if `program` is null.
  ModelBuilder(const std::string& name, const program::Program* program, const PipelineGraph& graph,
               const program::SceneFacts* scene, const CheckResult& result)
      : graph_(graph), program_(program), scene_(scene) {
    model_.program = name;
    if (scene_) model_.scene = scene_->name;
    model_.recursionDepth = result.recursionDepth;
    model_.declaredRecursion = graph_.groups.declaredRecursion;
    model_.stackBytes = result.stackBytes;
    model_.diagnostics = result.diagnostics;
    used_.resize(model_.diagnostics.size());
    model_.rays = graph_.groups.rays;
  }

  PipelineModel build() {
    const std::set<std::size_t> reached = graph_.reachableStages();
    for (std::size_t i = 0; i < graph_.stages.size(); ++i)
      model_.stages.push_back({graph_.nameOf(graph_.stages[i].file), graph_.stages[i].kind, reached.contains(i), {}});
    for (std::size_t group = 0; group < graph_.groups.hitGroups.size(); ++group)
      for (std::size_t ray = 0; ray < graph_.rayCount(); ++ray) addHit({group, ray});
    for (std::size_t i = 0; i < graph_.groups.misses.size(); ++i)
      model_.misses.push_back(
          recordOf(graph_.groups.misses[i].name, graph_.groups.misses[i].file, graph_.groups.misses[i].record));
    for (const program::Callable& callable : graph_.groups.callables)
      model_.callables.push_back(recordOf(callable.name, callable.file, callable.record));
    for (const TraceSite& site : graph_.traces) addTrace(site);
    for (const CallSite& site : graph_.calls) addCall(site);
    for (std::size_t i = 0; i < model_.stages.size(); ++i) addStageDiagnostics(i);
    return std::move(model_);
  }

 private:
  std::optional<std::size_t> stageOf(const std::string& file) const {
    const PipelineStage* stage = graph_.stage(file);
    if (!stage) return {};
    return static_cast<std::size_t>(stage - graph_.stages.data());
  }

  PipelineModel::Record recordOf(const std::string& name, const std::string& file,
                                 const program::RecordValues& values) const {
    return {name, stageOf(file), program_ ? recordText(*program_, values) : ""};
  }

  void addHit(HitGroupRay hit) {
    const program::HitGroup& group = graph_.groups.hitGroups[hit.group];
    const program::HitShaders& shaders = graph_.shaders(hit);
    PipelineModel::Hit added;
    added.group = group.name;
    added.ray = graph_.groups.rays[hit.ray];
    added.closestHit = stageOf(shaders.closestHit);
    added.anyHit = stageOf(shaders.anyHit);
    added.intersection = stageOf(shaders.intersection);
    if (program_) added.record = recordText(*program_, shaders.record);
    if (!group.geometry.empty()) added.binding.push_back(quotedList("geometry", group.geometry));
    if (!group.material.empty()) added.binding.push_back(quotedList("material", group.material));
    if (!group.primitives.empty()) added.binding.push_back(quotedList("primitives", group.primitives));
    if (scene_ && program_)
      for (const program::GeometryFacts& geometry : scene_->geometries)
        if (program::hitGroupFor(*program_, geometry) == hit.group) added.geometry.push_back(nameOf(geometry));
    const SourceLocation line = graph_.descriptionLocation(group.line);
    const SourceLocation own = graph_.descriptionLocation(shaders.line);
    for (std::size_t i = 0; i < model_.diagnostics.size(); ++i)
      if (isAt(i, line) || isAt(i, own)) added.diagnostics.push_back(i), used_[i] = true;
    model_.hits.push_back(std::move(added));
  }

  static std::string nameOf(const program::GeometryFacts& geometry) {
    std::string text = geometry.name.empty() ? "unnamed" : fmt::format("'{}'", geometry.name);
    if (!geometry.material.empty()) text += fmt::format(" ({})", geometry.material);
    return text;
  }

  SourceLocation userLocation(SourceLocation location) const {
    location.file =
        program_ ? program::userFile(*program_, location.file) : spirv::splitIdLocation(location.file).first;
    return location;
  }

  bool touches(std::size_t diagnostic, const auto& matches) const {
    const Diagnostic& d = model_.diagnostics[diagnostic];
    return matches(d.file, d.line) ||
           std::ranges::any_of(d.related, [&](const RelatedLocation& r) { return matches(r.file, r.line); });
  }

  bool isAt(std::size_t diagnostic, const SourceLocation& location) const {
    return location.line > 0 && touches(diagnostic, [&](const std::string& file, int line) {
             return file == location.file && line == location.line;
           });
  }

  // The diagnostics of a trace or call, and those of them that also name a target.
  template <class Site>
  void addDiagnostics(Site& site) {
    for (std::size_t i = 0; i < model_.diagnostics.size(); ++i) {
      if (!isAt(i, site.location)) continue;
      site.diagnostics.push_back(i);
      used_[i] = true;
      for (PipelineModel::Target& target : site.targets)
        if (names(i, target)) target.diagnostics.push_back(i);
    }
  }

  bool names(std::size_t diagnostic, const PipelineModel::Target& target) const {
    if (target.role == Role::closestHit) {
      const PipelineModel::Hit& hit = model_.hits[target.index];
      if (std::ranges::count(hit.diagnostics, diagnostic) > 0) return true;
      return std::ranges::any_of(std::array{hit.closestHit, hit.anyHit, hit.intersection},
                                 [&](const auto& stage) { return namesStage(diagnostic, stage); });
    }
    return namesStage(diagnostic, (target.role == Role::miss ? model_.misses : model_.callables)[target.index].stage);
  }

  // True if a location is the declaration of the payload or callable data that the stage receives.
  bool namesStage(std::size_t diagnostic, std::optional<std::size_t> stage) const {
    if (!stage || !graph_.stages[*stage].facts) return false;
    const auto& variables = graph_.stages[*stage].facts->variables();
    return std::ranges::any_of(variables, [&](const spirv::SharedVariable& v) {
      const bool incoming = v.storage == spv::StorageClass::IncomingRayPayloadKHR ||
                            v.storage == spv::StorageClass::IncomingCallableDataKHR;
      return incoming && isAt(diagnostic, userLocation(graph_.declarationOf(graph_.stages[*stage], v)));
    });
  }

  // Diagnostics in the file of a stage that no trace, call or hit group has.
  void addStageDiagnostics(std::size_t stage) {
    const std::string file = graph_.groups.path(model_.stages[stage].file);
    const bool shared = std::ranges::count(model_.stages, model_.stages[stage].file, &PipelineModel::Stage::file) > 1;
    for (std::size_t i = 0; i < model_.diagnostics.size(); ++i)
      if (!shared && !used_[i] && model_.diagnostics[i].file == file) model_.stages[stage].diagnostics.push_back(i);
  }

  void addTrace(const TraceSite& site) {
    const spirv::TraceFacts& facts = *site.trace;
    PipelineModel::Trace trace;
    trace.stage = site.stage;
    trace.location = userLocation(graph_.location(site));
    trace.rays = program_ ? graph_.rayTypes(facts) : Indices{0};
    trace.flags = valuesText(facts.flags, flagsText);
    trace.mask = valuesText(facts.mask, hexadecimal);
    trace.offset = valuesText(facts.offset, decimal);
    trace.stride = valuesText(facts.stride, decimal);
    trace.miss = valuesText(facts.miss, decimal);
    trace.inLoop = facts.inLoop;
    trace.searches = site.isSearch();
    trace.executes = site.isExecution();
    trace.skipsClosestHit = site.skipsClosestHit();
    trace.skipsAnyHit = facts.flags.mustHave(kFlagOpaque);
    describeVariable(site.stage, facts.payload, trace.payload, trace.payloadType, trace.payloadBytes);
    for (const HitGroupRay hit : site.hits)
      trace.targets.push_back({Role::closestHit,
                               hit.group * graph_.rayCount() + hit.ray,
                               program_ ? facts.offset.certain() : !site.assumesHits,
                               {}});
    for (const Edge& edge : site.edges)
      if (edge.role == Role::miss) trace.targets.push_back({Role::miss, edge.index, edge.exact, {}});
    addDiagnostics(trace);
    model_.traces.push_back(std::move(trace));
  }

  void addCall(const CallSite& site) {
    PipelineModel::Call call;
    call.stage = site.stage;
    call.location = userLocation(graph_.location(site));
    call.index = valuesText(site.call->index, decimal);
    describeVariable(site.stage, site.call->data, call.data, call.dataType, call.dataBytes);
    for (const Edge& edge : site.edges) call.targets.push_back({Role::callable, edge.index, edge.exact, {}});
    addDiagnostics(call);
    model_.calls.push_back(std::move(call));
  }

  void describeVariable(std::size_t stage, spirv::Id id, std::string& name, std::string& type,
                        std::uint64_t& bytes) const {
    const spirv::StageFacts& facts = *graph_.stages[stage].facts;
    const spirv::SharedVariable* variable = facts.variable(id);
    if (!variable) return;
    name = variable->name;
    type = facts.module().types().nameOf(variable->type);
    bytes = facts.module().types().get(variable->type).bytes;
  }

  const PipelineGraph& graph_;
  const program::Program* program_;  // null for raw modules
  const program::SceneFacts* scene_;
  PipelineModel model_;
  std::vector<bool> used_;  // diagnostics of traces, calls and hit groups
};

}  // namespace

std::optional<PipelineModel> describePipeline(const program::Program& program, const shader::Compiler& compiler,
                                              const program::SceneFacts* scene, const CheckResult& result) {
  const program::CompiledProgram compiled = program::compile(program, compiler, {});
  if (!compiled.ok) return {};
  const PipelineGraph graph(program, compiled);
  if (!graph.error.empty()) return {};
  std::optional<program::SceneFacts> facts;
  if (scene) facts = program::factsFor(program, *scene);
  return ModelBuilder(program.name, &program, graph, facts ? &*facts : nullptr, result).build();
}

std::optional<PipelineModel> describeModules(const std::string& name, PipelineGroups groups,
                                             std::span<const ModuleStage> modules, const CheckResult& result) {
  const PipelineGraph graph(std::move(groups), modules);
  if (!graph.error.empty()) return {};
  return ModelBuilder(name, nullptr, graph, nullptr, result).build();
}

namespace {

using Json = nlohmann::ordered_json;

Json optionalIndex(const std::optional<std::size_t>& index) { return index ? Json(*index) : Json(nullptr); }

Json locationJson(const SourceLocation& location) {
  return {{"file", location.file}, {"line", location.line}, {"column", location.column}};
}

Json targetsJson(const std::vector<PipelineModel::Target>& targets) {
  Json array = Json::array();
  for (const PipelineModel::Target& target : targets) {
    const char* list = target.role == Role::miss ? "misses" : target.role == Role::callable ? "callables" : "hits";
    array.push_back(
        {{"list", list}, {"index", target.index}, {"exact", target.exact}, {"diagnostics", target.diagnostics}});
  }
  return array;
}

Json recordsJson(const std::vector<PipelineModel::Record>& records) {
  Json array = Json::array();
  for (const PipelineModel::Record& record : records)
    array.push_back({{"name", record.name}, {"stage", optionalIndex(record.stage)}, {"record", record.record}});
  return array;
}

}  // namespace

std::string pipelineJson(const PipelineModel& model) {
  Json json{{"program", model.program}, {"scene", model.scene.empty() ? Json(nullptr) : Json(model.scene)}};
  json["recursion"] = {{"depth", model.recursionDepth},
                       {"declared", model.declaredRecursion ? Json(*model.declaredRecursion) : Json(nullptr)},
                       {"stackBytes", model.stackBytes}};
  json["rays"] = model.rays;
  for (const char* list : {"stages", "hits"}) json[list] = Json::array();
  for (const PipelineModel::Stage& stage : model.stages)
    json["stages"].push_back({{"kind", shader::stageName(stage.kind)},
                              {"file", stage.file},
                              {"reached", stage.reached},
                              {"diagnostics", stage.diagnostics}});
  for (const PipelineModel::Hit& hit : model.hits)
    json["hits"].push_back({{"group", hit.group},
                            {"ray", hit.ray},
                            {"closestHit", optionalIndex(hit.closestHit)},
                            {"anyHit", optionalIndex(hit.anyHit)},
                            {"intersection", optionalIndex(hit.intersection)},
                            {"record", hit.record},
                            {"binding", hit.binding},
                            {"geometry", hit.geometry},
                            {"diagnostics", hit.diagnostics}});
  json["misses"] = recordsJson(model.misses);
  json["callables"] = recordsJson(model.callables);
  for (const char* list : {"traces", "calls"}) json[list] = Json::array();
  for (const PipelineModel::Trace& trace : model.traces)
    json["traces"].push_back(
        {{"stage", trace.stage},
         {"location", locationJson(trace.location)},
         {"rays", trace.rays},
         {"flags", trace.flags},
         {"mask", trace.mask},
         {"offset", trace.offset},
         {"stride", trace.stride},
         {"miss", trace.miss},
         {"payload", {{"name", trace.payload}, {"type", trace.payloadType}, {"bytes", trace.payloadBytes}}},
         {"inLoop", trace.inLoop},
         {"searches", trace.searches},
         {"executes", trace.executes},
         {"skipsClosestHit", trace.skipsClosestHit},
         {"skipsAnyHit", trace.skipsAnyHit},
         {"targets", targetsJson(trace.targets)},
         {"diagnostics", trace.diagnostics}});
  for (const PipelineModel::Call& call : model.calls)
    json["calls"].push_back({{"stage", call.stage},
                             {"location", locationJson(call.location)},
                             {"index", call.index},
                             {"data", {{"name", call.data}, {"type", call.dataType}, {"bytes", call.dataBytes}}},
                             {"targets", targetsJson(call.targets)},
                             {"diagnostics", call.diagnostics}});
  json["diagnostics"] = Json::parse(diagnosticsJson(model.diagnostics));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace quintet::check
