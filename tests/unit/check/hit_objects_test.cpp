// SPDX-License-Identifier: Apache-2.0
// Hit objects of shader invocation reorder: what a trace with one and its execution run, and what conditions say about it. Each
// pipeline is checked as a module of the NV extension and, where it has the instructions, of the EXT extension.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "check/modules_test_support.h"
#include "check/reorder_test_support.h"
#include "spirv/plain_code.h"

namespace quintet::check {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

constexpr const char* kReorderHead = R"(#extension GL_NV_shader_invocation_reorder : require
layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(set = 0, binding = 1, rgba8) uniform image2D result;
layout(location = 0) rayPayloadEXT vec4 color;
layout(location = 1) rayPayloadEXT float alpha;
)";
constexpr const char* kTrace =
    "hitObjectTraceRayNV(hit, tlas, gl_RayFlagsNoneEXT, 0xFF, 0, 1, 0, vec3(0), 0.001, vec3(0, 0, 1), 100.0, 0);\n";
constexpr const char* kExecute = "hitObjectExecuteShaderNV(hit, 0);\n";
constexpr const char* kStore = "imageStore(result, ivec2(gl_LaunchIDEXT.xy), color);\n";

// The body of main() starts in line 9.
RawPipeline withBody(const std::string& body) {
  RawPipeline p = cleanPipeline();
  p.text("a.rgen") = std::string(kReorderHead) + "void main() {\n" + body + "}\n";
  return p;
}

RawPipeline plain() { return withBody(std::string("hitObjectNV hit;\n") + kTrace + kExecute + kStore); }

void addAnyHit(RawPipeline& p, const std::string& text) {
  p.stages.push_back({"a.rahit", text, shader::Stage::anyHit});
  p.groups.hitGroups[0].shaders[""].anyHit = "a.rahit";
}

void dropMiss(RawPipeline& p) {
  std::erase_if(p.stages, [](const auto& stage) { return stage.name == "a.rmiss"; });
  p.groups.misses.clear();
}

std::vector<std::string> withoutLines(std::vector<std::string> reports) {
  for (std::string& report : reports) report.resize(report.find(':'));
  return reports;
}

enum class Forms {
  nv,
  both,
  combined
};  // combined: also with the EXT extension's instruction for a trace and an execution

void expectReports(RawPipeline p, const std::vector<std::string>& expected, Forms forms = Forms::both) {
  EXPECT_THAT(p.check(), ElementsAreArray(expected)) << p.text("a.rgen");
  if (forms == Forms::nv) return;
  p.rewrite = [](const std::vector<std::uint32_t>& words) { return toReorderExt(words); };
  EXPECT_THAT(p.check(), ElementsAreArray(expected)) << "EXT\n" << p.text("a.rgen");
  if (forms == Forms::both) return;
  // It has the line of the trace.
  p.rewrite = [](const std::vector<std::uint32_t>& words) { return toReorderExt(words, true); };
  EXPECT_THAT(withoutLines(p.check()), ElementsAreArray(withoutLines(expected))) << "combined\n" << p.text("a.rgen");
}

constexpr const char* kSilentMiss =
    "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { if (color.x > 2.0) color.x = 2.0; }\n";
constexpr const char* kSilentHit = R"(layout(location = 0) rayPayloadInEXT vec4 color;
layout(set = 0, binding = 2) buffer Hits { uint count; } hits;
void main() { atomicAdd(hits.count, 1u); }
)";

TEST(HitObjects, ATraceAndItsExecutionAreATrace) {
  expectReports(plain(), {}, Forms::combined);
  RawPipeline p = plain();
  p.text("a.rchit") = "layout(location = 0) rayPayloadInEXT uvec4 color;\nvoid main() { color = uvec4(1); }\n";
  expectReports(p, {"Q101 a.rgen:11"}, Forms::combined);
  p = plain();
  p.text("a.rmiss") = "layout(location = 0) rayPayloadInEXT vec3 color;\nvoid main() { color = vec3(1); }\n";
  expectReports(p, {"Q101 a.rgen:11"}, Forms::combined);
  p = plain();
  p.text("a.rmiss") = "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color.xyz = vec3(1); }\n";
  expectReports(p, {"Q104 a.rgen:11"}, Forms::combined);
}

// Without the execution, only any-hit shaders run.
TEST(HitObjects, AMissingExecutionIsReported) {
  RawPipeline p = withBody(std::string("hitObjectNV hit;\n") + kTrace + kStore);
  expectReports(p, {"Q104 a.rgen:10", "Q801 a.rchit:5", "Q801 a.rmiss:4"});
  EXPECT_THAT(p.diagnostics().front().text, HasSubstr("run only when the hit object is executed"));
  addAnyHit(p, "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color = vec4(0.5); }\n");
  expectReports(p, {"Q801 a.rchit:5", "Q801 a.rmiss:4"});
}

TEST(HitObjects, AnyHitShadersReceiveThePayloadOfTheTrace) {
  RawPipeline p = plain();
  addAnyHit(p, "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color = vec4(0.5); }\n");
  expectReports(p, {});
  p.stages.back().text = "layout(location = 0) rayPayloadInEXT float color;\nvoid main() { color = 0.5; }\n";
  expectReports(p, {"Q101 a.rgen:10"});
  // The execution has a payload of its own.
  std::string& text = p.text("a.rgen");
  text.replace(text.find("100.0, 0"), 8, "100.0, 1");
  expectReports(p, {});
  // What the any-hit shader wrote can be read before the execution.
  text.insert(text.find("hitObjectExecute"), "float seen = alpha;\n");
  text.replace(text.find("color);"), 7, "color * seen);");
  expectReports(p, {});
}

// Only hits, or only misses, are executed.
TEST(HitObjects, ConditionsOnTheHitObjectCount) {
  const auto executedIf = [](const std::string& condition) {
    return withBody(std::string("hitObjectNV hit;\ncolor = vec4(0);\nif (gl_LaunchIDEXT.x > 5) color.x = 1.0;\n") +
                    kTrace + "if (" + condition + ") " + kExecute + kStore);
  };
  for (const char* hit :
       {"hitObjectIsHitNV(hit)", "!hitObjectIsMissNV(hit)", "hitObjectIsHitNV(hit) && gl_LaunchIDEXT.x > 3",
        "gl_LaunchIDEXT.x > 3 && !hitObjectIsMissNV(hit)"}) {
    RawPipeline p = executedIf(hit);
    expectReports(p, {"Q801 a.rmiss:4"}, Forms::nv);
    dropMiss(p);
    expectReports(p, {}, Forms::nv);
    p.text("a.rchit") = "layout(location = 0) rayPayloadInEXT float color;\nvoid main() { color = 1.0; }\n";
    expectReports(p, {"Q101 a.rgen:13"});
  }
  for (const char* miss : {"hitObjectIsMissNV(hit)", "!(hitObjectIsHitNV(hit) || gl_LaunchIDEXT.x > 3)"})
    expectReports(executedIf(miss), {"Q801 a.rchit:5"});
  // It can be either one.
  for (const char* unknown : {"hitObjectIsHitNV(hit) || gl_LaunchIDEXT.x > 3", "hitObjectGetHitKindNV(hit) != 255u",
                              "gl_LaunchIDEXT.x > 3", "!hitObjectIsEmptyNV(hit)"})
    expectReports(executedIf(unknown), {}, Forms::nv);
}

// The payload is not set before, and one of the shaders does not write it.
TEST(HitObjects, ConditionsThatAreNotUnderstoodAreNotReported) {
  const auto body = [](const std::string& condition) {
    return withBody(std::string("hitObjectNV hit;\n") + kTrace + "if (" + condition + ") {\n" + kExecute + kStore +
                    "}\n");
  };
  for (const bool hit : {false, true}) {
    const char* silent = hit ? "a.rchit" : "a.rmiss";
    for (const char* condition : {"hitObjectGetHitKindNV(hit) != 255u", "hitObjectGetRayTMaxNV(hit) < 50.0",
                                  "hitObjectGetInstanceCustomIndexNV(hit) == 3"}) {
      RawPipeline p = body(condition);
      p.text(silent) = hit ? kSilentHit : kSilentMiss;
      expectReports(p, {}, Forms::nv);
    }
    RawPipeline p = body("gl_LaunchIDEXT.x > 3");
    p.text(silent) = hit ? kSilentHit : kSilentMiss;
    if (hit) expectReports(p, {"Q104 a.rgen:12"});
  }
  RawPipeline hits = body("hitObjectIsHitNV(hit)");
  hits.text("a.rchit") = kSilentHit;
  dropMiss(hits);
  expectReports(hits, {"Q104 a.rgen:12"});
  // Nothing that can be executed writes it.
  RawPipeline p = body("hitObjectGetHitKindNV(hit) != 255u");
  p.text("a.rchit") = kSilentHit;
  dropMiss(p);
  expectReports(p, {"Q104 a.rgen:12"});
}

// A read behind a condition on the hit object is one of hits.
TEST(HitObjects, ConditionsGuardReads) {
  const std::string miss = "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color.xyz = vec3(1); }\n";
  RawPipeline p = withBody(std::string("hitObjectNV hit;\n") + kTrace + kExecute +
                           "float w = hitObjectIsHitNV(hit) ? color.w : 1.0;\n"
                           "imageStore(result, ivec2(gl_LaunchIDEXT.xy), vec4(color.xyz, w));\n");
  p.text("a.rmiss") = miss;
  expectReports(p, {});
  std::string& text = p.text("a.rgen");
  text.replace(text.find("hitObjectIsHitNV(hit) ?"), 23, "gl_LaunchIDEXT.x > 3u ?");
  expectReports(p, {"Q104 a.rgen:11"});
}

// A condition that holds for the shader that does not write the member is no guard.
TEST(HitObjects, ConditionsOfTheWrongWayDoNotGuardReads) {
  const std::string silentMiss =
      "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color.xyz = vec3(1); }\n";
  const std::string silentHit =
      "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color.xyz = vec3(2); }\n";
  const auto read = [&](const std::string& condition, bool missIsSilent, const std::string& filling = "") {
    RawPipeline p =
        withBody(std::string("hitObjectNV hit;\n") + kTrace + kExecute + filling + "float w = 1.0;\nif (" + condition +
                 ") w = color.w;\n" + "imageStore(result, ivec2(gl_LaunchIDEXT.xy), vec4(color.xyz, w));\n");
    p.text(missIsSilent ? "a.rmiss" : "a.rchit") = missIsSilent ? silentMiss : silentHit;
    return p;
  };
  for (const bool missIsSilent : {false, true}) {
    const char* right = missIsSilent ? "hitObjectIsHitNV(hit)" : "hitObjectIsMissNV(hit)";
    const char* wrong = missIsSilent ? "hitObjectIsMissNV(hit)" : "hitObjectIsHitNV(hit)";
    expectReports(read(right, missIsSilent), {});
    expectReports(read(std::string("!") + wrong, missIsSilent), {});
    expectReports(read(wrong, missIsSilent), {"Q104 a.rgen:11"});
    expectReports(read(std::string("!") + right, missIsSilent), {"Q104 a.rgen:11"});
    // What else the hit object says can exclude the shader.
    expectReports(read("hitObjectGetHitKindNV(hit) == 254u", missIsSilent), {});
    // The condition asks about the next ray.
    expectReports(read(wrong, missIsSilent, kTrace), {});
  }
}

TEST(HitObjects, AnObjectWithSeveralSourcesIsNotReported) {
  const std::string record = "hitObjectRecordMissNV(hit, 1, vec3(0), 0.001, vec3(0, 0, 1), 100.0);\n";
  RawPipeline p = withBody(std::string("hitObjectNV hit;\n") + kTrace + "if (hitObjectIsMissNV(hit)) " + record +
                           kExecute + kStore);
  p.groups.misses.push_back({{}, "b.rmiss", {}, 0});
  p.stages.push_back({"b.rmiss", p.text("a.rmiss"), shader::Stage::miss});
  p.text("a.rmiss") = kSilentMiss;
  expectReports(p, {});
  // The record alone.
  p = withBody("hitObjectNV hit;\n" + record + kExecute + kStore);
  expectReports(p, {"Q502 a.rgen:11"});
  EXPECT_THAT(p.diagnostics().front().text, HasSubstr("miss index of this execution of a hit object is 1"));
}

// Of an element of an array, a parameter and an empty object, the content is unknown: all shaders can run.
TEST(HitObjects, UnknownObjectsReachAllShaders) {
  const std::string execute = std::string(kExecute) + kStore;
  RawPipeline p = withBody(std::string("hitObjectNV hit;\nhitObjectRecordEmptyNV(hit);\nif (gl_LaunchIDEXT.x > 3) ") +
                           kTrace + execute);
  p.text("a.rmiss") = kSilentMiss;
  expectReports(p, {});
  // Also after a trace that skips the closest-hit shader.
  std::string& flags = p.text("a.rgen");
  flags.replace(flags.find("gl_RayFlagsNoneEXT"), 18, "gl_RayFlagsSkipClosestHitShaderEXT");
  expectReports(p, {});
  // In functions that are inlined, it is known.
  p = withBody("run();\n" + std::string(kStore));
  std::string& text = p.text("a.rgen");
  text.insert(text.find("void main"), std::string("hitObjectNV hit;\nvoid execute() { ") + kExecute +
                                          "}\nvoid run() {\n" + kTrace + "execute();\n}\n");
  expectReports(p, {});
  p.text("a.rmiss") = "layout(location = 0) rayPayloadInEXT vec3 color;\nvoid main() { color = vec3(1); }\n";
  expectReports(p, {"Q101 a.rgen:9"});
}

// A hit that is recorded: any hit group, no miss.
TEST(HitObjects, RecordedHitsRunAnyHitGroup) {
  RawPipeline p = withBody(
      "hitObjectNV hit;\n"
      "hitObjectRecordHitWithIndexNV(hit, tlas, 0, 0, 0, 0u, 0u, vec3(0), 0.001, vec3(0, 0, 1), 1.0, 2);\n" +
      std::string(kExecute) + kStore);
  std::string& text = p.text("a.rgen");
  text.insert(text.find("void main"), "layout(location = 2) hitObjectAttributeNV vec2 weights;\n");
  expectReports(p, {"Q801 a.rmiss:4"}, Forms::nv);
}

// The values of the ray before, and a second execution of the same object.
TEST(HitObjects, ValuesOfThePreviousRay) {
  const std::string loop = std::string("hitObjectNV hit;\ncolor = vec4(0);\nfor (int i = 0; i < 4; ++i) {\n") + kTrace +
                           kExecute + kStore + "}\n";
  RawPipeline p = withBody(loop);
  expectReports(p, {});
  p.text("a.rmiss") = "void main() {}\n";
  expectReports(p, {"Q104 a.rgen:13"});
  // The initial value is meant.
  p = withBody(std::string("hitObjectNV hit;\ncolor = vec4(0);\n") + kTrace + kExecute + kStore + kExecute + kStore);
  p.text("a.rmiss") = "void main() {}\n";
  expectReports(p, {});
}

TEST(HitObjects, ArgumentsAreReportedOnce) {
  const auto edited = [](const std::string& from, const std::string& to) {
    RawPipeline p = plain();
    std::string& text = p.text("a.rgen");
    text.replace(text.find(from), from.size(), to);
    return p;
  };
  expectReports(edited("gl_RayFlagsNoneEXT, 0xFF", "0xFF, gl_RayFlagsNoneEXT"), {"Q508 a.rgen:10"});
  expectReports(edited("0xFF, 0, 1, 0", "0xFF, 16, 1, 0"), {"Q503 a.rgen:10"});
  expectReports(edited("0xFF, 0, 1, 0", "0xFF, 0, 1, 1"), {"Q502 a.rgen:10"});
  expectReports(edited("vec3(0, 0, 1)", "vec3(0)"), {"Q510 a.rgen:10"});
  // A hit that is the first one that is found.
  RawPipeline p = edited("gl_RayFlagsNoneEXT", "gl_RayFlagsTerminateOnFirstHitEXT");
  expectReports(p, {"Q512 a.rgen:11"});
}

TEST(HitObjects, CandidatesAreThoseOfTheTrace) {
  RawPipeline p = plain();
  addAnyHit(p, "void main() { ignoreIntersectionEXT; }\n");
  expectReports(p, {"Q606 a.rahit:3"});
  p = plain();
  addAnyHit(p, "hitAttributeEXT vec2 b;\nvoid main() { if (b.x > 0.5) ignoreIntersectionEXT; }\n");
  std::string& text = p.text("a.rgen");
  text.replace(text.find("gl_RayFlagsNoneEXT"), 18, "gl_RayFlagsOpaqueEXT");
  expectReports(p, {"Q610 a.rahit:4"});
}

// What SPIRV-Tools does not know about a hit does not keep the check from the module.
TEST(HitObjects, QueriesOfClustersAreChecked) {
  RawPipeline p = withBody(std::string("hitObjectNV hit;\n") + kTrace + kExecute +
                           "if (hitObjectGetPrimitiveIndexNV(hit) == 7) color = vec4(1);\n" + kStore);
  p.text("a.rmiss") = "layout(location = 0) rayPayloadInEXT vec3 color;\nvoid main() { color = vec3(1); }\n";
  constexpr std::uint32_t kGetClusterId = 5346;
  p.rewrite = [](const std::vector<std::uint32_t>& given) {
    std::vector<std::uint32_t> words = given;
    for (const spirv::RawInstruction& i : spirv::RawInstructions(given))
      if (i.op == spv::Op::OpHitObjectGetPrimitiveIndexNV)
        words[i.position] = words[i.position] >> 16 << 16 | kGetClusterId;
    return words;
  };
  EXPECT_THAT(p.check(), ElementsAreArray({"Q101 a.rgen:11"}));
}

// Closest-hit shaders that trace and execute count as recursion; a search alone runs nothing that could.
TEST(HitObjects, ExecutionsAreRecursion) {
  const std::string nested = std::string(kReorderHead) +
                             "layout(location = 2) rayPayloadInEXT vec4 incoming;\nvoid main() {\nhitObjectNV hit;\n" +
                             kTrace + kExecute + "incoming = color;\n}\n";
  RawPipeline p = plain();
  p.groups.declaredRecursion = 2;
  p.text("a.rchit") = nested;
  p.text("a.rchit").replace(p.text("a.rchit").find("gl_RayFlagsNoneEXT"), 18, "gl_RayFlagsSkipClosestHitShaderEXT");
  p.text("a.rchit").insert(p.text("a.rchit").find("hitObjectNV hit"), "color = vec4(0);\n");
  expectReports(p, {});
  p.groups.declaredRecursion = 1;
  expectReports(p, {"Q402 a.rchit:12"});
}

// Words that are changed at random, as modules of both extensions: validated, and as they are. QUINTET_CHANGED_MODULES sets their
// number.
TEST(HitObjects, ChangedModulesAreSafe) {
  const char* given = std::getenv("QUINTET_CHANGED_MODULES");
  const int count = given ? std::atoi(given) : 40;
  RawPipeline p = plain();
  addAnyHit(p, "layout(location = 0) rayPayloadInEXT vec4 color;\nvoid main() { color = vec4(0.5); }\n");
  const std::vector<ModuleStage> correct = p.modules();
  const std::string body = std::string(
                               "hitObjectNV hit, other;\nhitObjectRecordEmptyNV(hit);\n"
                               "for (int i = 0; i < 3; ++i) {\n") +
                           kTrace + "if (hitObjectIsHitNV(hit) && i < 2) " + kExecute +
                           "hitObjectRecordMissNV(other, i, vec3(0), 0.0, vec3(1), 1.0);\nreorderThreadNV(other);\n"
                           "hitObjectExecuteShaderNV(other, 1);\n}\n" +
                           kStore;
  const std::vector<std::uint32_t> words =
      compileRaw(shader::Stage::rayGeneration, withBody(body).text("a.rgen"), "a.rgen");
  std::mt19937 generator(7);
  const auto random = [&](std::size_t limit) { return static_cast<std::uint32_t>(generator() % limit); };
  for (int k = 0; k < count; ++k) {
    std::vector<std::uint32_t> changed = k % 2 == 0 ? words : toReorderExt(words, k % 4 == 1);
    for (std::uint32_t edits = 1 + random(4); edits > 0; --edits) {
      std::uint32_t& word = changed[5 + random(changed.size() - 5)];
      switch (random(4)) {
        case 0: word ^= 1u << random(32); break;
        case 1: word = changed[random(changed.size())]; break;
        case 2: word = word >> 16 << 16 | (5249u + random(110)); break;  // another instruction of hit objects
        default: word += random(3) - 1; break;
      }
    }
    std::vector<ModuleStage> stages = correct;
    stages[0] = k % 3 == 0 ? stageModule("a.rgen", changed, {spv::ExecutionModel::RayGenerationKHR, "main"}, {})
                           : ModuleStage{"a.rgen", shader::Stage::rayGeneration, spirv::withPlainCode(changed), {}};
    for (const Diagnostic& d : checkModules(p.groups, stages, {}).diagnostics) EXPECT_NE(d.text, "");
  }
}

}  // namespace
}  // namespace quintet::check
