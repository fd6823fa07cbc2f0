// SPDX-License-Identifier: Apache-2.0
// Pipelines with many hit groups: equal traces and stages are followed once. The oracle is the check that follows each one.
#include <gmock/gmock.h>

#include <iostream>
#include <optional>
#include <random>

#include "modules_test_support.h"

namespace quintet::check {
namespace {

using shader::Stage;
using testing::HasSubstr;
using testing::IsEmpty;

void substitute(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, text.npos) << from;
  text.replace(at, from.size(), to);
}

// The pipeline with many hit groups, each with a closest-hit shader of its own that traces.
PipelineGroups withHitGroups(std::size_t count, std::vector<ModuleStage>& modules, PipelineGroups groups) {
  groups.tablesKnown = false;
  groups.hitGroups.clear();
  const ModuleStage hit = modules.back();
  modules.pop_back();
  for (std::size_t i = 0; i < count; ++i) {
    modules.push_back(hit);
    modules.back().name = "hit " + std::to_string(i);
    program::HitGroup group;
    group.name = std::to_string(i);
    group.shaders[""].closestHit = modules.back().name;
    groups.hitGroups.push_back(group);
  }
  return groups;
}

RawPipeline shadowPipeline() {
  RawPipeline p = cleanPipeline();
  p.groups.declaredRecursion = 2;
  p.text("a.rchit") = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadInEXT vec4 color;
layout(location = 1) rayPayloadEXT vec4 shadow;
hitAttributeEXT vec2 b;
void main() {
  shadow = vec4(0);
  vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  traceRayEXT(tlas, gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, 0, 1, 0, p, 0.01, vec3(0, 1, 0), 100.0, 1);
  color = vec4(b, 0, 1) * shadow;
}
)";
  return p;
}

// Each shader of many can be the one that a ray hits, and a mistake of one of them is found.
TEST(ManyHitGroups, AreFollowed) {
  const RawPipeline p = shadowPipeline();
  std::vector<ModuleStage> modules = p.modules();
  const PipelineGroups groups = withHitGroups(60, modules, p.groups);
  EXPECT_THAT(checkModules(groups, modules, {}).diagnostics, IsEmpty());
  RawPipeline wrong = shadowPipeline();
  substitute(wrong.text("a.rchit"), "rayPayloadInEXT vec4 color", "rayPayloadInEXT vec3 color");
  substitute(wrong.text("a.rchit"), "vec4(b, 0, 1) * shadow", "vec3(b, 0) * shadow.x");
  modules[40].spirv = wrong.modules().back().spirv;
  const std::vector<Diagnostic> found = checkModules(groups, modules, {}).diagnostics;
  EXPECT_THAT(found, IsEmpty());  // the table need not have it
  PipelineGroups known = groups;
  known.tablesKnown = true;
  const std::vector<Diagnostic> certain = checkModules(known, modules, {}).diagnostics;
  ASSERT_THAT(certain, testing::SizeIs(1));
  EXPECT_EQ(certain[0].id, "Q101");
  EXPECT_THAT(certain[0].text, HasSubstr("hit 38"));
}

// ---- Random pipelines

// Shaders that do different things with payloads. `BODY` has a payload { vec3 color; float t; vec3 normal; }.
struct Variant {
  Stage kind;
  std::string body;
};

const std::string kPayload = "struct Payload { vec3 color; float t; vec3 normal; };\n";
const std::string kTlas = "layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;\n";
const std::string kIncoming = kPayload + "layout(location = 0) rayPayloadInEXT Payload p;\n";

std::vector<Variant> variants() {
  const auto stage = [](const std::string& head, const std::string& body) {
    return head + "void main() {\n" + body + "}\n";
  };
  const std::string image = "layout(set = 0, binding = 1, rgba8) uniform image2D result;\n";
  const std::string outgoing = kPayload + "layout(location = 0) rayPayloadEXT Payload p;\n";
  const std::string shadow = "layout(location = 1) rayPayloadEXT float visible;\n";
  const std::string store = "imageStore(result, ivec2(gl_LaunchIDEXT.xy), vec4(";
  const std::string primary =
      "traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);\n";
  const std::string second =
      "traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 1, 1, 1, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);\n";
  const std::string visibility =
      "visible = 0.0;\n"
      "traceRayEXT(tlas, gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, 0, 1, 1, p.normal, 0.0, vec3(0, 1, 0), 9.0, 1);\n";
  const std::string firstHit =
      "traceRayEXT(tlas, gl_RayFlagsTerminateOnFirstHitEXT, 0xFF, 0, 1, 0, vec3(0), 0.001, vec3(0, 0, 2), 100.0, 0);\n";
  const std::string nested = kIncoming + kTlas + "layout(location = 1) rayPayloadEXT Payload inner;\n";
  const std::string trace =
      "traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(1), 0.001, vec3(0, 1, 0), 100.0, 1);\n";
  const std::string own =
      "traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(1), 0.001, vec3(0, 1, 0), 100.0, 0);\n";
  return {
      {Stage::rayGeneration, stage(outgoing + kTlas + image, primary + store + "p.color, p.t));\n")},
      {Stage::rayGeneration,
       stage(outgoing + kTlas + image, "p.t = 1.0;\n" + primary + store + "p.color * p.normal, 1));\n")},
      {Stage::rayGeneration,
       stage(outgoing + shadow + kTlas + image,
             primary + "if (p.t > 0.0) {\n" + visibility + "p.color *= visible;\n}\n" + store + "p.color, p.t));\n")},
      {Stage::rayGeneration,
       stage(outgoing + kTlas + image, "for (int i = 0; i < 3; ++i) {\n" + second + store + "p.color, p.t));\n}\n")},
      {Stage::rayGeneration, stage(outgoing + kTlas + image, firstHit + store + "p.color, 1));\n")},
      {Stage::miss, stage(kIncoming, "p = Payload(vec3(0.5), -1.0, vec3(0));\n")},
      {Stage::miss, stage(kIncoming, "p.color = vec3(0.5);\n")},
      {Stage::miss, stage(kIncoming, "p.color = gl_WorldRayDirectionEXT; p.t = gl_RayTmaxEXT; p.normal = vec3(0);\n")},
      {Stage::miss, stage("layout(location = 1) rayPayloadInEXT float visible;\n", "visible = 1.0;\n")},
      {Stage::closestHit,
       stage(kIncoming, "p = Payload(vec3(gl_PrimitiveID), gl_HitTEXT, gl_WorldRayDirectionEXT);\n")},
      {Stage::closestHit, stage(kIncoming, "p = Payload(vec3(0.5), gl_HitTEXT, vec3(gl_InstanceID));\n")},
      {Stage::closestHit, stage(kIncoming, "p.t = gl_HitTEXT; if (gl_PrimitiveID > 7) p.color = vec3(1);\n")},
      {Stage::closestHit, stage(kIncoming, "p.t = gl_HitTEXT; p.normal = vec3(gl_PrimitiveID);\n")},
      {Stage::closestHit, stage(kIncoming, "p.color = p.color * 0.5; p.t = gl_HitTEXT; p.normal = vec3(0);\n")},
      {Stage::closestHit, stage("", "")},
      {Stage::closestHit,
       stage("layout(location = 0) rayPayloadInEXT vec4 p;\n", "p = vec4(gl_WorldRayOriginEXT, gl_HitTEXT);\n")},
      {Stage::closestHit, stage(nested, "inner.color = vec3(0);\n" + trace + "p = inner; p.t = gl_HitTEXT;\n")},
      {Stage::closestHit, stage(nested, trace + "p.color = inner.color; p.t = inner.t; p.normal = inner.normal;\n")},
      {Stage::closestHit, stage(kIncoming + kTlas, "p.color = vec3(gl_PrimitiveID); p.t = 1.0;\n" + own +
                                                       "p.color += vec3(1); p.normal = vec3(0);\n")},
      {Stage::closestHit, stage(kIncoming,
                                "p = Payload(gl_WorldRayOriginEXT + gl_HitTEXT * normalize(gl_WorldRayDirectionEXT), "
                                "gl_HitTEXT, vec3(1));\n")},
      {Stage::closestHit, stage(kPayload + "layout(location = 0) rayPayloadEXT Payload p;\n", "p.t = 1.0;\n")},
      {Stage::anyHit, stage(kIncoming, "if (gl_PrimitiveID % 2 == 0) ignoreIntersectionEXT;\n")},
      {Stage::anyHit, stage(kIncoming, "p.color = vec3(gl_PrimitiveID);\n")},
      {Stage::anyHit, stage(kIncoming, "if (p.t > 3.0) terminateRayEXT;\n")},
      {Stage::anyHit, stage("", "ignoreIntersectionEXT;\n")},
      {Stage::intersection, stage("", "reportIntersectionEXT(1.0, 0u);\n")},
  };
}

class RandomPipelines {
 public:
  RandomPipelines() {
    for (const Variant& variant : variants()) {
      const std::vector<std::uint32_t> words = compileRaw(variant.kind, variant.body, "shader");
      std::string why;
      const auto summary = summarize(words, why);
      modules_.push_back(stageModule("shader", words, summary.value().entryPoints.front(), {}));
      EXPECT_EQ(modules_.back().problem, "");
    }
  }

  struct Pipeline {
    PipelineGroups groups;
    std::vector<ModuleStage> modules;
  };

  // The variants of a correct ray generation and miss shader, and a hit group with an instance for each closest-hit and any-hit
  // shader.
  Pipeline withGroups(const std::vector<std::pair<std::size_t, std::optional<std::size_t>>>& groups) {
    Pipeline p;
    p.groups.noun = "pipeline";
    p.groups.rays = {""};
    p.groups.hitRecords = HitRecords::byRecord;
    p.groups.tablesKnown = true;
    p.groups.declaredRecursion = 1;
    p.groups.rayGenerations = {addVariant(p, 0)};
    p.groups.misses.push_back({{}, addVariant(p, 5), {}, 0});
    for (const auto& [closestHit, anyHit] : groups) {
      program::HitGroup group;
      group.name = std::to_string(p.groups.hitGroups.size());
      group.shaders[""].closestHit = addVariant(p, closestHit);
      if (anyHit) group.shaders[""].anyHit = addVariant(p, *anyHit);
      p.groups.hitGroups.push_back(std::move(group));
    }
    p.groups.geometries.resize(groups.size());
    p.groups.instances.emplace();
    for (std::uint32_t i = 0; i < groups.size(); ++i) {
      InstanceRecords instance;
      instance.facts.firstGeometry = i;
      instance.facts.geometryCount = 1;
      instance.recordOffset = i;
      p.groups.instances->push_back(instance);
    }
    return p;
  }

  Pipeline next() {
    Pipeline p;
    p.groups.noun = "pipeline";
    p.groups.rays = {""};
    p.groups.hitRecords = HitRecords::byRecord;
    p.groups.tablesKnown = number(2) == 0;
    p.groups.declaredRecursion = 1 + number(3);
    p.groups.rayGenerations = {add(p, Stage::rayGeneration)};
    if (number(4) == 0) p.groups.rayGenerations.push_back(add(p, Stage::rayGeneration));
    for (std::uint32_t i = 0, count = 1 + number(3); i < count; ++i)
      p.groups.misses.push_back({{}, add(p, Stage::miss), {}, 0});
    const std::uint32_t count = 1 + number(7);
    const bool anyHits = number(2) == 0, boxes = number(3) == 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      program::HitGroup group;
      group.name = std::to_string(i);
      program::HitShaders& shaders = group.shaders[""];
      if (number(8) != 0) shaders.closestHit = pick(p, Stage::closestHit);
      if (anyHits && number(2) == 0) shaders.anyHit = pick(p, Stage::anyHit);
      if (boxes && number(2) == 0) shaders.intersection = pick(p, Stage::intersection);
      p.groups.hitGroups.push_back(std::move(group));
    }
    if (p.groups.tablesKnown && number(3) != 0) addInstances(p, count);
    return p;
  }

 private:
  std::uint32_t number(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }

  // A stage of its own from a random module of the kind, or one that the pipeline has.
  std::string pick(Pipeline& p, Stage kind) {
    if (number(4) == 0)
      for (const ModuleStage& module : p.modules)
        if (module.kind == kind) return module.name;
    return add(p, kind);
  }

  std::string add(Pipeline& p, Stage kind) {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < modules_.size(); ++i)
      if (modules_[i].kind == kind) all.push_back(i);
    // Often the first one, which is correct, so that there are equal stages.
    return addVariant(p, number(2) == 0 ? all.front() : all[number(static_cast<std::uint32_t>(all.size()))]);
  }

  std::string addVariant(Pipeline& p, std::size_t i) {
    p.modules.push_back(modules_[i]);
    return p.modules.back().name = "stage " + std::to_string(p.modules.size()) + " of " + std::to_string(i);
  }

  void addInstances(Pipeline& p, std::uint32_t count) {
    p.groups.instances.emplace();
    for (std::uint32_t i = 0; i < 1 + number(3); ++i) {
      InstanceRecords instance;
      instance.facts.name = "instance " + std::to_string(i);
      instance.facts.firstGeometry = static_cast<std::uint32_t>(p.groups.geometries.size());
      instance.facts.geometryCount = 1 + number(3);
      instance.recordOffset = number(count + 1);
      for (std::uint32_t k = 0; k < instance.facts.geometryCount; ++k) p.groups.geometries.emplace_back();
      p.groups.instances->push_back(instance);
    }
  }

  std::vector<ModuleStage> modules_;
  std::mt19937 random_{18};
};

std::vector<std::string> textsOf(const CheckResult& result) {
  std::vector<std::string> texts;
  for (const Diagnostic& d : result.diagnostics) {
    texts.push_back(d.id + " " + d.file + ":" + std::to_string(d.line) + " " + d.text);
    for (const RelatedLocation& r : d.related)
      texts.push_back("  " + r.file + ":" + std::to_string(r.line) + " " + r.text);
  }
  texts.push_back("depth " + std::to_string(result.recursionDepth) + ", stack " + std::to_string(result.stackBytes));
  texts.insert(texts.end(), result.reached.begin(), result.reached.end());
  texts.insert(texts.end(), result.chain.begin(), result.chain.end());
  return texts;
}

// Merging equal traces and stages changes no diagnostic. The mistakes are of many kinds, or the test would show little.
TEST(ManyHitGroups, HaveTheDiagnosticsOfTheCheckThatFollowsEachStage) {
  RandomPipelines random;
  std::map<std::string, int> ids;
  for (int i = 0; i < 250; ++i) {
    const RandomPipelines::Pipeline p = random.next();
    const CheckResult merged = checkModules(p.groups, p.modules, {}, true);
    ASSERT_EQ(textsOf(merged), textsOf(checkModules(p.groups, p.modules, {}, false))) << "pipeline " << i;
    for (const Diagnostic& d : merged.diagnostics) ++ids[d.id];
  }
  for (const char* id :
       {"Q101", "Q103", "Q104", "Q107", "Q402", "Q502", "Q512", "Q515", "Q606", "Q609", "Q717", "Q719"})
    EXPECT_GT(ids[id], 0) << id;
}

// Equal closest-hit shaders, which leave the color to the any-hit shader that only one of the groups has.
TEST(ManyHitGroups, DifferByTheAnyHitShaderBefore) {
  RandomPipelines random;
  constexpr std::size_t kWithoutColor = 12, kWritesColor = 22;
  for (const bool first : {true, false}) {
    const std::optional<std::size_t> writer(kWritesColor);
    const RandomPipelines::Pipeline p = random.withGroups(
        {{kWithoutColor, first ? writer : std::nullopt}, {kWithoutColor, first ? std::nullopt : writer}});
    const CheckResult merged = checkModules(p.groups, p.modules, {}, true);
    EXPECT_EQ(textsOf(merged), textsOf(checkModules(p.groups, p.modules, {}, false)));
    EXPECT_THAT(textsOf(merged), testing::Contains(HasSubstr("Q104"))) << first;
  }
}

// ---- Costs

// What the closest-hit shaders trace.
RawPipeline recursivePipeline() {
  RawPipeline p = shadowPipeline();
  substitute(p.text("a.rchit"), "gl_RayFlagsSkipClosestHitShaderEXT", "gl_RayFlagsNoneEXT");
  return p;
}

TEST(ManyHitGroupsCost, DISABLED_PrintsTimes) {
  struct Case {
    std::string name;
    RawPipeline pipeline;
    bool known;
  };
  for (const Case& c : {Case{"shadow rays", shadowPipeline(), false}, Case{"recursion", recursivePipeline(), false},
                        Case{"recursion, known table", recursivePipeline(), true}}) {
    for (const std::size_t count : {1u, 250u, 500u, 1000u, 2000u, 4000u}) {
      std::vector<ModuleStage> modules = c.pipeline.modules();
      PipelineGroups groups = withHitGroups(count, modules, c.pipeline.groups);
      if (c.known) {
        groups.tablesKnown = true;
        groups.geometries.resize(count);
        groups.instances.emplace();
        for (std::uint32_t i = 0; i < count; ++i) {
          InstanceRecords instance;
          instance.facts.firstGeometry = i;
          instance.facts.geometryCount = 1;
          instance.recordOffset = i;
          groups.instances->push_back(instance);
        }
      }
      const CheckResult result = checkModules(groups, modules, {});
      std::cout << c.name << ", " << count << " hit groups: " << result.seconds << " s, " << result.diagnostics.size()
                << " diagnostics" << std::endl;
    }
  }
}

}  // namespace
}  // namespace quintet::check
