// SPDX-License-Identifier: Apache-2.0
// `render` with several scenes: names of their files, failures of some of them, and the same bytes as one by one.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "base/file.h"
#include "base/parse.h"
#include "fixtures.h"
#include "sky_program.h"

namespace quintet::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class SeveralScenes : public CliTest {
 protected:
  SeveralScenes() {
    nlohmann::json red = quadScene();
    red["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.8, 0.1, 0.1, 1};
    write(folder_ / "red.gltf", red.dump());
    write(folder_ / "broken.gltf", "{\"asset\": {}}");
  }
  RunResult render(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "--program", "normals", "--size", "16x12",
                                       "--spp",  "4",         "--env",   "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
};

TEST_F(SeveralScenes, AreRenderedAsOneByOne) {
  const RunResult result = render({"scene.gltf", "red.gltf", "-o", "out/{scene}.exr", "-q", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  std::vector<std::string> lines = splitText(result.out, '\n');
  ASSERT_EQ(lines.size(), 3u) << result.out;  // the last one is empty
  EXPECT_EQ(nlohmann::json::parse(lines[0])["files"], nlohmann::json{"out/scene.exr"});
  EXPECT_EQ(nlohmann::json::parse(lines[1])["scene"], "red.gltf");
  for (const char* name : {"scene", "red"}) {
    ASSERT_EQ(render({std::string(name) + ".gltf", "-o", "one.exr", "-q"}).status, 0);
    EXPECT_EQ(readImage("one.exr").data, readImage(std::string("out/") + name + ".exr").data) << name;
  }
  ASSERT_EQ(render({"scene.gltf", "red.gltf", "-q"}).status, 0);
  EXPECT_EQ(readImage("scene.png").width, 16u);
  EXPECT_EQ(readImage("red.png").width, 16u);
}

TEST_F(SeveralScenes, AFailureDoesNotStopTheOthers) {
  const RunResult result = render({"broken.gltf", "scene.gltf", "missing.glb", "red.gltf", "--json", "-q"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("quintet: 2 of 4 scenes failed: broken.gltf, missing.glb\n"));
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 3);
  const std::vector<std::string> lines = splitText(result.out, '\n');
  ASSERT_EQ(lines.size(), 5u) << result.out;
  EXPECT_EQ(nlohmann::json::parse(lines[0])["error"]["scene"], "broken.gltf");
  EXPECT_EQ(nlohmann::json::parse(lines[1])["scene"], "scene.gltf");
  EXPECT_EQ(nlohmann::json::parse(lines[2])["error"]["file"], "missing.glb");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "red.png"));
  // A name that one of the scenes does not have.
  const RunResult camera = render({"scene.gltf", "red.gltf", "--camera", "top", "-q"});
  EXPECT_EQ(camera.status, 1);
  EXPECT_THAT(camera.err, AllOf(HasSubstr("'top' not found in scene.gltf"), HasSubstr("2 of 2 scenes failed")));
}

TEST_F(SeveralScenes, WrongOptionsAreErrorsBeforeTheFirst) {
  expectError(render({"scene.gltf", "red.gltf", "-o", "out.png", "-q"}), 2, {"out.png", "'{scene}.png'"});
  expectError(render({"scene.gltf", "red.gltf", "-o", "-", "-q"}), 2, {"- would be the file"});
  expectError(render({"scene.gltf", "red.gltf", "--checkpoint-file", "c.qfilm", "-q"}), 2, {"c.qfilm", "{scene}"});
  expectError(render({"scene.gltf", "red.gltf", "--set", "none=1", "-q"}), 2, {"'none'"});
  expectError(render({"scene.gltf", "red.gltf", "--frames", "3", "-o", "{scene}.qfilm", "-q"}), 2, {"film"});
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"broken.gltf", "red.gltf", "scene.gltf"}));
}

// The process that renders ends with the driver; a new one continues with the next scene.
TEST_F(SeveralScenes, ContinueAfterACrash) {
  PipeRun process({"render", "scene.gltf", "red.gltf", "--program", "normals", "--size", "16x12", "--time", "100000",
                   "--json-progress"},
                  {.folder = folder_.path()});
  ASSERT_TRUE(process.waitForNext("{\"scene\":\"scene.gltf\"}"));
  ASSERT_TRUE(process.waitForNext("\"samples\":"));
  const std::string id = std::to_string(process.id());
  pid_t child = 0;
  std::ifstream("/proc/" + id + "/task/" + id + "/children") >> child;
  ASSERT_GT(child, 0);
  ASSERT_EQ(::kill(child, SIGSEGV), 0);
  ASSERT_TRUE(process.waitForNext("scene.gltf: crash"));
  ASSERT_TRUE(process.waitForNext("{\"scene\":\"red.gltf\"}"));
  ASSERT_TRUE(process.waitForNext("\"samples\":"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130);
  EXPECT_THAT(result.err, HasSubstr("1 of 2 scenes failed: scene.gltf"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "red.png"));
}

TEST_F(SeveralScenes, ContinueAfterALaunchThatDoesNotEnd) {
  writeSkyProgram(folder_ / "loop", "payload.color = vec3(0.5);");
  write(folder_ / "loop" / "sky.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  while (true) {
    vec4 sum = loadOutput(kOutput_color, pixel);
    storeOutput(kOutput_color, pixel, sum + 1.0);
    if (sum.x < -1.0) break;
  }
}
)");
  const RunResult result =
      quintet({"render", "scene.gltf", "red.gltf", "--program", "loop", "--timeout", "1", "--size", "16x12", "-q"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("launch 1 (192 pixels, 1 sample each) did not end within 1 s"),
                                HasSubstr("2 of 2 scenes failed: scene.gltf, red.gltf")));
}

TEST_F(SeveralScenes, CtrlCEndsTheCurrentOne) {
  PipeRun process({"render", "scene.gltf", "red.gltf", "--program", "normals", "--size", "16x12", "--time", "100000",
                   "--json-progress"},
                  {.folder = folder_.path()});
  ASSERT_TRUE(process.waitForNext("\"samples\":"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130);
  EXPECT_THAT(result.err, Not(HasSubstr("failed")));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "scene.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "red.png"));
}

}  // namespace
}  // namespace quintet::test
