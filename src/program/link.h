// From a program's description to what the device runs: compile all stages, make the pipeline, and lay
// out hit records for the geometry of a scene.
#ifndef QUINTET_PROGRAM_LINK_H
#define QUINTET_PROGRAM_LINK_H

#include <memory>
#include <optional>

#include "program/program.h"
#include "program/scene_facts.h"
#include "rt/pipeline.h"

namespace quintet::program {

// Every stage's SPIR-V, or why not.
struct CompiledProgram {
  struct Stage {
    std::string file;
    shader::Stage kind = shader::Stage::rayGeneration;
    std::vector<std::uint32_t> spirv;
  };
  std::vector<Stage> stages;  // one per file of the program that is used
  std::vector<shader::Diagnostic> diagnostics;
  std::vector<std::filesystem::path> files;  // on disk, read besides Program::files: for --watch
  std::vector<Hash> fileHashes;              // of what was read from them, sorted, each once
  double seconds = 0;                        // wall clock
  bool ok = false;

  const Stage& stage(const std::string& file) const;
};

// A file as the user knows it: the compiler has the program's own in memory only and calls them "<folder/file>".
std::string userFile(const Program& program, const std::string& file);

// `defines`: for all stages (features of the scene and the device). `instrument`: with the checks of instrument.h.
CompiledProgram compile(const Program& program, const shader::Compiler& compiler,
                        const std::vector<std::pair<std::string, std::string>>& defines, bool instrument = false);

// Index in program.hitGroups of the group that serves a geometry: the first one bound to its name
// (HitGroup::primitives), else to its material (an intersection shader for boxes, none for triangles), else to
// its kind, else "procedural", else to its class (opaque, alpha; fitting as above), else the first without a
// binding that fits, else the first without a binding, else 0.
std::size_t hitGroupFor(const Program& program, const GeometryFacts& geometry);

// A program on a device.
class LinkedProgram {
 public:
  // `compiled.ok` must hold. `recursionDepth`: of nested traces, as check() derives it (check.h).
  LinkedProgram(gpu::Context& context, const gpu::BindlessSet& set, const Program& program,
                const CompiledProgram& compiled, std::uint32_t recursionDepth, const gpu::PipelineCache* cache,
                bool captureStatistics = false);

  const Program& program() const { return program_; }
  const rt::Pipeline& pipeline() const { return *pipeline_; }
  std::uint32_t rayTypeCount() const { return static_cast<std::uint32_t>(program_.rays.size()); }
  double pipelineSeconds() const { return pipelineSeconds_; }
  std::uint32_t recursionDepth() const { return recursionDepth_; }  // of the pipeline

  // Records: geometry k has records k · rayTypeCount … + rayTypeCount - 1, one per ray type.
  rt::ShaderBindingTable makeTable(std::span<const GeometryFacts> geometries) const;

 private:
  std::vector<std::byte> recordData(const RecordValues& values) const;

  gpu::Context& context_;
  Program program_;
  std::unique_ptr<rt::Pipeline> pipeline_;
  std::uint32_t firstMissGroup_ = 0;
  std::uint32_t firstHitGroup_ = 0;  // group of hit group h and ray r: first + h · rayTypeCount + r
  std::uint32_t firstCallableGroup_ = 0;
  double pipelineSeconds_ = 0;
  std::uint32_t recursionDepth_ = 1;
};

}  // namespace quintet::program
#endif
