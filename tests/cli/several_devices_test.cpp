// SPDX-License-Identifier: Apache-2.0
// --device with a list: the same bytes for any number of devices, also after a loss. The tests open the only device of the
// machine several times, as devices of their own.
#include <gmock/gmock.h>

#include <csignal>

#include "base/file.h"
#include "device_loss.h"
#include "fixtures.h"
#include "io/codec.h"
#include "render/film/film_file.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

class SeveralDevices : public CliTest {
 protected:
  // A lit quad, so that adaptive sampling distinguishes tiles. 70x45 pixels are six tiles; the last ones are incomplete.
  SeveralDevices() {
    nlohmann::json scene = quadScene();
    scene["extensionsUsed"] = {"KHR_lights_punctual"};
    scene["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 20}}};
    scene["nodes"].push_back(
        {{"translation", {0.5, 0.5, 1}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    scene["scenes"][0]["nodes"].push_back(3);
    write(folder_ / "scene.gltf", scene.dump());
  }
  static std::vector<std::string> command(const std::string& devices, const std::string& output,
                                          const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.gltf", "--env",    "0.5,0.6,0.7", "--size", "70x45",
                                       "-o",     output,       "--device", devices,       "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  void render(const std::string& devices, const std::string& output, const std::vector<std::string>& more) {
    const RunResult result = quintet(command(devices, output, more));
    ASSERT_EQ(result.status, 0) << devices << ": " << result.err;
    EXPECT_EQ(result.err, "");
  }
  RunResult losing(unsigned count, const std::string& trigger, const std::vector<std::string>& arguments) {
    const DeviceLoss loss{.trigger = std::filesystem::absolute(folder_ / trigger), .count = count};
    return quintet(arguments, {.environment = environmentOf(loss)});
  }
  // The film file without its notes (time, command, …): all sums, counts, ids and center values.
  std::vector<std::byte> film(const std::string& name) {
    render::FilmFile file = render::readFilm(folder_ / name);
    file.notes.clear();
    return render::encodeFilm(file);
  }
  void expectSameFilms(const std::vector<std::string>& more) {
    render("0", "one.qfilm", more);
    for (const auto& [devices, name] : {std::pair("0,0", "two.qfilm"), std::pair("0,0,0", "three.qfilm")}) {
      render(devices, name, more);
      EXPECT_EQ(film(name), film("one.qfilm")) << devices;
    }
  }
};

TEST_F(SeveralDevices, RenderTheSameFilm) { expectSameFilms({"--spp", "42"}); }

TEST_F(SeveralDevices, RenderTheSameLayers) {
  expectSameFilms({"--spp", "24", "--aov", "albedo,normal,depth,motion,cryptomatte_object,variance"});
  const std::vector<std::string> more{"--spp", "24", "--aov", "all"};
  render("0", "one.exr", more);
  render("0,0,0", "three.exr", more);
  EXPECT_EQ(readImage("three.exr").data, readImage("one.exr").data);
}

TEST_F(SeveralDevices, FollowTheSameAdaptivePlans) {
  expectSameFilms({"--spp", "120", "--adaptive"});
  EXPECT_FALSE(render::readFilm(folder_ / "three.qfilm").film.counts.cellBatches.empty());
}

TEST_F(SeveralDevices, StopAtTheSameError) {
  expectSameFilms({"--until-error", "0.08"});
  for (const char* name : {"one.qfilm", "two.qfilm", "three.qfilm"}) std::filesystem::remove(folder_ / name);
  expectSameFilms({"--until-error", "0.08", "--adaptive"});
}

TEST_F(SeveralDevices, RenderAPart) { expectSameFilms({"--spp", "48", "--batches", "3-8"}); }

TEST_F(SeveralDevices, ResumeOnAnyNumberOfDevices) {
  for (const std::vector<std::string>& sampling :
       {std::vector<std::string>{"--spp", "80"}, {"--spp", "80", "--adaptive"}}) {
    render("0", "whole.png", sampling);
    std::vector<std::string> first = sampling, then = sampling;
    first.insert(first.end(), {"--time", "0.01", "--keep-checkpoint"});
    then.push_back("--resume");
    for (const auto& [before, after] : {std::pair("0,0", "0"), std::pair("0", "0,0"), std::pair("0,0", "0,0,0")}) {
      render(before, "out.png", first);
      const std::uint64_t samples = render::readFilm(folder_ / "out.checkpoint.qfilm").film.counts.samples();
      EXPECT_GT(samples, 0u);
      EXPECT_LT(samples, 80u);
      render(after, "out.png", then);
      EXPECT_EQ(readImage("out.png").data, readImage("whole.png").data) << before << ", then " << after;
      EXPECT_FALSE(std::filesystem::exists(folder_ / "out.checkpoint.qfilm"));
    }
  }
}

TEST_F(SeveralDevices, WriteCheckpoints) {
  const std::vector<std::string> more{"--spp", "40", "--checkpoint", "0", "--json-progress"};
  render("0", "whole.png", {"--spp", "40"});
  const RunResult result = quintet(command("0,0", "out.png", more));
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, HasSubstr(R"({"samples":4,)"));
  EXPECT_THAT(result.err, HasSubstr(R"("checkpoint":40})"));
  EXPECT_EQ(readImage("out.png").data, readImage("whole.png").data);
}

TEST_F(SeveralDevices, ContinueWithoutLostOnes) {
  const std::vector<std::string> more{"--spp", "80", "--checkpoint", "0"};
  for (const std::string sampling : {"", "--adaptive"}) {
    std::vector<std::string> arguments = more;
    if (!sampling.empty()) arguments.push_back(sampling);
    render("0", "whole.png", arguments);
    for (const unsigned lost : {1u, 2u}) {
      const RunResult result = losing(lost, "out.checkpoint.qfilm", command("0,0,0", "out.png", arguments));
      EXPECT_EQ(result.status, 0) << result.err;
      EXPECT_EQ(std::ranges::count(result.err, '\n'), lost) << result.err;
      EXPECT_THAT(result.err, HasSubstr("warning: device "));
      EXPECT_THAT(result.err, HasSubstr("was lost: "));
      EXPECT_THAT(result.err, HasSubstr("VK_ERROR_DEVICE_LOST"));
      EXPECT_EQ(readImage("out.png").data, readImage("whole.png").data) << lost << " of 3";
    }
  }
}

TEST_F(SeveralDevices, ContinueWithoutOneThatIsLostWhileTheSceneIsLoaded) {
  render("0", "whole.png", {"--spp", "16"});
  const RunResult result = losing(1, "scene.gltf", command("0,0", "out.png", {"--spp", "16"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("was lost"));
  EXPECT_EQ(readImage("out.png").data, readImage("whole.png").data);
}

TEST_F(SeveralDevices, FailIfAllAreLost) {
  const RunResult result =
      losing(3, "out.checkpoint.qfilm", command("0,0,0", "out.png", {"--spp", "400", "--checkpoint", "0"}));
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("all 3 devices were lost"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out.checkpoint.qfilm"));
}

TEST_F(SeveralDevices, NameTheOneThatCannotBeOpened) {
  const DeviceLoss failure{.trigger = folder_ / "never", .failing = 2};
  expectError(quintet(command("0,0", "out.png", {"--spp", "4"}), {.environment = environmentOf(failure)}), 1,
              {" of 2 (index 0, ", "cannot create the device", "VK_ERROR_INITIALIZATION_FAILED",
               "name the devices to use without it"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
}

TEST_F(SeveralDevices, MustExist) {
  expectError(quintet(command("0,7", "out.png", {})), 1, {"device list '0,7': no device with index 7; found 0: "});
  expectError(quintet(command("0,nothing", "out.png", {})), 1, {"device list '0,nothing': no device 'nothing'"});
  expectError(quintet(command("0,,0", "out.png", {})), 2, {"device list '0,,0': entry 2 is empty"});
  expectError(quintet(command("0,", "out.png", {})), 2, {"device list '0,': entry 2 is empty"});
}

TEST_F(SeveralDevices, AreForRenders) {
  expectError(quintet({"find", "scene.gltf", "--device", "0,0", "-q"}), 2, {"device '0,0': one device is used here"});
  expectError(quintet({"explain-pixel", "scene.gltf", "--pixel", "1,1", "--device", "all", "-q"}), 2,
              {"device 'all': one device is used here"});
  expectError(quintet({"check", "pathtracer", "--device", "0,0"}), 2, {"device '0,0': one device is used here"});
  expectError(quintet({"bench", "scene.gltf", "--device", "0,0"}), 2, {"device '0,0': one device is used here"});
  // The environment is for all commands, so those that use one device use the first.
  EXPECT_EQ(quintet({"check", "normals"}, {.environment = {{"QUINTET_DEVICE", "0,0"}}}).status, 0);
}

TEST_F(SeveralDevices, AreRecorded) {
  render("0,0", "out.png", {"--spp", "4", "--json"});
  render("0", "one.png", {"--spp", "4"});
  const io::Metadata two = io::readMetadata(readFile(folder_ / "out.png"), "out.png");
  const io::Metadata one = io::readMetadata(readFile(folder_ / "one.png"), "one.png");
  EXPECT_THAT(two, ::testing::Contains(::testing::Pair("DeviceCount", "2")));
  EXPECT_THAT(one, ::testing::Not(::testing::Contains(::testing::Key("DeviceCount"))));
  const auto device = [](const io::Metadata& metadata) {
    return std::ranges::find(metadata, "Device", &io::Metadata::value_type::first)->second;
  };
  EXPECT_EQ(device(two), device(one)) << "one kind";
}

class FramesOnDevices : public SeveralDevices {
 protected:
  FramesOnDevices() {
    write(folder_ / "moving.scene.toml", R"([[mesh]]
name = "quad"
shape = "quad"
size = 1
[[instance]]
of = "quad"
keyframes = [{ frame = 0, translate = [-1.0, 0.0, 0.0] }, { frame = 4, translate = [1.0, 0.0, 0.0] }]
)");
  }
  static std::vector<std::string> animation(const std::string& devices, const std::string& output,
                                            const std::vector<std::string>& more) {
    std::vector<std::string> arguments = command(devices, output, more);
    arguments[1] = "moving.scene.toml";
    for (const char* argument : {"--frames", "0-4", "--look-from", "0,0,5", "--look-at", "0,0,0"})
      arguments.push_back(argument);
    return arguments;
  }
  void expectSameFrames(const std::string& name) {
    for (const std::string frame : {"0", "1", "2", "3", "4"})
      EXPECT_EQ(readImage(name + frame + ".exr").data, readImage("one" + frame + ".exr").data) << frame;
    EXPECT_NE(readImage(name + "0.exr").data, readImage(name + "2.exr").data);
  }
};

TEST_F(FramesOnDevices, AreTheSame) {
  for (const std::string shutter : {"0,0", "0,0.5"}) {
    const std::vector<std::string> more{"--spp", "12", "--shutter", shutter};
    for (const auto& [devices, output] : {std::pair("0", "one#.exr"), std::pair("0,0", "two#.exr")}) {
      const RunResult result = quintet(animation(devices, output, more));
      ASSERT_EQ(result.status, 0) << result.err;
    }
    expectSameFrames("two");
  }
}

// A checkpoint holds a frame, so all devices share each frame.
TEST_F(FramesOnDevices, ResumeWithinAFrame) {
  ASSERT_EQ(quintet(animation("0", "one#.exr", {"--spp", "24"})).status, 0);
  const std::vector<std::string> resumable{"--spp", "24", "--checkpoint", "0", "--resume", "--json-progress"};
  PipeRun process(animation("0,0", "two#.exr", resumable), {.folder = folder_.path()});
  ASSERT_TRUE(process.waitForNext("\"samples\":24,"));
  ASSERT_TRUE(process.waitForNext("\"samples\":24,"));
  process.signal(SIGKILL);
  process.finish();
  ASSERT_TRUE(std::filesystem::exists(folder_ / "two0.exr"));
  const RunResult result = quintet(animation("0,0,0", "two#.exr", {"--spp", "24", "--resume", "--json"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(nlohmann::json::parse(result.out)["frames"][0]["writtenBefore"]);
  expectSameFrames("two");
}

TEST_F(FramesOnDevices, AreRenderedAgainByOthers) {
  const std::vector<std::string> more{"--spp", "240"};  // so that frames are under way when the first one is written
  ASSERT_EQ(quintet(animation("0", "one#.exr", more)).status, 0);
  for (const unsigned lost : {1u, 2u}) {
    for (const std::string& name : fileNames())
      if (name.starts_with("three")) std::filesystem::remove(folder_ / name);
    const RunResult result = losing(lost, "three0.exr", animation("0,0,0", "three#.exr", more));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("was lost: "));
    expectSameFrames("three");
  }
}

TEST_F(FramesOnDevices, FailIfAllAreLost) {
  const RunResult result = losing(2, "two0.exr", animation("0,0", "two#.exr", {"--spp", "400"}));
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("all 2 devices were lost"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "two0.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "two4.exr"));
}

// Ctrl-C writes the unfinished frame; of the later ones, which other devices have started, nothing is written.
TEST_F(FramesOnDevices, StopInOrder) {
  std::vector<std::string> arguments = animation("0,0", "two#.exr", {"--spp", "100000"});
  std::erase(arguments, "-q");
  TerminalRun process(arguments, folder_.path());
  ASSERT_TRUE(process.waitFor(" samples"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"moving.scene.toml", "scene.gltf", "two0.exr"}));
}

// Frames that depend on each other, and prints in the order of the batches, need one device.
TEST_F(SeveralDevices, LeaveWorkInSequenceToOne) {
  const RunResult accumulated =
      quintet({"run", "lessons/01_first_ray", "--device", "0,0", "-o", "out.png", "--size", "16x12"});
  EXPECT_EQ(accumulated.status, 0) << accumulated.err;
  EXPECT_THAT(accumulated.err, HasSubstr("one of the 2 devices"));
}

}  // namespace
}  // namespace quintet::test
