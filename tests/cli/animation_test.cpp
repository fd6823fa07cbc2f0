// SPDX-License-Identifier: Apache-2.0
// `render` with glTF animations and keyframes of scene files: a time, frames, the choice of the animation, motion blur of
// cameras, and finished frames that are skipped.
#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "fixtures.h"

namespace quintet::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// The quad moves from the center of the image out of it, to the right ("Right") or to the left ("Left"), in a second.
nlohmann::json movingQuad() {
  nlohmann::json json = quadScene();
  const float data[] = {0, 1, 0, 0, 0, 8, 0, 0, -8, 0, 0};
  std::string bytes(sizeof data, '\0');
  std::memcpy(bytes.data(), data, sizeof data);
  json["buffers"].push_back(
      {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}});
  json["bufferViews"].push_back({{"buffer", 1}, {"byteLength", bytes.size()}});
  const auto addAccessor = [&](std::size_t offset, std::size_t count, const char* type) {
    json["accessors"].push_back(
        {{"bufferView", 3}, {"byteOffset", offset}, {"componentType", 5126}, {"count", count}, {"type", type}});
    return json["accessors"].size() - 1;
  };
  const auto times = addAccessor(0, 2, "SCALAR"), right = addAccessor(8, 2, "VEC3");
  for (const char* name : {"Right", "Left"})
    json["animations"].push_back(
        {{"name", name},
         {"samplers", {{{"input", times}, {"output", right}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  // From (8,0,0) to (-8,0,0).
  json["animations"][1]["samplers"][0]["output"] = addAccessor(20, 2, "VEC3");
  return json;
}

class Animation : public CliTest {
 protected:
  Animation() { write(folder_ / "moving.gltf", movingQuad().dump()); }
  RunResult render(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "moving.gltf", "--program", "normals", "--size", "16x10",
                                       "--spp",  "1",           "--env",     "none",    "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
  // Whether the quad is at the center, or right or left of it.
  std::string seen(const std::string& file) const {
    const io::Image image = readImage(file);
    const auto lit = [&](std::uint32_t x) { return image.pixel<std::uint8_t>(x, 5)[2] > 100; };
    return std::string(lit(1) ? "left " : "") + (lit(8) ? "center " : "") + (lit(14) ? "right" : "");
  }
};

TEST_F(Animation, RendersATime) {
  ASSERT_EQ(render({"-o", "rest.png"}).status, 0);
  ASSERT_EQ(render({"-o", "start.png", "--at", "0"}).status, 0);
  ASSERT_EQ(render({"-o", "later.png", "--at", "0.25"}).status, 0);
  ASSERT_EQ(render({"-o", "end.png", "--at", "7"}).status, 0);
  ASSERT_EQ(render({"-o", "left.png", "--at", "0.5", "--animation", "Left"}).status, 0);
  ASSERT_EQ(render({"-o", "none.png", "--animation", "none"}).status, 0);
  EXPECT_EQ(seen("rest.png"), "center ");
  EXPECT_EQ(seen("start.png"), "center ");
  EXPECT_EQ(seen("later.png"), "right");
  EXPECT_EQ(seen("end.png"), "");
  EXPECT_EQ(seen("left.png"), "center ");
  EXPECT_EQ(seen("none.png"), "center ");
}

TEST_F(Animation, FramesAreTimesTheRate) {
  ASSERT_EQ(render({"-o", "at.png", "--at", "0.25"}).status, 0);
  ASSERT_EQ(render({"-o", "frame.png", "--frame", "2", "--fps", "8"}).status, 0);
  EXPECT_EQ(readImage("at.png").data, readImage("frame.png").data);
  ASSERT_EQ(render({"-o", "f##.png", "--frames", "1:3", "--fps", "8"}).status, 0);
  EXPECT_EQ(readImage("at.png").data, readImage("f02.png").data);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "f00.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "f03.png"));
}

TEST_F(Animation, JsonListsTheFrames) {
  const RunResult result = render({"-o", "f#.png", "--frames", "2", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json frames = nlohmann::json::parse(result.out)["frames"];
  ASSERT_EQ(frames.size(), 2u);
  ASSERT_EQ(render({"-o", "all.png", "--frames", "2", "--all-frames"}).status, 0);
  EXPECT_EQ(readImage("all.0001.png").data, readImage("f1.png").data);
  EXPECT_EQ(frames[1]["frame"], 1);
  EXPECT_EQ(frames[1]["files"], nlohmann::json::array({"f1.png"}));
  EXPECT_EQ(frames[1]["writtenBefore"], false);
}

TEST_F(Animation, ResumeSkipsFinishedFrames) {
  const auto resume = [&](const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"-o", "f#.png", "--frames", "0-3", "--fps", "8", "--resume", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = render(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    std::vector<int> rendered;
    const nlohmann::json json = nlohmann::json::parse(result.out);
    for (const nlohmann::json& frame : json["frames"])
      if (!frame["writtenBefore"]) rendered.push_back(frame["frame"]);
    return rendered;
  };
  EXPECT_THAT(resume(), ElementsAre(0, 1, 2, 3));
  const std::vector<std::byte> second = readFile(folder_ / "f1.png");
  std::filesystem::remove(folder_ / "f2.png");
  write(folder_ / "f3.png", std::string("not an image"));
  EXPECT_THAT(resume(), ElementsAre(2, 3));
  EXPECT_EQ(readFile(folder_ / "f1.png"), second);
  EXPECT_THAT(resume(), ElementsAre());
  EXPECT_THAT(resume({"--exposure", "1"}), ElementsAre(0, 1, 2, 3)) << "a different image";
  EXPECT_THAT(resume({"--seed", "4"}), ElementsAre(0, 1, 2, 3)) << "a different render";
  EXPECT_THAT(fileNames(), Not(testing::Contains(HasSubstr("checkpoint")))) << "removed with each frame";
}

TEST_F(Animation, InfoListsThem) {
  const RunResult text = quintet({"info", "moving.gltf"});
  EXPECT_THAT(text.out, HasSubstr("animations  2"));
  EXPECT_THAT(text.out, HasSubstr("1 'Left': 1 s, 1 channel"));
  const nlohmann::json json = nlohmann::json::parse(quintet({"info", "moving.gltf", "--json"}).out);
  EXPECT_EQ(json["animations"][0]["name"], "Right");
  EXPECT_EQ(json["animations"][0]["seconds"], 1.0);
  EXPECT_EQ(json["animations"][0]["channels"], 1);
}

// The camera moves to the right, so that the quad leaves the image on the left side.
constexpr const char* kMovingCamera = R"([[mesh]]
shape = "quad"
size = 1
[[camera]]
look_from = [0, 0, 5]
look_at = [0, 0, 0]
fov = 40
keyframes = [{ time = 0 }, { time = 1, look_from = [8.8, 0, 5], look_at = [8.8, 0, 0] }]
)";

TEST_F(Animation, KeyframesMoveCameras) {
  write(folder_ / "pan.scene.toml", std::string(kMovingCamera));
  const auto pan = [&](const std::string& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "pan.scene.toml", "-o",    file,   "--program", "normals",
                                       "--size", "16x10",          "--env", "none", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
  };
  pan("rest.png", {"--spp", "1"});
  EXPECT_EQ(seen("rest.png"), "center ");
  pan("f#.png", {"--frames", "0-4", "--fps", "4", "--spp", "1"});
  EXPECT_EQ(seen("f0.png"), "center ");
  EXPECT_EQ(seen("f1.png"), "left ");
  EXPECT_EQ(seen("f4.png"), "");
  // Motion blur is the mean of the images of the times: the shutter is open from the first of these frames to the second.
  pan("blur.png", {"--at", "0.125", "--fps", "8", "--shutter", "-1,1", "--spp", "32"});
  const io::Image blurred = readImage("blur.png");
  const auto blue = [&](std::uint32_t x) { return blurred.pixel<std::uint8_t>(x, 5)[2]; };
  for (const std::uint32_t x : {1u, 4u, 8u}) EXPECT_TRUE(blue(x) > 60 && blue(x) < 230) << x << ": " << +blue(x);
  EXPECT_EQ(blue(14), 0);
  const nlohmann::json json = nlohmann::json::parse(quintet({"info", "pan.scene.toml", "--json"}).out);
  EXPECT_EQ(json["keyframes"], nlohmann::json::parse(R"([{"object": "[[camera]]", "count": 2, "firstSeconds": 0.0,
      "lastSeconds": 1.0, "keys": {"look_from": "linear", "look_at": "linear"}}])"));
  EXPECT_THAT(quintet({"info", "pan.scene.toml"}).out,
              HasSubstr("0 [[camera]]: 2 keyframes from 0 to 1 s: look_from linear, look_at linear"));
}

TEST_F(Animation, Errors) {
  expectError(render({"--at", "0", "--frame", "1"}), 2, {"--at", "--frame"});
  expectError(render({"--at", "-1"}), 2, {"--at"});
  expectError(render({"--at", "0", "--animation", "Up"}), 2, {"no animation 'Up'", "Right, Left"});
  expectError(render({"--fps", "0", "--at", "1"}), 2, {"--fps"});
  expectError(render({"--frames", "4", "-o", "a.qfilm", "--all-frames"}), 2, {"a film holds one frame"});
  expectError(quintet({"render", "scene.gltf", "--at", "1", "--program", "normals", "-q", "--env", "none"}), 2,
              {"neither keyframes nor an animation"});
}

}  // namespace
}  // namespace quintet::test
