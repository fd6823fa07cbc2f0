// SPDX-License-Identifier: Apache-2.0
// --until-error and --adaptive: numbers of samples, and the stated error in image, JSON, summary and progress bar.
#include <algorithm>
#include <csignal>
#include <cstdio>

#include <gmock/gmock.h>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"
#include "io/exr/exr.h"
#include "render/film/film_file.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class StatedError : public CliTest {
 protected:
  static constexpr const char* kCheckpoint = "out.checkpoint.qfilm";

  // A render with the program `normals` and 64x48 pixels. `more` sets the limits.
  static std::vector<std::string> command(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.gltf", "--program", "normals"};
    if (std::find(more.begin(), more.end(), "--size") == more.end())
      arguments.insert(arguments.end(), {"--size", "64x48"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  // A wide image with a quad in the middle third, so that tiles require different numbers of samples.
  static std::vector<std::string> adaptive(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.gltf", "--env", "default", "--size", "96x32", "--adaptive"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  // Renders and returns the output of --json.
  nlohmann::json render(std::vector<std::string> arguments, int status = 0) {
    arguments.insert(arguments.end(), {"-q", "--json"});
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, status) << result.err;
    return result.status == status ? nlohmann::json::parse(result.out) : nlohmann::json();
  }
  static constexpr int kNotReached = 3;
  // The value of a metadata key; empty if there is none.
  std::string metadata(const std::string& name, const std::string& key) const {
    for (const auto& [k, text] : io::readMetadata(readFile(folder_ / name), name))
      if (k == key) return text;
    return "";
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
};

// docs/cli.md: the error is checked after 4 to 15 batches, then eight times per doubling.
bool isChecked(std::uint64_t batches) {
  if (batches < 4) return false;
  std::uint64_t step = 1;
  while (batches >= 16 * step) step *= 2;
  return batches % step == 0;
}

TEST_F(StatedError, InvalidTargets) {
  for (const char* target : {"-1", "0", "nan", "inf", "little", "1e-7", "2", "0.1x", "2%", "0,1", ""}) {
    expectError(quintet(command({"--until-error", target, "-o", "out.png"})), 2, {"--until-error", target});
    expectError(quintet({"run", "normals", "--until-error", target, "-o", "out.png"}), 2, {"--until-error", target});
  }
  expectError(quintet(command({"--spp", "64", "--until-error", "0.1", "--batches", "0-1", "-o", "out.qfilm"})), 2,
              {"batches", "target error"});
  expectError(quintet(command({"--adaptive", "-o", "out.png"})), 2, {"adaptive", "'normals'"});
  expectError(
      quintet({"render", "scene.gltf", "--program", "lessons/09_progressive", "--until-error", "0.1", "-o", "out.png"}),
      2, {"target error", "09_progressive"});
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

TEST_F(StatedError, RendersUntilTheTargetIsReached) {
  // With a check after each batch, these renders would stop after 23 and 84 batches, which are no checkpoints.
  const nlohmann::json coarse = render(command({"--until-error", "0.05", "-o", "coarse.exr"}));
  const nlohmann::json fine = render(command({"--until-error", "0.025", "-o", "fine.exr"}));
  for (const auto& [json, target] : {std::pair(coarse, 0.05), std::pair(fine, 0.025)}) {
    const nlohmann::json error = json.at("error");
    EXPECT_EQ(error.at("target"), target);
    EXPECT_EQ(error.at("reached"), true);
    EXPECT_LE(error.at("image"), target);
    EXPECT_GT(error.at("image"), 0.25 * target);
    EXPECT_LE(error.at("tiles"), 2.0 * target);
    EXPECT_EQ(json.at("warnings"), nlohmann::json::array());
    EXPECT_EQ(json.at("adaptive"), false);
    EXPECT_EQ(json.at("samples").get<std::uint64_t>() % 4, 0u);
    EXPECT_TRUE(isChecked(json.at("samples").get<std::uint64_t>() / 4)) << json.at("samples");
  }
  EXPECT_LT(2 * coarse.at("samples").get<std::uint64_t>(), fine.at("samples").get<std::uint64_t>());
}

TEST_F(StatedError, IsInMetadataJsonAndSummary) {
  const RunResult result = quintet(command({"--until-error", "0.05", "-o", "out.png", "--json"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  const double image = json.at("error").at("image"), tiles = json.at("error").at("tiles");
  EXPECT_NEAR(std::stod(metadata("out.png", "Error")), image, 1e-5 * image);
  EXPECT_NEAR(std::stod(metadata("out.png", "TileError")), tiles, 1e-5 * tiles);
  EXPECT_EQ(metadata("out.png", "Samples"), json.at("samples").dump());
  EXPECT_EQ(metadata("out.png", "TargetError"), "0.05");
  EXPECT_EQ(metadata("out.png", "Adaptive"), "");
  EXPECT_EQ(metadata("out.png", "Interrupted"), "");
  char percent[32];
  std::snprintf(percent, sizeof percent, ", error %.2g %%, ", 100.0 * image);
  EXPECT_THAT(result.err, HasSubstr(percent));
  EXPECT_THAT(quintet({"info", "out.png"}).out, HasSubstr("TileError"));
  // The error is also stated without a target, but not for one batch.
  ASSERT_EQ(quintet(command({"--spp", "8", "-o", "two.exr", "-q"})).status, 0);
  EXPECT_GT(std::stod(metadata("two.exr", "Error")), 0.0);
  const nlohmann::json one = render(command({"--spp", "4", "-o", "one.exr"}));
  EXPECT_EQ(one.at("error"), nullptr);
  EXPECT_EQ(metadata("one.exr", "Error"), "");
  EXPECT_EQ(metadata("one.exr", "TileError"), "");
}

TEST_F(StatedError, WarnsIfTheTargetIsNotReached) {
  const RunResult result =
      quintet(command({"--spp", "12", "--until-error", "0.0001", "-o", "out.png", "-q", "--json"}));
  ASSERT_EQ(result.status, kNotReached) << result.err;
  EXPECT_EQ(readImage("out.png").width, 64u);
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("error").at("target"), 0.0001);
  EXPECT_EQ(json.at("error").at("reached"), false);
  EXPECT_EQ(json.at("samples"), 12);
  ASSERT_EQ(json.at("warnings").size(), 1u);
  const std::string warning = json.at("warnings").at(0);
  EXPECT_THAT(warning, HasSubstr("target error of 0.01 %"));
  EXPECT_EQ(result.err, "quintet: warning: " + warning + "\n");
  char percent[32];
  std::snprintf(percent, sizeof percent, " %.2g %%", 100.0 * json.at("error").at("image").get<double>());
  EXPECT_THAT(warning, HasSubstr(percent));
  // The time limit stops the render.
  const nlohmann::json late =
      render(command({"--time", "0.01", "--until-error", "0.0001", "-o", "out.png"}), kNotReached);
  EXPECT_EQ(late.at("error").at("reached"), false);
  EXPECT_EQ(late.at("warnings").size(), 1u);
  // The error of one batch is unknown.
  const nlohmann::json one = render(command({"--spp", "4", "--until-error", "0.5", "-o", "out.png"}), kNotReached);
  EXPECT_EQ(one.at("error"), nlohmann::json::parse(R"({"target": 0.5, "reached": false})"));
  EXPECT_THAT(one.at("warnings").at(0), HasSubstr("unknown"));
}

// The target is reached with the last sample of --spp, with and without a check after this number of samples.
TEST_F(StatedError, ReachedWithTheLastSample) {
  for (const char* samples : {"16", "12", "10"}) {
    const nlohmann::json json =
        render(command({"--spp", samples, "--until-error", "0.9", "-o", "out.png", "--checkpoint", "0"}));
    EXPECT_EQ(json.at("samples"), std::stoi(samples));
    EXPECT_EQ(json.at("error").at("reached"), true);
    EXPECT_EQ(json.at("warnings"), nlohmann::json::array());
    EXPECT_FALSE(exists(kCheckpoint)) << samples;
  }
}

TEST_F(StatedError, KeepsTheCheckpointUntilTheTargetIsReached) {
  render(command({"--spp", "12", "--until-error", "0.0001", "-o", "out.png", "--checkpoint", "1000"}), kNotReached);
  ASSERT_TRUE(exists(kCheckpoint));
  EXPECT_EQ(render::readFilm(folder_ / kCheckpoint).film.counts.samples(), 12u);
  const io::Image before = readImage("out.png");
  // No samples remain, but they reach a larger target.
  const nlohmann::json again = render(command({"--spp", "12", "--until-error", "0.9", "-o", "out.png", "--resume"}));
  EXPECT_EQ(again.at("samples"), 12);
  EXPECT_EQ(again.at("error").at("reached"), true);
  EXPECT_EQ(readImage("out.png").data, before.data);
  EXPECT_FALSE(exists(kCheckpoint));
}

// The process is killed before the first check, between two checks and at a check: 4, 5, …, 16, 18, … batches.
TEST_F(StatedError, ResumingGivesTheSameBytes) {
  const std::vector<std::string> target{"--until-error", "0.03", "-o", "out.exr", "--exr-type", "float"};
  std::vector<std::string> arguments = command(target);
  const nlohmann::json whole = render(arguments);
  const std::vector<std::byte> expected = readImage("out.exr").data;
  ASSERT_GT(whole.at("samples"), 100);
  arguments.insert(arguments.end(), {"--checkpoint", "0", "--resume"});
  std::vector<std::string> killed = arguments;
  killed.push_back("--json-progress");
  for (const char* moment : {"\"samples\":8,", "\"samples\":40,", "\"samples\":72,"}) {
    std::filesystem::remove(folder_ / "out.exr");
    TerminalRun process(killed, folder_.path());
    ASSERT_TRUE(process.waitFor(moment));
    process.signal(SIGKILL);
    process.finish();
    ASSERT_TRUE(exists(kCheckpoint));
  }
  const nlohmann::json resumed = render(arguments);
  EXPECT_EQ(resumed.at("samples"), whole.at("samples"));
  EXPECT_EQ(resumed.at("error"), whole.at("error"));
  EXPECT_EQ(readImage("out.exr").data, expected);
  EXPECT_FALSE(exists(kCheckpoint));
}

TEST_F(StatedError, IsInTheProgressBar) {
  TerminalRun process(
      command({"--size", "200x150", "--until-error", "0.00001", "-o", "out.png", "--checkpoint", "1000"}),
      folder_.path());
  ASSERT_TRUE(process.waitFor("Mrays/s  error "));
  ASSERT_TRUE(process.waitForNext(" %  "));
  ASSERT_TRUE(process.waitForNext(" left"));  // by the error, because there is no other limit
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  // The user who interrupts a render needs no warning.
  EXPECT_THAT(result.err, Not(HasSubstr("not reached")));
  EXPECT_EQ(metadata("out.png", "Interrupted"), "yes");
  EXPECT_GT(std::stod(metadata("out.png", "Error")), 0.00001);
  EXPECT_TRUE(exists(kCheckpoint));
}

// Without a target, the error is estimated every few seconds for the progress bar.
TEST_F(StatedError, IsInTheProgressBarWithoutATarget) {
  TerminalRun process(command({"--size", "200x150", "--time", "100000", "-o", "out.png"}), folder_.path());
  EXPECT_TRUE(process.waitFor("Mrays/s  error "));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().status, 130);
}

TEST_F(StatedError, IsDeterministic) {
  const auto twice = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--exr-type", "float"});
    std::vector<std::string> a = arguments, b = arguments;
    a.insert(a.end(), {"-o", "a.exr"});
    b.insert(b.end(), {"-o", "b.exr"});
    const nlohmann::json first = render(a), second = render(b);
    EXPECT_EQ(first.at("samples"), second.at("samples"));
    EXPECT_EQ(first.at("error"), second.at("error"));
    EXPECT_EQ(readImage("a.exr").data, readImage("b.exr").data);
    return first;
  };
  EXPECT_EQ(twice(command({"--until-error", "0.05"})).at("error").at("reached"), true);
  EXPECT_EQ(twice(adaptive({"--spp", "32"})).at("adaptive"), true);
  const nlohmann::json both = twice(adaptive({"--until-error", "0.03"}));
  EXPECT_EQ(both.at("error").at("reached"), true);
  EXPECT_LE(both.at("error").at("image"), 0.03);
}

// --spp is the average number of samples.
TEST_F(StatedError, AdaptiveSamplingFollowsTheError) {
  const nlohmann::json json =
      render(adaptive({"--spp", "64", "-o", "out.exr", "--aov", "sample_count,variance", "--exr-type", "float"}));
  EXPECT_EQ(json.at("adaptive"), true);
  EXPECT_NEAR(json.at("samples").get<double>(), 64, 2);
  EXPECT_EQ(metadata("out.exr", "Adaptive"), "yes");
  EXPECT_GT(std::stod(metadata("out.exr", "Error")), 0.0);
  EXPECT_EQ(metadata("out.exr", "Samples"), json.at("samples").dump());
  const io::Image counts = io::decodeExrLayer(readFile(folder_ / "out.exr"), "out.exr", "sample_count");
  ASSERT_EQ(counts.width, 96u);
  double sum = 0;
  std::vector<float> least{1e9f, 1e9f, 1e9f};  // by tile
  for (std::uint32_t y = 0; y < counts.height; ++y)
    for (std::uint32_t x = 0; x < counts.width; ++x) {
      const float samples = counts.pixel<float>(x, y)[0];
      sum += samples;
      least[x / 32] = std::min(least[x / 32], samples);
    }
  EXPECT_NEAR(sum / (96 * 32), 64, 2);
  EXPECT_GT(least[1], 4 * least[0]);
  EXPECT_GT(least[1], 4 * least[2]);
}

// The squares of a very bright environment exceed the range of the film, so that the error stays unknown.
TEST_F(StatedError, StopsIfTheErrorCannotBeKnown) {
  for (const bool isAdaptive : {false, true}) {
    std::vector<std::string> arguments{"render",        "scene.gltf", "--env", "1e10,1e10,1e10", "--size", "32x32",
                                       "--until-error", "0.1",        "-o",    "out.exr"};
    if (isAdaptive) arguments.push_back("--adaptive");
    const nlohmann::json json = render(arguments, kNotReached);
    EXPECT_EQ(json.at("error").at("reached"), false);
    EXPECT_THAT(json.at("warnings").at(0), HasSubstr("unknown"));
    EXPECT_LE(json.at("samples"), 64);
  }
}

}  // namespace
}  // namespace quintet::test
