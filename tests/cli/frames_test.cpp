// SPDX-License-Identifier: Apache-2.0
// `run` with programs that render frame by frame: number of frames, written frames, file names.
#include <algorithm>
#include <cmath>
#include <csignal>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"
#include "io/exr/exr.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Red: the current frame. Green: mean of 16 · frameID, accumulated with gsnGetPreviousPixel. Blue: number of frames.
constexpr const char* kProgram = R"(
void main() { /**** RAY GENERATION SHADER ****/
  float sum = gsnGetPreviousPixel().g * 255.0 * float(frameID) + 16.0 * float(frameID);
  gsnSetPixel(vec4(float(frameID) * 16.0 / 255.0, sum / float(frameID + 1) / 255.0, float(frameSize) / 255.0, 1.0));
}
)";

class Frames : public CliTest {
 protected:
  Frames() { write(folder_ / "count.rt.glsl", kProgram); }
  RunResult runCount(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"run", "count.rt.glsl", "--size", "8x8"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
  std::vector<int> pixel(const std::string& file) const {
    const auto bytes = readImage(file).pixel<std::uint8_t>(3, 5);
    return {bytes[0], bytes[1], bytes[2]};
  }
};

TEST_F(Frames, OneByDefault) {
  const RunResult result = runCount({});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("count.png: 8x8, 1 frame, "));
  EXPECT_THAT(pixel("count.png"), ElementsAre(0, 0, 1));
}

TEST_F(Frames, WritesTheLastFrame) {
  const RunResult result = runCount({"--frames", "5"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("count.png: 8x8, 5 frames, "));
  EXPECT_THAT(pixel("count.png"), ElementsAre(64, 32, 5));
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"count.png", "count.rt.glsl", "scene.gltf"}));
  ASSERT_EQ(runCount({"--spp", "3", "-q"}).status, 0);  // as --frames
  EXPECT_THAT(pixel("count.png"), ElementsAre(32, 16, 3));
}

TEST_F(Frames, WritesAllFrames) {
  ASSERT_EQ(runCount({"--frames", "3", "-o", "a_%02d.png", "-q"}).status, 0);
  ASSERT_EQ(runCount({"--frames", "2", "--all-frames", "-o", "b.png", "-q"}).status, 0);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"a_00.png", "a_01.png", "a_02.png", "b.0000.png", "b.0001.png",
                                                   "count.rt.glsl", "scene.gltf"}));
  EXPECT_THAT(pixel("a_00.png"), ElementsAre(0, 0, 3));
  EXPECT_THAT(pixel("a_02.png"), ElementsAre(32, 16, 3));
  EXPECT_THAT(pixel("b.0001.png"), ElementsAre(16, 8, 2));
  const auto data = io::readMetadata(readFile(folder_ / "a_01.png"), "a_01.png");
  EXPECT_NE(std::ranges::find(data, std::pair<std::string, std::string>("Frame", "1")), data.end());
}

// The frames 1 and 2 are not finite in two pixels. The image has the last frame, whose pixels are finite.
TEST_F(Frames, ReportsPixelsThatWereNotFiniteInAnyFrame) {
  write(folder_ / "bad.rt.glsl", R"(#include <quintet/output.glsl>
void main() { /**** RAY GENERATION SHADER ****/
  float t = float(gl_LaunchIDEXT.x) + 1.0;
  bool bad = (frameID == 1 || frameID == 2) && gl_LaunchIDEXT.y < 2u && gl_LaunchIDEXT.x == 5u;
  if (gl_LaunchIDEXT.xy == uvec2(3u, 4u)) countRays(uvec2(3u, 4u), 1u, frameID == 1 ? 1u : 0u);
  gsnSetPixel(vec4(bad ? sqrt(-t) : 0.5));
}
)");
  for (const bool all : {false, true}) {
    std::vector<std::string> command{"run", "bad.rt.glsl", "--size",  "16x8",  "--frames",
                                     "4",   "-o",          "out.png", "--json"};
    if (all) command.emplace_back("--all-frames");
    const RunResult result = quintet(command);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err,
                HasSubstr("warning: 2 pixels of the output 'image' were not finite in at least one frame; the first is "
                          "at pixel (5, 6), counted from the top left corner"));
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["notFinitePixels"], 2) << all;
    EXPECT_EQ(json["droppedSamples"], 1) << all;
  }
  const RunResult check = quintet({"check", "bad.rt.glsl", "--instrument", "--spp", "4", "--size", "16x8"});
  EXPECT_EQ(check.status, 1);
  EXPECT_THAT(check.err, AllOf(HasSubstr("'image' is not finite"), HasSubstr("pixel 5, 6"), HasSubstr("2 such")));
}

TEST_F(Frames, RenderCommandRendersSppFrames) {
  const RunResult result =
      quintet({"render", "scene.gltf", "--program", "count.rt.glsl", "--spp", "5", "--size", "8x8", "-q"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(pixel("scene.png"), ElementsAre(64, 32, 5));
}

TEST_F(Frames, StopsAtTheTimeLimit) {
  const RunResult result = runCount({"--time", "0.2", "-q", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_GE(nlohmann::json::parse(result.out)["samples"], 2);
  EXPECT_EQ(pixel("count.png")[2], 0);  // the number of frames is unknown
}

TEST_F(Frames, InterruptWritesTheCurrentFrame) {
  TerminalRun process({"run", "count.rt.glsl", "--size", "64x64", "--time", "100000"}, folder_.path());
  ASSERT_TRUE(process.waitFor(" left"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_THAT(result.err, HasSubstr("interrupted"));
  EXPECT_EQ(readImage("count.png").width, 64u);
}

TEST_F(Frames, WatchRestartsTheAnimation) {
  TerminalRun process({"run", "count.rt.glsl", "--size", "8x8", "--frames", "4", "--watch"}, folder_.path());
  ASSERT_TRUE(process.waitForNext("8x8, 4 frames"));
  EXPECT_THAT(pixel("count.png"), ElementsAre(48, 24, 4));
  std::string text = kProgram;
  text.replace(text.find("float(frameSize)"), 16, "200.0");
  write(folder_ / "count.rt.glsl", text);
  ASSERT_TRUE(process.waitForNext("count.rt.glsl saved: "));
  ASSERT_TRUE(process.waitForNext("8x8, 4 frames"));
  EXPECT_THAT(pixel("count.png"), ElementsAre(48, 24, 200));
  text.replace(text.find("200.0"), 5, "undefined");
  write(folder_ / "count.rt.glsl", text);
  ASSERT_TRUE(process.waitForNext("count.rt.glsl:4:"));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().status, 0);
}

// A program without accumulation of its own, and a quad that moves out of the image.
constexpr const char* kMovingQuad =
    "[[file]]\nname = \"quad\"\npath = \"scene.gltf\"\n"
    "[[instance]]\nof = \"quad\"\n"
    "keyframes = [{ frame = 0 }, { frame = 2, translate = [8.0, 0.0, 0.0] }]\n"
    "[[camera]]\nlook_from = [0, 0, 4]\nlook_at = [0, 0, 0]\n";

TEST_F(Frames, AnimatedScenes) {
  write(folder_ / "moving.scene.toml", kMovingQuad);
  const std::vector<std::string> run{"run",   "normals", "moving.scene.toml", "--size", "16x12", "--spp", "4", "-q",
                                     "--env", "none"};
  auto all = run, numbered = run;
  all.insert(all.end(), {"--frames", "3", "-o", "m.%d.exr"});
  numbered.insert(numbered.end(), {"--frames", "1-2", "-o", "n.exr"});
  const RunResult result = quintet(all);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NEAR(readImage("m.0.exr").pixel<float>(8, 6)[2], 1.0f, 0.01f);  // normal of the quad, which faces the camera
  EXPECT_NEAR(readImage("m.2.exr").pixel<float>(8, 6)[2], 0.0f, 0.01f);  // outside of the image
  EXPECT_NE(readImage("m.1.exr").data, readImage("m.0.exr").data);
  // Without a pattern, no frame is lost.
  ASSERT_EQ(quintet(numbered).status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "n.exr"));
  EXPECT_EQ(readImage("n.0001.exr").data, readImage("m.1.exr").data);
  EXPECT_EQ(readImage("n.0002.exr").data, readImage("m.2.exr").data);
  auto single = run, piped = run, film = run;
  single.insert(single.end(), {"--frames", "1", "-o", "one.exr"});
  EXPECT_EQ(quintet(single).status, 0);
  EXPECT_EQ(readImage("one.exr").data, readImage("m.0.exr").data);
  piped.insert(piped.end(), {"--frames", "2", "-o", "-"});
  expectError(quintet(piped), 2, {"standard output takes one image"});
  expectError(quintet({"render", "moving.scene.toml", "--frames", "2", "-o", "a.qfilm", "-q"}), 2,
              {"a film holds one frame"});
}

// The time of a frame is its own, not that of all frames so far; the rays of the report are those of all.
TEST_F(Frames, TimesAndRaysOfAnimations) {
  write(folder_ / "moving.scene.toml", kMovingQuad);
  const RunResult result =
      quintet({"render", "moving.scene.toml", "--program", "normals", "--size", "32x24", "--spp", "256", "--env",
               "none", "--frames", "6", "--fps", "23.976", "-o", "f#.exr", "-q", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  double sum = 0, largest = 0, rounding = 0;
  std::uint64_t rays = 0;
  for (int frame = 0; frame < 6; ++frame) {
    const std::string name = fmt::format("f{}.exr", frame);
    const std::vector<std::byte> bytes = readFile(folder_ / name);
    double seconds = 0;
    for (const auto& [key, text] : io::readMetadata(bytes, name)) {
      if (key == "Seconds") seconds = std::stod(text);
      if (key == "Rays") rays += std::stoull(text);
    }
    EXPECT_NEAR(json["frames"][static_cast<std::size_t>(frame)]["seconds"].get<double>(), seconds, 1e-5);
    sum += seconds;
    rounding +=
        0.5 * std::pow(10.0, std::floor(std::log10(seconds)) - 5.0);  // the metadata have six significant digits
    largest = std::max(largest, seconds);
    const io::ExrImage image = io::decodeExr(bytes, name);
    const auto attribute = [&](const char* key) {
      const auto found = std::ranges::find(image.attributes, key, &io::ExrAttribute::name);
      return found == image.attributes.end() ? io::ExrValue() : found->value;
    };
    EXPECT_EQ(attribute("framesPerSecond"), io::ExrValue(io::ExrRational{24000, 1001}));
  }
  EXPECT_LT(largest, 0.9 * sum);
  EXPECT_NEAR(json["seconds"]["render"].get<double>(), sum, rounding);
  EXPECT_EQ(json["rays"], rays);
}

// The frames of an animation that is split over processes are those of the whole one.
TEST_F(Frames, PartsOfAnAnimation) {
  std::string slow = kMovingQuad;
  slow.replace(slow.find("8.0"), 3, "1.0");  // visible in all frames
  write(folder_ / "moving.scene.toml", slow);
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"run",   "normals", "moving.scene.toml", "--size", "16x12", "--spp", "4", "-q",
                                       "--env", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  };
  const RunResult whole = run({"--frames", "3", "-o", "w####.png", "--json"});
  ASSERT_EQ(whole.status, 0) << whole.err;
  EXPECT_EQ(nlohmann::json::parse(whole.out)["files"],
            (nlohmann::json{"w0000.png", "w0001.png", "w0002.png"}));  // not only the last one
  const RunResult part = run({"--frames", "1-2", "-o", "p##.png", "--json"});
  ASSERT_EQ(part.status, 0) << part.err;
  EXPECT_EQ(nlohmann::json::parse(part.out)["files"], (nlohmann::json{"p01.png", "p02.png"}));
  ASSERT_EQ(run({"--frame", "1", "-o", "single.png"}).status, 0);
  ASSERT_EQ(run({"--frame", "2", "-o", "s#.png"}).status, 0);
  EXPECT_EQ(readImage("p01.png").data, readImage("w0001.png").data);
  EXPECT_EQ(readImage("p02.png").data, readImage("w0002.png").data);
  EXPECT_EQ(readImage("single.png").data, readImage("w0001.png").data);
  EXPECT_EQ(readImage("s2.png").data, readImage("w0002.png").data);
  EXPECT_NE(readImage("w0001.png").data, readImage("w0002.png").data);
  // A program that accumulates needs the frames before.
  expectError(runCount({"--frames", "1-2"}), 2, {"frames 1–2", "'count'", "accumulates"});
  expectError(runCount({"--frame", "0"}), 2, {"accumulates"});
  for (const char* range : {"2-1", "1-", "-1", "1-2-3", "a-b", "0-1000000"})
    expectError(run({"--frames", range}), 2, {"--frames", range});
  expectError(run({"--frames", "1-2", "--frame", "3"}), 2, {"--frame", "--frames"});
}

// A pattern in the name is replaced also without frames, and by `render`.
TEST_F(Frames, PatternOfAStillImage) {
  for (const char* command : {"run", "render"}) {
    std::vector<std::string> arguments{command, "--size", "8x8", "--spp", "1", "-q", "-o", "f####.png"};
    if (std::string(command) == "run")
      arguments.insert(arguments.begin() + 1, {"normals", "scene.gltf"});
    else
      arguments.insert(arguments.begin() + 1, {"scene.gltf", "--program", "normals"});
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(fileNames(), (std::vector<std::string>{"count.rt.glsl", "f0000.png", "scene.gltf"})) << command;
    std::filesystem::remove(folder_ / "f0000.png");
  }
  // The default name is no pattern.
  std::filesystem::rename(folder_ / "scene.gltf", folder_ / "a#b#.gltf");
  ASSERT_EQ(quintet({"render", "a#b#.gltf", "--program", "normals", "--size", "8x8", "--spp", "1", "-q"}).status, 0);
  EXPECT_EQ(readImage("a#b#.png").width, 8u);
}

// An animation that moves nothing, and none.
TEST_F(Frames, GltfAnimations) {
  nlohmann::json json = quadScene();
  json["animations"] = nlohmann::json::parse(R"([{"channels": [], "samplers": []}])");
  write(folder_ / "fox.gltf", json.dump());
  expectError(quintet({"run", "normals", "fox.gltf", "--frames", "4", "--size", "8x8", "-q", "--env", "none"}), 2,
              {"fox.gltf: 1 glTF animation is not played", "keyframes", "scenes.md"});
  expectError(quintet({"run", "normals", "scene.gltf", "--frames", "4", "--size", "8x8", "-q", "--env", "none"}), 2,
              {"scene.gltf: the scene has neither keyframes nor an animation"});
}

// A scene without animation has one frame, whose name gets no number.
TEST_F(Frames, AllFramesOfAStillScene) {
  const std::vector<std::string> arguments{"run", "normals", "scene.gltf", "--size", "8x8",   "--spp",       "1",
                                           "-q",  "--env",   "none",       "-o",     "a.png", "--all-frames"};
  const RunResult result = quintet(arguments);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"a.png", "count.rt.glsl", "scene.gltf"}));
}

TEST_F(Frames, InvalidOptions) {
  expectError(runCount({"--frames", "0"}), 2, {"--frames"});
  expectError(runCount({"--frames", "1.5"}), 2, {"--frames", "1.5"});
  expectError(runCount({"-o", "%d_%d.png", "--frames", "2"}), 2, {"%d_%d.png"});
  expectError(runCount({"--all-frames", "-o", "-"}), 2, {"standard output"});
  expectError(quintet({"run", "normals", "scene.gltf", "--frames", "2", "--size", "8x8", "-q", "--env", "none"}), 2,
              {"frames"});
}

}  // namespace
}  // namespace quintet::test
