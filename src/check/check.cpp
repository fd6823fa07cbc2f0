// SPDX-License-Identifier: Apache-2.0
// The order of the rules, within each stage and across stages.
#include "check/check.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "check/flow/pipeline_spaces.h"
#include "check/rules/across_stages/payload_receivers.h"
#include "check/rules/rules.h"

namespace quintet::check {
namespace {

// A wrong argument of a trace or call leaves stages unreachable. Only the argument is reported then.
constexpr std::array<std::string_view, 10> kWrongArgument{"Q302", "Q501", "Q502", "Q503", "Q504",
                                                          "Q506", "Q507", "Q513", "Q515", "Q605"};

// Ids whose cause is code that is missing. More outputs can remove them.
constexpr std::array<std::string_view, 1> kUnreachable{"Q801"};

// Ids of code and groups without effect. Pipelines of one engine that differ in specialization constants share them.
constexpr std::array<std::string_view, 3> kWithoutEffect{"Q606", "Q610", "Q801"};

// The intersection shaders of hit groups with an any-hit shader.
std::set<std::string> intersectionsWithAnyHit(const PipelineGraph& graph) {
  std::set<std::string> files;
  for (const program::HitGroup& group : graph.groups.hitGroups)
    for (const auto& [ray, shaders] : group.shaders)
      if (!shaders.anyHit.empty()) files.insert(shaders.intersection);
  return files;
}

// A null `program` for raw modules.
void runRulesWithinStages(const CheckInput& input, const ProgramStageContext* program, Report& report) {
  const PipelineGraph& graph = input.graph;
  const std::set<std::string> withAnyHit = intersectionsWithAnyHit(graph);
  std::vector<std::vector<Diagnostic>> found(graph.stages.size());
  parallelFor(graph.stages.size(), [&](std::size_t i) {
    const PipelineStage& stage = graph.stages[i];
    if (!stage.facts) return;
    const StageContext context{graph.usesLibrary, withAnyHit.contains(stage.file), input.limits.defects};
    found[i] = checkStage(stage.facts->module(), context);
    if (program) std::ranges::move(checkProgramStage(stage.facts->module(), *program), std::back_inserter(found[i]));
  });
  for (std::size_t i = 0; i < found.size(); ++i)
    for (Diagnostic& d : found[i])
      report.add(d.id, graph.location(graph.stages[i], {d.file, d.line, d.column}), std::move(d.text),
                 std::move(d.related));
}

// The rules that hold for every pipeline.
RecursionNeeds runGeneralRules(const CheckInput& input, const PipelineSpaces& spaces, Report& report) {
  const PayloadReceivers receivers(input.graph);
  checkPayloadTypes(input, receivers, report);
  checkPayloadMembers(input, receivers, report);
  checkPayloadInputs(input, receivers, report);
  checkHitAttributes(input, report);
  checkCallableTypes(input, report);
  checkCallableData(input, report);
  checkCandidates(input, report);
  const RecursionNeeds needs = checkRecursion(input, report);
  checkEndlessRecursion(input, report);
  checkArguments(input, report);
  checkRayArguments(input, report);
  checkHitKinds(input, report);
  checkRayOrigins(input, report);
  checkHitPositions(input, report);
  checkMissDistances(input, report);
  checkArrayIndices(input, report);
  checkSpaces(input, spaces, report);
  return needs;
}

// The rules that depend on Quintet's layout, library and descriptions.
void runProgramRules(const ProgramInput& input, const PipelineSpaces& spaces, Report& report) {
  checkSharedLocations(input, report);
  checkRecordLayout(input, report);
  checkStrides(input, report);
  checkTriangleKinds(input, report);
  checkGeometry(input, report);
  checkResources(input, report);
  checkRandomSeeds(input, report);
  checkColorEncoding(input, spaces, report);
  if (input.limits.defects.sharesAnyHit) checkSharedIntersections(input, report);
  checkUnusedHitGroups(input, report);
  checkOutputs(input, report);
}

void checkUnreachable(const CheckInput& input, Report& report) {
  if (input.graph.error.empty() && !input.featureDefines && !report.hasAny(kWrongArgument))
    checkUnreachableStages(input, report);
}

std::set<std::size_t> usedGroups(const program::Program& program, const program::SceneFacts& facts) {
  std::set<std::size_t> groups;
  for (const program::GeometryFacts& geometry : facts.geometries)
    groups.insert(program::hitGroupFor(program, geometry));
  return groups;
}

// Without the suppressions.
CheckResult runRules(const program::Program& program, const program::CompiledProgram& compiled,
                     const program::SceneFacts* scene, const DeviceLimits& limits, bool featureDefines) {
  const Stopwatch clock;
  CheckResult result;
  result.diagnostics = compiled.diagnostics;
  result.files = compiled.files;
  result.recursionDepth = program.declaredRecursion.value_or(1);
  if (compiled.ok) {
    const PipelineGraph graph(program, compiled);
    const std::optional<program::SceneFacts> facts =
        scene ? std::optional(program::factsFor(program, *scene)) : std::nullopt;
    ProgramInput input{{graph, facts ? &*facts : nullptr, limits, featureDefines}, program, compiled.outputs};
    if (facts) input.usedGroups = usedGroups(program, *facts);
    const ProgramStageContext ofStages{program.keepsInstanceOrder};
    const PipelineSpaces spaces(graph);
    Report report;
    runRulesWithinStages(input, &ofStages, report);
    const RecursionNeeds needs = runGeneralRules(input, spaces, report);
    runProgramRules(input, spaces, report);
    checkUnreachable(input, report);
    result.recursionDepth = needs.depth;
    result.stackBytes = needs.stackBytes;
    result.cyclic = needs.cyclic;
    if (graph.error.empty())
      for (const std::size_t stage : graph.reachableStages()) result.reached.push_back(graph.stages[stage].file);
    for (Diagnostic& d : report.take()) {
      d.file = program::userFile(program, d.file);
      for (RelatedLocation& r : d.related) r.file = program::userFile(program, r.file);
      result.diagnostics.push_back(std::move(d));
    }
  }
  result.seconds = compiled.seconds + clock.seconds();
  return result;
}

// The rules that compare what is known, if a stage cannot be analyzed.
void runRulesOfKnownStages(const CheckInput& input, Report& report) {
  checkPayloadTypes(input, PayloadReceivers(input.graph), report);
  checkHitAttributes(input, report);
  checkCallableTypes(input, report);
  checkArguments(input, report);
  checkRayArguments(input, report);
  checkHitRecords(input, report);
}

std::optional<program::SceneFacts> factsOf(const PipelineGroups& groups) {
  if (!groups.instances) return {};
  program::SceneFacts facts{"the acceleration structure", groups.geometries, {}};
  for (const InstanceRecords& instance : *groups.instances) facts.instances.push_back(instance.facts);
  return facts;
}

void replaceAll(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

// Moves the SPIR-V id of an unknown line from the file to the text.
void nameIds(Diagnostic& d) {
  for (std::size_t at = d.text.find(spirv::kIdMark); at != d.text.npos; at = d.text.find(spirv::kIdMark, at)) {
    d.text.replace(at, 1, " (");
    const std::size_t end = d.text.find(":0", at);
    if (end != d.text.npos) d.text.replace(end, 2, ")");
  }
  for (const char* unknown : {" (line 0)", " in line 0"}) replaceAll(d.text, unknown, "");
  const auto [file, id] = spirv::splitIdLocation(d.file);
  d.file = file;
  if (!id.empty()) d.text += fmt::format(" ({})", id);
}

// Moves the diagnostics that comments accept to CheckResult::suppressed. `complete`: the check saw all code, so it knows
// which suppressions are unused.
void suppress(CheckResult& result, const program::Program& program, const program::SceneFacts* scene, bool complete) {
  Suppressions suppressions(program);
  result.suppressed = suppressions.apply(result.diagnostics);
  if (complete && result.ok())
    std::ranges::move(suppressions.problems(scene != nullptr), std::back_inserter(result.diagnostics));
}

CheckResult checkWithOutputs(const program::Program& program, const shader::Compiler& compiler,
                             const program::SceneFacts* scene, const DeviceLimits& limits,
                             const std::vector<std::string>& outputs) {
  std::vector<std::pair<std::string, std::string>> defines;
  for (const std::string& output : outputs) defines.emplace_back(program::outputMacro(output), "1");
  return runRules(program, compile(program, compiler, defines), scene, limits, false);
}

// Returns whether the list has a diagnostic of the same id and line. The texts of compiler messages must be equal too;
// those of rules can contain numbers that depend on the outputs, or a note (withNote).
bool contains(const std::vector<Diagnostic>& list, const Diagnostic& diagnostic) {
  return std::ranges::any_of(list, [&](const Diagnostic& d) {
    const bool sameText = d.text.starts_with(diagnostic.text) || diagnostic.id.starts_with('Q');
    return d.id == diagnostic.id && d.file == diagnostic.file && d.line == diagnostic.line && sameText;
  });
}

Diagnostic withNote(Diagnostic diagnostic, const std::string& condition) {
  diagnostic.text += fmt::format(" (with {})", condition);
  return diagnostic;
}

// Returns what a check with more outputs found in addition. A stage that is unreachable only then does not count.
std::vector<Diagnostic> newFindings(const CheckResult& known, const CheckResult& variant) {
  std::vector<Diagnostic> found;
  for (const Diagnostic& d : variant.diagnostics)
    if (!std::ranges::count(kUnreachable, d.id) && !contains(known.diagnostics, d)) found.push_back(d);
  return found;
}

// Joins the facts of a check with more outputs. Its rays can reach more stages.
void addVariant(CheckResult& result, const CheckResult& variant) {
  result.recursionDepth = std::max(result.recursionDepth, variant.recursionDepth);
  result.stackBytes = std::max(result.stackBytes, variant.stackBytes);
  result.cyclic = result.cyclic || variant.cyclic;
  result.seconds += variant.seconds;
  for (const std::filesystem::path& file : variant.files)
    if (std::ranges::find(result.files, file) == result.files.end()) result.files.push_back(file);
  for (const std::string& file : variant.reached)
    if (std::ranges::find(result.reached, file) == result.reached.end()) result.reached.push_back(file);
  if (!variant.ok()) return;
  std::erase_if(result.diagnostics, [&](const Diagnostic& d) {
    return std::ranges::count(kUnreachable, d.id) && !contains(variant.diagnostics, d);
  });
}

// Adds what a check with the optional outputs finds. Diagnostics name the output that causes them.
void addOptionalOutputs(CheckResult& result, const program::Program& program, const shader::Compiler& compiler,
                        const program::SceneFacts* scene, const DeviceLimits& limits) {
  const std::vector<std::string> outputs = program::optionalOutputs(program);
  if (outputs.empty()) return;
  const CheckResult all = checkWithOutputs(program, compiler, scene, limits, outputs);
  addVariant(result, all);

  std::vector<Diagnostic> found = newFindings(result, all);
  if (!found.empty() && outputs.size() > 1) {
    // Which output causes them? An error can also hide those of other outputs.
    std::vector<Diagnostic> precise;
    for (const std::string& output : outputs) {
      const CheckResult single = checkWithOutputs(program, compiler, scene, limits, {output});
      result.seconds += single.seconds;
      for (Diagnostic& d : newFindings(result, single))
        if (!contains(precise, d))
          precise.push_back(withNote(std::move(d), fmt::format("optional output '{}'", output)));
    }
    for (Diagnostic& d : found)
      if (!contains(precise, d))
        precise.push_back(withNote(std::move(d), fmt::format("all optional outputs: {}", fmt::join(outputs, ", "))));
    found = std::move(precise);
  } else {
    for (Diagnostic& d : found) d = withNote(std::move(d), fmt::format("optional output '{}'", outputs.front()));
  }
  std::ranges::move(found, std::back_inserter(result.diagnostics));
}

}  // namespace

std::vector<Diagnostic> checkStage(const spirv::Module& module, const StageContext& context) {
  using Model = spv::ExecutionModel;
  Report report;
  const auto stage = module.stage();
  if (!stage) return {};
  const bool intersection = stage == Model::IntersectionKHR;
  if (intersection) checkDistance(module, report);
  checkDescriptorIndices(module, report);
  checkPrintFormats(module, report);
  checkPixelDivision(module, context.usesLibrary, report);
  checkRayLengths(module, report);
  const DriverDefects& defects = context.defects;
  if (defects.changesNestedBuiltIns && stage == Model::ClosestHitKHR) checkNestedBuiltIns(module, report);
  if (defects.corruptsHitAttributes && intersection) checkAttributeWrites(module, report);
  if (defects.sharesLocalArrays && intersection && context.hasAnyHit) checkLocalArrays(module, report);
  return report.take();
}

std::vector<Diagnostic> checkProgramStage(const spirv::Module& module, const ProgramStageContext& context) {
  using Model = spv::ExecutionModel;
  Report report;
  const auto stage = module.stage();
  const bool hit = stage == Model::IntersectionKHR || stage == Model::AnyHitKHR || stage == Model::ClosestHitKHR;
  if (hit && !context.keepsInstanceOrder) checkInstanceIndices(module, report);
  if (stage == Model::RayGenerationKHR) checkPixels(module, report);
  if (stage == Model::IntersectionKHR) checkRayTmaxReads(module, report);
  return report.take();
}

CheckResult check(const program::Program& program, const program::CompiledProgram& compiled,
                  const program::SceneFacts* scene, const DeviceLimits& limits, bool featureDefines) {
  CheckResult result = runRules(program, compiled, scene, limits, featureDefines);
  suppress(result, program, scene, !featureDefines);
  return result;
}

CheckResult check(const program::Program& program, const shader::Compiler& compiler, const program::SceneFacts* scene,
                  const DeviceLimits& limits, const std::vector<std::pair<std::string, std::string>>& defines) {
  const bool features =
      std::ranges::any_of(defines, [](const auto& define) { return define.first.starts_with("QUINTET_NO_"); });
  return check(program, compile(program, compiler, defines), scene, limits, features);
}

CheckResult checkModules(PipelineGroups groups, std::span<const ModuleStage> modules, const DeviceLimits& limits,
                         bool mergesEqual) {
  const Stopwatch clock;
  const PipelineGraph graph(std::move(groups), modules, mergesEqual);
  const std::optional<program::SceneFacts> facts = factsOf(graph.groups);
  const CheckInput input{graph, facts ? &*facts : nullptr, limits};
  Report report;
  runRulesWithinStages(input, nullptr, report);
  CheckResult result;
  result.recursionDepth = graph.groups.declaredRecursion.value_or(1);
  if (graph.error.empty()) {
    const RecursionNeeds needs = runGeneralRules(input, PipelineSpaces(graph), report);
    result.recursionDepth = needs.depth;
    result.stackBytes = needs.stackBytes;
    result.cyclic = needs.cyclic;
    for (const std::size_t stage : needs.chain) result.chain.push_back(graph.stages[stage].file);
    checkHitRecords(input, report);
    if (!graph.groups.rayGenerations.empty()) checkUnreachable(input, report);
    for (const std::size_t stage : graph.reachableStages()) result.reached.push_back(graph.stages[stage].file);
  } else {
    runRulesOfKnownStages(input, report);
  }
  result.diagnostics = report.take();
  if (graph.hasVariants)
    std::erase_if(result.diagnostics, [](const Diagnostic& d) { return std::ranges::count(kWithoutEffect, d.id) > 0; });
  std::ranges::for_each(result.diagnostics, nameIds);
  for (std::size_t i = 0; i < modules.size(); ++i)
    if (const PipelineStage& stage = graph.stages[i]; !stage.problem.empty() && modules[i].problem.empty())
      result.diagnostics.push_back(
          {Severity::note,
           modules[i].name,
           0,
           0,
           "",
           (stage.facts ? "only its types and arguments are checked, because " : "not checked: ") + stage.problem,
           {}});
  result.seconds = clock.seconds();
  return result;
}

CheckResult checkWithOptionalOutputs(const program::Program& program, const shader::Compiler& compiler,
                                     const program::SceneFacts* scene, const DeviceLimits& limits) {
  CheckResult result = checkWithOutputs(program, compiler, scene, limits, {});
  addOptionalOutputs(result, program, compiler, scene, limits);
  suppress(result, program, scene, true);
  return result;
}

}  // namespace quintet::check
