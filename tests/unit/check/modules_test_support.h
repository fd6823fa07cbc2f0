// SPDX-License-Identifier: Apache-2.0
// Raw SPIR-V modules of GLSL, without the optimizer, as applications have them.
#ifndef QUINTET_TESTS_UNIT_CHECK_MODULES_TEST_SUPPORT_H
#define QUINTET_TESTS_UNIT_CHECK_MODULES_TEST_SUPPORT_H

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/file.h"
#include "check/check.h"
#include "check/modules/stage_module.h"
#include "shader/compiler.h"

namespace quintet::check {

inline constexpr const char* kRayHead = R"(#version 460
#extension GL_EXT_ray_tracing : require
)";

// The lines of `text` start at 3. `name` becomes the file of lines. Each text is compiled once: variants of a pipeline differ in
// one of its stages.
inline std::vector<std::uint32_t> compileRaw(shader::Stage stage, const std::string& text, const std::string& name,
                                             bool lines = true) {
  static std::map<std::tuple<shader::Stage, std::string, std::string, bool>, std::vector<std::uint32_t>> known;
  const auto [found, isNew] = known.try_emplace({stage, text, name, lines});
  if (!isNew) return found->second;
  shader::CompilerOptions options;
  options.optimize = false;
  options.debugInfo = lines;
  const shader::Compiler compiler(options);
  shader::Source source;
  source.stage = stage;
  source.name = name;
  source.text = kRayHead + text;
  source.optimize = false;
  const shader::Result result = compiler.compile(source);
  for (const Diagnostic& d : result.diagnostics) ADD_FAILURE() << d.format();
  return found->second = result.spirv;
}

// A small pipeline: ray generation 'a.rgen', miss shaders, one hit group. Tests edit it.
struct RawPipeline {
  struct Stage {
    std::string name, text;
    shader::Stage kind;
  };
  std::vector<Stage> stages;
  PipelineGroups groups;
  bool lines = true;
  std::optional<shader::SpecializationValues> values = {};
  std::function<std::vector<std::uint32_t>(const std::vector<std::uint32_t>&)> rewrite =
      {};  // the module of each stage

  std::string& text(const std::string& name) {
    for (Stage& stage : stages)
      if (stage.name == name) return stage.text;
    ADD_FAILURE() << name;
    return stages.front().text;
  }

  std::vector<ModuleStage> modules() const {
    std::vector<ModuleStage> result;
    for (const Stage& stage : stages) {
      std::vector<std::uint32_t> words = compileRaw(stage.kind, stage.text, stage.name, lines);
      if (rewrite) words = rewrite(words);
      std::string why;
      const auto summary = summarize(words, why);
      EXPECT_TRUE(summary && summary->entryPoints.size() == 1) << why;
      if (summary && !summary->entryPoints.empty())
        result.push_back(stageModule(stage.name, words, summary->entryPoints.front(), values));
      EXPECT_EQ(result.back().problem, "");
    }
    return result;
  }

  // "Q101 a.rgen:7", sorted by id.
  std::vector<std::string> check() const {
    std::vector<std::string> result;
    for (const Diagnostic& d : diagnostics()) result.push_back(d.id + " " + locationText(d.file, d.line, 0));
    return result;
  }
  std::vector<Diagnostic> diagnostics() const { return checkModules(groups, modules(), {}).diagnostics; }
};

inline RawPipeline cleanPipeline() {
  RawPipeline p;
  p.stages = {{"a.rgen",
               R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba8) uniform image2D result;
layout(location = 0) rayPayloadEXT vec4 color;
void main() {
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);
  imageStore(result, ivec2(gl_LaunchIDEXT.xy), color);
}
)",
               shader::Stage::rayGeneration},
              {"a.rmiss", "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color = vec4(0.5); }\n",
               shader::Stage::miss},
              {"a.rchit",
               "layout(location = 0) rayPayloadInEXT vec4 color;\nhitAttributeEXT vec2 b;\n"
               "void main() { color = vec4(b, 0, 1); }\n",
               shader::Stage::closestHit}};
  p.groups.noun = "pipeline";
  p.groups.rays = {""};
  p.groups.hitRecords = HitRecords::byRecord;
  p.groups.rayGenerations = {"a.rgen"};
  p.groups.misses = {{{}, "a.rmiss", {}, 0}};
  program::HitGroup group;
  group.name = "0";
  group.shaders[""].closestHit = "a.rchit";
  p.groups.hitGroups = {group};
  p.groups.declaredRecursion = 1;
  return p;
}

}  // namespace quintet::check
#endif
