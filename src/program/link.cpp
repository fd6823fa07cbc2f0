#include "program/link.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>

#include "base/parallel.h"

namespace quintet::program {
namespace {

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<std::string> usedFiles(const Program& program) {
  std::vector<std::string> files;
  const auto add = [&](const std::string& file) {
    if (!file.empty() && std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  };
  add(program.rayGeneration);
  for (const RayType& ray : program.rays) add(ray.miss);
  for (const HitGroup& group : program.hitGroups) {
    for (const auto& [ray, shaders] : group.shaders) {
      add(shaders.closestHit);
      add(shaders.anyHit);
      add(shaders.intersection);
    }
  }
  for (const std::string& file : program.callables) add(file);
  return files;
}

bool hasIntersection(const HitGroup& group) {
  return std::ranges::any_of(group.shaders, [](const auto& entry) { return !entry.second.intersection.empty(); });
}

bool isBound(const HitGroup& group) { return !group.geometry.empty() || !group.material.empty() || !group.primitives.empty(); }

bool names(const HitGroup& group, std::string_view what) { return group.geometry == what; }

std::string_view kindName(GeometryKind kind) {
  constexpr std::array<std::string_view, 4> kNames{"triangles", "solids", "csg", "custom"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace

const CompiledProgram::Stage& CompiledProgram::stage(const std::string& file) const {
  const auto found = std::find_if(stages.begin(), stages.end(), [&](const Stage& stage) { return stage.file == file; });
  assert(found != stages.end());
  return *found;
}

CompiledProgram compile(const Program& program, const shader::Compiler& compiler,
                        const std::vector<std::pair<std::string, std::string>>& defines) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::string> files = usedFiles(program);
  std::map<std::string, std::string> virtualFiles;
  virtualFiles["quintet/generated/program.glsl"] = generatedConstants(program);
  for (const auto& [name, text] : program.files) virtualFiles[program.path(name)] = text;

  std::vector<shader::Result> results(files.size());
  CompiledProgram compiled;
  compiled.stages.resize(files.size());
  parallelFor(files.size(), [&](std::size_t i) {
    shader::Source source;
    const bool library = isLibraryStage(files[i]);
    source.stage = *shader::stageOfFile(library ? files[i].substr(1, files[i].size() - 2) : files[i]);
    source.text = library ? "#version 460\n#extension GL_EXT_ray_tracing : require\n#include " + files[i] + "\n" : program.files.at(files[i]);
    source.name = program.path(files[i]);
    source.defines = defines;
    source.virtualFiles = virtualFiles;
    results[i] = compiler.compile(source);
    compiled.stages[i] = {files[i], source.stage, std::move(results[i].spirv)};
  });
  compiled.ok = true;
  for (std::size_t i = 0; i < files.size(); ++i) {
    compiled.ok = compiled.ok && !compiled.stages[i].spirv.empty();
    std::move(results[i].diagnostics.begin(), results[i].diagnostics.end(), std::back_inserter(compiled.diagnostics));
  }
  compiled.seconds = secondsSince(start);
  return compiled;
}

LinkedProgram::LinkedProgram(gpu::Context& context, const gpu::BindlessSet& set, const Program& program,
                             const CompiledProgram& compiled, const gpu::PipelineCache* cache)
    : context_(context), program_(program) {
  assert(compiled.ok);
  const auto start = std::chrono::steady_clock::now();
  rt::PipelineOptions options;
  options.name = program.name;
  options.maxRecursionDepth = program.maxRecursion;
  for (const CompiledProgram::Stage& stage : compiled.stages) options.stages.push_back({stage.kind, stage.spirv, program.path(stage.file)});
  const auto index = [&](const std::string& file) {
    return file.empty() ? rt::kNoStage : static_cast<int>(&compiled.stage(file) - compiled.stages.data());
  };
  const auto groupCount = [&] { return static_cast<std::uint32_t>(options.groups.size()); };

  options.groups.push_back({.general = index(program.rayGeneration)});
  firstMissGroup_ = groupCount();
  for (const RayType& ray : program.rays) options.groups.push_back({.general = index(ray.miss)});
  firstHitGroup_ = groupCount();
  for (const HitGroup& group : program.hitGroups) {
    for (const RayType& ray : program.rays) {
      const auto found = group.shaders.find(ray.name);
      const HitShaders shaders = found == group.shaders.end() ? HitShaders{} : found->second;
      options.groups.push_back({.closestHit = index(shaders.closestHit), .anyHit = index(shaders.anyHit), .intersection = index(shaders.intersection)});
    }
  }
  firstCallableGroup_ = groupCount();
  for (const std::string& file : program.callables) options.groups.push_back({.general = index(file)});

  pipeline_ = std::make_unique<rt::Pipeline>(context, set, options, cache);
  pipelineSeconds_ = secondsSince(start);
}

std::size_t hitGroupFor(const Program& program, const GeometryFacts& geometry) {
  const auto first = [&](auto matches) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < program.hitGroups.size(); ++i)
      if (matches(program.hitGroups[i])) return i;
    return {};
  };
  const bool boxes = geometry.procedural();
  if (auto i = first([&](const HitGroup& g) { return !geometry.name.empty() && g.primitives == geometry.name; })) return *i;
  if (auto i = first([&](const HitGroup& g) { return !geometry.material.empty() && g.material == geometry.material && hasIntersection(g) == boxes; })) return *i;
  if (auto i = first([&](const HitGroup& g) { return names(g, kindName(geometry.kind)); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return boxes && names(g, "procedural"); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return hasIntersection(g) == boxes && names(g, geometry.alpha ? "alpha" : "opaque"); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return !isBound(g) && hasIntersection(g) == boxes; })) return *i;
  if (auto i = first([&](const HitGroup& g) { return !isBound(g); })) return *i;
  return 0;
}

rt::ShaderBindingTable LinkedProgram::makeTable(std::span<const GeometryFacts> geometries) const {
  rt::SbtContents contents;
  contents.rayGeneration.group = 0;
  for (std::uint32_t r = 0; r < rayTypeCount(); ++r) contents.miss.push_back({firstMissGroup_ + r, {}});
  for (const GeometryFacts& geometry : geometries) {
    for (std::uint32_t r = 0; r < rayTypeCount(); ++r) {
      const std::uint32_t group = firstHitGroup_ + static_cast<std::uint32_t>(hitGroupFor(program_, geometry)) * rayTypeCount() + r;
      contents.hit.push_back({program_.hitGroups.empty() ? rt::SbtRecord::kUnusedGroup : group, {}});
    }
  }
  for (std::size_t i = 0; i < program_.callables.size(); ++i)
    contents.callable.push_back({firstCallableGroup_ + static_cast<std::uint32_t>(i), {}});
  return rt::ShaderBindingTable(context_, *pipeline_, contents, program_.name + " shader binding table");
}

}  // namespace quintet::program
