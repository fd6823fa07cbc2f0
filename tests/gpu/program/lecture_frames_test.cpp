// SPDX-License-Identifier: Apache-2.0
// Pixels, frames and inputs of the lecture form: where gsnSetPixel writes, the previous frame, uniforms and images; and the
// image file shows the written values.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness.h"
#include "io/codec.h"
#include "lecture_run.h"
#include "render/tone_map/tone_map.h"

namespace quintet::test {
namespace {

std::string rayGeneration(const std::string& body) {
  return "void main() { /**** RAY GENERATION SHADER ****/\n" + body + "\n}\n";
}

scene::Scene oneSquare() {
  scene::Scene scene;
  scene.meshes.emplace_back().geometries = {quad({-1, 0.5f, -2}, {2, 0, 0}, {0, 0.5f, 0})};
  scene.instances.emplace_back().mesh = 0;
  return scene;
}

const std::string kLaunch = rayGeneration("gsnSetPixel(vec4(gl_LaunchIDEXT.xy, gl_LaunchSizeEXT.xy));");

TEST(LectureFrames, LaunchIndexStartsAtTheLowerLeft) {
  for (const double seconds : {0.25, 1e-9}) {  // the second gives strips of one row
    const LectureImage image =
        runLecture(kLaunch, oneSquare(), {.width = 5, .height = 7, .frames = 2, .launchSeconds = seconds});
    for (std::uint32_t row = 0; row < 7; ++row)
      for (std::uint32_t x = 0; x < 5; ++x) EXPECT_EQ(image.at(x, row), vec4(x, row, 5, 7));
  }
}

TEST(LectureFrames, RegionKeepsTheWholeLaunchSize) {
  const LectureImage image = runLecture(kLaunch, oneSquare(), {.width = 9, .height = 8, .region = {2, 1, 3, 4}});
  ASSERT_EQ(image.width, 3u);
  ASSERT_EQ(image.height, 4u);
  // Rows 1 … 4 from the top of 8 are 6 … 3 from the bottom.
  for (std::uint32_t row = 0; row < 4; ++row)
    for (std::uint32_t x = 0; x < 3; ++x) EXPECT_EQ(image.at(x, row), vec4(2 + x, 3 + row, 9, 8));
}

// With the camera of the lectures, points above the axis are in the upper half of the image.
TEST(LectureFrames, ImagesAreUpright) {
  const std::string text = R"(struct RayPayloadType { vec3 color; };
)" + rayGeneration(R"(
  vec2 texCoord = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy);
  vec2 pos = 2.0 * (texCoord - 0.5);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0), 0.001, normalize(vec3(pos.x, pos.y, -2.0)), 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));)") +
                           "void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(1.0); }\n"
                           "void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }\n";
  const LectureImage image = runLecture(text, oneSquare(), {.width = 8, .height = 8});
  EXPECT_EQ(image.pixels[8 * 1 + 4].x, 1.0f);  // second row from the top: y / z = 0.3125
  EXPECT_EQ(image.pixels[8 * 6 + 4].x, 0.0f);
}

TEST(LectureFrames, FramesReadThePreviousFrame) {
  const std::string text = rayGeneration(R"(
  if (gl_LaunchIDEXT.x == 3u) return;
  vec4 before = gsnGetPreviousPixel();
  gsnSetPixel(before + vec4(1.0, frameID, frameSize, before.x));)");
  const LectureImage one = runLecture(text, oneSquare(), {.width = 4, .height = 2, .frames = 1, .launchSeconds = 1e-9});
  EXPECT_EQ(one.at(0), vec4(1, 0, 1, 0));
  const LectureImage four =
      runLecture(text, oneSquare(), {.width = 4, .height = 2, .frames = 4, .launchSeconds = 1e-9});
  EXPECT_EQ(four.at(2, 1), vec4(4, 0 + 1 + 2 + 3, 4 * 4, 0 + 1 + 2 + 3));
  EXPECT_EQ(four.at(3, 1), vec4(0));  // unset pixels are 0
}

struct LectureRenderer {
  scene::Scene scene = oneSquare();
  render::DeviceScene device{testContext(), scene::Scene(scene), scene::Environment{}};
  render::RenderSettings settings;
  render::Renderer make(const std::string& text, std::uint32_t width = 4, std::uint32_t height = 4) {
    const program::Program program = program::parseLecture(text, "test.rt.glsl", "test");
    settings.width = width;
    settings.height = height;
    settings.timeoutSeconds = 600;
    settings.parameters = program::ParameterValues(program.parameters);
    return makeRenderer(device, program, settings);
  }
};

TEST(LectureFrames, RenderFrameSetsTheIndex) {
  LectureRenderer r;
  render::Renderer renderer = r.make(rayGeneration("gsnSetPixel(gsnGetPreviousPixel() * 100.0 + float(frameID));"));
  renderer.renderFrame(7);
  renderer.renderFrame(3);
  EXPECT_EQ(renderer.film().download(0).pixel<float>(0, 0)[0], 703.0f);
  // renderBatch renders the next frames.
  renderer.renderBatch(2);
  EXPECT_EQ(renderer.statistics().samples, 4u);
  EXPECT_EQ(renderer.film().download(0).pixel<float>(0, 0)[0], 7030203.0f);
}

TEST(LectureFrames, CanceledFrameKeepsThePreviousOne) {
  LectureRenderer r;
  r.settings.launchSeconds = 1e-9;
  render::Renderer renderer = r.make(rayGeneration("gsnSetPixel(vec4(1.0 + float(frameID)));"), 4, 8);
  EXPECT_TRUE(renderer.renderFrame(0));
  EXPECT_FALSE(renderer.renderFrame(1, [](double done) { return done < 0.5; }));
  EXPECT_EQ(renderer.statistics().samples, 1u);
  EXPECT_EQ(renderer.film().download(0).pixel<float>(0, 0)[0], 1.0f);
  EXPECT_TRUE(renderer.renderFrame(1));
  EXPECT_EQ(renderer.film().download(0).pixel<float>(0, 7)[0], 2.0f);
}

// The byte in the image file is the value times 255, without tone mapping or another sRGB encoding.
TEST(LectureFrames, FileShowsTheWrittenValues) {
  LectureRenderer r;
  const std::string text = rayGeneration("gsnSetPixel(vec4(float(gl_LaunchIDEXT.x) / 255.0, 2.0, -1.0, 0.5));");
  render::Renderer renderer = r.make(text, 256, 1);
  renderer.renderFrame(0);
  const io::Image shown = render::toDisplay(renderer.image(), render::ToneMap::linear, 0.0f, true);
  for (std::uint32_t x = 0; x < 256; ++x) {
    EXPECT_EQ(shown.pixel<std::uint8_t>(x, 0)[0], x);
    EXPECT_EQ(shown.pixel<std::uint8_t>(x, 0)[1], 255);
    EXPECT_EQ(shown.pixel<std::uint8_t>(x, 0)[2], 0);
  }
  r.settings.transparent = true;
  render::Renderer transparent = r.make(text, 256, 1);
  transparent.renderFrame(0);
  const io::Image half = render::toDisplay(transparent.image(), render::ToneMap::linear, 0.0f, false);
  EXPECT_EQ(half.pixel<std::uint8_t>(200, 0)[0], 200);
  EXPECT_EQ(half.pixel<std::uint8_t>(200, 0)[3], 128);
}

TEST(LectureInputs, UniformsHaveDefaultsOrSetValues) {
  const std::string text = R"(uniform float a; // defaultval="0.25" min="0" max="1"
uniform vec3 b = vec3(1.0, 2.0, 3.0);
uniform int c; // help="none"
uniform bool d; // defaultval="true"
uniform vec2 e, f; // defaultval="4, 5"
uniform vec4 tintColor; // defaultval="1"
uniform uint g = 7;
uniform int frameID;
float twice(float a) { return 2.0 * a; }
)" + rayGeneration(R"(
  gsnSetPixel(gl_LaunchIDEXT.x == 0u ? vec4(a, b) : gl_LaunchIDEXT.x == 1u ? vec4(c, d ? 1.0 : 0.0, e.y, f.x)
            : gl_LaunchIDEXT.x == 2u ? tintColor : vec4(twice(3.0), g, frameID, userParam1 + userParam0));)");
  const LectureImage given = runLecture(text, oneSquare());
  EXPECT_EQ(given.at(0), vec4(0.25f, 1, 2, 3));
  EXPECT_EQ(given.at(1), vec4(0, 1, 5, 4));
  EXPECT_EQ(given.at(2), vec4(1));
  EXPECT_EQ(given.at(3), vec4(6, 7, 0, 0));
  const LectureImage set =
      runLecture(text, oneSquare(), {.set = {"a=0.5", "b=4,5,6", "c=-3", "d=false", "userParam1=0.75"}});
  EXPECT_EQ(set.at(0), vec4(0.5f, 4, 5, 6));
  EXPECT_EQ(set.at(1), vec4(-3, 0, 5, 4));
  EXPECT_EQ(set.at(3), vec4(6, 7, 0, 0.75f));
}

// Returns an image of 2 x 2 pixels: upper row red and green, lower row blue and gray.
std::string smallImage() {
  io::Image image = io::makeImage(2, 2, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  const std::vector<std::uint8_t> bytes{255, 0, 0, 0, 255, 0, 0, 0, 255, 128, 128, 128};
  std::ranges::copy(bytes, image.samples<std::uint8_t>().begin());
  const std::vector<std::byte> png = io::encodePng(image, {});
  return std::string(reinterpret_cast<const char*>(png.data()), png.size());
}

TEST(LectureInputs, ImagesStartAtTheLowerLeft) {
  const std::string text = R"(uniform sampler2D photo; // defaultval="small.png"
vec4 look(sampler2D image, vec2 st) { return texture(image, st); }
)" + rayGeneration(R"(
  uint x = gl_LaunchIDEXT.x;
  gsnSetPixel(x == 0u ? look(photo, vec2(0.25)) : x == 1u ? look(photo, vec2(0.75, 0.25)) : x == 2u ? textureLod(photo, vec2(0.25, 0.75), 0.0)
            : x == 3u ? texelFetch(photo, ivec2(1, 1), 0) : x == 4u ? vec4(textureSize(photo, 0), 0.0, 1.0) : x == 5u ? texture(texture3, vec2(0.5))
            : x == 6u ? texelFetch(photo, ivec2(0), 0) : x == 7u ? texelFetch(photo, ivec2(2, 0), 0) : vec4(textureSize(texture3, 0), 0.0, 1.0));)");
  const LectureImage p = runLecture(text, oneSquare(), {.width = 9}, {{"small.png", smallImage()}});
  EXPECT_EQ(p.at(0), vec4(0, 0, 1, 1));
  EXPECT_NEAR(p.at(1).x, 128.0f / 255.0f, 1e-3f);  // the byte itself, not decoded
  EXPECT_EQ(p.at(2), vec4(1, 0, 0, 1));
  EXPECT_EQ(p.at(3), vec4(0, 1, 0, 1));
  EXPECT_EQ(p.at(4), vec4(2, 2, 0, 1));
  EXPECT_EQ(p.at(5), vec4(1)) << "without an image";
  EXPECT_EQ(p.at(6), vec4(0, 0, 1, 1));
  EXPECT_EQ(p.at(7), vec4(0)) << "outside of the image";
  EXPECT_EQ(p.at(8), vec4(1, 1, 0, 1)) << "without an image";
}

}  // namespace
}  // namespace quintet::test
