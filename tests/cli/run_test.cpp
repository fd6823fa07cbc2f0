// SPDX-License-Identifier: Apache-2.0
// `run`: programs by name and by folder, their help, outputs, and parameters from a file.
#include <gmock/gmock.h>

#include "fixtures.h"
#include "io/codec.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using ::testing::HasSubstr;

// The shader writes its parameters to two outputs.
constexpr const char* kRunToml = R"([program]
description = "Two flat colors"
ray_generation = "flat.rgen"
[[ray]]
name = "primary"
miss = "flat.rmiss"
[[output]]
name = "first"
[[output]]
name = "second"
[[parameter]]
name = "tint"
type = "color"
default = [1.0, 0.5, 0.25]
min = 0.0
max = 1.0
help = "The color"
[[parameter]]
name = "count"
type = "int"
default = 2
unit = "pieces"
help = "How many"
[[parameter]]
name = "on"
type = "bool"
default = true
)";
constexpr const char* kRgen = R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  storeOutput(kOutput_first, pixel, loadOutput(kOutput_first, pixel) + vec4(parameters.tint, 1.0));
  const float value = parameters.on != 0u ? float(parameters.count) / 8.0 : 0.0;
  storeOutput(kOutput_second, pixel, loadOutput(kOutput_second, pixel) + vec4(vec3(value), 1.0));
}
)";
constexpr const char* kMiss = "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n";

class Run : public CliTest {
 protected:
  Run() {
    std::filesystem::create_directory(folder_ / "flat");
    write(folder_ / "flat" / "program.toml", kRunToml);
    write(folder_ / "flat" / "flat.rgen", kRgen);
    write(folder_ / "flat" / "flat.rmiss", kMiss);
  }
  RunResult flat(std::vector<std::string> more) {
    std::vector<std::string> arguments{"run", "flat", "--size", "8x4", "--spp", "1", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
  float red(const std::string& file) const { return readImage(file).pixel<float>(3, 2)[0]; }
};

TEST_F(Run, UsesTheBuiltInSceneByDefault) {
  const RunResult result = quintet({"run", "normals", "--size", "32x18", "--spp", "1"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("normals.png: 32x18"));
  const io::Image image = readImage("normals.png");
  EXPECT_EQ(image.width, 32u);
  // The floor at the bottom has the normal (0, 1, 0), shown as 0.5 + 0.5 n.
  ASSERT_EQ(quintet({"run", "normals", "--size", "32x18", "--spp", "1", "-q", "-o", "n.exr"}).status, 0);
  const io::Image exact = readImage("n.exr");
  EXPECT_NEAR(exact.pixel<float>(16, 17)[0], 0.5f, 1e-3f);
  EXPECT_NEAR(exact.pixel<float>(16, 17)[1], 1.0f, 1e-3f);
}

TEST_F(Run, RendersASceneLikeRender) {
  const std::vector<std::string> more{"--size", "32x24", "--spp", "2", "-q", "-o"};
  std::vector<std::string> run{"run", "normals", "scene.gltf"}, render{"render", "scene.gltf", "--program", "normals"};
  run.insert(run.end(), more.begin(), more.end()), run.push_back("a.png");
  render.insert(render.end(), more.begin(), more.end()), render.push_back("b.png");
  ASSERT_EQ(quintet(run).status, 0);
  ASSERT_EQ(quintet(render).status, 0);
  EXPECT_EQ(readImage("a.png").data, readImage("b.png").data);
}

TEST_F(Run, SelectsOutputs) {
  ASSERT_EQ(flat({"-o", "a.exr"}).status, 0);
  EXPECT_NEAR(red("a.exr"), 1.0f, 1e-3f);
  ASSERT_EQ(flat({"-o", "b.exr", "--output", "second"}).status, 0);
  EXPECT_NEAR(red("b.exr"), 0.25f, 1e-3f);
  ASSERT_EQ(flat({"-o", "c.exr", "--all-outputs"}).status, 0);
  EXPECT_EQ(readImage("c.first.exr").data, readImage("a.exr").data);
  EXPECT_EQ(readImage("c.second.exr").data, readImage("b.exr").data);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "c.exr"));
  expectError(flat({"--output", "secnd"}), 2, {"'secnd'", "'second'", "'flat'"});
  expectError(flat({"--output", "second", "--all-outputs"}), 2, {"exclude"});
  expectError(flat({"-o", "-", "--all-outputs"}), 2, {"standard output"});
}

TEST_F(Run, ReadsParametersFromAFile) {
  write(folder_ / "set.json", R"({"tint": [0.5, 0.25, 1], "count": 4, "on": true})");
  ASSERT_EQ(flat({"--set-file", "set.json", "-o", "a.exr", "--all-outputs"}).status, 0);
  EXPECT_NEAR(red("a.first.exr"), 0.5f, 1e-3f);
  EXPECT_NEAR(red("a.second.exr"), 0.5f, 1e-3f);
  // --set overrides the file.
  ASSERT_EQ(flat({"--set-file", "set.json", "--set", "count=6", "-o", "b.exr", "--output", "second"}).status, 0);
  EXPECT_NEAR(red("b.exr"), 0.75f, 1e-3f);
  write(folder_ / "set.json", R"({"tnt": 1})");
  expectError(flat({"--set-file", "set.json"}), 1, {"set.json", "tnt", "'tint'"});
  write(folder_ / "set.json", R"({"tint": {"r": 1}})");
  expectError(flat({"--set-file", "set.json"}), 1, {"set.json", "/tint"});
  write(folder_ / "set.json", "[1]");
  expectError(flat({"--set-file", "set.json"}), 1, {"set.json", "object"});
  write(folder_ / "set.json", "{\"tint\": ");
  expectError(flat({"--set-file", "set.json"}), 1, {"set.json", "JSON"});
  expectError(flat({"--set-file", "none.json"}), 1, {"none.json", "No such file"});
}

TEST_F(Run, PrintsTheHelpOfAProgram) {
  const RunResult text = quintet({"run", "flat", "--help"});
  EXPECT_EQ(text.status, 0) << text.err;
  for (const char* part : {"Two flat colors", "tint", "The color", "color, default 1,0.5,0.25, at least 0, at most 1",
                           "int, default 2 pieces", "bool, default true", "first", "second"})
    EXPECT_THAT(text.out, HasSubstr(part));
  const auto json = nlohmann::json::parse(quintet({"run", "flat", "--help", "--json"}).out);
  EXPECT_EQ(json["name"], "flat");
  EXPECT_EQ(json["outputs"].size(), 2u);
  EXPECT_EQ(json["outputs"][1]["name"], "second");
  EXPECT_EQ(json["parameters"][0]["default"], (nlohmann::json{1.0, 0.5, 0.25}));
  EXPECT_EQ(json["parameters"][0]["max"], 1.0);
  EXPECT_EQ(json["parameters"][1]["default"], 2);
  EXPECT_EQ(json["parameters"][1]["unit"], "pieces");
  EXPECT_TRUE(json["parameters"][1]["max"].is_null());
  EXPECT_EQ(json["parameters"][2]["default"], true);
  const RunResult general = quintet({"run", "--help"});
  EXPECT_EQ(general.status, 0);
  EXPECT_THAT(general.out, HasSubstr("Examples:"));
}

TEST_F(Run, ListsBuiltInPrograms) {
  const RunResult text = quintet({"run", "--list"});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("pathtracer"));
  const auto json = nlohmann::json::parse(quintet({"run", "--list", "--json"}).out);
  EXPECT_EQ(static_cast<std::ptrdiff_t>(json.size()), std::count(text.out.begin(), text.out.end(), '\n'));
  for (const auto& entry : json) EXPECT_FALSE(entry["description"].get<std::string>().empty()) << entry;
}

TEST_F(Run, InvalidCommandLines) {
  expectError(quintet({"run"}), 2, {"program", "--list"});
  expectError(quintet({"run", "pathtracr"}), 2, {"'pathtracr'", "'pathtracer'"});
  expectError(quintet({"run", "flat", "--fraems", "3"}), 2, {"'--fraems'", "'--frames'"});
  expectError(quintet({"run", "flat", "no.glb"}), 1, {"no.glb"});
  expectError(flat({"-o", "out.jpg"}), 2, {"out.jpg"});
}

// In both forms, a warning, --json and the metadata of the image report NaN with the first pixel from the top left.
TEST_F(Run, ReportsPixelsThatAreNotFinite) {
  write(folder_ / "bad.rt.glsl",
        "void main() { /**** RAY GENERATION SHADER ****/ float t = float(gl_LaunchIDEXT.x) + 1.0; bool bad = "
        "gl_LaunchIDEXT.y < 2u && gl_LaunchIDEXT.x == 5u; gsnSetPixel(vec4(bad ? sqrt(-t) : t)); }\n");
  std::string rgen = kRgen;
  rgen.insert(rgen.rfind('}'),
              "  if (pixel == uvec2(5u, 6u) || pixel == uvec2(5u, 7u)) storeOutput(kOutput_second, pixel, "
              "vec4(sqrt(-value - float(pixel.x))));\n");
  write(folder_ / "flat" / "flat.rgen", rgen);
  for (const auto& [program, pixels] : {std::pair{"bad.rt.glsl", "'image' were not finite in at least one frame"},
                                        {"flat", "'second' are not finite"}}) {
    const RunResult result = quintet({"run", program, "--size", "16x8", "--spp", "3", "-o", "out.png", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("warning: 2 pixels of the output " + std::string(pixels) +
                                      "; the first is at pixel (5, 6), counted from the top left corner"));
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["notFinitePixels"], 2);
    EXPECT_EQ(json["firstNotFinitePixel"], nlohmann::json({5, 6}));
    EXPECT_EQ(json["warnings"].size(), 1u);
    const std::string info = quintet({"info", "out.png"}).out;
    EXPECT_THAT(info, HasSubstr("NotFinitePixels"));
    EXPECT_THAT(info, HasSubstr("5,6"));
  }
}

TEST_F(Run, ReportsTheFirstDiscardedSample) {
  std::string rgen = kRgen;
  rgen.insert(rgen.rfind('}'), "  countRays(pixel, 1u, pixel.x == 7u && pixel.y >= 2u ? 1u : 0u);\n");
  write(folder_ / "flat" / "flat.rgen", rgen);
  const RunResult result = quintet({"run", "flat", "--size", "16x4", "--spp", "4", "-o", "out.png", "--json"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("8 samples were not finite"), HasSubstr("pixel (7, 2)")));
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["droppedSamples"], 8);
  EXPECT_EQ(json["firstDroppedSample"], nlohmann::json({7, 2}));
  EXPECT_TRUE(json["firstNotFinitePixel"].is_null());
  // merge reports what the film stores.
  ASSERT_EQ(
      quintet({"render", "scene.gltf", "--program", "flat", "--size", "16x4", "--spp", "4", "-o", "out.qfilm", "-q"})
          .status,
      0);
  const RunResult merged = quintet({"merge", "out.qfilm", "-o", "merged.png", "--json"});
  EXPECT_THAT(merged.err, AllOf(HasSubstr("8 samples were not finite"), HasSubstr("pixel (7, 2)")));
  EXPECT_EQ(nlohmann::json::parse(merged.out)["warnings"].size(), 1u);
}

}  // namespace
}  // namespace quintet::test
