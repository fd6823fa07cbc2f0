// SPDX-License-Identifier: Apache-2.0
// The tree of events from the records of a log.
#include "job/explanation_builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>

#include "explanations.h"
#include "quintet/shared/frame.h"

namespace quintet::job {
namespace {

using namespace shared;
using testing::ElementsAre;

program::RunnableProgram someProgram() {
  program::RunnableProgram runnable;
  program::Program& program = runnable.description;
  program.rays = {{.name = "radiance", .miss = "sky.rmiss"}, {.name = "shadow", .miss = "lit.rmiss"}};
  program.outputs = {{.name = "color"}, {.name = "depth"}};
  program.callables = {{.name = "foil", .file = "foil.rcall"}};
  using shader::Stage;
  runnable.compiled.stages = {{"main.rgen", Stage::rayGeneration, {1}}, {"hit.rchit", Stage::closestHit, {1}},
                              {"sky.rmiss", Stage::miss, {1}},          {"alpha.rahit", Stage::anyHit, {1}},
                              {"ball.rint", Stage::intersection, {1}},  {"foil.rcall", Stage::callable, {1}}};
  using Kind = spirv::DataField::Kind;
  runnable.compiled.stages[1].calls = {
      {"payload",
       "Payload",
       {{"payload.t", "float", Kind::floating, 32, 1, 0}, {"payload.cell", "ivec2", Kind::signedInteger, 32, 2, 1}},
       true,
       {"inner.glsl", 9, 3}}};
  return runnable;
}

const std::vector<std::string> kInstances{"floor", "ball"}, kMaterials{"wood", "default"}, kLights{"lamp"};

std::vector<ExplainedEvent> build(const LogWriter& log, const program::RunnableProgram& program = someProgram()) {
  return buildEvents(log.contents(), program, {kInstances, kMaterials, kLights}, {3, 4});
}

ExplainRay rayTo(uint offset, uint flags = 0) {
  return {0, 12, flags, 0xFF, offset, 2, offset, {0, 0, 0}, 0.0f, {0, 0, 1}, 10.0f};
}

ExplainHit hitBy(uint stage, bool runs = true) {
  ExplainHit hit{};
  hit.stage = stage;
  hit.instance = 1;
  hit.primitive = 5;
  hit.material = 0;
  hit.hitKind = 0xFE;
  hit.t = 2.0f;
  hit.runsProgram = runs;
  return hit;
}

std::vector<std::string> typesOf(const std::vector<ExplainedEvent>& events) {
  std::vector<std::string> types;
  for (const ExplainedEvent& event : events) types.push_back(event.type);
  return types;
}

TEST(ExplanationBuilder, NestsRaysInStages) {
  LogWriter log;
  log.add(kLogRay, rayTo(0)).add(kLogHit, hitBy(1)).add(kLogRay, rayTo(1, 4)).add(kLogStage, ExplainStage{2});
  log.add(kLogStageEnd, ExplainStageEnd{0}).add(kLogRayEnd, ExplainRayEnd{1}).add(kLogStageEnd, ExplainStageEnd{0});
  log.add(kLogRayEnd, ExplainRayEnd{1}).add(kLogStore, ExplainStore{0, 20, 0, kExplainStored, {3, 4}, {1, 2, 3, 4}});
  const std::vector<ExplainedEvent> events = build(log);
  ASSERT_THAT(typesOf(events), ElementsAre("ray", "store"));
  EXPECT_EQ(events[0].text("rayType"), "radiance");
  EXPECT_EQ(events[0].text("result"), "hit");
  ASSERT_THAT(typesOf(events[0].children), ElementsAre("closest-hit"));
  const ExplainedEvent& hit = events[0].children[0];
  EXPECT_EQ(hit.text("instanceName"), "ball");
  EXPECT_EQ(hit.text("material"), "wood");
  EXPECT_EQ(hit.text("stage"), "hit.rchit");
  ASSERT_THAT(typesOf(hit.children), ElementsAre("ray"));
  EXPECT_EQ(hit.children[0].text("flags"), "TerminateOnFirstHit");
  EXPECT_EQ(hit.children[0].text("missShader"), "lit.rmiss");
  EXPECT_EQ(hit.children[0].text("result"), "miss");
  EXPECT_THAT(typesOf(hit.children[0].children), ElementsAre("miss"));
  EXPECT_EQ(events[1].text("output"), "color");
  EXPECT_EQ(events[1].find("pixel"), nullptr) << "its own pixel";
}

TEST(ExplanationBuilder, NamesHitsWithoutShader) {
  LogWriter log;
  log.add(kLogRay, rayTo(1)).add(kLogHit, hitBy(0, false)).add(kLogStageEnd, ExplainStageEnd{0});
  log.add(kLogRayEnd, ExplainRayEnd{1});
  const std::vector<ExplainedEvent> events = build(log);
  ASSERT_THAT(typesOf(events[0].children), ElementsAre("hit"));
  EXPECT_EQ(events[0].children[0].find("stage"), nullptr);
  EXPECT_EQ(events[0].text("result"), "hit");
}

TEST(ExplanationBuilder, ShowsCandidates) {
  LogWriter log;
  log.add(kLogRay, rayTo(0)).add(kLogBox, ExplainBox{4, 1, 0, 3, 0.5f, 8.0f}).add(kLogHit, hitBy(3));
  log.add(kLogStageEnd, ExplainStageEnd{kExplainIgnored}).add(kLogReport, ExplainReport{2.5f, 7, 0});
  log.add(kLogStageEnd, ExplainStageEnd{0}).add(kLogStage, ExplainStage{2}).add(kLogStageEnd, ExplainStageEnd{0});
  log.add(kLogRayEnd, ExplainRayEnd{1});
  const std::vector<ExplainedEvent> events = build(log);
  ASSERT_THAT(typesOf(events[0].children), ElementsAre("intersection", "miss"));
  const std::vector<ExplainedEvent>& candidates = events[0].children[0].children;
  ASSERT_THAT(typesOf(candidates), ElementsAre("any-hit", "report"));
  EXPECT_EQ(candidates[0].text("result"), "ignored");
  EXPECT_FALSE(candidates[1].flag("accepted"));
  EXPECT_EQ(candidates[1].number("t"), 2.5f);
  EXPECT_EQ(events[0].text("result"), "miss");
}

TEST(ExplanationBuilder, DecodesPayloads) {
  const auto words = [](float t, int x, int y) {
    return std::vector<std::uint32_t>{program::kCallsPerStage, std::bit_cast<std::uint32_t>(t),
                                      static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)};
  };
  LogWriter log;
  log.add(kLogRay, rayTo(0)).addWords(kLogData, words(1.5f, -2, 3)).addWords(kLogData, words(0.0f, 4, 5));
  log.add(kLogRayEnd, ExplainRayEnd{0});
  const std::vector<ExplainedEvent> events = build(log);
  EXPECT_EQ(events[0].text("result"), "not traced");
  EXPECT_EQ(events[0].text("file"), "inner.glsl");
  EXPECT_EQ(events[0].integer("line"), 9);
  ASSERT_THAT(typesOf(events[0].children), ElementsAre("payload", "payload"));
  const ExplainedEvent& before = events[0].children[0];
  EXPECT_EQ(before.text("when"), "before");
  EXPECT_EQ(before.number("payload.t"), 1.5f);
  EXPECT_EQ(*before.find("payload.cell"), EventValue(std::vector<std::int64_t>{-2, 3}));
  EXPECT_EQ(events[0].children[1].text("when"), "after");
}

// A payload can be a variable without members, with any name.
TEST(ExplanationBuilder, KeepsTheFieldsOfPayloadsApart) {
  for (const char* name : {"when", "variable", "dataType", "type", "events", ""}) {
    program::RunnableProgram program = someProgram();
    program.compiled.stages[1].calls = {
        {name, "float", {{name, "float", spirv::DataField::Kind::floating, 32, 1, 0}}, true, {}}};
    LogWriter log;
    for (int i = 0; i < 2; ++i) {
      if (i == 0) log.add(kLogRay, rayTo(0));
      log.addWords(kLogData, {program::kCallsPerStage, std::bit_cast<std::uint32_t>(1.5f)});
    }
    log.add(kLogRayEnd, ExplainRayEnd{1});
    const std::vector<ExplainedEvent> events = build(log, program);
    ASSERT_THAT(typesOf(events[0].children), ElementsAre("payload", "payload")) << name;
    const ExplainedEvent& after = events[0].children[1];
    EXPECT_EQ(after.text("when"), "after") << name;
    EXPECT_EQ(after.text("variable"), name);
    EXPECT_EQ(after.text("dataType"), "float");
    EXPECT_EQ(after.number("value"), 1.5f) << name;
  }
}

TEST(ExplanationBuilder, JoinsChoicesAndSamples) {
  LogWriter log;
  log.add(kLogRay, rayTo(0)).add(kLogHit, hitBy(1)).add(kLogStageEnd, ExplainStageEnd{0});
  log.add(kLogRayEnd, ExplainRayEnd{1});
  log.add(kLogLightChoice, ExplainLightChoice{0, kLightPoint, 0, 0, 0, 0.5f}).add(kLogLobe, ExplainLobe{2, 0.75f});
  log.add(kLogLightSample, ExplainLightSample{1, {0, 1, 0}, 3, {9, 9, 9}, 0.5f, {1, 1, 1}, 0.25f, 1, {1, 1, 1}});
  log.add(kLogBsdfSample, ExplainBsdfSample{1, 0, 0, 0, {1, 0, 0}, 0.3f, {0.8f, 0.8f, 0.8f}});
  log.add(kLogLightRoulette, ExplainLightRoulette{0.25f, 0.125f});
  log.add(kLogRay, rayTo(1)).add(kLogStage, ExplainStage{2}).add(kLogStageEnd, ExplainStageEnd{0});
  log.add(kLogRayEnd, ExplainRayEnd{1}).add(kLogVisibility, ExplainVisibility{{0.5f, 1, 1}});
  log.add(kLogLightChoice, ExplainLightChoice{7, kLightTriangle, 0, 2, 33, 0.25f});
  const std::vector<ExplainedEvent> events = build(log);
  ASSERT_THAT(typesOf(events), ElementsAre("ray", "light", "bsdf", "ray", "light"));
  EXPECT_EQ(events[1].text("light"), "lamp");
  EXPECT_EQ(events[1].number("pdf"), 0.5f);
  EXPECT_EQ(events[1].number("survival"), 0.25f);
  EXPECT_TRUE(events[1].flag("survived"));
  EXPECT_EQ(events[2].text("lobe"), "diffuse");
  EXPECT_EQ(events[2].number("pdf"), 0.3f);
  EXPECT_EQ(events[3].vector("transmittance"), vec3(0.5f, 1, 1));
  EXPECT_EQ(events[4].text("light"), "floor") << "the instance of the triangle";
  EXPECT_EQ(events[4].find("pdf"), nullptr) << "a sample of an earlier vertex is not this one's";
}

// traceVisible() traces a ray without instances if there is nothing to test.
TEST(ExplanationBuilder, DropsRaysThatAreNone) {
  ExplainRay none = rayTo(1);
  none.mask = 0;
  none.tmax = 0.0f;
  LogWriter log;
  log.add(kLogRay, rayTo(0)).add(kLogRayEnd, ExplainRayEnd{1}).add(kLogRay, none).add(kLogStage, ExplainStage{2});
  log.add(kLogStageEnd, ExplainStageEnd{0})
      .add(kLogRayEnd, ExplainRayEnd{1})
      .add(kLogVisibility, ExplainVisibility{{1, 1, 1}});
  const std::vector<ExplainedEvent> events = build(log);
  ASSERT_THAT(typesOf(events), ElementsAre("ray"));
  EXPECT_EQ(events[0].find("transmittance"), nullptr);
}

TEST(ExplanationBuilder, ClosesWhatALostRecordLeftOpen) {
  LogWriter log;
  log.add(kLogRay, rayTo(0))
      .add(kLogHit, hitBy(1))
      .add(kLogRayEnd, ExplainRayEnd{1})
      .add(kLogStageEnd, ExplainStageEnd{0});
  log.add(kLogRay, rayTo(1)).addWords(kLogHit, {1, 2, 3});
  EXPECT_THAT(typesOf(build(log)), ElementsAre("ray", "ray"));
}

}  // namespace
}  // namespace quintet::job
