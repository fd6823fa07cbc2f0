// SPDX-License-Identifier: Apache-2.0
// The pipeline as a graph: the facts of each stage, its traces and callable calls, and the stages that these can
// reach over the shader binding table. Constant arguments select exactly; for other arguments all values within the table
// are assumed. A graph is built from a program, or from raw SPIR-V modules. It has no description of a program: a rule
// that depends on Quintet's layout or library takes one as input (rules/rules.h).
#ifndef QUINTET_CHECK_PIPELINE_GRAPH_H
#define QUINTET_CHECK_PIPELINE_GRAPH_H

#include <array>
#include <compare>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "check/pipeline_groups.h"
#include "check/value_context.h"
#include "program/compile.h"
#include "program/hit_group_binding.h"
#include "spirv/stage_facts.h"
#include "spirv/trace_instruction.h"

namespace quintet::check {

// gl_RayFlags…EXT
constexpr std::uint32_t kFlagOpaque = 1, kFlagNoOpaque = 2, kFlagTerminateOnFirstHit = 4, kFlagSkipClosestHit = 8,
                        kFlagCullBack = 16, kFlagCullFront = 32, kFlagCullOpaque = 64, kFlagCullNoOpaque = 128,
                        kFlagSkipTriangles = 256, kFlagSkipAabbs = 512;

// SPIR-V of one stage that did not come from a program.
struct ModuleStage {
  std::string name;  // as PipelineGroups names it
  shader::Stage kind = shader::Stage::rayGeneration;
  std::vector<std::uint32_t> spirv;  // one entry point, optimized (shader/optimizer.h)
  std::string problem;               // why there is no SPIR-V; empty if there is
  bool malformed = false;  // the problem is a mistake of the module, not something that is unknown to SPIRV-Tools
  bool isStub = false;     // an intersection shader without statements: a variant of a shader without its code
  // Specialization constants with values decide which code runs: what is unused here can be used by other pipelines.
  bool isVariant = false;
};

struct PipelineStage {
  std::string file;  // as in PipelineGroups
  shader::Stage kind = shader::Stage::rayGeneration;
  std::unique_ptr<spirv::StageFacts> facts;  // null if the module cannot be analyzed
  std::string problem = {};                  // why not, or what of it is not followed
  bool isStub = false;                       // as in ModuleStage
};

// A hit group for one ray type: indices in PipelineGroups::hitGroups and PipelineGroups::rays.
struct HitGroupRay {
  std::size_t group = 0;
  std::size_t ray = 0;
  auto operator<=>(const HitGroupRay&) const = default;
};

enum class Role { miss, closestHit, anyHit, intersection, callable };

// A stage that a trace or a call can reach.
struct Edge {
  std::size_t stage = 0;  // in PipelineGraph::stages
  Role role = Role::miss;
  bool exact = true;      // selected by constant arguments; false if assumed
  HitGroupRay hit;        // for the roles of a hit group
  std::size_t index = 0;  // for misses and callables
};

// What traces with equal arguments can run. Pipelines of engines have thousands of traces and thousands of hit groups, but
// few different arguments.
struct TraceTargets {
  std::vector<Edge> edges;          // miss shaders, then those of hit groups in the order of `hits`
  std::vector<HitGroupRay> hits;    // that a hit can use, in their order
  std::vector<std::size_t> traces;  // in PipelineGraph::traces, in their order
  // One of the hit groups or miss shaders runs, or a record without shaders, but it is unknown which one: the layout of the
  // table is unknown, or conditions select which hit objects are executed.
  bool assumesHits = false, assumesMisses = false;
  // It may also be that none of them runs: a hit object that can be empty.
  bool mayRunNothing = false;
};

// The edges to the shaders of a hit group. `edges` is in the order of TraceTargets.
std::span<const Edge> edgesOf(std::span<const Edge> edges, HitGroupRay hit);

struct TraceSite {
  std::size_t stage = 0;
  const spirv::TraceFacts* trace = nullptr;  // as intended, if arguments are swapped
  std::size_t targets = 0;                   // in PipelineGraph::targets
  std::span<const Edge> edges;               // as the targets have them
  std::span<const HitGroupRay> hits;
  bool assumesHits = false, assumesMisses = false;
  bool mayRunNothing = false;
  std::vector<std::string> swapped;  // which arguments are swapped (swapped_arguments.h)
  bool skipsClosestHit() const { return trace->flags.mustHave(kFlagSkipClosestHit); }
  bool isSearch() const { return trace->part == spirv::TracePart::search; }
  bool isExecution() const { return trace->part == spirv::TracePart::execution; }
  std::string_view noun() const { return isExecution() ? "execution of a hit object" : "trace"; }  // of messages
};

// The invocations of a stage with one record of the shader binding table.
struct RecordRuns {
  std::string record;           // "hit record 3"
  spirv::ValueContext context;  // with the data of the record, and the built-ins of its hits
};

struct CallSite {
  std::size_t stage = 0;
  const spirv::CallFacts* call = nullptr;
  std::vector<Edge> edges;
};

struct PipelineGraph {
  // Reads the modules in parallel. `program` must outlive the graph.
  PipelineGraph(const program::Program& program, const program::CompiledProgram& compiled);
  // Of raw modules. `mergesEqual`: equal traces and stages are followed once, which changes only the time.
  PipelineGraph(PipelineGroups groups, std::span<const ModuleStage> modules, bool mergesEqual = true);

  const PipelineGroups groups;
  const bool usesLibrary;  // the stages include <quintet/…>, so structures with its names are those of the library
  const bool mergesEqual;
  std::vector<PipelineStage> stages;
  std::vector<TraceSite> traces;  // in the order of their stages
  std::deque<TraceTargets> targets;
  std::vector<CallSite> calls;  // in the order of their stages
  bool hasVariants = false;     // a stage is one, as ModuleStage::isVariant
  std::string error;            // first module that cannot be analyzed completely, and the reason; empty if all can

  std::size_t rayCount() const { return groups.rays.size(); }
  const PipelineStage* stage(const std::string& file) const;  // null if unknown
  std::span<const TraceSite> tracesOf(std::size_t stage) const;
  std::span<const CallSite> callsOf(std::size_t stage) const;
  const spirv::StageFacts& facts(const TraceSite& site) const { return *stages[site.stage].facts; }
  const spirv::StageFacts& facts(const CallSite& site) const { return *stages[site.stage].facts; }
  const spirv::StageFacts& facts(const Edge& edge) const { return *stages[edge.stage].facts; }
  // The arguments of the ray of a trace; of an execution of a hit object, those of the trace that filled it. Nullopt if these
  // are not known.
  std::optional<spirv::RayOperands> ray(const TraceSite& site) const;
  const program::HitShaders& shaders(HitGroupRay hit) const;  // empty if the group has none for that ray type
  bool hasIntersection(std::size_t group) const;
  // What is known about the values of a stage. A null `scene` stands for any scene.
  spirv::ValueContext context(const std::string& file, const program::SceneFacts* scene) const;
  // The records with known data with which the stage certainly runs, if rays hit what the arguments of traces select. With equal
  // data and built-ins, only the first one.
  std::vector<RecordRuns> recordRuns(const std::string& file) const;
  // Ranges of a stage, which has facts, if all parameters have their defaults; null without parameters. Cached; threads
  // must ask for different stages.
  const DefaultRanges* defaults(std::size_t stage) const;
  // Ray types whose hit shaders the trace can use.
  std::vector<std::size_t> rayTypes(const spirv::TraceFacts& trace) const;
  // With HitRecords::byRecord: indices of the hit records that the known instances and values of the arguments select,
  // which can be beyond the table.
  std::set<std::size_t> recordsOf(const spirv::TraceFacts& trace) const;
  // Stages reachable from ray generation. An any-hit shader counts as reachable even if opacity prevents it.
  std::set<std::size_t> reachableStages() const;

  // Name of a stage's file as the user knows it. The stages of the lecture form are parts of one file.
  const std::string& nameOf(const std::string& file) const;
  // True if both are compiled from the same hit shader of the lecture form: for triangles, and for procedural geometry.
  bool areVariants(const PipelineStage& a, const PipelineStage& b) const;
  // "closest-hit shader 'a.rchit' (hit group 'surface', ray type 'primary')"
  std::string describe(const Edge& edge) const;
  std::string describe(HitGroupRay hit) const;  // "hit group 'surface', ray type 'primary'"
  // True if the file is one of the user's: not of the shader library.
  bool isOwnFile(const std::string& file) const;
  // A line of the description of the groups.
  SourceLocation descriptionLocation(int line) const;
  // The given location if its line is known, else the file of the stage.
  SourceLocation location(const PipelineStage& stage, const SourceLocation& location) const;
  // Where the stage declares a variable that stages share; its main() if the lecture form declares it.
  SourceLocation declarationOf(const PipelineStage& stage, const spirv::SharedVariable& variable) const;
  SourceLocation location(const TraceSite& site) const;
  SourceLocation location(const CallSite& site) const;

 private:
  using Context = std::function<spirv::ValueContext(const std::string&, const program::SceneFacts*, ParameterUse)>;

  std::unordered_map<std::string, std::size_t> index_;  // of the stages, by file
  std::deque<spirv::TraceFacts> intended_;              // of traces with swapped arguments
  Context context_;
  bool hasParameters_ = false;
  // Without a known table: all traces use the same records, so a single hit group or miss shader is that of each trace.
  bool sameHitRecords_ = true, sameMissRecord_ = true;
  mutable std::vector<std::unique_ptr<DefaultRanges>> defaults_;  // by stage

  // Reads module i, which `words` returns, if it is not empty.
  void readStages(const std::function<std::vector<std::uint32_t>(std::size_t)>& words, std::vector<std::string> errors);
  // The targets by what selects them: flags, mask, offset, stride, miss index; for parts of traces also what they run.
  struct Selection {
    std::array<spirv::ArgumentValues, 5> arguments;
    spirv::TracePart part = spirv::TracePart::whole;
    bool mayHit = true, mayMiss = true, runsAll = true;
    auto operator<=>(const Selection&) const = default;
  };
  using TargetsOfArguments = std::map<Selection, std::size_t>;

  void compareRecords();
  void addCustomIndices(const std::string& file, spirv::ValueContext& context) const;
  // The built-ins of hits that run a stage, by hit record.
  struct HitBuiltIns {
    std::set<double> customIndices, geometries;
    bool allCustomIndices = true;  // each instance has a known one
  };
  std::map<std::size_t, HitBuiltIns> certainHits(std::size_t stage) const;
  std::set<std::size_t> certainMisses(std::size_t stage) const;
  std::set<std::size_t> certainCallables(std::size_t stage) const;
  void assume(TraceTargets& targets) const;
  void addTraces(std::size_t stage, TargetsOfArguments& known);
  void addCalls(std::size_t stage);
  std::size_t targetsOf(const spirv::TraceFacts& trace, TargetsOfArguments& known);
  void addMisses(const spirv::TraceFacts& trace, TraceTargets& added) const;
  void addHits(const spirv::TraceFacts& trace, TraceTargets& added) const;
  void addHit(const spirv::TraceFacts& trace, HitGroupRay hit, bool exact, TraceTargets& added) const;
  void addHitsByRecord(const spirv::TraceFacts& trace, TraceTargets& added) const;
  void addEdge(std::vector<Edge>& edges, const std::string& file, Edge edge) const;
};

}  // namespace quintet::check
#endif
