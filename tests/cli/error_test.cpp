// --until-error and --adaptive: what they do to the samples, and what picture, report and progress line say of the error.
#include <algorithm>
#include <csignal>
#include <cstdio>

#include <gmock/gmock.h>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"
#include "io/exr.h"
#include "render/film_file.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class StatedError : public CliTest {
 protected:
  static constexpr const char* kCheckpoint = "out.checkpoint.qfilm";

  // The program `normals`, 64x48, as long as `more` says.
  static std::vector<std::string> command(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.gltf", "--program", "normals"};
    if (std::find(more.begin(), more.end(), "--size") == more.end())
      arguments.insert(arguments.end(), {"--size", "64x48"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  // A quad in the middle third of a wide picture: tiles that differ in what they need.
  static std::vector<std::string> adaptive(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.gltf", "--env", "default", "--size", "96x32", "--adaptive"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  // Renders and returns the report.
  nlohmann::json report(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"-q", "--json"});
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.status == 0 ? nlohmann::json::parse(result.out) : nlohmann::json();
  }
  // "": the picture does not say.
  std::string told(const std::string& name, const std::string& key) const {
    for (const auto& [k, text] : io::readMetadata(readFile(folder_ / name), name))
      if (k == key) return text;
    return "";
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
};

// docs/cli.md: after 4 to 15 batches, then eight times per doubling.
bool isLookedAfter(std::uint64_t batches) {
  if (batches < 4) return false;
  std::uint64_t step = 1;
  while (batches >= 16 * step) step *= 2;
  return batches % step == 0;
}

TEST_F(StatedError, GoalsThatMakeNoSense) {
  for (const char* goal : {"-1", "0", "nan", "inf", "little", "1e-7", "2", "0.1x", "2%", "0,1", ""}) {
    expectError(quintet(command({"--until-error", goal, "-o", "out.png"})), 2, {"--until-error", goal});
    expectError(quintet({"run", "normals", "--until-error", goal, "-o", "out.png"}), 2, {"--until-error", goal});
  }
  expectError(quintet(command({"--spp", "64", "--until-error", "0.1", "--batches", "0-1", "-o", "out.qfilm"})), 2,
              {"--batches", "--until-error"});
  expectError(quintet(command({"--adaptive", "-o", "out.png"})), 2, {"--adaptive", "'normals'"});
  expectError(
      quintet({"render", "scene.gltf", "--program", "lessons/09_progressive", "--until-error", "0.1", "-o", "out.png"}),
      2, {"--until-error", "09_progressive", "averages its samples itself"});
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

TEST_F(StatedError, RendersUntilItIsReached) {
  // Looked after each batch, they would end after 23 and 84, which are not among the numbers.
  const nlohmann::json coarse = report(command({"--until-error", "0.05", "-o", "coarse.exr"}));
  const nlohmann::json fine = report(command({"--until-error", "0.025", "-o", "fine.exr"}));
  for (const auto& [json, goal] : {std::pair(coarse, 0.05), std::pair(fine, 0.025)}) {
    const nlohmann::json error = json.at("error");
    EXPECT_EQ(error.at("wanted"), goal);
    EXPECT_EQ(error.at("reached"), true);
    EXPECT_LE(error.at("image"), goal);
    EXPECT_GT(error.at("image"), 0.25 * goal);
    EXPECT_LE(error.at("tiles"), 2.0 * goal);
    EXPECT_EQ(json.at("warnings"), nlohmann::json::array());
    EXPECT_EQ(json.at("adaptive"), false);
    EXPECT_EQ(json.at("samples").get<std::uint64_t>() % 4, 0u);
    EXPECT_TRUE(isLookedAfter(json.at("samples").get<std::uint64_t>() / 4)) << json.at("samples");
  }
  EXPECT_LT(2 * coarse.at("samples").get<std::uint64_t>(), fine.at("samples").get<std::uint64_t>());
}

TEST_F(StatedError, IsToldByPictureReportAndLastLine) {
  const RunResult result = quintet(command({"--until-error", "0.05", "-o", "out.png", "--json"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  const double image = json.at("error").at("image"), tiles = json.at("error").at("tiles");
  EXPECT_NEAR(std::stod(told("out.png", "Error")), image, 1e-5 * image);
  EXPECT_NEAR(std::stod(told("out.png", "TileError")), tiles, 1e-5 * tiles);
  EXPECT_EQ(told("out.png", "Samples"), json.at("samples").dump());
  EXPECT_EQ(told("out.png", "Adaptive"), "");
  EXPECT_EQ(told("out.png", "Interrupted"), "");
  char percent[32];
  std::snprintf(percent, sizeof percent, ", error %.2g %%, ", 100.0 * image);
  EXPECT_THAT(result.err, HasSubstr(percent));
  EXPECT_THAT(quintet({"info", "out.png"}).out, HasSubstr("TileError"));
  // Without a goal it is stated, too; one batch has no spread.
  ASSERT_EQ(quintet(command({"--spp", "8", "-o", "two.exr", "-q"})).status, 0);
  EXPECT_GT(std::stod(told("two.exr", "Error")), 0.0);
  const nlohmann::json one = report(command({"--spp", "4", "-o", "one.exr"}));
  EXPECT_EQ(one.at("error"), nullptr);
  EXPECT_EQ(told("one.exr", "Error"), "");
  EXPECT_EQ(told("one.exr", "TileError"), "");
}

TEST_F(StatedError, AWarningSaysThatItWasNotReached) {
  const RunResult result =
      quintet(command({"--spp", "12", "--until-error", "0.0001", "-o", "out.png", "-q", "--json"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("error").at("wanted"), 0.0001);
  EXPECT_EQ(json.at("error").at("reached"), false);
  EXPECT_EQ(json.at("samples"), 12);
  ASSERT_EQ(json.at("warnings").size(), 1u);
  const std::string warning = json.at("warnings").at(0);
  EXPECT_TRUE(warning.starts_with("the error of 0.01 % was not reached: it is ")) << warning;
  EXPECT_EQ(result.err, "quintet: warning: " + warning + "\n");
  char percent[32];
  std::snprintf(percent, sizeof percent, "it is %.2g %%, ", 100.0 * json.at("error").at("image").get<double>());
  EXPECT_THAT(warning, HasSubstr(percent));
  // Time ends it, too.
  const nlohmann::json late = report(command({"--time", "0.01", "--until-error", "0.0001", "-o", "out.png"}));
  EXPECT_EQ(late.at("error").at("reached"), false);
  EXPECT_EQ(late.at("warnings").size(), 1u);
  // One batch: not known at all.
  const nlohmann::json one = report(command({"--spp", "4", "--until-error", "0.5", "-o", "out.png"}));
  EXPECT_EQ(one.at("error"), nlohmann::json::parse(R"({"wanted": 0.5, "reached": false})"));
  EXPECT_THAT(one.at("warnings").at(0), HasSubstr("not known"));
}

// The end of --spp and the goal at once: at a count that is looked after (16 samples), and at others.
TEST_F(StatedError, ReachedWithTheLastSampleIsReached) {
  for (const char* samples : {"16", "12", "10"}) {
    const nlohmann::json json =
        report(command({"--spp", samples, "--until-error", "0.9", "-o", "out.png", "--checkpoint", "0"}));
    EXPECT_EQ(json.at("samples"), std::stoi(samples));
    EXPECT_EQ(json.at("error").at("reached"), true);
    EXPECT_EQ(json.at("warnings"), nlohmann::json::array());
    EXPECT_FALSE(exists(kCheckpoint)) << samples;
  }
}

TEST_F(StatedError, TheCheckpointStaysAsLongAsItIsNotReached) {
  report(command({"--spp", "12", "--until-error", "0.0001", "-o", "out.png", "--checkpoint", "1000"}));
  ASSERT_TRUE(exists(kCheckpoint));
  EXPECT_EQ(render::readFilm(folder_ / kCheckpoint).film.counts.samples(), 12u);
  const io::Image before = picture("out.png");
  // Nothing is left to do, and a goal that these samples reach is reached.
  const nlohmann::json again = report(command({"--spp", "12", "--until-error", "0.9", "-o", "out.png", "--resume"}));
  EXPECT_EQ(again.at("samples"), 12);
  EXPECT_EQ(again.at("error").at("reached"), true);
  EXPECT_EQ(picture("out.png").data, before.data);
  EXPECT_FALSE(exists(kCheckpoint));
}

// Killed before the first look, between looks, and just where it looks: 4, 5, …, 16, 18, … batches.
TEST_F(StatedError, GoingOnGivesTheSameBytes) {
  const std::vector<std::string> goal{"--until-error", "0.03", "-o", "out.exr", "--exr-type", "float"};
  std::vector<std::string> arguments = command(goal);
  const nlohmann::json whole = report(arguments);
  const std::vector<std::byte> expected = picture("out.exr").data;
  ASSERT_GT(whole.at("samples"), 100);
  arguments.insert(arguments.end(), {"--checkpoint", "0", "--resume"});
  std::vector<std::string> broken = arguments;
  broken.push_back("--json-progress");
  for (const char* moment : {"\"samples\":8,", "\"samples\":40,", "\"samples\":72,"}) {
    std::filesystem::remove(folder_ / "out.exr");
    TerminalRun process(broken, folder_.path());
    ASSERT_TRUE(process.waitFor(moment));
    process.signal(SIGKILL);
    process.finish();
    ASSERT_TRUE(exists(kCheckpoint));
  }
  const nlohmann::json resumed = report(arguments);
  EXPECT_EQ(resumed.at("samples"), whole.at("samples"));
  EXPECT_EQ(resumed.at("error"), whole.at("error"));
  EXPECT_EQ(picture("out.exr").data, expected);
  EXPECT_FALSE(exists(kCheckpoint));
}

TEST_F(StatedError, TheProgressLineTellsIt) {
  TerminalRun process(
      command({"--size", "200x150", "--until-error", "0.00001", "-o", "out.png", "--checkpoint", "1000"}),
      folder_.path());
  ASSERT_TRUE(process.waitFor("Mrays/s  error "));
  ASSERT_TRUE(process.waitForNext(" %  "));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  // Whoever breaks it off knows that the goal is not reached.
  EXPECT_THAT(result.err, Not(HasSubstr("not reached")));
  EXPECT_EQ(told("out.png", "Interrupted"), "yes");
  EXPECT_GT(std::stod(told("out.png", "Error")), 0.00001);
  EXPECT_TRUE(exists(kCheckpoint));
}

// Without a goal the error is looked at every few seconds, for the line alone.
TEST_F(StatedError, TheProgressLineTellsItWithoutAGoal) {
  TerminalRun process(command({"--size", "200x150", "--time", "100000", "-o", "out.png"}), folder_.path());
  EXPECT_TRUE(process.waitFor("Mrays/s  error "));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().status, 130);
}

TEST_F(StatedError, TheSameCommandGivesTheSameBytes) {
  const auto twice = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--exr-type", "float"});
    std::vector<std::string> a = arguments, b = arguments;
    a.insert(a.end(), {"-o", "a.exr"});
    b.insert(b.end(), {"-o", "b.exr"});
    const nlohmann::json first = report(a), second = report(b);
    EXPECT_EQ(first.at("samples"), second.at("samples"));
    EXPECT_EQ(first.at("error"), second.at("error"));
    EXPECT_EQ(picture("a.exr").data, picture("b.exr").data);
    return first;
  };
  EXPECT_EQ(twice(command({"--until-error", "0.05"})).at("error").at("reached"), true);
  EXPECT_EQ(twice(adaptive({"--spp", "32"})).at("adaptive"), true);
  const nlohmann::json both = twice(adaptive({"--until-error", "0.03"}));
  EXPECT_EQ(both.at("error").at("reached"), true);
  EXPECT_LE(both.at("error").at("image"), 0.03);
}

// --spp is the average of what the pixels get; the picture says that they differ.
TEST_F(StatedError, AdaptiveSpendsSamplesWhereTheyAreNeeded) {
  const nlohmann::json json =
      report(adaptive({"--spp", "64", "-o", "out.exr", "--aov", "sample_count,variance", "--exr-type", "float"}));
  EXPECT_EQ(json.at("adaptive"), true);
  EXPECT_NEAR(json.at("samples").get<double>(), 64, 2);
  EXPECT_EQ(told("out.exr", "Adaptive"), "yes");
  EXPECT_GT(std::stod(told("out.exr", "Error")), 0.0);
  EXPECT_EQ(told("out.exr", "Samples"), json.at("samples").dump());
  const io::Image counts = io::decodeExrLayer(readFile(folder_ / "out.exr"), "out.exr", "sample_count");
  ASSERT_EQ(counts.width, 96u);
  double sum = 0;
  std::vector<float> least{1e9f, 1e9f, 1e9f};  // of the tiles
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

// An environment in cd/m2, as of the sun: its squares are beyond the film's range, its error is never known.
TEST_F(StatedError, ThatCannotBeKnownEndsTheRendering) {
  for (const bool isAdaptive : {false, true}) {
    std::vector<std::string> arguments{"render",        "scene.gltf", "--env", "1e10,1e10,1e10", "--size", "32x32",
                                       "--until-error", "0.1",        "-o",    "out.exr"};
    if (isAdaptive) arguments.push_back("--adaptive");
    const nlohmann::json json = report(arguments);
    EXPECT_EQ(json.at("error").at("reached"), false);
    EXPECT_THAT(json.at("warnings").at(0), HasSubstr("beyond the range"));
    EXPECT_LE(json.at("samples"), 64);
  }
}

}  // namespace
}  // namespace quintet::test
