// SPDX-License-Identifier: Apache-2.0
#include "program/linked/linked_program.h"

#include <algorithm>
#include <cassert>

#include "base/stopwatch.h"
#include "program/hit_group_binding.h"
#include "program/linked/device_stages.h"

namespace quintet::program {
LinkedProgram::LinkedProgram(gpu::Context& context, const gpu::BindlessSet& set, const Program& program,
                             const CompiledProgram& compiled, std::uint32_t recursionDepth,
                             const gpu::PipelineCache* cache, bool captureStatistics)
    : context_(context), program_(program), recursionDepth_(recursionDepth) {
  assert(compiled.ok);
  const Stopwatch clock;
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
                                .intersection = stages.index(shaders.intersection),
                                .name = "hit " + group.name + ", " + ray.name});
    }
  }
  firstCallableGroup_ = groupCount();
  for (const Callable& callable : program.callables)
    options.groups.push_back({.general = stages.index(callable.file), .name = "callable " + callable.file});

  options.stages = stages.stages();
  pipeline_ = std::make_unique<rt::Pipeline>(context, set, options, cache);
  pipelineSeconds_ = clock.seconds();
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
