// SPDX-License-Identifier: Apache-2.0
// A program that averages its own samples reads the frame number and the output of the previous frame.
#include "harness.h"
#include "program/description/parser.h"
#include "run_program.h"

namespace quintet::test {
namespace {

const Files kAccumulationFiles = {
    {"m.rmiss", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n"},
    {"main.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  const vec4 first = loadPrevious(kOutput_first, pixel), second = loadPrevious(kOutput_second, pixel);
  storeOutput(kOutput_first, pixel, first + vec4(1.0, launchFrame(), second.x, pixel.x));
  storeOutput(kOutput_second, pixel, vec4(10.0 + float(launchFrame())));
}
)"}};

std::vector<vec4> renderAccumulating(const std::string& accumulation, std::uint32_t frames) {
  const std::string toml =
      "[program]\nray_generation = \"main.rgen\"\naccumulation = \"" + accumulation +
      "\"\n[[ray]]\nname = \"r\"\nmiss = \"m.rmiss\"\n[[output]]\nname = \"first\"\n[[output]]\nname = \"second\"\n";
  ImageOptions options;
  options.program = program::parseProgram(toml, "test", "<test>", kAccumulationFiles);
  options.width = 3;
  options.height = 1;
  const SceneBuilder scene = namedSquares({"a"});
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(scene.scene.cameras[0], options));
  for (std::uint32_t i = 0; i < frames; ++i) renderer.renderBatch(1);
  std::vector<vec4> values;
  for (std::size_t output = 0; output < 2; ++output) {
    const io::Image image = renderer.image(output);
    const auto p = image.pixel<float>(2, 0);
    values.emplace_back(p[0], p[1], p[2], p[3]);
  }
  return values;
}

TEST(Accumulation, ByTheProgramReadsThePreviousFrame) {
  const std::vector<vec4> values = renderAccumulating("program", 4);
  EXPECT_EQ(values[0], vec4(4.0f, 0 + 1 + 2 + 3, 0 + 10 + 11 + 12, 4 * 2));
  EXPECT_EQ(values[1], vec4(13.0f));
}

TEST(Accumulation, ByTheFilmHasNoPreviousFrame) {
  const std::vector<vec4> values = renderAccumulating("film", 2);
  EXPECT_EQ(values[0].x, 1.0f) << "the mean";
  EXPECT_EQ(values[0].z, 0.0f);
}

}  // namespace
}  // namespace quintet::test
