// SPDX-License-Identifier: Apache-2.0
// The pipeline as JSON, DOT and SVG.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "check/diagram/svg.h"
#include "check_test_support.h"
#include "program/lecture/lecture.h"
#include "program/load.h"

namespace quintet::check {
namespace {

using testing::HasSubstr;
using testing::Not;

PipelineModel modelOf(const program::Program& program, const program::SceneFacts* scene = nullptr) {
  const CheckResult result = check(program, checkCompiler(), scene, {});
  return describePipeline(program, checkCompiler(), scene, result).value();
}

PipelineModel modelOf(const Files& files, const program::SceneFacts* scene = nullptr) {
  return modelOf(program::parseProgram(files.at("program.toml"), "demo", "folder/demo", files), scene);
}

nlohmann::json jsonOf(const Files& files, const program::SceneFacts* scene = nullptr) {
  return nlohmann::json::parse(pipelineJson(modelOf(files, scene)));
}

TEST(PipelineModel, HasTheArgumentsAndTargetsOfTraces) {
  const nlohmann::json json = jsonOf(cleanFiles());
  EXPECT_EQ(json["program"], "demo");
  EXPECT_EQ(json["scene"], nullptr);
  EXPECT_EQ(json["recursion"]["depth"], 2);
  EXPECT_EQ(json["rays"], nlohmann::json({"primary", "shadow"}));
  ASSERT_EQ(json["traces"].size(), 2u);
  const nlohmann::json& primary = json["traces"][0];
  EXPECT_EQ(json["stages"][primary["stage"].get<std::size_t>()]["file"], "main.rgen");
  EXPECT_EQ(primary["location"]["line"], 10);
  EXPECT_EQ(primary["flags"], "None");
  EXPECT_EQ(primary["mask"], "0xff");
  EXPECT_EQ(primary["offset"], "0");
  EXPECT_EQ(primary["stride"], "2");
  EXPECT_EQ(primary["payload"]["type"], "Payload");
  EXPECT_EQ(primary["payload"]["bytes"], 16);
  ASSERT_EQ(primary["targets"].size(), 2u);
  EXPECT_EQ(primary["targets"][0]["list"], "hits");
  EXPECT_EQ(json["hits"][primary["targets"][0]["index"].get<std::size_t>()]["group"], "surface");
  EXPECT_EQ(primary["targets"][1]["list"], "misses");
  EXPECT_EQ(primary["targets"][1]["exact"], true);
  EXPECT_EQ(json["traces"][1]["flags"], "TerminateOnFirstHit | SkipClosestHitShader");
  EXPECT_EQ(json["diagnostics"], nlohmann::json::array());
}

TEST(PipelineModel, HasTheGeometryOfTheScene) {
  const program::SceneFacts scene = sceneWith({{program::GeometryKind::triangles, true, "tree", "leaf"}});
  const nlohmann::json json = jsonOf(cleanFiles(), &scene);
  EXPECT_EQ(json["scene"], "scene.glb");
  EXPECT_EQ(json["hits"][0]["geometry"], nlohmann::json({"'tree' (leaf)"}));
}

TEST(PipelineModel, HasCallsAndRecords) {
  const nlohmann::json calls = jsonOf(callFiles());
  ASSERT_EQ(calls["calls"].size(), 1u);
  EXPECT_EQ(calls["calls"][0]["index"], "0");
  EXPECT_EQ(calls["calls"][0]["targets"][0]["list"], "callables");
  const nlohmann::json records = nlohmann::json::parse(pipelineJson(modelOf(program::loadProgram("17_records"))));
  EXPECT_THAT(records["hits"][0]["record"].get<std::string>(), HasSubstr("stripes=0"));
}

// The edge from the trace to the miss shader with another payload, and nothing else.
TEST(PipelineModel, MarksTheEdgeOfADiagnostic) {
  const nlohmann::json json = jsonOf(edited(cleanFiles(), "sky.rmiss", "struct Payload { vec3 color; float t; };",
                                            "struct Payload { vec3 color; float t; float more; };"));
  ASSERT_EQ(json["diagnostics"].size(), 1u) << json["diagnostics"];
  const nlohmann::json& targets = json["traces"][0]["targets"];
  EXPECT_EQ(targets[0]["diagnostics"], nlohmann::json::array());
  EXPECT_EQ(targets[1]["diagnostics"], nlohmann::json::array({0}));
  EXPECT_EQ(json["traces"][1]["diagnostics"], nlohmann::json::array());
}

TEST(PipelineModel, ExistsOnlyForProgramsThatCompile) {
  const Files files = edited(cleanFiles(), "sky.rmiss", "payload.color", "payload.tint");
  const program::Program program = program::parseProgram(files.at("program.toml"), "demo", "folder/demo", files);
  EXPECT_FALSE(describePipeline(program, checkCompiler(), nullptr, {}));
}

TEST(Diagram, JoinsHitGroupsWithTheSameShaders) {
  const Diagram diagram = diagramOf(modelOf(program::loadProgram("17_records")));
  const auto count = [&](NodeKind kind) { return std::ranges::count(diagram.nodes, kind, &DiagramNode::kind); };
  EXPECT_EQ(count(NodeKind::rayGeneration), 1);
  EXPECT_EQ(count(NodeKind::trace), 3);
  EXPECT_EQ(count(NodeKind::miss), 3);
  EXPECT_EQ(count(NodeKind::hit), 5);  // matt, foil; foil's shadow, no shadow shader; distance
}

TEST(Diagram, WritesDot) {
  const std::string dot = dotText(diagramOf(modelOf(cleanFiles())));
  EXPECT_TRUE(dot.starts_with("digraph pipeline {\n"));
  EXPECT_TRUE(dot.ends_with("}\n"));
  EXPECT_THAT(dot, HasSubstr("trace main.rgen:10\\l"));
  EXPECT_THAT(dot, Not(HasSubstr("penwidth")));
}

TEST(Diagram, WritesSvg) {
  Files files = edited(cleanFiles(), "sky.rmiss", "struct Payload { vec3 color; float t; };",
                       "struct Payload { vec3 color; float t; float more; };");
  files["program.toml"] =
      changed(files["program.toml"], "name = \"surface\"", "name = \"surface\"\nmaterial = \"a<b&c\"");
  const std::string svg = svgText(diagramOf(modelOf(files)));
  EXPECT_TRUE(svg.starts_with("<svg xmlns="));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_THAT(svg, HasSubstr("a&lt;b&amp;c"));
  EXPECT_THAT(svg, HasSubstr(">Q101</text>"));
  EXPECT_THAT(svg, HasSubstr("stroke=\"#c8102e\" stroke-width=\"3\""));
}

TEST(Diagram, NamesTheFileOfTheLectureForm) {
  const std::string svg = svgText(diagramOf(modelOf(program::loadProgram("05_shadow"))));
  EXPECT_THAT(svg, HasSubstr("shadow.rt.glsl"));
  EXPECT_THAT(svg, Not(HasSubstr(".rchit")));
}

}  // namespace
}  // namespace quintet::check
