// SPDX-License-Identifier: Apache-2.0
// Raw SPIR-V modules: which rules run, locations with and without lines, records, and malformed modules.
#include <gmock/gmock.h>

#include <cstring>
#include <iostream>

#include "check/modules/stage_groups.h"
#include "modules_test_support.h"
#include "spirv/plain_lines.h"
#include "spirv/raw_instructions.h"
#include "spirv/shader_record.h"

namespace quintet::check {
namespace {

using shader::Stage;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, text.npos) << from;
  text.replace(at, from.size(), to);
}

InstanceRecords instanceOf(std::uint32_t offset, std::uint32_t first, std::uint32_t count) {
  InstanceRecords instance;
  instance.facts.name = "ball";
  instance.facts.firstGeometry = first;
  instance.facts.geometryCount = count;
  instance.recordOffset = offset;
  return instance;
}

TEST(ModuleCheck, AcceptsACleanPipeline) { EXPECT_THAT(cleanPipeline().check(), IsEmpty()); }

TEST(ModuleCheck, ReportsPayloadTypesAtTheLineOfTheTrace) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rmiss"), "vec4 color;", "vec3 color;");
  replace(p.text("a.rmiss"), "vec4(0.5)", "vec3(0.5)");
  EXPECT_THAT(p.check(), Contains("Q101 a.rgen:7"));
}

// A ray generation shader with a second trace, with records and a payload of its own.
std::string twoTraces(const std::string& flags) {
  return R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba8) uniform image2D result;
layout(location = 0) rayPayloadEXT vec4 color;
layout(location = 1) rayPayloadEXT float visible;
void main() {
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 2, 0, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);
  visible = 0.0;
  traceRayEXT(tlas, )" +
         flags +
         R"(, 0xFF, 1, 2, 1, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 1);
  imageStore(result, ivec2(gl_LaunchIDEXT.xy), color * visible);
}
)";
}

// A trace whose hits run no closest-hit shader has a payload of its own type. Which group it hits is unknown.
TEST(ModuleCheck, AcceptsPayloadsThatOnlyOneOfSeveralTracesShares) {
  RawPipeline p = cleanPipeline();
  p.text("a.rgen") = twoTraces("gl_RayFlagsTerminateOnFirstHitEXT");
  p.stages.push_back({"s.rmiss",
                      "layout(location = 1) rayPayloadInEXT float visible;\nvoid main() { visible = 1.0; }\n",
                      Stage::miss});
  p.groups.misses.push_back({{}, "s.rmiss", {}, 0});
  program::HitGroup empty;
  empty.shaders.try_emplace("");
  p.groups.hitGroups.push_back(empty);
  for (const bool known : {true, false}) {
    p.groups.tablesKnown = known;
    EXPECT_THAT(p.check(), IsEmpty()) << known;
  }
  replace(p.text("s.rmiss"), "float visible", "double visible");  // no trace sends it
  replace(p.text("s.rmiss"), "visible = 1.0", "visible = 1.0LF");
  for (const bool known : {true, false}) {
    p.groups.tablesKnown = known;
    EXPECT_THAT(p.check(), Contains("Q101 a.rgen:10")) << known;
  }
}

TEST(ModuleCheck, NamesTheIdIfThereAreNoLines) {
  RawPipeline p = cleanPipeline();
  p.lines = false;
  replace(p.text("a.rmiss"), "vec4 color;", "vec3 color;");
  replace(p.text("a.rmiss"), "vec4(0.5)", "vec3(0.5)");
  const std::vector<Diagnostic> found = p.diagnostics();
  ASSERT_THAT(found, testing::SizeIs(1));
  EXPECT_EQ(found[0].id + found[0].file, "Q101a.rgen");
  EXPECT_EQ(found[0].line, 0);
  EXPECT_THAT(found[0].text, AllOf(HasSubstr("SPIR-V id %"), HasSubstr("OpTraceRayKHR number 1")));
  EXPECT_THAT(found[0].text, testing::Not(HasSubstr("\x1f")));
}

TEST(ModuleCheck, DoesNotAssumeTheLibraryOfQuintet) {
  RawPipeline p = cleanPipeline();
  // A descriptor and push constants of its own, gl_InstanceID as an index, and structures with names of the library.
  p.text("a.rchit") = R"(layout(location = 0) rayPayloadInEXT vec4 color;
struct InstanceData { vec4 worldFromObject[3]; vec4 tint; };
layout(set = 3, binding = 9) buffer Instances { InstanceData at[]; } instances;
layout(push_constant) uniform Launch { uint firstSample; } launch;
void main() { color = instances.at[gl_InstanceID].tint * float(launch.firstSample); }
)";
  EXPECT_THAT(p.check(), IsEmpty());
}

TEST(ModuleCheck, ReportsMembersThatAShaderDoesNotWrite) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rmiss"), "color = vec4(0.5);", "color.x = 0.5;");
  EXPECT_THAT(p.check(), Contains("Q104 a.rgen:7"));
}

TEST(ModuleCheck, AcceptsMembersThatOneOfSeveralUnknownHitGroupsWrites) {
  RawPipeline p = cleanPipeline();
  p.stages.push_back({"b.rchit", "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color.x = 1.0; }\n",
                      Stage::closestHit});
  program::HitGroup other;
  other.shaders[""].closestHit = "b.rchit";
  p.groups.hitGroups.push_back(other);
  EXPECT_THAT(p.check(), IsEmpty());  // which of the two is hit is unknown
  p.groups.geometries.resize(1);
  p.groups.instances = {instanceOf(1, 0, 1)};
  EXPECT_THAT(p.check(), Contains("Q104 a.rgen:7"));  // the second one
}

TEST(ModuleCheck, ReportsIndicesBeyondTheTable) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rgen"), "0xFF, 0, 1, 0,", "0xFF, 0, 1, 1,");
  EXPECT_THAT(p.check(), ElementsAre("Q502 a.rgen:7"));
  p.groups.tablesKnown = false;  // the miss shader can be record 1
  EXPECT_THAT(p.check(), IsEmpty());
}

// ~0 is the usual mask of HLSL; other bits above the low 8 are a mistake.
TEST(ModuleCheck, AcceptsAMaskOfAllBits) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rgen"), "0xFF, 0, 1, 0,", "~0u, 0, 1, 0,");
  EXPECT_THAT(p.check(), IsEmpty());
  replace(p.text("a.rgen"), "~0u, 0, 1, 0,", "0x100u, 0, 1, 0,");
  EXPECT_THAT(p.check(), ElementsAre("Q505 a.rgen:7"));
}

// The types of HLSL and GLSL differ in structures around single values only.
TEST(ModuleCheck, AcceptsStructuresAroundSingleValues) {
  RawPipeline p = cleanPipeline();
  p.text("a.rmiss") =
      "struct P { vec4 color; };\nlayout(location = 0) rayPayloadInEXT P p;\nvoid main() { p.color = vec4(0.5); }\n";
  replace(p.text("a.rchit"), "hitAttributeEXT vec2 b;\n", "struct A { vec2 b; };\nhitAttributeEXT A a;\n");
  replace(p.text("a.rchit"), "vec4(b, 0, 1)", "vec4(a.b, 0, 1)");
  EXPECT_THAT(p.check(), IsEmpty());
  replace(p.text("a.rmiss"), "vec4 color;", "vec3 color;");
  replace(p.text("a.rmiss"), "vec4(0.5)", "vec3(0.5)");
  EXPECT_THAT(p.check(), Contains("Q101 a.rgen:7"));
  replace(p.text("a.rchit"), "struct A { vec2 b; };", "struct A { vec2 b; float c; };");
  EXPECT_THAT(p.check(), Contains("Q202 a.rchit:5"));
}

TEST(ModuleCheck, ReportsRecordsBeyondTheTable) {
  RawPipeline p = cleanPipeline();
  p.groups.geometries.resize(2);
  p.groups.instances = {instanceOf(0, 0, 1)};
  EXPECT_THAT(p.check(), IsEmpty());
  p.groups.instances = {instanceOf(0, 0, 2)};  // geometry 1 uses record 1
  EXPECT_THAT(p.check(), ElementsAre("Q515 a.rgen:7"));
}

// Two instances: custom index 0 with record 0, and `index` with `record`.
RawPipeline withCustomIndex(std::uint32_t index, std::uint32_t record) {
  RawPipeline p = cleanPipeline();
  p.text("a.rchit") = R"(layout(set = 0, binding = 2) uniform sampler2D textures[4];
layout(location = 0) rayPayloadInEXT vec4 color;
hitAttributeEXT vec2 b;
void main() { color = textureLod(textures[gl_InstanceCustomIndexEXT], b, 0.0); }
)";
  p.stages.push_back({"b.rchit",
                      "layout(location = 0) rayPayloadInEXT vec4 color;\n"
                      "void main() { color = vec4(float(gl_InstanceCustomIndexEXT)); }\n",
                      Stage::closestHit});
  p.groups.hitGroups.push_back(p.groups.hitGroups[0]);
  p.groups.hitGroups[1].shaders[""].closestHit = "b.rchit";
  p.groups.geometries.resize(1);
  p.groups.instances = {instanceOf(0, 0, 1), instanceOf(record, 0, 1)};
  for (InstanceRecords& instance : *p.groups.instances) instance.hasCustomIndex = true;
  p.groups.instances->at(1).facts.customIndex = index;
  return p;
}

// What the check says besides the missing nonuniformEXT (Q704).
std::vector<std::string> ofIndices(const RawPipeline& p) {
  std::vector<std::string> reports = p.check();
  std::erase_if(reports, [](const std::string& report) { return report.starts_with("Q704"); });
  return reports;
}

TEST(ModuleCheck, ReportsCustomIndicesBeyondAnArray) {
  EXPECT_THAT(ofIndices(withCustomIndex(4, 0)), ElementsAre("Q711 a.rchit:6", "Q801 b.rchit:4"));
  EXPECT_THAT(ofIndices(withCustomIndex(3, 0)), ElementsAre("Q801 b.rchit:4"));
  EXPECT_THAT(ofIndices(withCustomIndex(4, 1)), IsEmpty());  // the other shader gets it
  const auto edited = [](auto edit) {
    RawPipeline p = withCustomIndex(4, 0);
    p.groups.hitGroups.resize(1);
    std::erase_if(p.stages, [](const auto& stage) { return stage.name == "b.rchit"; });
    edit(p);
    return ofIndices(p);
  };
  EXPECT_THAT(edited([](RawPipeline&) {}), ElementsAre("Q711 a.rchit:6"));
  // It is unknown, or no ray sees the instance, or a condition excludes the index.
  EXPECT_THAT(edited([](RawPipeline& p) { p.groups.instances->at(0).hasCustomIndex = false; }), IsEmpty());
  EXPECT_THAT(edited([](RawPipeline& p) { p.groups.tablesKnown = false; }), IsEmpty());
  EXPECT_THAT(edited([](RawPipeline& p) {
                p.groups.instances->at(1).facts.mask = 2;
                replace(p.text("a.rgen"), "0xFF, 0, 1, 0,", "0x01, 0, 1, 0,");
              }),
              IsEmpty());
  EXPECT_THAT(edited([](RawPipeline& p) {
                replace(p.text("a.rchit"), "color = textureLod(",
                        "color = vec4(0); if (gl_InstanceCustomIndexEXT < 4) color = textureLod(");
              }),
              IsEmpty());
  // A mask that is not constant may exclude it.
  EXPECT_THAT(edited([](RawPipeline& p) {
                replace(p.text("a.rgen"), "void main",
                        "layout(push_constant) uniform Push { uint mask; } push;\nvoid main");
                replace(p.text("a.rgen"), "0xFF, 0, 1, 0,", "push.mask, 0, 1, 0,");
              }),
              IsEmpty());
}

// The launch of a different application can have any size, and three dimensions.
TEST(ModuleCheck, LaunchesHaveThreeDimensions) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rgen"), "0xFF, 0, 1, 0,", "0xFF, 0, 1, gl_LaunchIDEXT.z,");
  replace(p.text("a.rgen"), "void main() {", "const float kWeights[4] = float[](1.0, 2.0, 2.0, 1.0);\nvoid main() {");
  replace(p.text("a.rgen"), ", color);", ", color * kWeights[gl_LaunchIDEXT.x]);");
  p.groups.misses.push_back({{}, "b.rmiss", {}, 0});
  p.stages.push_back({"b.rmiss", p.text("a.rmiss"), Stage::miss});
  EXPECT_THAT(p.check(), IsEmpty());
}

// What marks an index as one that differs within a subgroup, and what makes it equal there.
TEST(ModuleCheck, KnowsIndicesThatAreMarkedOrUniform) {
  RawPipeline p = cleanPipeline();
  p.text("a.rchit") = R"(#extension GL_EXT_nonuniform_qualifier : require
#extension GL_KHR_shader_subgroup_ballot : require
layout(set = 0, binding = 2) uniform texture2D textures[];
layout(set = 0, binding = 3) uniform sampler linear;
layout(location = 0) rayPayloadInEXT vec4 color;
hitAttributeEXT vec2 b;
void main() {
  uint index = gl_InstanceCustomIndexEXT;
  color = textureLod(sampler2D(textures[index], linear), b, 0.0);
}
)";
  EXPECT_THAT(p.check(), ElementsAre("Q704 a.rchit:11"));
  // As some compilers do: only the image that is sampled has the decoration.
  RawPipeline marked = p;
  replace(marked.text("a.rchit"), "textures[index]", "textures[nonuniformEXT(index)]");
  marked.rewrite = [](const std::vector<std::uint32_t>& words) {
    std::vector<std::uint32_t> result(words.begin(), words.begin() + 5);
    std::uint32_t image = 0;
    for (std::size_t at = 5; at < words.size(); at += words[at] >> 16)
      if (static_cast<spv::Op>(words[at] & 0xFFFFu) == spv::Op::OpSampledImage) image = words[at + 2];
    bool isMarked = false;
    for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
      std::vector<std::uint32_t> next(words.begin() + static_cast<std::ptrdiff_t>(at),
                                      words.begin() + static_cast<std::ptrdiff_t>(at + (words[at] >> 16)));
      if (static_cast<spv::Op>(next[0] & 0xFFFFu) == spv::Op::OpDecorate &&
          static_cast<spv::Decoration>(next[2]) == spv::Decoration::NonUniform) {
        next[1] = image;
        if (std::exchange(isMarked, true)) continue;
      }
      result.insert(result.end(), next.begin(), next.end());
    }
    return result;
  };
  EXPECT_THAT(marked.check(), IsEmpty());
  replace(p.text("a.rchit"), "index = gl_InstanceCustomIndexEXT",
          "index = subgroupBroadcastFirst(gl_InstanceCustomIndexEXT)");
  EXPECT_THAT(p.check(), IsEmpty());
}

// Specialization constants that choose what runs: shaders that a pipeline does not use are those of its other variants.
TEST(ModuleCheck, UnusedStagesOfVariantsAreNotReported) {
  RawPipeline p = cleanPipeline();
  p.text("a.rgen") = R"(layout(constant_id = 0) const bool kShadows = true;
layout(constant_id = 1) const uint kSamples = 2;
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba8) uniform image2D result;
layout(location = 0) rayPayloadEXT vec4 color;
layout(location = 1) rayPayloadEXT float lit;
void main() {
  vec4 sum = vec4(0);
  for (uint i = 0; i < kSamples; ++i) {
    traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(i), 0.001, vec3(0, 0, 1), 100.0, 0);
    lit = 0.5;
    if (kShadows) traceRayEXT(tlas, gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, 0, 1, 1, vec3(i), 0.001, vec3(1), 100.0, 1);
    sum += color * lit;
  }
  imageStore(result, ivec2(gl_LaunchIDEXT.xy), sum);
}
)";
  p.stages.push_back(
      {"b.rmiss", "layout(location = 1) rayPayloadInEXT float lit;\nvoid main() { lit = 1.0; }\n", Stage::miss});
  p.groups.misses.push_back({{}, "b.rmiss", {}, 0});
  EXPECT_THAT(p.check(), IsEmpty());
  p.values = shader::SpecializationValues{{0, {0u}}};
  EXPECT_THAT(p.check(), IsEmpty());
  replace(p.text("a.rgen"), "if (kShadows)", "bool traces = kShadows && lit < 1.0; if (traces)");
  EXPECT_THAT(p.check(), IsEmpty());
  // A constant that chooses nothing.
  replace(p.text("a.rgen"), "bool traces = kShadows && lit < 1.0; if (traces)", "if (false)");
  EXPECT_THAT(p.check(), ElementsAre("Q801 b.rmiss:4"));
}

// Two hit records of the same shader, each used by an instance: their data are an index and a kind.
RawPipeline withRecords(std::vector<std::uint32_t> first, std::vector<std::uint32_t> second) {
  RawPipeline p = cleanPipeline();
  p.text("a.rchit") = R"(#extension GL_EXT_nonuniform_qualifier : require
layout(set = 2, binding = 3) uniform sampler2D textures[];
layout(set = 2, binding = 4, std430) buffer Material { uint textured; vec4 tint; } materials[];
layout(shaderRecordEXT, std430) buffer Record { uint texture; uint kind; } record;
layout(location = 0) rayPayloadInEXT vec4 color;
hitAttributeEXT vec2 b;
void main() {
  color = textureLod(textures[record.texture], b, 0.0);
}
)";
  const auto bytesOf = [](const std::vector<std::uint32_t>& words) {
    const auto* from = reinterpret_cast<const std::byte*>(words.data());
    return RecordData(from, from + words.size() * sizeof(std::uint32_t));
  };
  p.groups.hitGroups.push_back(p.groups.hitGroups[0]);
  p.groups.recordData.hits = {bytesOf(first), bytesOf(second)};
  p.groups.descriptorCounts = {{{2, 3}, 4}, {{2, 4}, 2}};
  p.groups.geometries.resize(1);
  p.groups.instances = {instanceOf(0, 0, 1), instanceOf(1, 0, 1)};
  return p;
}

TEST(ModuleCheck, ReportsIndicesOfRecordsBeyondDescriptors) {
  const std::vector<Diagnostic> found = withRecords({3, 0}, {4, 0}).diagnostics();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].id, "Q711");
  EXPECT_EQ(found[0].line, 10);
  EXPECT_EQ(found[0].text, "the index of 'textures' is 4 (data of hit record 1), but it has 4 elements (index 0 to 3)");
  EXPECT_THAT(withRecords({3, 0}, {0, 0}).check(), IsEmpty());
  const auto edited = [](auto edit) {
    RawPipeline p = withRecords({3, 0}, {4, 0});
    edit(p);
    return p.check();
  };
  const auto main = [&](const std::string& text) {
    return edited([&](RawPipeline& p) {
      replace(p.text("a.rchit"), "color = textureLod(textures[record.texture], b, 0.0);", text);
    });
  };
  EXPECT_THAT(edited([](RawPipeline& p) { p.groups.descriptorCounts.clear(); }), IsEmpty());
  EXPECT_THAT(edited([](RawPipeline& p) { p.groups.recordData.hits.pop_back(); }), IsEmpty());
  EXPECT_THAT(edited([](RawPipeline& p) { p.groups.recordData.hits[1].resize(3); }), IsEmpty());
  EXPECT_THAT(edited([](RawPipeline& p) { p.groups.tablesKnown = false; }), IsEmpty());
  // No ray hits the instance of the record.
  EXPECT_THAT(edited([](RawPipeline& p) { p.groups.instances->pop_back(); }), IsEmpty());
  EXPECT_THAT(edited([](RawPipeline& p) {
                replace(p.text("a.rgen"), "0xFF, 0, 1", "1, 0, 1");
                p.groups.instances->at(1).facts.mask = 2;
              }),
              IsEmpty());
  // Conditions on the record, and on what a buffer says about the material.
  EXPECT_THAT(main("color = vec4(0); if (record.texture < 4) color = textureLod(textures[record.texture], b, 0.0);"),
              IsEmpty());
  EXPECT_THAT(main("color = vec4(0); if (record.kind != 0) color = textureLod(textures[record.texture], b, 0.0);"),
              IsEmpty());
  EXPECT_THAT(main("color = record.kind == 0 ? vec4(1) : textureLod(textures[record.texture], b, 0.0);"), IsEmpty());
  EXPECT_THAT(
      main("color = vec4(0); if (materials[record.kind].textured != 0) color = textureLod(textures[record.texture], b, "
           "0.0);"),
      IsEmpty());
  EXPECT_THAT(main("color = vec4(0); if (b.x > 0.5) color = textureLod(textures[record.texture], b, 0.0);"),
              ElementsAre("Q711 a.rchit:10"));
  // An array of buffers, through two chains.
  EXPECT_THAT(main("color = materials[record.texture - 2].tint;"), ElementsAre("Q711 a.rchit:10"));
  EXPECT_THAT(main("color = materials[record.kind].tint;"), IsEmpty());
}

TEST(ModuleCheck, ReportsConstantIndicesBeyondDescriptors) {
  RawPipeline p = withRecords({}, {});
  // Without an index that is not constant, glslang gives the array a size.
  replace(p.text("a.rchit"), "color = ", "color = textureLod(textures[4], b, 0.0) + ");
  EXPECT_THAT(p.check(), ElementsAre("Q711 a.rchit:10"));
  p.groups.descriptorCounts[{2, 3}] = 5;
  EXPECT_THAT(p.check(), IsEmpty());
}

TEST(ModuleCheck, ReadsTheDataOfMissRayGenerationAndCallableRecords) {
  const std::string head = R"(#extension GL_EXT_nonuniform_qualifier : require
layout(set = 0, binding = 3) uniform sampler2D textures[];
layout(shaderRecordEXT, std430) buffer Record { vec2 unused; int texture[2]; } record;
)";
  const std::vector<std::uint32_t> words{0, 0, 1, 9};
  const auto* from = reinterpret_cast<const std::byte*>(words.data());
  const RecordData data(from, from + 16);
  RawPipeline p = cleanPipeline();
  p.groups.descriptorCounts = {{{0, 3}, 4}};
  p.groups.recordData.misses = {data};
  p.text("a.rmiss") = head +
                      "layout(location = 0) rayPayloadInEXT vec4 color;\n"
                      "void main() { color = textureLod(textures[record.texture[1]], vec2(0.5), 0.0); }\n";
  EXPECT_THAT(p.check(), ElementsAre("Q711 a.rmiss:7"));
  replace(p.text("a.rmiss"), "texture[1]]", "texture[0]]");
  EXPECT_THAT(p.check(), IsEmpty());
  p.groups.recordData.rayGeneration["a.rgen"] = data;
  replace(p.text("a.rgen"), "layout(set = 0, binding = 0)", head + "layout(set = 0, binding = 0)");
  replace(p.text("a.rgen"), ", color);", ", color + textureLod(textures[record.texture[1]], vec2(0.5), 0.0));");
  EXPECT_THAT(p.check(), ElementsAre("Q711 a.rgen:11"));
}

// A loop of bounces: the closest-hit shader sets the throughput for the next ray, but nothing sets it for the first one.
TEST(ModuleCheck, ReportsMembersThatAreUnsetForTheFirstRay) {
  const std::string payload = "struct Payload { vec4 color; vec4 throughput; };\n";
  const auto pipeline = [&](const std::string& flags, const std::string& before) {
    RawPipeline p = cleanPipeline();
    p.text("a.rgen") =
        "layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;\n"
        "layout(set = 0, binding = 1, rgba8) uniform image2D result;\n" +
        payload + "layout(location = 0) rayPayloadEXT Payload p;\nvoid main() {\n  p.color = vec4(0);\n  " + before +
        "\n  for (int i = 0; i < 4; ++i) {\n    traceRayEXT(tlas, " + flags +
        ", 0xFF, 0, 1, 0, vec3(i), 0.001, vec3(0, 0, 1), 100.0, 0);\n  }\n"
        "  imageStore(result, ivec2(gl_LaunchIDEXT.xy), p.color);\n}\n";
    p.text("a.rmiss") = payload +
                        "layout(location = 0) rayPayloadInEXT Payload p;\n"
                        "void main() { p.color += p.throughput; }\n";
    p.text("a.rchit") = payload +
                        "layout(location = 0) rayPayloadInEXT Payload p;\nhitAttributeEXT vec2 b;\n"
                        "void main() { p.color += vec4(b, 0, 0); p.throughput = vec4(b, 0, 1); }\n";
    return p;
  };
  RawPipeline p = pipeline("gl_RayFlagsNoneEXT", "");
  EXPECT_THAT(p.check(), ElementsAre("Q107 a.rmiss:5"));
  EXPECT_THAT(p.diagnostics().front().text,
              HasSubstr("nothing sets it before the first ray of the trace at a.rgen:11"));
  EXPECT_THAT(pipeline("gl_RayFlagsNoneEXT", "p.throughput = vec4(1);").check(), IsEmpty());
  // A trace before the loop sets it, the flags of the first ray differ, or a condition tells the first ray from the others.
  const std::string first = "traceRayEXT(tlas, 0, 0xFF, 0, 1, 1, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);";
  RawPipeline twice = pipeline("gl_RayFlagsNoneEXT", first);
  twice.groups.misses.push_back({{}, "b.rmiss", {}, 0});
  twice.stages.push_back(
      {"b.rmiss",
       payload + "layout(location = 0) rayPayloadInEXT Payload p;\nvoid main() { p.throughput = vec4(1); }\n",
       Stage::miss});
  EXPECT_THAT(twice.check(), IsEmpty());
  EXPECT_THAT(pipeline("i == 0 ? gl_RayFlagsOpaqueEXT : gl_RayFlagsNoneEXT", "").check(), IsEmpty());
  replace(p.text("a.rmiss"), "{ p.color += p.throughput; }", "{ if (gl_RayTminEXT > 0.0) p.color += p.throughput; }");
  EXPECT_THAT(p.check(), IsEmpty());
  // The code after the trace sets it for the next ray.
  RawPipeline later = pipeline("gl_RayFlagsNoneEXT", "");
  replace(later.text("a.rgen"), "100.0, 0);\n", "100.0, 0);\n    p.throughput = vec4(0.5);\n");
  EXPECT_THAT(later.check(), ElementsAre("Q107 a.rmiss:5"));
  replace(later.text("a.rgen"), "    traceRayEXT", "    p.throughput = vec4(1);\n    traceRayEXT");
  EXPECT_THAT(later.check(), IsEmpty());
}

// Reflections with a depth in the payload: the ray generation shader and the closest-hit shader must both set it.
TEST(ModuleCheck, ReportsMembersThatOneOfTwoTracingStagesLeavesUnset) {
  const std::string head =
      "layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;\n"
      "struct Payload { vec4 color; uint depth; };\n";
  RawPipeline p = cleanPipeline();
  p.groups.declaredRecursion = 4;
  p.text("a.rgen") = head +
                     "layout(set = 0, binding = 1, rgba8) uniform image2D result;\n"
                     "layout(location = 0) rayPayloadEXT Payload p;\nvoid main() {\n  p.depth = 0u;\n"
                     "  traceRayEXT(tlas, 0, 0xFF, 0, 1, 0, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);\n"
                     "  imageStore(result, ivec2(gl_LaunchIDEXT.xy), p.color);\n}\n";
  p.text("a.rmiss") = head +
                      "layout(location = 0) rayPayloadInEXT Payload p;\n"
                      "void main() { p.color = vec4(0.5); }\n";
  p.text("a.rchit") = head +
                      "layout(location = 0) rayPayloadInEXT Payload p;\n"
                      "layout(location = 1) rayPayloadEXT Payload inner;\nvoid main() {\n  p.color = vec4(0.1);\n"
                      "  if (p.depth >= 3u) return;\n  inner.depth = p.depth + 1u;\n"
                      "  traceRayEXT(tlas, 0, 0xFF, 0, 1, 0, vec3(1), 0.001, vec3(0, 1, 0), 100.0, 1);\n"
                      "  p.color += inner.color;\n}\n";
  EXPECT_THAT(p.check(), IsEmpty());
  RawPipeline start = p;
  replace(start.text("a.rgen"), "p.depth = 0u;", "");
  EXPECT_THAT(start.check(), ElementsAre("Q107 a.rchit:9"));
  EXPECT_THAT(start.diagnostics().front().text, HasSubstr("before the trace at a.rgen:9"));
  replace(start.text("a.rgen"), "0xFF", "0x0F");  // these rays could hit other instances only
  EXPECT_THAT(start.check(), IsEmpty());
  replace(p.text("a.rchit"), "inner.depth = p.depth + 1u;", "");
  EXPECT_THAT(p.check(), ElementsAre("Q107 a.rchit:9"));
  EXPECT_THAT(p.diagnostics().front().text, HasSubstr("before the trace at a.rchit:11"));
}

TEST(ModuleCheck, ReportsGeometryOfADifferentKind) {
  RawPipeline p = cleanPipeline();
  p.groups.geometries.resize(1);
  p.groups.geometries[0].kind = program::GeometryKind::custom;
  p.groups.instances = {instanceOf(0, 0, 1)};
  EXPECT_THAT(p.check(), ElementsAre("Q609 a.rgen:7"));
}

TEST(ModuleCheck, ReportsAnyHitShadersThatFlagsExclude) {
  RawPipeline p = cleanPipeline();
  p.stages.push_back({"a.rahit", "void main() { ignoreIntersectionEXT; }\n", Stage::anyHit});
  p.groups.hitGroups[0].shaders[""].anyHit = "a.rahit";
  replace(p.text("a.rgen"), "gl_RayFlagsNoneEXT", "gl_RayFlagsOpaqueEXT");
  EXPECT_THAT(p.check(), ElementsAre(testing::StartsWith("Q610 a.rahit")));
}

TEST(ModuleCheck, ReportsRecursionBeyondTheDeclaredDepth) {
  RawPipeline p = cleanPipeline();
  p.text("a.rchit") = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadInEXT vec4 color;
layout(location = 1) rayPayloadEXT vec4 inner;
void main() {
  inner = vec4(0);
  traceRayEXT(tlas, gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, 0, 1, 0, vec3(1), 0.001, vec3(0, 0, 1), 100.0, 1);
  color = inner;
}
)";
  EXPECT_THAT(p.check(), Contains("Q402 a.rchit:8"));
  p.groups.declaredRecursion = 2;
  EXPECT_THAT(p.check(), IsEmpty());
  p.groups.declaredRecursion.reset();  // the description does not say it
  EXPECT_THAT(p.check(), IsEmpty());
}

TEST(ModuleCheck, AppliesSpecializationConstants) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rgen"), "void main() {", "layout(constant_id = 3) const uint kMiss = 0u;\nvoid main() {");
  replace(p.text("a.rgen"), "0xFF, 0, 1, 0,", "0xFF, 0, 1, kMiss,");
  EXPECT_THAT(p.check(), IsEmpty());  // unknown
  p.values.emplace();
  EXPECT_THAT(p.check(), IsEmpty());  // the default
  (*p.values)[3] = {1};
  EXPECT_THAT(p.check(), ElementsAre("Q502 a.rgen:8"));
}

// The length of an array in a payload: a constant here, a number there.
TEST(ModuleCheck, AcceptsLengthsThatSpecializationConstantsDecide) {
  RawPipeline p = cleanPipeline();
  for (const char* stage : {"a.rmiss", "a.rchit"}) replace(p.text(stage), "vec4 color;", "vec4 color[4];");
  replace(p.text("a.rmiss"), "color = vec4(0.5)", "color[0] = vec4(0.5)");
  replace(p.text("a.rchit"), "color = vec4", "color[0] = vec4");
  p.text("a.rgen") = "layout(constant_id = 0) const int kCount = 4;\n" + p.text("a.rgen");
  replace(p.text("a.rgen"), "vec4 color;", "vec4 color[kCount];");
  replace(p.text("a.rgen"), "gl_LaunchIDEXT.xy), color", "gl_LaunchIDEXT.xy), color[0]");
  EXPECT_THAT(p.check(), IsEmpty());  // unknown
  p.values.emplace();
  EXPECT_THAT(p.check(), IsEmpty());  // the default
  (*p.values)[0] = {5};
  EXPECT_THAT(p.check(), ElementsAre("Q101 a.rgen:8", "Q101 a.rgen:8"));
}

// A loop of bounces in a loop of samples: the position is read only after a hit, or after the loop of samples has set it.
TEST(ModuleCheck, AcceptsMembersThatALoopAroundSets) {
  RawPipeline p = cleanPipeline();
  const std::string payload = "struct Payload { vec3 origin; float light; int done; };\n";
  p.text("a.rgen") = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba8) uniform image2D result;
)" + payload + R"(layout(location = 0) rayPayloadEXT Payload p;
layout(push_constant) uniform Push { int samples, bounces; } push;
void main() {
  float sum = 0.0;
  for (int i = 0; i < push.samples; ++i) {
    p.origin = vec3(0);
    p.done = 1;
    for (int bounce = 0; bounce < push.bounces; ++bounce) {
      traceRayEXT(tlas, gl_RayFlagsOpaqueEXT, 0xFF, 0, 0, 0, p.origin, 0.001, vec3(0, 0, 1), 1e4, 0);
      sum += p.light;
      if (p.done == 1) break;
      p.done = 1;
    }
  }
  imageStore(result, ivec2(gl_LaunchIDEXT.xy), vec4(sum));
}
)";
  const std::string received = payload + "layout(location = 0) rayPayloadInEXT Payload p;\nvoid main() { ";
  p.text("a.rmiss") = received + "p.light = 1.0; }\n";
  p.text("a.rchit") = received + "p.light = 0.5; p.origin = vec3(0, 0, gl_HitTEXT); p.done = 0; }\n";
  EXPECT_THAT(p.check(), IsEmpty());
  replace(p.text("a.rgen"), "if (p.done == 1) break;", "");
  EXPECT_THAT(p.check(), ElementsAre("Q104 a.rgen:14"));
}

TEST(ModuleCheck, FindsGroupsOfStagesAlone) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rmiss"), "vec4 color;", "vec3 color;");
  replace(p.text("a.rmiss"), "vec4(0.5)", "vec3(0.5)");
  const std::vector<ModuleStage> modules = p.modules();
  const PipelineGroups groups = groupsOfStages(modules);
  EXPECT_FALSE(groups.tablesKnown);
  const CheckResult result = checkModules(groups, modules, {});
  ASSERT_THAT(result.diagnostics, testing::SizeIs(1));
  EXPECT_EQ(result.diagnostics[0].id, "Q101");
  EXPECT_THAT(result.chain, ElementsAre("a.rgen", testing::_));
}

// Without groups, each of two miss shaders can be the one of each trace. The one that fits to no trace is the mistake.
TEST(ModuleCheck, NamesTheStageThatFitsToNothing) {
  RawPipeline p = cleanPipeline();
  p.text("a.rgen") = twoTraces("gl_RayFlagsNoneEXT");
  p.stages.push_back({"s.rmiss",
                      "layout(location = 1) rayPayloadInEXT float visible;\nvoid main() { visible = 1.0; }\n",
                      Stage::miss});
  const auto found = [&] {
    const std::vector<ModuleStage> modules = p.modules();
    std::vector<std::string> texts;
    for (const Diagnostic& d : checkModules(groupsOfStages(modules), modules, {}).diagnostics)
      if (d.id == "Q101") texts.push_back(d.text);
    return texts;
  };
  EXPECT_THAT(found(), IsEmpty());
  replace(p.text("s.rmiss"), "float visible", "vec2 visible");
  replace(p.text("s.rmiss"), "= 1.0", "= vec2(1.0)");
  EXPECT_THAT(found(), ElementsAre(AllOf(HasSubstr("is float"), HasSubstr("s.rmiss"), HasSubstr("vec2"))));
}

// A member that a miss leaves, in a condition that the miss decides.
TEST(ModuleCheck, AcceptsMembersBehindLogicalOperators) {
  RawPipeline p = cleanPipeline();
  const std::string head =
      "layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;\n"
      "layout(set = 0, binding = 1, rgba8) uniform image2D result;\n"
      "layout(location = 0) rayPayloadEXT vec4 color;\nvoid main() {\n"
      "  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);\n";
  const auto stored = [&](const std::string& condition) {
    return head + "  imageStore(result, ivec2(gl_LaunchIDEXT.xy), vec4(" + condition + " ? 1.0 : 0.0));\n}\n";
  };
  p.text("a.rmiss") = "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color.w = -1.0; }\n";
  for (const char* condition : {"color.w < 0.0 || color.x > 0.5", "color.w > 0.0 && color.x > 0.5"}) {
    p.text("a.rgen") = stored(condition);
    EXPECT_THAT(p.check(), IsEmpty()) << condition;
  }
  for (const char* condition : {"gl_LaunchIDEXT.x > 5u || color.x > 0.5", "color.x > 0.2 && color.x < 0.5"}) {
    p.text("a.rgen") = stored(condition);
    EXPECT_THAT(p.check(), ElementsAre("Q104 a.rgen:7")) << condition;
  }
}

// Without groups: an any-hit shader of shadow rays is in a different hit group than the closest-hit shader, a trace with a
// different record can run no shader, and a miss shader can receive nothing.
TEST(ModuleCheck, DoesNotAssumeTheGroupsOfStagesAlone) {
  RawPipeline p = cleanPipeline();
  p.text("a.rgen") = twoTraces("gl_RayFlagsNoneEXT");
  replace(p.text("a.rgen"), "visible = 0.0", "visible = 1.0");
  const auto found = [&] {
    const std::vector<ModuleStage> modules = p.modules();
    std::vector<std::string> ids;
    for (const Diagnostic& d : checkModules(groupsOfStages(modules), modules, {}).diagnostics) ids.push_back(d.id);
    return ids;
  };
  EXPECT_THAT(found(), IsEmpty());  // records 1 without shaders
  p.stages.push_back({"s.rmiss", "void main() {}\n", Stage::miss});
  p.stages.push_back({"s.rahit",
                      "layout(location = 1) rayPayloadInEXT float visible;\nhitAttributeEXT vec2 b;\n"
                      "void main() { if (b.x > 0.5) ignoreIntersectionEXT; visible *= 0.5; }\n",
                      Stage::anyHit});
  EXPECT_THAT(found(), IsEmpty());
  replace(p.text("a.rgen"), "gl_RayFlagsNoneEXT, 0xFF, 1",
          "gl_RayFlagsOpaqueEXT, 0xFF, 1");  // excludes the any-hit shader
  EXPECT_THAT(found(), IsEmpty());
  replace(p.text("s.rahit"), "float visible", "vec3 visible");  // no trace sends it
  EXPECT_THAT(found(), Contains("Q101"));
}

// Ids and texts of the diagnostics if only the stages are known.
std::vector<std::string> foundWithoutGroups(const RawPipeline& p) {
  const std::vector<ModuleStage> modules = p.modules();
  std::vector<std::string> texts;
  for (const Diagnostic& d : checkModules(groupsOfStages(modules), modules, {}).diagnostics)
    texts.push_back(d.id + " " + d.text);
  return texts;
}

// Without groups, a miss or callable shader can be unused if there are more than the indices of traces and calls name.
TEST(ModuleCheck, AcceptsShadersThatNothingRunsWithoutGroups) {
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rgen"), "void main() {",
          "layout(location = 0) callableDataEXT vec4 shade;\nvoid main() {\n  shade = vec4(1);\n"
          "  executeCallableEXT(0u, 0);");
  replace(p.text("a.rgen"), ", color);", ", color * shade);");
  const auto add = [&](const std::string& name, const std::string& text, Stage kind) {
    p.stages.push_back({name, text, kind});
  };
  add("c.rcall", "layout(location = 0) callableDataInEXT vec4 shade;\nvoid main() { shade *= 0.5; }\n",
      Stage::callable);
  add("d.rcall", "layout(location = 0) callableDataInEXT float other;\nvoid main() { other = 1.0; }\n",
      Stage::callable);
  add("s.rmiss", "layout(location = 0) rayPayloadInEXT float other;\nvoid main() { other = 1.0; }\n", Stage::miss);
  EXPECT_THAT(foundWithoutGroups(p), IsEmpty());
  replace(p.text("a.rgen"), "executeCallableEXT(0u, 0)", "executeCallableEXT(gl_LaunchIDEXT.x & 1u, 0)");
  EXPECT_THAT(foundWithoutGroups(p), ElementsAre(AllOf(HasSubstr("Q301"), HasSubstr("d.rcall"))));
  replace(p.text("a.rgen"), "executeCallableEXT(gl_LaunchIDEXT.x & 1u, 0)", "executeCallableEXT(0u, 0)");
  replace(p.text("c.rcall"), "vec4 shade", "vec3 shade");  // now the call matches neither
  EXPECT_THAT(foundWithoutGroups(p), Contains(AllOf(HasSubstr("Q301"), HasSubstr("c.rcall"))));
}

// In a loop, the call itself comes before its next one. It sets only what its shaders write.
TEST(ModuleCheck, ReportsCallableDataThatALoopLeavesUnset) {
  const std::string data = "struct Data { vec4 normal; vec4 color; };\n";
  RawPipeline p = cleanPipeline();
  replace(p.text("a.rgen"), "void main() {",
          data +
              "layout(location = 0) callableDataEXT Data d;\nvoid main() {\n  vec4 sum = vec4(0);\n"
              "  for (uint i = 0u; i < gl_LaunchSizeEXT.z; ++i) {\n    d.normal = sum;\n"
              "    executeCallableEXT(0u, 0);\n    sum += d.color;\n  }");
  replace(p.text("a.rgen"), ", color);", ", color + sum);");
  p.stages.push_back({"c.rcall",
                      data + "layout(location = 0) callableDataInEXT Data d;\nvoid main() { d.color = d.normal; }\n",
                      Stage::callable});
  EXPECT_THAT(foundWithoutGroups(p), IsEmpty());
  replace(p.text("a.rgen"), "d.normal = sum;", "");
  EXPECT_THAT(foundWithoutGroups(p),
              ElementsAre(AllOf(HasSubstr("Q304"), HasSubstr("'d.normal'"), HasSubstr("not set before"))));
}

// A constant point is an origin only if a trace starts there.
TEST(ModuleCheck, AcceptsOffsetsOfPositionsFromAConstantOrigin) {
  RawPipeline p = cleanPipeline();
  const auto shadowFrom = [&](const std::string& origin) {
    p.text("a.rgen") = R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba8) uniform image2D result;
layout(location = 0) rayPayloadEXT vec4 color;
void main() {
  vec3 d = normalize(vec3(gl_LaunchIDEXT.xy, 100.0));
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(0), 0.001, d, 100.0, 0);
  vec3 p = )" + origin +
                       R"( + color.w * d;
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, p, 0.0, vec3(0, 1, 0), 100.0, 0);
  imageStore(result, ivec2(gl_LaunchIDEXT.xy), color);
}
)";
    return p.check();
  };
  EXPECT_THAT(shadowFrom("vec3(0, 0.01, 0)"), IsEmpty());
  EXPECT_THAT(shadowFrom("vec3(gl_LaunchIDEXT)"), ElementsAre("Q705 a.rgen:10"));
}

TEST(ModuleCheck, KeepsOneOfSeveralEntryPoints) {
  // A second entry point with a function of its own, as in libraries of HLSL.
  const std::vector<std::uint32_t> words = compileRaw(Stage::miss, cleanPipeline().text("a.rmiss"), "a.rmiss");
  std::vector<std::uint32_t> twice(words.begin(), words.begin() + 5);
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    const std::size_t count = words[at] >> 16;
    const std::size_t copies = (words[at] & 0xFFFFu) == static_cast<std::uint32_t>(spv::Op::OpEntryPoint) ? 2 : 1;
    for (std::size_t k = 0; k < copies; ++k) {
      twice.insert(twice.end(), words.begin() + static_cast<std::ptrdiff_t>(at),
                   words.begin() + static_cast<std::ptrdiff_t>(at + count));
      if (k == 1) twice[twice.size() - count + 3] = 0x00626173;  // "sab"
    }
  }
  std::string why;
  const auto summary = summarize(twice, why);
  ASSERT_TRUE(summary) << why;
  ASSERT_EQ(summary->entryPoints.size(), 2u);
  EXPECT_EQ(summary->entryPoints[0].name, "main");
  const auto one = spirv::withEntryPoint(twice, summary->entryPoints[0]);
  const auto left = summarize(one, why);
  ASSERT_TRUE(left);
  ASSERT_EQ(left->entryPoints.size(), 1u);
  EXPECT_EQ(left->entryPoints[0].name, "main");
}

TEST(ModuleCheck, ReportsWhatCannotBeAnalyzedAsAProblem) {
  std::vector<std::uint32_t> words = compileRaw(Stage::miss, cleanPipeline().text("a.rmiss"), "a.rmiss");
  std::string why;
  const auto summary = summarize(words, why);
  ASSERT_TRUE(summary);
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16)
    if ((words[at] & 0xFFFFu) == static_cast<std::uint32_t>(spv::Op::OpCapability)) words[at + 1] = 65000;
  const ModuleStage stage = stageModule("a.rmiss", words, summary->entryPoints.front(), {});
  EXPECT_THAT(stage.problem, HasSubstr("requires one of these capabilities"));  // unknown ones are removed
  RawPipeline p = cleanPipeline();
  std::vector<ModuleStage> modules = p.modules();
  modules[1] = stage;
  EXPECT_THAT(checkModules(p.groups, modules, {}).diagnostics, IsEmpty());
}

// The instructions of a module, without the header.
std::vector<std::vector<std::uint32_t>> instructionsOf(const std::vector<std::uint32_t>& words) {
  std::vector<std::vector<std::uint32_t>> result;
  for (const spirv::RawInstruction& i : spirv::RawInstructions(words))
    result.emplace_back(i.words.begin(), i.words.end());
  return result;
}

std::vector<std::uint32_t> encoded(spv::Op op, std::vector<std::uint32_t> operands) {
  operands.insert(operands.begin(),
                  static_cast<std::uint32_t>((operands.size() + 1) << 16) | static_cast<std::uint32_t>(op));
  return operands;
}

spv::Op opOf(const std::vector<std::uint32_t>& instruction) { return static_cast<spv::Op>(instruction[0] & 0xFFFFu); }

// OpCopyMemory, which some compilers write for an assignment, is followed as a load and a store.
TEST(ModuleCheck, FollowsCopiesOfMemory) {
  RawPipeline p = cleanPipeline();
  p.text("a.rmiss") =
      "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() {\n  vec4 sky;\n  sky.xyz = vec3(0.5);\n"
      "  sky.w = 1.0;\n  color = sky;\n}\n";
  const auto withCopies = [&] {
    const std::vector<std::uint32_t> words = compileRaw(Stage::miss, p.text("a.rmiss"), "a.rmiss");
    std::vector<std::uint32_t> result(words.begin(), words.begin() + 5);
    const auto all = instructionsOf(words);
    std::size_t copies = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      std::vector<std::uint32_t> next = all[i];
      if (i + 1 < all.size() && opOf(all[i]) == spv::Op::OpLoad && opOf(all[i + 1]) == spv::Op::OpStore &&
          all[i + 1][2] == all[i][2]) {
        next = encoded(spv::Op::OpCopyMemory, {all[i + 1][1], all[i][3]});
        ++i, ++copies;
      }
      result.insert(result.end(), next.begin(), next.end());
    }
    EXPECT_EQ(copies, 1u);
    std::vector<ModuleStage> modules = p.modules();
    modules[1] = stageModule("a.rmiss", result, {spv::ExecutionModel::MissKHR, "main"}, {});
    EXPECT_EQ(modules[1].problem, "");
    std::vector<std::string> ids;
    for (const Diagnostic& d : checkModules(p.groups, modules, {}).diagnostics) ids.push_back(d.id);
    return ids;
  };
  EXPECT_THAT(withCopies(), IsEmpty());
  replace(p.text("a.rmiss"), "  sky.w = 1.0;\n", "");
  EXPECT_THAT(withCopies(), ElementsAre("Q104"));
}

// Decorations by OpGroupDecorate, which is deprecated: NonUniform of a descriptor index.
TEST(ModuleCheck, AppliesDecorationGroups) {
  RawPipeline p = cleanPipeline();
  p.text("a.rchit") = R"(#extension GL_EXT_nonuniform_qualifier : require
layout(set = 0, binding = 2) uniform sampler2D textures[];
layout(location = 0) rayPayloadInEXT vec4 color;
hitAttributeEXT vec2 b;
void main() { color = textureLod(textures[nonuniformEXT(gl_InstanceCustomIndexEXT)], b, 0.0); }
)";
  const auto found = [&](bool grouped) {
    std::vector<std::uint32_t> words = compileRaw(Stage::closestHit, p.text("a.rchit"), "a.rchit");
    const std::uint32_t group = words[3]++;
    std::vector<std::uint32_t> result(words.begin(), words.begin() + 5), targets{group}, kept;
    bool written = false;
    for (const auto& i : instructionsOf(words)) {
      if (opOf(i) == spv::Op::OpDecorate && i[2] == static_cast<std::uint32_t>(spv::Decoration::NonUniform)) {
        targets.push_back(i[1]);
        continue;
      }
      if (opOf(i) == spv::Op::OpTypeVoid && !written) {
        written = true;
        const auto add = [&](const std::vector<std::uint32_t>& instruction) {
          result.insert(result.end(), instruction.begin(), instruction.end());
        };
        add(encoded(spv::Op::OpDecorate, {group, static_cast<std::uint32_t>(spv::Decoration::NonUniform)}));
        add(encoded(spv::Op::OpDecorationGroup, {group}));
        if (grouped) add(encoded(spv::Op::OpGroupDecorate, targets));
      }
      result.insert(result.end(), i.begin(), i.end());
    }
    EXPECT_GT(targets.size(), 1u);
    std::vector<ModuleStage> modules = p.modules();
    modules[2] = stageModule("a.rchit", result, {spv::ExecutionModel::ClosestHitKHR, "main"}, {});
    EXPECT_EQ(modules[2].problem, "");
    std::vector<std::string> ids;
    for (const Diagnostic& d : checkModules(p.groups, modules, {}).diagnostics) ids.push_back(d.id);
    return ids;
  };
  EXPECT_THAT(found(true), IsEmpty());
  EXPECT_THAT(found(false), ElementsAre("Q704"));
}

// Applications compile variants of an intersection shader without its code. A shader that computes a distance and does not report it
// is a mistake, although the optimizer removes its code, too.
TEST(ModuleCheck, AcceptsIntersectionShadersWithoutStatements) {
  RawPipeline p = cleanPipeline();
  const std::string code = "float t = dot(gl_ObjectRayOriginEXT, gl_ObjectRayDirectionEXT);\n";
  p.stages.push_back({"a.rint", "void main() {\n" + code + "}\n", Stage::intersection});
  p.groups.hitGroups[0].shaders[""].intersection = "a.rint";
  p.text("a.rchit") =
      "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color = vec4(gl_PrimitiveID); }\n";
  EXPECT_THAT(p.check(), Contains(testing::StartsWith("Q206 a.rint")));
  replace(p.text("a.rint"), code, "");
  EXPECT_THAT(p.check(), IsEmpty());
}

TEST(ModuleCheck, LeavesOutRepeatedGroups) {
  PipelineGroups groups = cleanPipeline().groups;
  groups.hitGroups.push_back(groups.hitGroups[0]);
  groups.hitGroups.push_back(groups.hitGroups[0]);
  groups.hitGroups[2].shaders[""].anyHit = "a.rahit";
  groups.misses.push_back(groups.misses[0]);
  const PipelineGroups once = withoutRepeatedGroups(groups);
  EXPECT_THAT(once.hitGroups, testing::SizeIs(2));
  EXPECT_THAT(once.misses, testing::SizeIs(1));
}

// NonSemantic.Shader.DebugInfo.100 in place of OpLine: the instructions that glslang -gVS and DXC write.
TEST(ModuleCheck, ConvertsDebugInfoToLines) {
  const auto op = [](spv::Op code, std::vector<std::uint32_t> operands) {
    operands.insert(operands.begin(),
                    static_cast<std::uint32_t>((operands.size() + 1) << 16) | static_cast<std::uint32_t>(code));
    return operands;
  };
  std::vector<std::uint32_t> words{spv::MagicNumber, 0x00010600, 0, 40, 0};
  const auto add = [&](spv::Op code, std::vector<std::uint32_t> operands) {
    const auto encoded = op(code, std::move(operands));
    words.insert(words.end(), encoded.begin(), encoded.end());
  };
  const auto text = [](const std::string& value) {
    std::vector<std::uint32_t> literal(value.size() / 4 + 1);
    std::memcpy(literal.data(), value.data(), value.size());
    return literal;
  };
  const auto with = [](std::vector<std::uint32_t> head, const std::vector<std::uint32_t>& tail) {
    head.insert(head.end(), tail.begin(), tail.end());
    return head;
  };
  using spv::Op;
  add(Op::OpCapability, {4479});  // RayTracingKHR
  add(Op::OpExtension, text("SPV_KHR_ray_tracing"));
  add(Op::OpExtension, text("SPV_KHR_non_semantic_info"));
  add(Op::OpExtInstImport, with({1}, text("NonSemantic.Shader.DebugInfo.100")));
  add(Op::OpMemoryModel, {0, 1});
  add(Op::OpEntryPoint, with(with({5317, 20}, text("main")), {10}));
  add(Op::OpString, with({2}, text("a.hlsl")));
  add(Op::OpString, with({3}, text("float4 color;")));
  add(Op::OpTypeVoid, {4});
  add(Op::OpTypeInt, {5, 32, 0});
  add(Op::OpConstant, {5, 6, 17});
  add(Op::OpTypeFloat, {7, 32});
  add(Op::OpTypePointer, {8, 5342, 7});
  add(Op::OpConstant, {7, 9, 0});
  add(Op::OpVariable, {8, 10, 5342});
  add(Op::OpConstant, {5, 14, 8});
  add(Op::OpExtInst, {4, 11, 1, 35, 2, 3});                         // DebugSource
  add(Op::OpExtInst, {4, 12, 1, 18, 2, 4, 11, 6, 6, 4, 2, 10, 6});  // DebugGlobalVariable
  add(Op::OpTypeFunction, {13, 4});
  add(Op::OpFunction, {4, 20, 0, 13});
  add(Op::OpLabel, {21});
  add(Op::OpExtInst, {4, 22, 1, 103, 11, 6, 6, 6, 6});  // DebugLine
  add(Op::OpStore, {10, 9});
  add(Op::OpReturn, {});
  add(Op::OpFunctionEnd, {});
  const auto module = spirv::Module::read(spirv::withPlainLines(words));
  ASSERT_TRUE(module);
  EXPECT_EQ(module->source("a.hlsl"), "float4 color;");
  EXPECT_EQ(module->declaration(10).line, 17);
  for (const spirv::Instruction& i : module->instructions()) {
    EXPECT_NE(i.op, Op::OpExtInst);
    if (i.op != Op::OpStore) continue;
    EXPECT_EQ(locationText(module->location(i).file, module->location(i).line, 0), "a.hlsl:17");
  }
  // spirv-opt can process it.
  const ModuleStage stage = stageModule("a.spv", words, {spv::ExecutionModel::MissKHR, "main"}, {});
  EXPECT_EQ(stage.problem, "");
  const auto direct = spirv::Module::read(words);  // the reader understands both
  ASSERT_TRUE(direct);
  EXPECT_EQ(direct->source("a.hlsl"), "float4 color;");
  EXPECT_EQ(direct->declaration(10).line, 17);
}

TEST(ModuleCheck, RejectsFilesThatAreNoSpirv) {
  EXPECT_THROW(moduleWords("a.spv", {}), FileError);
  const std::string text = "#version 460\n";
  EXPECT_THROW(moduleWords("a.spv", std::as_bytes(std::span(text))), FileError);
}

TEST(ShaderRecord, HasTheEndOfItsLastMember) {
  const auto bytesOf = [](const std::string& block) {
    const auto words = compileRaw(Stage::callable,
                                  "#extension GL_EXT_scalar_block_layout : require\n"
                                  "layout(location = 0) callableDataInEXT vec4 c;\n" +
                                      block + "void main() { c = vec4(record.last); }\n",
                                  "a.rcall");
    const auto module = spirv::Module::read(words);
    return module ? spirv::shaderRecordBytes(*module) : 0u;
  };
  EXPECT_EQ(bytesOf("layout(shaderRecordEXT, std430) buffer R { vec3 a; float b; vec4 last; } record;\n"), 32u);
  EXPECT_EQ(bytesOf("layout(shaderRecordEXT, scalar) buffer R { float a; mat3 m; float last; } record;\n"), 44u);
}

}  // namespace
}  // namespace quintet::check
