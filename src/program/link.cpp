#include "program/link.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>

#include "base/parallel.h"
#include "program/device_stages.h"
#include "program/generated.h"
#include "program/instrument.h"
#include "program/lecture.h"

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
  for (const MissShader& miss : missShaders(program)) add(miss.file);
  for (const HitGroup& group : program.hitGroups) {
    for (const auto& [ray, shaders] : group.shaders) {
      add(shaders.closestHit);
      add(shaders.anyHit);
      add(shaders.intersection);
    }
  }
  for (const Callable& callable : program.callables) add(callable.file);
  return files;
}

bool hasIntersection(const HitGroup& group) {
  return std::ranges::any_of(group.shaders, [](const auto& entry) { return !entry.second.intersection.empty(); });
}

bool isBound(const HitGroup& group) {
  return !group.geometry.empty() || !group.material.empty() || !group.primitives.empty();
}

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return !name.empty() && std::find(names.begin(), names.end(), name) != names.end();
}

std::string_view kindName(GeometryKind kind) {
  constexpr std::array<std::string_view, 4> kNames{"triangles", "solids", "csg", "custom"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace

std::string userFile(const Program& program, const std::string& file) {
  if (!isLibraryStage(file)) return file;
  const std::string inside = file.substr(1, file.size() - 2);
  const bool own =
      std::ranges::any_of(program.files, [&](const auto& entry) { return program.path(entry.first) == inside; });
  return own ? inside : file;
}

const CompiledProgram::Stage& CompiledProgram::stage(const std::string& file) const {
  const auto found = std::find_if(stages.begin(), stages.end(), [&](const Stage& stage) { return stage.file == file; });
  assert(found != stages.end());
  return *found;
}

CompiledProgram compile(const Program& program, const shader::Compiler& compiler,
                        const std::vector<std::pair<std::string, std::string>>& defines, bool instrument) {
  const auto start = std::chrono::steady_clock::now();
  const auto isError = [](const shader::Diagnostic& d) { return d.severity == shader::Severity::error; };
  if (std::ranges::any_of(program.diagnostics, isError)) return {.stages = {}, .diagnostics = program.diagnostics};
  const std::vector<std::string> files = usedFiles(program);
  std::map<std::string, std::string> virtualFiles = generatedFiles(program);
  for (const auto& [name, text] : program.files) virtualFiles[program.path(name)] = text;

  std::vector<shader::Result> results(files.size());
  CompiledProgram compiled;
  compiled.stages.resize(files.size());
  parallelFor(files.size(), [&](std::size_t i) {
    shader::Source source;
    const bool library = isLibraryStage(files[i]);
    source.stage = *shader::stageOfFile(library ? files[i].substr(1, files[i].size() - 2) : files[i]);
    source.text = library ? "#version 460\n#extension GL_EXT_ray_tracing : require\n#include " + files[i] + "\n"
                          : program.files.at(files[i]);
    if (instrument) source.text = instrumentStage(source.text, source.stage, i);
    source.name = program.path(files[i]);
    source.defines = defines;
    source.virtualFiles = virtualFiles;
    results[i] = compiler.compile(source);
    if (program.descriptionFile.ends_with(kLectureExtension)) explainLectureNames(results[i].diagnostics, source.stage);
    compiled.stages[i] = {files[i], source.stage, std::move(results[i].spirv)};
  });
  compiled.ok = true;
  compiled.diagnostics = program.diagnostics;
  for (std::size_t i = 0; i < files.size(); ++i) {
    compiled.ok = compiled.ok && !compiled.stages[i].spirv.empty();
    // What stages share (common text, an included file) says the same in each of them.
    for (shader::Diagnostic& d : results[i].diagnostics) {
      const std::string line = d.format();
      if (std::ranges::none_of(compiled.diagnostics,
                               [&](const shader::Diagnostic& known) { return known.format() == line; }))
        compiled.diagnostics.push_back(std::move(d));
    }
    for (const std::filesystem::path& file : results[i].files)
      if (std::ranges::find(compiled.files, file) == compiled.files.end()) compiled.files.push_back(file);
    compiled.fileHashes.insert(compiled.fileHashes.end(), results[i].fileHashes.begin(), results[i].fileHashes.end());
  }
  std::ranges::sort(compiled.fileHashes);
  compiled.fileHashes.erase(std::unique(compiled.fileHashes.begin(), compiled.fileHashes.end()),
                            compiled.fileHashes.end());
  for (shader::Diagnostic& d : compiled.diagnostics) d.file = userFile(program, d.file);
  compiled.seconds = secondsSince(start);
  return compiled;
}

LinkedProgram::LinkedProgram(gpu::Context& context, const gpu::BindlessSet& set, const Program& program,
                             const CompiledProgram& compiled, std::uint32_t recursionDepth,
                             const gpu::PipelineCache* cache, bool captureStatistics)
    : context_(context), program_(program), recursionDepth_(recursionDepth) {
  assert(compiled.ok);
  const auto start = std::chrono::steady_clock::now();
  rt::PipelineOptions options;
  options.name = program.name;
  options.captureStatistics = captureStatistics;
  options.maxRecursionDepth = std::max(1u, recursionDepth);
  DeviceStages stages(program, compiled, context.info().quirks);
  const auto groupCount = [&] { return static_cast<std::uint32_t>(options.groups.size()); };

  options.groups.push_back({.general = stages.index(program.rayGeneration), .name = "ray generation"});
  firstMissGroup_ = groupCount();
  for (const MissShader& miss : missShaders(program))
    options.groups.push_back({.general = stages.index(miss.file), .name = "miss " + miss.file});
  firstHitGroup_ = groupCount();
  for (const HitGroup& group : program.hitGroups) {
    for (const RayType& ray : program.rays) {
      const auto found = group.shaders.find(ray.name);
      const HitShaders shaders = found == group.shaders.end() ? HitShaders{} : found->second;
      options.groups.push_back({.closestHit = stages.index(shaders.closestHit),
                                .anyHit = stages.index(shaders.anyHit),
                                .intersection = stages.intersection(shaders.intersection, shaders.anyHit),
                                .name = "hit " + group.name + ", " + ray.name});
    }
  }
  firstCallableGroup_ = groupCount();
  for (const Callable& callable : program.callables)
    options.groups.push_back({.general = stages.index(callable.file), .name = "callable " + callable.file});

  options.stages = stages.stages();
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
  const auto fits = [&](const HitGroup& g) { return hasIntersection(g) == boxes; };
  const std::string_view kind = kindName(geometry.kind), opacity = geometry.alpha ? "alpha" : "opaque";
  if (auto i = first([&](const HitGroup& g) { return contains(g.primitives, geometry.name); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return fits(g) && contains(g.material, geometry.material); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return contains(g.geometry, kind); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return boxes && contains(g.geometry, "procedural"); })) return *i;
  if (geometry.thin && !geometry.alpha)
    if (auto i = first([&](const HitGroup& g) { return fits(g) && contains(g.geometry, "thin"); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return fits(g) && contains(g.geometry, opacity); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return !isBound(g) && fits(g); })) return *i;
  if (auto i = first([&](const HitGroup& g) { return !isBound(g); })) return *i;
  return 0;
}

std::vector<std::byte> LinkedProgram::recordData(const RecordValues& values) const {
  if (program_.record.empty()) return {};
  ParameterValues data(program_.record);
  if (!values.empty()) data.setAll(values);
  return data.pack();
}

rt::ShaderBindingTable LinkedProgram::makeTable(std::span<const GeometryFacts> geometries) const {
  rt::SbtContents contents;
  contents.rayGeneration = {0, recordData(program_.rayGenerationRecord)};
  std::uint32_t group = firstMissGroup_;
  for (const MissShader& miss : missShaders(program_)) contents.miss.push_back({group++, recordData(miss.record)});
  for (const GeometryFacts& geometry : geometries) {
    const std::size_t h = hitGroupFor(program_, geometry);
    for (std::uint32_t r = 0; r < rayTypeCount(); ++r) {
      if (program_.hitGroups.empty()) {
        contents.hit.push_back({rt::SbtRecord::kUnusedGroup, {}});
        continue;
      }
      const auto& shaders = program_.hitGroups[h].shaders;
      const auto found = shaders.find(program_.rays[r].name);
      contents.hit.push_back({firstHitGroup_ + static_cast<std::uint32_t>(h) * rayTypeCount() + r,
                              recordData(found == shaders.end() ? RecordValues{} : found->second.record)});
    }
  }
  group = firstCallableGroup_;
  for (const Callable& callable : program_.callables)
    contents.callable.push_back({group++, recordData(callable.record)});
  return rt::ShaderBindingTable(context_, *pipeline_, contents, program_.name + " shader binding table");
}

}  // namespace quintet::program
