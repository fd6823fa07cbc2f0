// SPDX-License-Identifier: Apache-2.0
// NaN and infinity in the outputs of any program are counted on the device, with the first pixel.
#include <gmock/gmock.h>

#include "../program/run_program.h"
#include "harness.h"
#include "job/scene_source.h"
#include "program/description/parser.h"
#include "program/lecture/lecture.h"

namespace quintet::test {
namespace {

using render::NotFinitePixels;
using testing::ElementsAre;
using testing::IsEmpty;

// `color` is NaN at the pixels of `badColor`, in one sample and in one component, the next one in each column; `depth` is
// infinite at those of `badDepth`.
Files programFiles(const std::string& badColor, const std::string& badDepth) {
  const std::string head = "#version 460\n#extension GL_EXT_ray_tracing : require\n";
  return {{"m.rmiss", head + "void main() {}\n"},
          {"main.rgen", head + R"(
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  const float t = float(pixel.x) + 1.0;
  vec4 value = vec4(t, 1.0, 2.0, 1.0);
  if ((launch.firstSample == 1u || kAccumulates) && ()" +
                            badColor + R"()) value[pixel.x & 3u] = sqrt(-t);
#ifdef QUINTET_OUTPUT_depth
  if (launch.firstSample == 0u) storeOutput(kOutput_depth, pixel, vec4(()" +
                            badDepth + R"() ? uintBitsToFloat(0x7F800000u) : t));
#endif
  storeOutput(kOutput_color, pixel, (kAccumulates ? vec4(0.0) : loadOutput(kOutput_color, pixel)) + value);
}
)"}};
}

render::FilmState renderFilm(const std::string& accumulation, const std::string& badColor, const std::string& badDepth,
                             render::Region region, std::vector<NotFinitePixels>& found) {
  // A program that accumulates has no optional outputs.
  const bool film = accumulation == "film";
  const std::string depth = "[[output]]\nname = \"depth\"\npixel = \"center\"\noptional = true\n";
  const std::string toml = "[program]\nray_generation = \"main.rgen\"\naccumulation = \"" + accumulation +
                           "\"\n[[ray]]\nname = \"r\"\nmiss = \"m.rmiss\"\n[[output]]\nname = \"color\"\n" +
                           (film ? depth : "");
  const program::Program program = program::parseProgram(toml, "test", "<test>", programFiles(badColor, badDepth));
  const SceneBuilder scene = namedSquares({"a"});
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.program = program;
  options.width = 40;
  options.height = 30;
  render::RenderSettings settings = settingsFor(scene.scene.cameras[0], options);
  settings.region = region;
  if (film) settings.outputs = {"depth"};
  render::Defines defines{{"kAccumulates", film ? "false" : "true"}};
  if (film) defines.emplace_back(program::outputMacro("depth"), "1");
  render::Renderer renderer = makeRenderer(device, program, settings, defines);
  renderer.renderBatch();
  found = renderer.notFinitePixels();
  return renderer.saveFilm();
}

TEST(NotFinite, AreCountedInAllOutputsWithTheFirstPixel) {
  for (const char* accumulation : {"film", "program"}) {
    std::vector<NotFinitePixels> found;
    const std::string badDepth = std::string(accumulation) == "film" ? "pixel.y >= 28u" : "false";
    const render::FilmState film =
        renderFilm(accumulation, "pixel.x + pixel.y == 37u && pixel.y > 5u", badDepth, {}, found);
    std::vector<NotFinitePixels> expected{{"color", 24, {31, 6}}};
    if (badDepth != "false") expected.push_back({"depth", 80, {0, 28}});
    EXPECT_EQ(found, expected) << accumulation;
    EXPECT_EQ(found, render::findNotFinite(film)) << accumulation << ": as on the host";
  }
}

TEST(NotFinite, AreNotReportedForFiniteOutputs) {
  for (const char* accumulation : {"film", "program"}) {
    std::vector<NotFinitePixels> found;
    renderFilm(accumulation, "false", "false", {}, found);
    EXPECT_THAT(found, IsEmpty()) << accumulation;
  }
}

TEST(NotFinite, HaveThePixelOfTheWholeImage) {
  std::vector<NotFinitePixels> found;
  renderFilm("film", "pixel == uvec2(25u, 13u)", "false", {20, 10, 8, 6}, found);
  EXPECT_THAT(found, ElementsAre(NotFinitePixels{"color", 1, {25, 13}}));
}

// In the lecture form, row 0 of gl_LaunchIDEXT is the bottom. The report counts from the top.
TEST(NotFinite, AreCountedInTheLectureForm) {
  const program::Program program = program::parseLecture(
      "void main() { /**** RAY GENERATION SHADER ****/ float t = float(gl_LaunchIDEXT.x) + 1.0; bool bad = "
      "gl_LaunchIDEXT.y == 2u && gl_LaunchIDEXT.x > 6u; gsnSetPixel(vec4(bad ? sqrt(-t) : t, t, t, 1.0)); }\n",
      "demo.rt.glsl", "here");
  const SceneBuilder scene = namedSquares({"a"});
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.program = program;
  options.width = 16;
  options.height = 10;
  render::Renderer renderer = makeRenderer(device, program, settingsFor(scene.scene.cameras[0], options));
  renderer.renderBatch(2);
  EXPECT_THAT(renderer.notFinitePixels(), ElementsAre(NotFinitePixels{"image", 9, {7, 7}}));
}

// Later frames overwrite the value. Each pixel counts once.
TEST(NotFinite, AreCountedInAllFrames) {
  const program::Program program = program::parseLecture(
      "void main() { /**** RAY GENERATION SHADER ****/ float t = float(gl_LaunchIDEXT.x) + 1.0; bool bad = "
      "(frameID == 1 || frameID == 2) && gl_LaunchIDEXT.y == 2u && gl_LaunchIDEXT.x > 6u; gsnSetPixel(vec4(bad ? "
      "sqrt(-t) : t, t, t, 1.0)); }\n",
      "demo.rt.glsl", "here");
  const SceneBuilder scene = namedSquares({"a"});
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.program = program;
  options.width = 16;
  options.height = 10;
  render::Renderer renderer = makeRenderer(device, program, settingsFor(scene.scene.cameras[0], options));
  renderer.renderBatch(1);
  EXPECT_THAT(renderer.notFinitePixels(), IsEmpty());
  renderer.renderBatch(3);
  EXPECT_THAT(render::findNotFinite(renderer.saveFilm()), IsEmpty());
  EXPECT_THAT(renderer.notFinitePixels(), ElementsAre(NotFinitePixels{"image", 9, {7, 7}}));
  renderer.restart();
  renderer.renderBatch(1);
  EXPECT_THAT(renderer.notFinitePixels(), IsEmpty());
}

TEST(NotFinite, AreCountedInEachOutputThatAccumulates) {
  const program::Program program = program::parseProgram(
      "[program]\nray_generation = \"main.rgen\"\naccumulation = \"program\"\n[[ray]]\nname = \"r\"\nmiss = "
      "\"m.rmiss\"\n[[output]]\nname = \"color\"\n[[output]]\nname = \"second\"\n[[output]]\nname = \"third\"\n",
      "test", "<test>",
      {{"m.rmiss", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n"},
       {"main.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  const float t = float(pixel.x) + 1.0, nan = sqrt(-t);
  storeOutput(kOutput_color, pixel, vec4(launchFrame() == 0u && pixel == uvec2(4u, 2u) ? nan : t));
  storeOutput(kOutput_second, pixel, vec4(t));
  storeOutput(kOutput_third, pixel, vec4(launchFrame() == 0u && pixel.x == 4u ? nan : t));
}
)"}});
  const SceneBuilder scene = namedSquares({"a"});
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.program = program;
  options.width = 16;
  options.height = 10;
  render::Renderer renderer = makeRenderer(device, program, settingsFor(scene.scene.cameras[0], options));
  renderer.renderBatch(2);
  EXPECT_THAT(renderer.notFinitePixels(),
              ElementsAre(NotFinitePixels{"color", 1, {4, 2}}, NotFinitePixels{"third", 10, {4, 0}}));
}

// What programs call to decide which samples they discard.
TEST(NotFinite, IsFiniteTestsEachComponentForBoth) {
  const std::string toml =
      "[program]\nray_generation = \"main.rgen\"\n[[ray]]\nname = \"r\"\nmiss = \"m.rmiss\"\n[[output]]\nname = "
      "\"color\"\n";
  const Outputs outputs = runProgram(toml, {{"m.rmiss", "void main() {}\n"}, {"main.rgen", R"(
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  const float infinity = uintBitsToFloat(0x7F800000u), nan = sqrt(-1.0 - float(pixel.x));
  vec4 value = vec4(3e38, -3e38, 0.0, 1.0);
  if (pixel.x > 0u) value[pixel.x % 4u] = pixel.x > 8u ? nan : pixel.x > 4u ? -infinity : infinity;
  storeOutput(kOutput_color, pixel, vec4(vec3(isFinite(value) ? 1.0 : 0.5), 1.0));
}
)"}},
                                     namedSquares({"a"}), 13);
  for (std::size_t i = 0; i < 13; ++i) EXPECT_EQ(outputs[0][i].x, i == 0 ? 1.0f : 0.5f) << i;
}

// Samples that a program discards are counted by the program; the first pixel is the first one row by row.
TEST(NotFinite, DroppedSamplesHaveAFirstPixel) {
  const std::vector<uvec2> statistics{{5, 0}, {5, 0}, {5, 0}, {5, 2}, {5, 0}, {5, 1}};
  const render::RayCount count = render::countRays(statistics, {10, 20, 3, 2});
  EXPECT_EQ(count.rays, 30u);
  EXPECT_EQ(count.droppedSamples, 3u);
  EXPECT_EQ(count.firstDropped, uvec2(10, 21));
}

}  // namespace
}  // namespace quintet::test
