// SPDX-License-Identifier: Apache-2.0
// A lost device (tests/device_loss): sessions continue on a new one, and renders keep their checkpoint.
#include <gmock/gmock.h>

#include "base/parse.h"
#include "device_loss.h"
#include "fixtures.h"
#include "render/film/film_file.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using ::testing::HasSubstr;

class DeviceLossTest : public CliTest {
 protected:
  // The trigger is a file of the test's folder, such as an image that a script has saved.
  RunResult losing(const std::string& trigger, unsigned count, const std::vector<std::string>& arguments) {
    const DeviceLoss loss{.trigger = std::filesystem::absolute(folder_ / trigger), .count = count};
    return quintet(arguments, {.environment = environmentOf(loss)});
  }
  std::vector<std::string> session(const std::string& script) {
    write(folder_ / "script.jsonl", script);
    return {"view",  "scene.gltf", "--program", "pathtracer", "--env",        "none",        "--size",
            "16x12", "--spp",      "5",         "--script",   "script.jsonl", "--keep-going"};
  }
  static std::vector<nlohmann::json> eventsOf(const RunResult& result, const std::string& name) {
    std::vector<nlohmann::json> found;
    for (const std::string& line : splitText(result.out, '\n'))
      if (!line.empty())
        if (nlohmann::json event = nlohmann::json::parse(line); event["event"] == name) found.push_back(event);
    return found;
  }
  void forgetImages() {
    for (const std::string& name : fileNames())
      if (name.ends_with(".exr")) std::filesystem::remove(folder_ / name);
  }
};

// Edits of every kind before the loss, and one step of undo after it.
constexpr const char* kEdits = R"({"do":"material","name":"paint","emissive":[0.25,0.5,1]}
{"do":"camera","name":"side"}
{"do":"orbit","dx":20,"dy":-10}
{"do":"set","parameter":"bounces","value":"2"}
{"do":"environment","source":"default"}
{"do":"save","file":"first.exr"}
{"do":"pick","x":8,"y":6}
{"do":"save","file":"second.exr"}
{"do":"undo"}
{"do":"save","file":"third.exr"}
)";

TEST_F(DeviceLossTest, ASessionContinuesWithItsEdits) {
  nlohmann::json scene = quadScene();
  scene["materials"][0]["name"] = "paint";
  write(folder_ / "scene.gltf", scene.dump());
  const std::vector<std::string> command = session(kEdits);
  const RunResult whole = quintet(command);
  ASSERT_EQ(whole.status, 0) << whole.err;
  const auto images = [&] {
    std::vector<std::vector<std::byte>> data;
    for (const char* name : {"first.exr", "second.exr", "third.exr"}) data.push_back(readImage(name).data);
    return data;
  };
  const auto expected = images();
  EXPECT_NE(expected[1], expected[2]);
  forgetImages();
  const RunResult result = losing("first.exr", 2, command);  // twice, because opening again is followed by a loss
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(images(), expected);
  EXPECT_EQ(eventsOf(result, "picked"), eventsOf(whole, "picked"));
  EXPECT_EQ(eventsOf(whole, "deviceReplaced").size(), 0u);
  const std::vector<nlohmann::json> replaced = eventsOf(result, "deviceReplaced");
  ASSERT_EQ(replaced.size(), 2u) << result.out;
  EXPECT_THAT(replaced[0]["message"].get<std::string>(), HasSubstr("VK_ERROR_DEVICE_LOST"));
  EXPECT_NE(replaced[0]["device"], "");
}

TEST_F(DeviceLossTest, ASessionGivesUpUntilTheNextChange) {
  const RunResult result = losing("a.exr", 3, session(R"({"do":"save","file":"a.exr"}
{"do":"orbit","dx":20}
{"do":"save","file":"b.exr"}
{"do":"orbit","dx":20}
{"do":"save","file":"c.exr"}
)"));
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("line 3: "), HasSubstr("lost 3 times")));
  EXPECT_EQ(eventsOf(result, "error").size(), 1u) << result.out;
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"a.exr", "c.exr", "scene.gltf", "script.jsonl"}));
}

TEST_F(DeviceLossTest, ALossWhileTheSceneIsLoaded) {
  const RunResult result = losing("scene.gltf", 2, session(R"({"do":"save","file":"a.exr"})"));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(eventsOf(result, "deviceReplaced").size(), 2u);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "a.exr"));
  expectError(losing("scene.gltf", 3, session("")), 1, {"the device was lost 3 times in sequence"});
}

TEST_F(DeviceLossTest, ARenderKeepsItsCheckpoint) {
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--spp", "40"});
    return quick(more);
  };
  ASSERT_EQ(quintet(with({"-o", "whole.png"})).status, 0);
  const char* checkpoint = "out.checkpoint.qfilm";
  expectError(losing(checkpoint, 1, with({"-o", "out.png", "--checkpoint", "0"})), 1, {"VK_ERROR_DEVICE_LOST"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
  const std::uint64_t samples = render::readFilm(folder_ / checkpoint).film.counts.samples();
  EXPECT_GT(samples, 0u);
  EXPECT_LT(samples, 40u);
  ASSERT_EQ(quintet(with({"-o", "out.png", "--resume"})).status, 0);
  EXPECT_EQ(readImage("out.png").data, readImage("whole.png").data);
}

}  // namespace
}  // namespace quintet::test
