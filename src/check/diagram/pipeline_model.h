// SPDX-License-Identifier: Apache-2.0
// The linked pipeline as plain data for people and tools: stages, traces and calls with their arguments, and what they
// reach. `quintet check --graph` writes it as JSON, and diagram.h draws it.
#ifndef QUINTET_CHECK_DIAGRAM_PIPELINE_MODEL_H
#define QUINTET_CHECK_DIAGRAM_PIPELINE_MODEL_H

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "check/check.h"
#include "check/pipeline_graph.h"

namespace quintet::check {

using Indices = std::vector<std::size_t>;

// Indices of diagnostics are in PipelineModel::diagnostics, those of stages in PipelineModel::stages.
struct PipelineModel {
  struct Stage {
    std::string file;  // as the user knows it; the stages of the lecture form have the same one
    shader::Stage kind = shader::Stage::rayGeneration;
    bool reached = false;
    Indices diagnostics;  // whose location is in the file, outside of traces and calls
  };

  // A hit group for one ray type.
  struct Hit {
    std::string group, ray;
    std::optional<std::size_t> closestHit, anyHit, intersection;  // stages
    std::string record;                 // "tint=0.85,0.35,0.15 stripes=4"; empty without fields
    std::vector<std::string> binding;   // "material 'glass'"; empty if the group is bound to nothing
    std::vector<std::string> geometry;  // of the scene, that uses the group; empty without a scene
    Indices diagnostics;                // whose location is the line of the hit group
  };

  // A miss or callable shader; its position is its index in the shader binding table.
  struct Record {
    std::string name;  // can be empty
    std::optional<std::size_t> stage;
    std::string record;
  };

  // What a trace or call can run: an index in `hits`, `misses` or `callables`.
  struct Target {
    Role role = Role::miss;  // closestHit stands for all shaders of a hit
    std::size_t index = 0;
    bool exact = true;    // selected by constant arguments
    Indices diagnostics;  // that name both ends
  };

  struct Trace {
    std::size_t stage = 0;
    SourceLocation location;
    Indices rays;                                   // ray types that it can select
    std::string flags, mask, offset, stride, miss;  // values, or "not constant"
    std::string payload, payloadType;               // names
    std::uint64_t payloadBytes = 0;
    bool inLoop = false;
    bool searches = false;  // a trace with a hit object: without the shader at the end of the ray
    bool executes = false;  // the execution of a hit object: only that shader
    bool skipsClosestHit = false, skipsAnyHit = false;  // always, because of the flags
    std::vector<Target> targets;
    Indices diagnostics;
  };

  struct Call {
    std::size_t stage = 0;
    SourceLocation location;
    std::string index, data, dataType;
    std::uint64_t dataBytes = 0;
    std::vector<Target> targets;
    Indices diagnostics;
  };

  std::string program, scene;  // names; without a scene empty
  std::uint32_t recursionDepth = 1;
  std::optional<std::uint32_t> declaredRecursion;
  std::uint64_t stackBytes = 0;
  std::vector<std::string> rays;  // names
  std::vector<Stage> stages;
  std::vector<Hit> hits;  // by group, then by ray type
  std::vector<Record> misses, callables;
  std::vector<Trace> traces;
  std::vector<Call> calls;
  std::vector<Diagnostic> diagnostics;
};

// Compiles the program with its default outputs and describes it. `result` is that of the check with the same scene, which
// can be null. Returns nullopt if a stage does not compile.
std::optional<PipelineModel> describePipeline(const program::Program& program, const shader::Compiler& compiler,
                                              const program::SceneFacts* scene, const CheckResult& result);

// Describes a pipeline of raw modules, with the arguments and the result of checkModules(). Ray types have no names there, and
// records and bindings of hit groups are unknown. Returns nullopt if a stage cannot be analyzed.
std::optional<PipelineModel> describeModules(const std::string& name, PipelineGroups groups,
                                             std::span<const ModuleStage> modules, const CheckResult& result);

// Returns an object with a line break at its end. docs/cli.md lists the keys.
std::string pipelineJson(const PipelineModel& model);

}  // namespace quintet::check
#endif
