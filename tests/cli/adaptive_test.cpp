// SPDX-License-Identifier: Apache-2.0
// --adaptive with interruptions: a resumed render follows the same plan and gives the same image.
#include <chrono>
#include <csignal>
#include <cstring>
#include <random>
#include <regex>
#include <thread>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"
#include "io/exr/exr.h"
#include "render/film/film_file.h"

namespace quintet::test {
namespace {

class Adaptive : public CliTest {
 protected:
  static constexpr const char* kFile = "out.checkpoint.qfilm";

  // A lit quad in an empty scene, so that tiles require different numbers of samples. 70x40 pixels are six tiles; the last
  // ones of rows and columns are incomplete.
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
  // The film file without its notes (time, command, …).
  std::vector<std::byte> bytes(const std::string& name) {
    render::FilmFile file = film(name);
    file.notes.clear();
    return render::encodeFilm(file);
  }
  io::ExrImage layers(const std::string& name) { return io::decodeExr(readFile(folder_ / name), name); }
  // The metadata that does not depend on time and command line.
  std::string metadata(const std::string& name) {
    std::string text;
    for (const auto& [key, value] : io::readMetadata(readFile(folder_ / name), name))
      if (key != "Command" && key != "Seconds") text += key + "=" + value + "\n";
    return text;
  }
  // Resumes from the checkpoint for one batch.
  void renderOneBatch(std::vector<std::string> more) {
    more.insert(more.end(), {"--resume", "--keep-checkpoint", "--time", timeForOneBatch(kFile), "-o", "part.exr",
                             "--checkpoint-file", kFile});
    render(more);
  }
};

void expectSame(const io::ExrImage& a, const io::ExrImage& b) {
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

bool hasRemainingBatches(const render::FilmFile& file) {
  for (std::uint32_t c = 0; c < file.plan.size(); ++c)
    if (file.plan[c] > file.film.counts.batchesOf(c)) return true;
  return false;
}

// One process per batch. After each batch, a copy of the checkpoint is completed by a single process.
TEST_F(Adaptive, ResumesAfterEachBatch) {
  const std::vector<std::string> what{"--spp", "40", "--aov", "variance,sample_count,depth,cryptomatte_object"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), what.begin(), what.end());
    return more;
  };
  render(with({"-o", "whole.exr", "--checkpoint-file", "whole.qfilm", "--keep-checkpoint"}));
  const io::ExrImage whole = layers("whole.exr");
  const std::vector<std::byte> wholeFilm = bytes("whole.qfilm");
  const std::uint64_t all = batchesOf(film("whole.qfilm"));
  int planned = 0;  // interruptions before a plan was complete
  for (std::uint64_t before = 0; before < all;) {
    renderOneBatch(what);
    const render::FilmFile file = film(kFile);
    ASSERT_GT(batchesOf(file), before);
    before = batchesOf(file);
    planned += hasRemainingBatches(file);
    if (before == all) break;
    std::filesystem::copy_file(folder_ / kFile, folder_ / "rest.qfilm");
    render(with({"-o", "rest.exr", "--resume", "--checkpoint-file", "rest.qfilm", "--keep-checkpoint"}));
    EXPECT_EQ(bytes("rest.qfilm"), wholeFilm) << before;
    expectSame(layers("rest.exr"), whole);
    EXPECT_EQ(metadata("rest.exr"), metadata("whole.exr"));
    std::filesystem::remove(folder_ / "rest.qfilm");
  }
  EXPECT_GE(planned, 2);
  EXPECT_EQ(bytes(kFile), wholeFilm);
}

TEST_F(Adaptive, ResumesAfterBeingKilled) {
  const std::vector<std::string> what{"--until-error", "0.01", "--size", "128x96"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), what.begin(), what.end());
    return command(more);
  };
  ASSERT_EQ(quintet(with({"-o", "whole.exr", "--keep-checkpoint", "-q"})).status, 0);
  std::mt19937 random(20261122);
  int incomplete = 0, killed = 0;
  std::uint32_t longest = 60'000;  // microseconds
  for (int i = 0; killed < 8 && i < 40; ++i) {
    TerminalRun process(with({"-o", "out.exr", "--checkpoint", "0", "--resume", "--json-progress"}), folder_.path());
    for (int batch = 0; batch < 2; ++batch) process.waitForNext("\"checkpoint\"");
    std::this_thread::sleep_for(std::chrono::microseconds(random() % longest));
    process.signal(SIGKILL);
    const RunResult result = process.finish();
    if (std::filesystem::exists(folder_ / "out.exr")) {  // the render was faster: try again from the start
      EXPECT_EQ(readImage("out.exr").data, readImage("whole.exr").data);
      std::filesystem::remove(folder_ / "out.exr");
      std::filesystem::remove(folder_ / kFile);
      longest = longest / 2 + 1;
      continue;
    }
    ++killed;
    incomplete += hasRemainingBatches(film(kFile));
  }
  EXPECT_EQ(killed, 8);
  EXPECT_GE(incomplete, 1);
  ASSERT_EQ(quintet(with({"-o", "out.exr", "--checkpoint", "0", "--resume", "--keep-checkpoint", "-q"})).status, 0);
  EXPECT_EQ(readImage("out.exr").data, readImage("whole.exr").data);
  EXPECT_EQ(metadata("out.exr"), metadata("whole.exr"));
  EXPECT_EQ(bytes(kFile), bytes("whole.checkpoint.qfilm"));
  EXPECT_EQ(fileNames(),
            (std::vector<std::string>{kFile, "out.exr", "scene.gltf", "whole.checkpoint.qfilm", "whole.exr"}));
}

TEST_F(Adaptive, FilmsBecomeImages) {
  render({"--spp", "28", "-o", "whole.exr", "--aov", "variance,sample_count"});
  render({"--spp", "28", "-o", "a.qfilm", "--aov", "variance,sample_count"});
  ASSERT_EQ(quintet({"merge", "a.qfilm", "-o", "a.exr", "-q"}).status, 0);
  expectSame(layers("a.exr"), layers("whole.exr"));
  EXPECT_EQ(metadata("a.exr"), metadata("whole.exr"));
  ASSERT_EQ(quintet({"merge", "a.qfilm", "-o", "b.qfilm", "-q"}).status, 0);
  const auto withoutCommand = [&](const char* name) {
    render::FilmFile file = film(name);
    std::erase_if(file.notes, [](const auto& note) { return note.first == "command"; });
    return render::encodeFilm(file);
  };
  EXPECT_EQ(withoutCommand("b.qfilm"), withoutCommand("a.qfilm"));
  const RunResult info = quintet({"info", "a.qfilm"});
  EXPECT_EQ(info.status, 0);
  EXPECT_NE(info.out.find("a.qfilm: film, 70x40, "), std::string::npos) << info.out;
  EXPECT_NE(info.out.find(" samples per pixel on average (16–"), std::string::npos) << info.out;
  const nlohmann::json json = nlohmann::json::parse(quintet({"info", "a.qfilm", "--json"}).out);
  EXPECT_NEAR(json["adaptive"]["average"], 28.0, 2.0);
  EXPECT_EQ(json["adaptive"]["average"], json["adaptive"]["planned"]);
  EXPECT_EQ(json["identity"]["adaptive"], "yes");
}

TEST_F(Adaptive, IncompleteFilmsRequirePartial) {
  renderOneBatch({"--spp", "28"});
  const std::vector<std::string> merge{"merge", kFile, "-o", "m.png", "-q"};
  expectError(quintet(merge), 1, {"4.0 of 28 samples per pixel", "--partial"});
  while (!hasRemainingBatches(film(kFile))) renderOneBatch({"--spp", "28"});
  expectError(quintet(merge), 1, {" of 28 samples per pixel", "--partial"});
  EXPECT_EQ(quintet({"merge", kFile, "-o", "m.png", "-q", "--partial"}).status, 0);
  EXPECT_EQ(readImage("m.png").width, 70u);
}

TEST_F(Adaptive, HasNoParts) {
  render({"--spp", "20", "-o", "a.qfilm"});
  expectError(quintet({"merge", "a.qfilm", "a.qfilm", "-o", "m.png", "-q"}), 1, {"a.qfilm: ", "adaptive"});
  expectError(quintet(command({"--spp", "64", "--batches", "0-3", "-o", "b.qfilm"})), 2, {"batches", "adaptive"});
  // It is unknown whether the same render would have all samples of the file again.
  expectError(quintet(command({"--spp", "20", "-o", "a.qfilm", "-q"})), 1,
              {"a.qfilm: holds ", "on average", "--force"});
  render({"--spp", "20", "-o", "a.qfilm", "--force"});
}

// A resumed render may overwrite the film of the previous one, which has the first of its samples.
TEST_F(Adaptive, FilmsAreExtended) {
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
  expectError(repeat({"--until-error", "0.012"}), 1, {"a.qfilm: ", "samples 0–", "--force"});
  EXPECT_EQ(batchesOf(film("a.qfilm")), before);
}

TEST_F(Adaptive, ResumesOnlyWithTheSameSampling) {
  render({"--until-error", "0.05", "-o", "out.png", "--keep-checkpoint"});
  const std::uint64_t before = batchesOf(film(kFile));
  const auto expectRejected = [&](std::vector<std::string> arguments, const std::string& difference) {
    arguments.insert(arguments.end(), {"--resume", "-q"});
    expectError(quintet(arguments), 1, {"out.checkpoint.qfilm: ", difference, "--force"});
    EXPECT_EQ(batchesOf(film(kFile)), before);
  };
  std::vector<std::string> uniform = command({"--until-error", "0.05", "-o", "out.png"});
  std::erase(uniform, "--adaptive");
  expectRejected(uniform, "adaptive yes, expected no");
  expectRejected(command({"--until-error", "0.05", "--spp", "64", "-o", "out.png"}),
                 "planned samples none, expected 64");
  std::vector<std::string> plain{"render",    "scene.gltf",        "--spp", "8", "--size", "16x16", "-o",
                                 "plain.png", "--keep-checkpoint", "-q"};
  ASSERT_EQ(quintet(plain).status, 0);
  plain.insert(plain.end(), {"--resume", "--adaptive"});
  expectError(quintet(plain), 1, {"plain.checkpoint.qfilm: ", "adaptive no, expected yes"});
}

// With a larger target no samples are added. With a smaller one the render continues, and a note reports that its samples
// differ from those of an uninterrupted render.
TEST_F(Adaptive, ResumesWithADifferentTarget) {
  render({"--until-error", "0.05", "-o", "out.png", "--keep-checkpoint"});
  const std::uint64_t before = batchesOf(film(kFile));
  const auto resume = [&](const char* error) {
    return quintet(command({"--until-error", error, "-o", "out.png", "--resume", "--keep-checkpoint"}));
  };
  const RunResult larger = resume("0.1");
  EXPECT_EQ(larger.status, 0) << larger.err;
  EXPECT_EQ(batchesOf(film(kFile)), before);
  const RunResult smaller = resume("0.02");
  EXPECT_EQ(smaller.status, 0) << smaller.err;
  EXPECT_TRUE(std::regex_search(smaller.err, std::regex("out\\.checkpoint\\.qfilm: .* 5 %.* 2 %"))) << smaller.err;
  EXPECT_EQ(smaller.err.find("not reached"), std::string::npos) << smaller.err;
  EXPECT_GT(batchesOf(film(kFile)), before);
  const RunResult merged = quintet({"merge", kFile, "-o", "m.png", "--json", "-q"});
  ASSERT_EQ(merged.status, 0) << merged.err;
  EXPECT_EQ(nlohmann::json::parse(merged.out)["error"]["reached"], true);
}

// A target error that cannot be reached does not exceed --spp.
TEST_F(Adaptive, StaysWithinTheSampleLimit) {
  const RunResult result =
      quintet(command({"--until-error", "1e-4", "--spp", "32", "-o", "out.png", "--json", "--keep-checkpoint"}));
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["error"]["reached"], false);
  EXPECT_NEAR(render::averageSamples(film(kFile).film.region, film(kFile).film.counts), 31.0, 1.0);
}

}  // namespace
}  // namespace quintet::test
