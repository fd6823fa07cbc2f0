// SPDX-License-Identifier: Apache-2.0
// `render --shutter`: blur, parts and checkpoints with the same bytes as the whole, metadata, and errors.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"

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
