// --adaptive with breaks: whenever a rendering ends too early, the next one goes on with the same plan, to the same picture.
#include <chrono>
#include <csignal>
#include <cstring>
#include <random>
#include <thread>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"
#include "io/exr.h"
#include "render/film_file.h"

namespace quintet::test {
namespace {

class Adaptive : public CliTest {
 protected:
  static constexpr const char* kFile = "out.checkpoint.qfilm";

  // A lit quad before nothing: tiles differ in what they need. 70x40 are six tiles, the last of each row and column cut.
  Adaptive() {
    nlohmann::json scene = quadScene();
    scene["extensionsUsed"] = {"KHR_lights_punctual"};
    scene["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 20}}};
    scene["nodes"].push_back(
        {{"translation", {0.5, 0.5, 1}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    scene["scenes"][0]["nodes"].push_back(3);
    write(folder_ / "scene.gltf", scene.dump());
  }
  static std::vector<std::string> command(std::vector<std::string> more) {
    std::vector<std::string> arguments{"render", "scene.gltf", "--adaptive", "--env", "0.5,0.6,0.7"};
    if (std::ranges::find(more, "--size") == more.end()) arguments.insert(arguments.end(), {"--size", "70x40"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  void render(std::vector<std::string> more) {
    more.push_back("-q");
    const RunResult result = quintet(command(more));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  render::FilmFile film(const std::string& name) { return render::readFilm(folder_ / name); }
  // Everything but what really happened: seconds, command, plan that is carried out.
  std::vector<std::byte> bytes(const std::string& name) {
    render::FilmFile file = film(name);
    file.notes.clear();
    return render::encodeFilm(file);
  }
  io::ExrPicture layers(const std::string& name) { return io::decodeExr(readFile(folder_ / name), name); }
  // What a picture says that does not depend on the time.
  std::string facts(const std::string& name) {
    std::string text;
    for (const auto& [key, value] : io::readMetadata(readFile(folder_ / name), name))
      if (key != "Command" && key != "Seconds") text += key + "=" + value + "\n";
    return text;
  }
  // Renders one more batch than the checkpoint holds.
  void renderOneBatch(std::vector<std::string> more) {
    more.insert(more.end(), {"--resume", "--keep-checkpoint", "--time", timeForABatch(kFile), "-o", "part.exr",
                             "--checkpoint-file", kFile});
    render(more);
  }
};

void expectSame(const io::ExrPicture& a, const io::ExrPicture& b) {
  ASSERT_EQ(a.channels.size(), b.channels.size());
  for (std::size_t i = 0; i < a.channels.size(); ++i) {
    EXPECT_EQ(a.channels[i].name, b.channels[i].name);
    ASSERT_EQ(a.channels[i].samples.size(), b.channels[i].samples.size());
    EXPECT_EQ(std::memcmp(a.channels[i].samples.data(), b.channels[i].samples.data(), 4 * a.channels[i].samples.size()),
              0)
        << a.channels[i].name;
  }
}

std::uint64_t batchesOf(const render::FilmFile& file) {
  std::uint64_t sum = 0;
  for (std::uint32_t c = 0; c < 2 * render::tileCount(file.film.region); ++c) sum += file.film.counts.batchesOf(c);
  return sum;
}

bool isHalfWay(const render::FilmFile& file) {
  for (std::uint32_t c = 0; c < file.plan.size(); ++c)
    if (file.plan[c] > file.film.counts.batchesOf(c)) return true;
  return false;
}

// A break after every batch, and after each of them the rest in one go.
TEST_F(Adaptive, GoesOnWithThePlanAfterABreakAnywhere) {
  const std::vector<std::string> what{"--spp", "28", "--aov", "variance,sample_count,depth,cryptomatte_object"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), what.begin(), what.end());
    return more;
  };
  render(with({"-o", "whole.exr", "--checkpoint-file", "whole.qfilm", "--keep-checkpoint"}));
  const io::ExrPicture whole = layers("whole.exr");
  const std::vector<std::byte> wholeFilm = bytes("whole.qfilm");
  const std::uint64_t all = batchesOf(film("whole.qfilm"));
  int planned = 0;
  for (std::uint64_t before = 0; before < all;) {
    renderOneBatch(what);
    const render::FilmFile file = film(kFile);
    ASSERT_GT(batchesOf(file), before);
    before = batchesOf(file);
    planned += isHalfWay(file);
    if (before == all) break;
    std::filesystem::copy_file(folder_ / kFile, folder_ / "rest.qfilm");
    render(with({"-o", "rest.exr", "--resume", "--checkpoint-file", "rest.qfilm", "--keep-checkpoint"}));
    EXPECT_EQ(bytes("rest.qfilm"), wholeFilm) << before;
    expectSame(layers("rest.exr"), whole);
    EXPECT_EQ(facts("rest.exr"), facts("whole.exr"));
    std::filesystem::remove(folder_ / "rest.qfilm");
  }
  EXPECT_GE(planned, 2) << "breaks while a plan is being carried out";
  EXPECT_EQ(bytes(kFile), wholeFilm);
}

TEST_F(Adaptive, SurvivesBeingKilledOnItsWayToAnError) {
  const std::vector<std::string> what{"--until-error", "0.01", "--size", "128x96"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), what.begin(), what.end());
    return command(more);
  };
  ASSERT_EQ(quintet(with({"-o", "whole.exr", "--keep-checkpoint", "-q"})).status, 0);
  std::mt19937 random(20261122);
  int halfWay = 0, killed = 0;
  std::uint32_t longest = 60'000;
  for (int i = 0; killed < 8 && i < 40; ++i) {
    TerminalRun process(with({"-o", "out.exr", "--checkpoint", "0", "--resume", "--json-progress"}), folder_.path());
    for (int batch = 0; batch < 2; ++batch) process.waitForNext("\"checkpoint\"");
    std::this_thread::sleep_for(std::chrono::microseconds(random() % longest));
    process.signal(SIGKILL);
    const RunResult result = process.finish();
    if (std::filesystem::exists(folder_ / "out.exr")) {  // it was faster: once more from the beginning
      EXPECT_EQ(picture("out.exr").data, picture("whole.exr").data);
      std::filesystem::remove(folder_ / "out.exr");
      std::filesystem::remove(folder_ / kFile);
      longest = longest / 2 + 1;
      continue;
    }
    ++killed;
    halfWay += isHalfWay(film(kFile));
  }
  EXPECT_EQ(killed, 8);
  EXPECT_GE(halfWay, 1);
  ASSERT_EQ(quintet(with({"-o", "out.exr", "--checkpoint", "0", "--resume", "--keep-checkpoint", "-q"})).status, 0);
  EXPECT_EQ(picture("out.exr").data, picture("whole.exr").data);
  EXPECT_EQ(facts("out.exr"), facts("whole.exr"));
  EXPECT_EQ(bytes(kFile), bytes("whole.checkpoint.qfilm"));
  EXPECT_EQ(fileNames(),
            (std::vector<std::string>{kFile, "out.exr", "scene.gltf", "whole.checkpoint.qfilm", "whole.exr"}));
}

TEST_F(Adaptive, FilmsAreShownAndBecomePictures) {
  render({"--spp", "28", "-o", "whole.exr", "--aov", "variance,sample_count"});
  render({"--spp", "28", "-o", "a.qfilm", "--aov", "variance,sample_count"});
  ASSERT_EQ(quintet({"merge", "a.qfilm", "-o", "a.exr", "-q"}).status, 0);
  expectSame(layers("a.exr"), layers("whole.exr"));
  EXPECT_EQ(facts("a.exr"), facts("whole.exr"));
  ASSERT_EQ(quintet({"merge", "a.qfilm", "-o", "b.qfilm", "-q"}).status, 0);
  EXPECT_EQ(readFile(folder_ / "b.qfilm"), readFile(folder_ / "a.qfilm"));
  const RunResult info = quintet({"info", "a.qfilm"});
  EXPECT_EQ(info.status, 0);
  EXPECT_NE(info.out.find("a.qfilm: film, 70x40, "), std::string::npos) << info.out;
  EXPECT_NE(info.out.find(" samples per pixel on average (16 to "), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("kind of color "), std::string::npos) << info.out;
  EXPECT_EQ(info.out.find("kind of albedo "), std::string::npos) << "the film has none: " << info.out;
  const nlohmann::json json = nlohmann::json::parse(quintet({"info", "a.qfilm", "--json"}).out);
  EXPECT_NEAR(json["adaptive"]["average"], 28.0, 2.0);
  EXPECT_EQ(json["adaptive"]["average"], json["adaptive"]["planned"]);
  EXPECT_EQ(json["identity"]["adaptive"], "yes");
}

TEST_F(Adaptive, HalfAFilmIsAPictureOnlyIfAsked) {
  renderOneBatch({"--spp", "28"});
  const std::vector<std::string> merge{"merge", kFile, "-o", "m.png", "-q"};
  expectError(quintet(merge), 1, {"4.0 of 28 samples per pixel are there", "--partial"});
  while (!isHalfWay(film(kFile))) renderOneBatch({"--spp", "28"});
  expectError(quintet(merge), 1, {" of 28 samples per pixel are there", "--partial"});
  EXPECT_EQ(quintet({"merge", kFile, "-o", "m.png", "-q", "--partial"}).status, 0);
  EXPECT_EQ(picture("m.png").width, 70u);
}

TEST_F(Adaptive, HasNoParts) {
  render({"--spp", "20", "-o", "a.qfilm"});
  expectError(quintet({"merge", "a.qfilm", "a.qfilm", "-o", "m.png", "-q"}), 1,
              {"a.qfilm: is of an adaptive rendering", "no parts"});
  expectError(quintet(command({"--spp", "64", "--batches", "0-3", "-o", "b.qfilm"})), 2,
              {"--batches and --adaptive exclude each other", "does not know"});
  // Another rendering of the same: whether it would have all these samples is not known before.
  expectError(quintet(command({"--spp", "20", "-o", "a.qfilm", "-q"})), 1,
              {"a.qfilm: holds ", "on average", "--force"});
  render({"--spp", "20", "-o", "a.qfilm", "--force"});
}

// A scheduler repeats a command that ran out of time: the film that it has left is a beginning of this one.
TEST_F(Adaptive, FilmsThatAreGoneOnWithAreNotLost) {
  const auto repeat = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"-o", "a.qfilm", "--checkpoint-file", "c.qfilm", "--resume", "--keep-checkpoint", "-q"});
    return quintet(command(more));
  };
  std::uint64_t before = 0;
  for (const char* error : {"0.03", "0.02", "0.012"}) {
    EXPECT_EQ(repeat({"--until-error", error}).status, 0);
    EXPECT_GT(batchesOf(film("a.qfilm")), before) << error;
    before = batchesOf(film("a.qfilm"));
  }
  std::filesystem::remove(folder_ / "c.qfilm");
  expectError(repeat({"--until-error", "0.012"}), 1, {"a.qfilm: holds samples 0 to ", "would be lost"});
  EXPECT_EQ(batchesOf(film("a.qfilm")), before);
}

TEST_F(Adaptive, OtherLimitsAreRefusedOrHaveAMeaning) {
  render({"--until-error", "0.05", "-o", "out.png", "--keep-checkpoint"});
  const std::uint64_t before = batchesOf(film(kFile));
  const auto refused = [&](std::vector<std::string> arguments, const std::vector<std::string>& texts) {
    arguments.insert(arguments.end(), {"--resume", "-q"});
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 1);
    for (const std::string& text : texts)
      EXPECT_NE(result.err.find("quintet: out.checkpoint.qfilm: " + text), std::string::npos) << result.err;
    EXPECT_EQ(batchesOf(film(kFile)), before);
  };
  const std::string other = "is of another rendering; --force begins anew\n";
  std::vector<std::string> same = command({"--until-error", "0.05", "-o", "out.png"});
  std::erase(same, "--adaptive");
  refused(same, {"adaptive: yes in the checkpoint, no here\n", other});
  refused(command({"--until-error", "0.05", "--spp", "64", "-o", "out.png"}),
          {"samples planned: any number in the checkpoint, 64 here\n", other});
  // A smaller error: it goes on, and says that this is not the way of one rendering. A larger one: nothing is left to do.
  const auto with = [&](const char* error) {
    return quintet(command({"--until-error", error, "-o", "out.png", "--resume", "--keep-checkpoint"}));
  };
  const RunResult larger = with("0.1");
  EXPECT_EQ(larger.status, 0) << larger.err;
  EXPECT_EQ(batchesOf(film(kFile)), before);
  const RunResult smaller = with("0.02");
  EXPECT_EQ(smaller.status, 0) << smaller.err;
  EXPECT_NE(smaller.err.find("was planned for an error of 5 %, goes on for an error of 2 %"), std::string::npos)
      << smaller.err;
  EXPECT_EQ(smaller.err.find("not reached"), std::string::npos) << smaller.err;
  EXPECT_GT(batchesOf(film(kFile)), before);
  const RunResult merged = quintet({"merge", kFile, "-o", "m.png", "--json", "-q"});
  ASSERT_EQ(merged.status, 0) << merged.err;
  EXPECT_EQ(nlohmann::json::parse(merged.out)["error"]["reached"], true);
  // One without --adaptive is not gone on with, either.
  std::vector<std::string> plain{"render",    "scene.gltf",        "--spp", "8", "--size", "16x16", "-o",
                                 "plain.png", "--keep-checkpoint", "-q"};
  ASSERT_EQ(quintet(plain).status, 0);
  plain.insert(plain.end(), {"--resume", "--adaptive"});
  const RunResult result = quintet(plain);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("plain.checkpoint.qfilm: adaptive: no in the checkpoint, yes here"), std::string::npos)
      << result.err;
}

// An error out of reach does not lead beyond --spp.
TEST_F(Adaptive, KeepsWithinTheSamples) {
  const RunResult result =
      quintet(command({"--until-error", "1e-4", "--spp", "32", "-o", "out.png", "--json", "--keep-checkpoint"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("was not reached"), std::string::npos) << result.err;
  EXPECT_NEAR(render::averageSamples(film(kFile).film.region, film(kFile).film.counts), 31.0, 1.0);
}

}  // namespace
}  // namespace quintet::test
