// SPDX-License-Identifier: Apache-2.0
// Checkpoints: a render that was killed or interrupted resumes without a change of any pixel.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <random>
#include <regex>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>

#include "base/file.h"
#include "base/temporary_file.h"
#include "fixtures.h"
#include "io/exr/exr.h"
#include "render/film/film_file.h"
#include "sky_program.h"

namespace quintet::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class Checkpoint : public CliTest {
 protected:
  static constexpr const char* kFile = "out.checkpoint.qfilm";

  // A render of 100 batches. `more` replaces the defaults.
  static std::vector<std::string> command(const std::vector<std::string>& more = {}, const char* output = "out.png") {
    std::vector<std::string> arguments{"render", "scene.gltf"};
    const std::vector<std::pair<const char*, const char*>> defaults{
        {"--program", "normals"}, {"--size", "48x36"}, {"--spp", "400"}, {"-o", output}};
    for (const auto& [name, value] : defaults)
      if (std::find(more.begin(), more.end(), name) == more.end()) arguments.insert(arguments.end(), {name, value});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  // The image of an uninterrupted render.
  io::Image renderWhole(std::vector<std::string> more = {}) {
    more.push_back("-q");
    const RunResult result = quintet(command(more, "whole.png"));
    EXPECT_EQ(result.status, 0) << result.err;
    return readImage("whole.png");
  }
  // Kills a render after some batches, so that a checkpoint remains.
  void leaveCheckpoint(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = command({"--checkpoint", "0", "--json-progress"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    TerminalRun process(arguments, folder_.path());
    ASSERT_TRUE(process.waitFor("\"samples\":8,"));
    process.signal(SIGKILL);
    process.finish();
    ASSERT_TRUE(std::filesystem::exists(folder_ / kFile));
  }
  std::uint64_t savedSamples() { return render::readFilm(folder_ / kFile).film.counts.samples(); }
};

// The last number of samples that --json-progress reported as saved.
std::uint64_t reportedSamples(const std::string& lines) {
  const std::string name = "\"checkpoint\":";
  const std::size_t at = lines.rfind(name);
  const std::size_t end = lines.find('}', at);
  return at == lines.npos || end == lines.npos ? 0 : std::stoull(lines.substr(at + name.size()));
}

// Twenty times a render is killed at a random moment, usually while it saves batches. All samples that it reported as saved
// are in the checkpoint, and the next process resumes from it.
TEST_F(Checkpoint, SurvivesBeingKilledAtAnyTime) {
  const io::Image expected = renderWhole({"--spp", "1200"});
  std::mt19937 random(20261121);
  std::uint64_t before = 0;
  int advanced = 0, killed = 0;
  for (int i = 0; killed < 20 && i < 40; ++i) {
    TerminalRun process(command({"--checkpoint", "0", "--resume", "--json-progress", "--spp", "1200"}), folder_.path());
    if (i % 5 != 0) process.waitFor("\"checkpoint\"");  // otherwise it is killed while it starts
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 200'000));
    process.signal(SIGKILL);
    const RunResult result = process.finish();
    if (std::filesystem::exists(folder_ / "out.png")) {  // the render was faster: try again from the start
      EXPECT_EQ(readImage("out.png").data, expected.data);
      std::filesystem::remove(folder_ / "out.png");
      std::filesystem::remove(folder_ / kFile);
      before = 0;
      continue;
    }
    ++killed;
    ASSERT_EQ(result.status, 1000 + SIGKILL) << result.err;
    const std::uint64_t reported = std::max(before, reportedSamples(result.err));
    if (reported == 0 && !std::filesystem::exists(folder_ / kFile)) continue;
    const std::uint64_t saved = savedSamples();
    EXPECT_GE(saved, reported) << result.err;
    EXPECT_EQ(saved % 4, 0u);
    advanced += saved > before;
    before = saved;
  }
  EXPECT_EQ(killed, 20);
  EXPECT_GE(advanced, 10);
  const RunResult result = quintet(command({"--resume", "-q", "--spp", "1200"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(readImage("out.png").data, expected.data);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf", "whole.png"}));
}

TEST_F(Checkpoint, InterruptLeavesACheckpointAndAnImage) {
  const io::Image expected = renderWhole();
  TerminalRun process(command({"--checkpoint", "1000", "--json-progress"}), folder_.path());
  ASSERT_TRUE(process.waitFor("\"samples\":8,"));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().status, 130);
  EXPECT_GE(savedSamples(), 8u);
  EXPECT_LT(savedSamples(), 400u);
  EXPECT_NE(readImage("out.png").data, expected.data);
  const RunResult result = quintet(command({"--resume"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(std::regex_search(result.err, std::regex("out\\.checkpoint\\.qfilm: .* [0-9]+ samples"))) << result.err;
  EXPECT_EQ(readImage("out.png").data, expected.data);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf", "whole.png"}));
}

TEST_F(Checkpoint, ResumeStartsWithoutACheckpoint) {
  const RunResult result = quintet(command({"--resume", "--spp", "8"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("out.checkpoint.qfilm: no checkpoint"), std::string::npos) << result.err;
}

TEST_F(Checkpoint, KeptCheckpointsAreComplete) {
  const auto with = [&](const char* samples, std::vector<std::string> more) {
    more.insert(more.end(), {"--size", "48x36", "--spp", samples});
    return quintet(quick(more));
  };
  ASSERT_EQ(with("12", {"-o", "a.png", "--keep-checkpoint"}).status, 0);
  ASSERT_EQ(
      with("12", {"-o", "b.png", "--resume", "--checkpoint-file", "a.checkpoint.qfilm", "--keep-checkpoint"}).status,
      0);
  EXPECT_EQ(readImage("a.png").data, readImage("b.png").data);  // no samples remained
  // The sampler may have distributed its points for 12 samples.
  expectError(with("24", {"-o", "a.png", "--resume"}), 1,
              {"a.checkpoint.qfilm: ", "planned samples 12, expected 24", "--force"});
}

TEST_F(Checkpoint, PartsCanBeExtended) {
  const auto part = [&](const char* batches, std::vector<std::string> more) {
    more.insert(more.end(), {"--size", "48x36", "--spp", "30", "--batches", batches, "--checkpoint-file", "c.qfilm"});
    return quintet(quick(more));
  };
  ASSERT_EQ(part("1-3", {"-o", "a.qfilm", "--keep-checkpoint"}).status, 0);
  ASSERT_EQ(part("1-7", {"-o", "b.qfilm", "--keep-checkpoint", "--resume"}).status, 0);
  ASSERT_EQ(part("1-7", {"-o", "c.qfilm.qfilm", "--force"}).status, 0);
  const auto sums = [&](const char* name) { return render::readFilm(folder_ / name).film.planes[0].sums; };
  const auto a = sums("b.qfilm"), b = sums("c.qfilm.qfilm");
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
  ASSERT_EQ(part("1-7", {"-o", "d.qfilm", "--keep-checkpoint"}).status, 0);
  expectError(part("1-3", {"-o", "e.qfilm", "--resume"}), 1, {"c.qfilm: ", "samples 4–29", " 15"});
  expectError(part("2-7", {"-o", "e.qfilm", "--resume"}), 1, {"c.qfilm: ", "samples 4–29", " 8"});
}

TEST_F(Checkpoint, PartsCanBeResumed) {
  std::vector<std::string> arguments =
      quick({"--size", "48x36", "--spp", "400", "--batches", "50-90", "-o", "part.qfilm"});
  ASSERT_EQ(quintet(arguments).status, 0);
  std::filesystem::rename(folder_ / "part.qfilm", folder_ / "whole.qfilm");
  std::vector<std::string> killed = arguments;
  killed.insert(killed.end(), {"--checkpoint", "0", "--json-progress"});
  {
    TerminalRun process(killed, folder_.path());
    ASSERT_TRUE(process.waitFor("\"samples\":8,"));
    process.signal(SIGKILL);
    process.finish();
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "part.qfilm"));
  arguments.push_back("--resume");
  ASSERT_EQ(quintet(arguments).status, 0);
  const render::FilmFile a = render::readFilm(folder_ / "part.qfilm"), b = render::readFilm(folder_ / "whole.qfilm");
  EXPECT_EQ(a.film.counts, b.film.counts);
  ASSERT_EQ(a.film.planes[0].sums.size(), b.film.planes[0].sums.size());
  EXPECT_EQ(std::memcmp(a.film.planes[0].sums.data(), b.film.planes[0].sums.data(), a.film.planes[0].sums.size() * 16),
            0);
}

// Means, values of pixel centers, counted ids and rays: the film of a resumed render has the same bytes.
TEST_F(Checkpoint, LayersAreResumed) {
  const auto part = [&](const char* batches, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "render",    "scene.gltf", "-q", "--size", "16x12", "--spp", "16", "--aov", "albedo,depth,cryptomatte_object",
        "--batches", batches};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
  };
  part("0-3", {"-o", "whole.qfilm"});
  part("0-1", {"-o", "a.qfilm", "--checkpoint-file", "c.qfilm", "--keep-checkpoint"});
  part("0-3", {"-o", "b.qfilm", "--checkpoint-file", "c.qfilm", "--resume"});
  const render::FilmFile whole = render::readFilm(folder_ / "whole.qfilm"),
                         resumed = render::readFilm(folder_ / "b.qfilm");
  render::FilmFile same = whole;
  same.notes = resumed.notes;  // seconds, command
  EXPECT_EQ(render::encodeFilm(same), render::encodeFilm(resumed));
  const auto has = [&](auto member) {
    return std::any_of(whole.film.planes.begin(), whole.film.planes.end(),
                       [&](const render::FilmPlane& p) { return !(p.*member).empty(); });
  };
  EXPECT_TRUE(has(&render::FilmPlane::squares) && has(&render::FilmPlane::values) && has(&render::FilmPlane::coverage));
}

// Interruptions after the first, second and third batch do not change any layer.
TEST_F(Checkpoint, ImagesOfLayersAreTheSame) {
  const std::vector<std::string> arguments{"render", "scene.gltf", "-q",  "--size",     "16x12", "--spp",
                                           "16",     "--aov",      "all", "--exr-type", "float", "-o"};
  const auto rendered = [&](std::vector<std::string> more) {
    more.insert(more.begin(), arguments.begin(), arguments.end());
    const RunResult result = quintet(more);
    EXPECT_EQ(result.status, 0) << result.err;
  };
  const auto layers = [&](const char* name) { return io::decodeExr(readFile(folder_ / name), name); };
  rendered({"whole.exr"});
  const io::ExrImage whole = layers("whole.exr");
  const auto has = [&](const std::string& name) {
    return std::ranges::find(whole.channels, name, &io::ExrChannel::name) != whole.channels.end();
  };
  EXPECT_TRUE(has("CryptoObject00.R") && has("CryptoMaterial00.A") && has("depth.Z") && has("position.Y") &&
              has("variance.G"));
  for (int breaks = 1; breaks <= 3; ++breaks) {
    rendered(
        {"part.exr", "--resume", "--time", timeForOneBatch(kFile), "--keep-checkpoint", "--checkpoint-file", kFile});
    ASSERT_EQ(savedSamples(), static_cast<std::uint64_t>(4 * breaks));
    std::filesystem::copy_file(folder_ / kFile, folder_ / "rest.qfilm");
    rendered({"rest.exr", "--resume", "--checkpoint-file", "rest.qfilm"});
    const io::ExrImage rest = layers("rest.exr");
    ASSERT_EQ(rest.channels.size(), whole.channels.size());
    for (std::size_t i = 0; i < whole.channels.size(); ++i) {
      const auto &a = whole.channels[i].samples, &b = rest.channels[i].samples;
      EXPECT_EQ(rest.channels[i].name, whole.channels[i].name);
      EXPECT_TRUE(a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0)
          << whole.channels[i].name << ", " << breaks;
    }
  }
}

TEST_F(Checkpoint, RemovesLeftoversOfKilledProcesses) {
  const pid_t writer = fork();
  if (writer == 0) {
    const TemporaryFile file(folder_ / kFile);
    _exit(0);  // as if killed: no destructor removes the file
  }
  ASSERT_EQ(waitpid(writer, nullptr, 0), writer);
  ASSERT_EQ(fileNames().size(), 2u);
  EXPECT_TRUE(fileNames()[0].starts_with(".quintet-")) << fileNames()[0];
  ASSERT_EQ(quintet(command({"--resume", "-q", "--spp", "4"})).status, 0);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf"}));
}

// A second process would overwrite the samples of the first one.
TEST_F(Checkpoint, BelongsToOneProcessAtATime) {
  TerminalRun first(command({"--checkpoint", "0", "--json-progress", "--spp", "16000000"}), folder_.path());
  ASSERT_TRUE(first.waitFor("\"samples\":8,"));  // the file was replaced after it was locked
  const RunResult second = quintet(command({"--checkpoint", "60", "--resume", "--spp", "16000000"}));
  EXPECT_EQ(second.status, 1);
  EXPECT_THAT(second.err,
              AllOf(HasSubstr("out.checkpoint.qfilm: is in use by process "), HasSubstr("waiting up to 10 s"),
                    HasSubstr("quintet: out.checkpoint.qfilm: is in use by process ")));
  expectError(quintet(command({"--checkpoint-file", kFile, "-o", "other.png", "-q", "--force"})), 1, {"is in use by"});
  first.signal(SIGKILL);
  first.finish();
  ASSERT_EQ(quintet(command({"--checkpoint", "60", "--spp", "4", "-q", "--force"})).status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / kFile));
}

// The killed process is the supervisor; the one that renders ends after it, and holds the lock until then.
TEST_F(Checkpoint, ResumesDirectlyAfterAKill) {
  for (int kill = 0; kill < 3; ++kill) {
    PipeRun first(command({"--checkpoint", "0", "--resume", "--json-progress", "--spp", "16000000"}),
                  {.folder = folder_.path()});
    ASSERT_TRUE(first.waitFor("\"samples\":"));
    first.kill();
    const RunResult next = quintet(command({"--resume", "--spp", "16000000", "--time", "0"}));
    EXPECT_EQ(next.status, 0) << next.err;
    EXPECT_THAT(next.err, HasSubstr("resuming after "));
  }
}

TEST_F(Checkpoint, RejectsADifferentRenderByFact) {
  leaveCheckpoint();
  const std::vector<std::byte> bytes = readFile(folder_ / kFile);
  write(folder_ / "other.gltf", [] {
    nlohmann::json json = quadScene();
    json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.1, 0.3, 0.1, 1};
    return json.dump();
  }());
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> cases{
      {{"--seed", "4"}, {"seed 0, expected 4"}},
      {{"--size", "48x35"}, {"size 48x36, expected 48x35", "region 0,0,48,36, expected 0,0,48,35"}},
      {{"--region", "1,2,10,11"}, {"region 0,0,48,36, expected 1,2,10,11"}},
      {{"--program", "ao"}, {"program normals, expected ao", "program files "}},
      {{"--camera", "side"}, {"camera position 0,0,4, expected 4,0,0", "camera axes "}},
      {{"--fov", "30"}, {"camera perspective, 0.8 rad, expected perspective, 0.5235988 rad"}},
      {{"--aperture", "0.5"}, {"camera lens "}},
      {{"--transparent"}, {"transparent no, expected yes"}},
      {{"--env", "1,2,3"}, {"environment "}}};
  for (const auto& [more, texts] : cases) {
    std::vector<std::string> arguments{"--resume", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    std::vector<std::string> expected{"out.checkpoint.qfilm: ", "--force"};
    expected.insert(expected.end(), texts.begin(), texts.end());
    expectError(quintet(command(arguments)), 1, expected);
  }
  std::vector<std::string> other = command({"--resume", "-q"});
  other[1] = "other.gltf";
  expectError(quintet(other), 1, {"out.checkpoint.qfilm: ", "(scene ", "--force"});
  EXPECT_EQ(readFile(folder_ / kFile), bytes);  // unchanged
}

// The identity contains the files as they were when the render started, also those outside of the program's folder.
TEST_F(Checkpoint, RecordTheProgramFilesOfTheStart) {
  writeSkyProgram(folder_ / "sky", "payload.color = vec3(kGray);");
  const std::filesystem::path include = folder_ / "gray.inc";
  write(folder_ / "sky/payload.glsl", "#include \"../gray.inc\"\nstruct Payload {\n  vec3 color;\n};\n");
  const std::string gray = "const float kGray = 0.5;\n";
  write(include, gray);
  const auto interrupted = [&](const auto& change) {
    std::filesystem::remove(folder_ / kFile);
    write(include, gray);
    TerminalRun process(command({"--program", "sky", "--spp", "4000", "--checkpoint", "1000", "--json-progress"}),
                        folder_.path());
    EXPECT_TRUE(process.waitFor("\"samples\":8,"));
    change();
    process.signal(SIGINT);
    EXPECT_EQ(process.finish().status, 130);
  };
  const auto resumed = [&](const char* samples) {
    return quintet(command({"--program", "sky", "--spp", samples, "--resume", "-q"}));
  };
  interrupted([&] { write(include, "const float kGray = 0.25;\n"); });
  expectError(resumed("4000"), 1, {"out.checkpoint.qfilm: ", "(program files "});
  interrupted([&] { std::filesystem::remove(include); });
  write(include, gray);
  EXPECT_EQ(resumed("4000").status, 0);
}

// Included files count with any extension.
TEST_F(Checkpoint, AreRejectedAfterChangesOfIncludedFiles) {
  writeSkyProgram(folder_ / "sky", "payload.color = vec3(kGray);");
  write(folder_ / "sky/payload.glsl", "#include \"more.text\"\nstruct Payload {\n  vec3 color;\n};\n");
  write(folder_ / "sky/more.text", "#include \"./noise.inc\"\n");
  write(folder_ / "sky/noise.inc", "const float kGray = 0.5;\n");
  write(folder_ / "sky/README", "Gray.");
  const std::vector<std::string> arguments = command(
      {"--program", "sky", "--spp", "8", "--checkpoint-file", "c.qfilm", "--keep-checkpoint", "--resume", "-q"});
  ASSERT_EQ(quintet(arguments).status, 0);
  write(folder_ / "sky/README", "Still gray.");
  ASSERT_EQ(quintet(arguments).status, 0);
  write(folder_ / "sky/noise.inc", "const float kGray = 0.25;\n");
  expectError(quintet(arguments), 1, {"c.qfilm: ", "(program files "});
}

TEST_F(Checkpoint, RejectsDifferentVersionsAndDamagedFiles) {
  leaveCheckpoint();
  render::FilmFile file = render::readFilm(folder_ / kFile);
  file.identity[0].second = "0.0.9";  // version of Quintet
  render::writeFilm(folder_ / kFile, file);
  expectError(quintet(command({"--resume", "-q"})), 1, {"out.checkpoint.qfilm: ", " 0.0.9, expected 0."});
  std::filesystem::resize_file(folder_ / kFile, 1000);
  expectError(quintet(command({"--resume", "-q"})), 1,
              {"out.checkpoint.qfilm: ", "1000 bytes", "; use --force to start over"});
  write(folder_ / kFile, "not a film");
  expectError(quintet(command({"--resume", "-q"})), 1, {"out.checkpoint.qfilm: ", ".qfilm)", "--force"});
  expectError(quintet(command({"--checkpoint", "60", "-q"})), 1, {"out.checkpoint.qfilm: ", ".qfilm)", "--force"});
  EXPECT_EQ(quintet(command({"--resume", "--force", "-q"})).status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / kFile));
}

TEST_F(Checkpoint, IsNotOverwrittenWithoutForce) {
  leaveCheckpoint();
  const std::uint64_t saved = savedSamples();
  expectError(quintet(command({"--checkpoint", "60", "-q"})), 1,
              {"out.checkpoint.qfilm: ", std::to_string(saved) + " samples", "--resume", "--force"});
  EXPECT_EQ(savedSamples(), saved);
  EXPECT_EQ(quintet(command({"--checkpoint", "60", "-q", "--force"})).status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / kFile));
}

TEST_F(Checkpoint, KeepsTheSamplesIfTheImageCannotBeWritten) {
  const io::Image expected = renderWhole();
  const std::filesystem::path results = folder_ / "results";
  const std::vector<std::string> arguments =
      command({"-o", "results/out.png", "--checkpoint", "1000", "--checkpoint-file", "keep.qfilm", "--resume",
               "--json-progress"});
  std::filesystem::create_directory(results);
  {
    TerminalRun process(arguments, folder_.path());
    ASSERT_TRUE(process.waitFor("\"samples\":8,"));
    std::filesystem::remove_all(results);
    const RunResult result = process.finish();
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_NE(result.err.find("quintet: results/out.png: "), std::string::npos) << result.err;
  }
  EXPECT_EQ(render::readFilm(folder_ / "keep.qfilm").film.counts.samples(), 400u);
  std::filesystem::create_directory(results);
  EXPECT_EQ(quintet(arguments).status, 0);
  EXPECT_EQ(readImage("results/out.png").data, expected.data);
}

// The warning appears at once, not at the end of the render, which takes 30 seconds here.
TEST_F(Checkpoint, WarnsAtOnceIfItCannotBeWritten) {
  for (const std::string& option : {std::string("--json-progress"), std::string("-q")}) {
    const std::filesystem::path checkpoints = folder_ / "checkpoints";
    std::filesystem::create_directory(checkpoints);
    TerminalRun process(quick({"--size", "48x36", "--time", "30", "-o", "out.png", "--checkpoint", "0",
                               "--checkpoint-file", "checkpoints/c.qfilm", option}),
                        folder_.path());
    for (int i = 0; i < 12000 && !std::filesystem::exists(checkpoints / "c.qfilm"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::filesystem::rename(checkpoints, folder_ / "moved");
    const std::string form =
        option == "-q" ? "quintet: warning: checkpoints/c.qfilm: " : "{\"warning\":\"checkpoints/c.qfilm: ";
    EXPECT_TRUE(process.waitFor(form));
    process.signal(SIGINT);
    EXPECT_EQ(process.finish().status, 130);
    std::filesystem::remove_all(folder_ / "moved");
  }
}

// The last batch is completed anyway. The first progress is that of the only batch.
TEST_F(Checkpoint, InterruptInTheLastBatchHasNoEffect) {
  TerminalRun process(command({"--size", "1200x900", "--spp", "4", "--checkpoint", "1000"}), folder_.path());
  ASSERT_TRUE(process.waitFor("/4 samples"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf"}));
}

TEST_F(Checkpoint, RendersWithAClosedStandardError) {
  const io::Image expected = renderWhole({"--spp", "16"});
  // A pipe whose reader has ended, and a closed stream.
  for (const char* shell : {"rm -f p; mkfifo p; true < p & exec 2> p; wait", "exec 2>&-"}) {
    std::filesystem::remove(folder_ / "out.png");
    RunOptions options;
    options.shell = shell;
    const RunResult result = quintet(command({"--spp", "16", "--json-progress"}), options);
    EXPECT_EQ(result.status, 0) << shell;
    EXPECT_EQ(readImage("out.png").data, expected.data) << shell;
    EXPECT_EQ(quintet(command({"--spp", "16"}), options).status, 0) << shell;  // the summary
    EXPECT_EQ(quintet(command({"--spp", "0"}), options).status, 2) << shell;   // the error
  }
}

// The target error is not reached, and the time is used up. The same command adds no samples, also if less than half of a
// batch would fit into the remaining time.
TEST_F(Checkpoint, AddsNoSamplesAfterTheTimeLimit) {
  const auto again = [&](const std::string& seconds) {
    const RunResult result = quintet({"render", "scene.gltf", "--program", "normals", "--size", "48x36",
                                      "--until-error", "1e-6", "--time", seconds, "-o", "out.png", "--resume"});
    EXPECT_EQ(result.status, 3) << result.err;
    EXPECT_NE(result.err.find("not reached"), std::string::npos) << result.err;
  };
  again("0.05");
  const std::uint64_t before = savedSamples();
  again("0.05");
  EXPECT_EQ(savedSamples(), before);
  // Sets the duration of the last batch. With one second per batch, half a batch does not fit into 0.4 s.
  const auto setBatchSeconds = [&](const char* batch) {
    render::FilmFile file = render::readFilm(folder_ / kFile);
    for (auto& [name, value] : file.notes) {
      if (name == "seconds") value = "50";
      if (name == "batch seconds") value = batch;
    }
    render::writeFilm(folder_ / kFile, file);
  };
  setBatchSeconds("1");
  again("50.4");
  EXPECT_EQ(savedSamples(), before);
  setBatchSeconds("0.7");
  again("50.4");
  EXPECT_GT(savedSamples(), before);
  setBatchSeconds("a while");
  expectError(quintet({"render", "scene.gltf", "--program", "normals", "--size", "48x36", "--until-error", "1e-6",
                       "--time", "50.4", "-o", "out.png", "--resume", "-q"}),
              1, {"out.checkpoint.qfilm: header", "batch seconds", "'a while'"});
}

TEST_F(Checkpoint, JsonProgressHasALineForEachBatch) {
  std::vector<std::string> arguments = quick({"--size", "8x8", "--spp", "10", "--json-progress"});
  std::erase(arguments, "--quiet");
  const RunResult result = quintet(arguments);
  EXPECT_EQ(result.status, 0);
  std::istringstream lines(result.err);
  std::string line;
  for (const int samples : {4, 8, 10}) {
    ASSERT_TRUE(std::getline(lines, line));
    const nlohmann::json json = nlohmann::json::parse(line);
    EXPECT_EQ(json["samples"], samples);
    EXPECT_GT(json["seconds"], 0.0);
    EXPECT_FALSE(json.contains("checkpoint"));
  }
  EXPECT_FALSE(std::getline(lines, line)) << line;
}

TEST_F(Checkpoint, InvalidOptions) {
  const auto expectRejected = [&](const std::vector<std::string>& more, const std::vector<std::string>& texts) {
    expectError(quintet(quick(more)), 2, texts);
  };
  expectRejected({"--checkpoint", "-1"}, {"--checkpoint", "-1"});
  expectRejected({"--checkpoint", "soon"}, {"--checkpoint", "soon"});
  expectRejected({"--checkpoint", "5", "-o", "-"}, {"--checkpoint-file"});
  expectRejected({"--checkpoint", "5", "--checkpoint-file", "a.png"}, {"a.png", ".qfilm"});
  expectRejected({"--resume", "--checkpoint-file", "a.qfilm", "-o", "a.qfilm"}, {"a.qfilm", "output"});
  std::filesystem::create_directory_symlink(".", folder_ / "here");
  for (const char* other : {"./a.qfilm", "here/a.qfilm", "none/../a.qfilm"})
    expectRejected({"--checkpoint-file", other, "-o", "a.qfilm"}, {other, "output"});
  expectRejected({"--checkpoint-file", (folder_ / "a.qfilm").string(), "-o", "here/a.qfilm"}, {"a.qfilm", "output"});
  std::filesystem::remove(folder_ / "here");
  expectRejected({"--batches", "0-1"}, {"--batches", ".qfilm"});
  expectRejected({"--batches", "0-1", "-o", "a.png"}, {"--batches", ".qfilm"});
  for (const char* range : {"1-0", "-1-2", "0-", "-", "a", "0-1-2", "1.5-2", "0 - 1", "99999999999999999999-1"})
    expectRejected({"--spp", "64", std::string("--batches=") + range, "-o", "a.qfilm"}, {"--batches", "A-B"});
  expectRejected({"--spp", "30", "--batches", "4-8", "-o", "a.qfilm"},
                 {"batches", "batch 8", "30 samples", "the last batch of 30 samples is 7"});
  expectRejected({"--time", "1", "--batches", "0-1", "-o", "a.qfilm"}, {"batches", "time"});
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

TEST_F(Checkpoint, RequiresAProgramThatTheFilmAccumulates) {
  const RunResult result = quintet({"render", "scene.gltf", "--program", "lessons/09_progressive", "--size", "8x8",
                                    "-q", "--checkpoint", "1", "-o", "a.png"});
  expectError(result, 2, {"09_progressive", "checkpoints"});
}

}  // namespace
}  // namespace quintet::test
