// SPDX-License-Identifier: Apache-2.0
// `render --shutter`: blur, parts and checkpoints with the same bytes as the whole, metadata, and errors.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"
#include "sky_program.h"

namespace quintet::test {
namespace {

using ::testing::Contains;
using ::testing::Not;
using ::testing::Pair;

// A quad that moves by its width per frame, from the left edge of the image to the right.
constexpr const char* kMovingScene = R"(
[[camera]]
look_from = [0.0, 0.0, 5.0]
look_at = [0.0, 0.0, 0.0]
[[mesh]]
name = "quad"
shape = "quad"
size = 1
[[instance]]
of = "quad"
keyframes = [{ frame = 0, translate = [-2.0, 0.0, 0.0] }, { frame = 4, translate = [2.0, 0.0, 0.0] }]
)";

class MotionBlur : public CliTest {
 protected:
  MotionBlur() { write(folder_ / "moving.scene.toml", kMovingScene); }
  RunResult render(const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "render", "moving.scene.toml", "-o", output, "--program", "normals", "--size", "32x20", "--env", "none", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
  std::vector<std::byte> pixels(const std::string& file) const { return readImage(file).data; }
  io::Metadata metadata(const std::string& file) const { return io::readMetadata(readFile(folder_ / file), file); }
  void expectSameImage(const std::string& a, const std::string& b) const { EXPECT_EQ(pixels(a), pixels(b)) << a << b; }
};

TEST_F(MotionBlur, AClosedShutterIsAStillImage) {
  ASSERT_EQ(render("closed.exr", {"--frame", "1", "--shutter", "0.5,0.5", "--spp", "4"}).status, 0);
  ASSERT_EQ(render("still.exr", {"--at", "0.0625", "--spp", "4"}).status, 0);  // frame 1.5
  expectSameImage("closed.exr", "still.exr");
}

// Renders with the same open interval of the shutter, whichever frame it is relative to.
TEST_F(MotionBlur, TheUnitIsTheFrame) {
  ASSERT_EQ(render("a.exr", {"--frame", "1", "--shutter", "0.25,0.75", "--spp", "8"}).status, 0);
  ASSERT_EQ(render("b.exr", {"--frame", "2", "--shutter", "-0.75,-0.25", "--spp", "8"}).status, 0);
  ASSERT_EQ(render("c.exr", {"--at", "0.0625", "--shutter", "-0.25,0.25", "--spp", "8"}).status, 0);
  ASSERT_EQ(render("f#.exr", {"--frames", "0-1", "--shutter", "0.25,0.75", "--spp", "8"}).status, 0);
  ASSERT_EQ(render("still.exr", {"--at", "0.0625", "--spp", "8"}).status, 0);
  expectSameImage("a.exr", "b.exr");
  expectSameImage("a.exr", "c.exr");
  expectSameImage("a.exr", "f1.exr");
  EXPECT_NE(pixels("a.exr"), pixels("still.exr"));
  EXPECT_NE(pixels("a.exr"), pixels("f0.exr"));
}

TEST_F(MotionBlur, PartsAndCheckpointsHaveTheSameBytes) {
  const std::vector<std::string> shot{"--shutter", "0,1", "--spp", "12"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), shot.begin(), shot.end());
    return more;
  };
  ASSERT_EQ(render("whole.exr", shot).status, 0);
  ASSERT_EQ(render("a.qfilm", with({"--batches", "0"})).status, 0);
  ASSERT_EQ(render("b.qfilm", with({"--batches", "1-2"})).status, 0);
  ASSERT_EQ(quintet({"merge", "a.qfilm", "b.qfilm", "-o", "merged.exr"}).status, 0);
  expectSameImage("merged.exr", "whole.exr");
  EXPECT_THAT(metadata("merged.exr"), Contains(Pair("Shutter", "0,1")));
  // The part continues as a checkpoint of the whole.
  std::filesystem::copy(folder_ / "a.qfilm", folder_ / "c.qfilm");
  const RunResult resumed = render("resumed.exr", with({"--resume", "--checkpoint-file", "c.qfilm", "--json"}));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  expectSameImage("resumed.exr", "whole.exr");
  EXPECT_EQ(nlohmann::json::parse(resumed.out)["shutter"], "0,1");
  expectError(render("other.exr", {"--shutter", "0,0.5", "--spp", "12", "--resume", "--checkpoint-file", "a.qfilm"}), 1,
              {"a.qfilm", "shutter 0,1, expected 0,0.5"});
  expectError(render("other.exr", {"--spp", "12", "--resume", "--checkpoint-file", "a.qfilm"}), 1,
              {"a.qfilm", "shutter 0,1, expected none"});
}

// A session at rest has the image of `render`, also after a click has moved the scene to the middle of the shutter.
TEST_F(MotionBlur, SessionsSaveTheSameImage) {
  write(folder_ / "script.jsonl",
        R"({"do":"time","frame":1}
{"do":"refine","samples":4}
{"do":"pick","x":14,"y":10}
{"do":"refine","samples":8}
{"do":"save","file":"session.exr"}
)");
  const RunResult session = quintet({"view", "moving.scene.toml", "--program", "normals", "--size", "32x20", "--env",
                                     "none", "--shutter", "0,1", "--spp", "8", "--script", "script.jsonl"});
  ASSERT_EQ(session.status, 0) << session.err << session.out;
  EXPECT_THAT(session.out, ::testing::HasSubstr(R"("event":"picked","x":14,"y":10,"instance":"quad")"));
  ASSERT_EQ(render("image.exr", {"--frame", "1", "--shutter", "0,1", "--spp", "8"}).status, 0);
  expectSameImage("session.exr", "image.exr");
}

// The explanation of a sample shows the scene at the time of this sample: the mean of all of them is the pixel.
TEST_F(MotionBlur, ExplainedSamplesHaveTheirTimes) {
  const std::vector<std::string> shot{"--frame", "1", "--shutter", "0,1", "--spp", "4"};
  std::vector<std::string> exact = shot;
  exact.insert(exact.end(), {"--exr-type", "float"});
  ASSERT_EQ(render("image.exr", exact).status, 0);
  const io::Image image = readImage("image.exr");
  std::uint32_t x = 0;  // a pixel that the quad covers in some of the samples
  while (x < 32 && !(image.pixel<float>(x, 10)[2] > 0.0f && image.pixel<float>(x, 10)[2] < 1.0f)) ++x;
  ASSERT_LT(x, 32u);
  double mean = 0;
  for (const char* sample : {"0", "1", "2", "3"}) {
    std::vector<std::string> arguments{"explain-pixel",
                                       "moving.scene.toml",
                                       "--program",
                                       "normals",
                                       "--size",
                                       "32x20",
                                       "--env",
                                       "none",
                                       "--sample",
                                       sample,
                                       "--json",
                                       "--pixel",
                                       std::to_string(x) + ",10"};
    arguments.insert(arguments.end(), shot.begin(), shot.end());
    const RunResult result = quintet(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
    mean += nlohmann::json::parse(result.out)["outputs"][0]["value"][2].get<double>() / 4;
  }
  EXPECT_FLOAT_EQ(image.pixel<float>(x, 10)[2], static_cast<float>(mean));
}

// The launch for the values of pixel centers is not counted.
TEST_F(MotionBlur, HeatMapsCountTheSamples) {
  writeSkyProgram(folder_ / "sky", "payload.color = vec3(0.5);");
  write(folder_ / "sky" / "program.toml",
        skyToml("sky.rmiss") + "[[output]]\nname = \"color\"\n" +
            "[[output]]\nname = \"here\"\nkind = \"linear\"\npixel = \"center\"\noptional = true\n");
  for (const std::string file : {"still.exr", "blurred.exr"}) {
    std::vector<std::string> arguments{"run", "sky",   "moving.scene.toml", "-q",    "--size", "8x6", "-o",
                                       file,  "--aov", "here,heat_rays",    "--spp", "4"};
    if (file == "blurred.exr") arguments.insert(arguments.end(), {"--shutter", "0,1"});
    const RunResult result = quintet(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  const RunResult compared = quintet({"compare", "still.exr", "blurred.exr", "--layer", "heat_rays"});
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_THAT(compared.out, ::testing::HasSubstr("rmse    0 "));
}

TEST_F(MotionBlur, StillImagesHaveNoShutter) {
  ASSERT_EQ(render("still.exr", {"--frame", "1", "--spp", "1"}).status, 0);
  EXPECT_THAT(metadata("still.exr"), Not(Contains(Pair("Shutter", ::testing::_))));
}

TEST_F(MotionBlur, Errors) {
  expectError(render("a.png", {"--shutter", "0.5,0"}), 2, {"--shutter", "'0.5,0' is not OPEN,CLOSE"});
  expectError(render("a.png", {"--shutter", "0.5"}), 2, {"--shutter", "OPEN,CLOSE"});
  expectError(render("a.png", {"--shutter", "0,nan"}), 2, {"--shutter", "OPEN,CLOSE"});
  expectError(quintet({"render", "scene.gltf", "--shutter", "0,0.5", "--program", "normals", "-q", "--env", "none"}), 2,
              {"neither keyframes nor an animation", "a shutter would change nothing"});
  expectError(quintet({"run", "lessons/01_first_ray", "--shutter", "0,0.5", "-q"}), 2,
              {"shutter", "averages its frames itself"});
}

}  // namespace
}  // namespace quintet::test
