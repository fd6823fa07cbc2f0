// Long renderings: what is left on the disk when one ends too early, and that going on from there changes no pixel.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <random>
#include <thread>

#include "base/file.h"
#include "base/temporary_file.h"
#include "fixtures.h"
#include "io/exr.h"
#include "render/film_file.h"
#include "sky_program.h"

namespace quintet::test {
namespace {

class Checkpoint : public CliTest {
 protected:
  static constexpr const char* kFile = "out.checkpoint.qfilm";

  // 100 batches, if `more` says nothing else.
  static std::vector<std::string> command(const std::vector<std::string>& more = {}, const char* output = "out.png") {
    std::vector<std::string> arguments{"render", "scene.gltf"};
    const std::vector<std::pair<const char*, const char*>> defaults{
        {"--program", "normals"}, {"--size", "48x36"}, {"--spp", "400"}, {"-o", output}};
    for (const auto& [name, value] : defaults)
      if (std::find(more.begin(), more.end(), name) == more.end()) arguments.insert(arguments.end(), {name, value});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  // Renders without a break.
  io::Image whole(std::vector<std::string> more = {}) {
    more.push_back("-q");
    const RunResult result = quintet(command(more, "whole.png"));
    EXPECT_EQ(result.status, 0) << result.err;
    return picture("whole.png");
  }
  // Leaves a checkpoint of some batches.
  void interrupt(const std::vector<std::string>& more = {}) {
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

// The last number that a line of --json-progress has promised.
std::uint64_t promisedSamples(const std::string& lines) {
  const std::string name = "\"checkpoint\":";
  const std::size_t at = lines.rfind(name);
  const std::size_t end = lines.find('}', at);
  return at == lines.npos || end == lines.npos ? 0 : std::stoull(lines.substr(at + name.size()));
}

// Twenty times: a rendering is killed at a random moment, most often while it writes one batch after the other. What it
// had reported as written is there, and the next one goes on from it.
TEST_F(Checkpoint, SurvivesBeingKilledAtAnyMoment) {
  const io::Image expected = whole({"--spp", "1200"});
  std::mt19937 random(20261121);
  std::uint64_t before = 0;
  int advanced = 0, killed = 0;
  for (int i = 0; killed < 20 && i < 40; ++i) {
    TerminalRun process(command({"--checkpoint", "0", "--resume", "--json-progress", "--spp", "1200"}), folder_.path());
    if (i % 5 != 0) process.waitFor("\"checkpoint\"");  // else while it starts
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 200'000));
    process.signal(SIGKILL);
    const RunResult result = process.finish();
    if (std::filesystem::exists(folder_ / "out.png")) {  // it was faster: once more from the beginning
      EXPECT_EQ(picture("out.png").data, expected.data);
      std::filesystem::remove(folder_ / "out.png");
      std::filesystem::remove(folder_ / kFile);
      before = 0;
      continue;
    }
    ++killed;
    ASSERT_EQ(result.status, 1000 + SIGKILL) << result.err;
    const std::uint64_t promised = std::max(before, promisedSamples(result.err));
    if (promised == 0 && !std::filesystem::exists(folder_ / kFile)) continue;
    const std::uint64_t saved = savedSamples();
    EXPECT_GE(saved, promised) << result.err;
    EXPECT_EQ(saved % 4, 0u);
    advanced += saved > before;
    before = saved;
  }
  EXPECT_EQ(killed, 20);
  EXPECT_GE(advanced, 10);
  const RunResult result = quintet(command({"--resume", "-q", "--spp", "1200"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(picture("out.png").data, expected.data);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf", "whole.png"}));
}

TEST_F(Checkpoint, CtrlCLeavesACheckpointAndThePictureSoFar) {
  const io::Image expected = whole();
  TerminalRun process(command({"--checkpoint", "1000", "--json-progress"}), folder_.path());
  ASSERT_TRUE(process.waitFor("\"samples\":8,"));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().status, 130);
  EXPECT_GE(savedSamples(), 8u);
  EXPECT_LT(savedSamples(), 400u);
  EXPECT_NE(picture("out.png").data, expected.data);
  const RunResult result = quintet(command({"--resume"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("going on after"), std::string::npos) << result.err;
  EXPECT_EQ(picture("out.png").data, expected.data);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf", "whole.png"}));
}

TEST_F(Checkpoint, ResumeBeginsWhereThereIsNone) {
  const RunResult result = quintet(command({"--resume", "--spp", "8"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("out.checkpoint.qfilm: there is no checkpoint"), std::string::npos) << result.err;
}

TEST_F(Checkpoint, KeptOnesAreComplete) {
  const auto with = [&](const char* samples, std::vector<std::string> more) {
    more.insert(more.end(), {"--size", "48x36", "--spp", samples});
    return quintet(quick(more));
  };
  ASSERT_EQ(with("12", {"-o", "a.png", "--keep-checkpoint"}).status, 0);
  ASSERT_EQ(
      with("12", {"-o", "b.png", "--resume", "--checkpoint-file", "a.checkpoint.qfilm", "--keep-checkpoint"}).status,
      0);
  EXPECT_EQ(picture("a.png").data, picture("b.png").data);  // nothing was left to do
  // The sampler may have placed its points for 12 samples.
  const RunResult more = with("24", {"-o", "a.png", "--resume"});
  EXPECT_EQ(more.status, 1);
  EXPECT_NE(more.err.find("quintet: a.checkpoint.qfilm: samples planned: 12 in the checkpoint, 24 here\n"),
            std::string::npos)
      << more.err;
}

TEST_F(Checkpoint, KeptOnesOfAPartGoOnToALongerPart) {
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
  expectError(part("1-3", {"-o", "e.qfilm", "--resume"}), 1,
              {"c.qfilm: holds samples 4 to 29; only those up to 15 are wanted"});
  expectError(part("2-7", {"-o", "e.qfilm", "--resume"}), 1,
              {"c.qfilm: holds samples 4 to 29; those from 8 on are wanted"});
}

TEST_F(Checkpoint, PartsHaveThemToo) {
  std::vector<std::string> arguments =
      quick({"--size", "48x36", "--spp", "400", "--batches", "50-90", "-o", "part.qfilm"});
  ASSERT_EQ(quintet(arguments).status, 0);
  std::filesystem::rename(folder_ / "part.qfilm", folder_ / "whole.qfilm");
  std::vector<std::string> broken = arguments;
  broken.insert(broken.end(), {"--checkpoint", "0", "--json-progress"});
  {
    TerminalRun process(broken, folder_.path());
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

// Means, values of pixel centres, counted ids, rays: each goes on where it was.
TEST_F(Checkpoint, LayersGoOnToo) {
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

// The picture of all layers, with a break after the first, second and third batch: centres come from the first one, ids are
// counted and variances summed over all.
TEST_F(Checkpoint, PicturesOfLayersAreThoseWithoutABreak) {
  const std::vector<std::string> what{"render", "scene.gltf", "-q",  "--size",     "16x12", "--spp",
                                      "16",     "--aov",      "all", "--exr-type", "float", "-o"};
  const auto rendered = [&](std::vector<std::string> more) {
    more.insert(more.begin(), what.begin(), what.end());
    const RunResult result = quintet(more);
    EXPECT_EQ(result.status, 0) << result.err;
  };
  const auto layers = [&](const char* name) { return io::decodeExr(readFile(folder_ / name), name); };
  rendered({"whole.exr"});
  const io::ExrPicture whole = layers("whole.exr");
  const auto has = [&](const std::string& name) {
    return std::ranges::find(whole.channels, name, &io::ExrChannel::name) != whole.channels.end();
  };
  EXPECT_TRUE(has("CryptoObject00.R") && has("CryptoMaterial00.A") && has("depth.Z") && has("position.Y") &&
              has("variance.G"));
  for (int breaks = 1; breaks <= 3; ++breaks) {
    rendered({"part.exr", "--resume", "--time", timeForABatch(kFile), "--keep-checkpoint", "--checkpoint-file", kFile});
    ASSERT_EQ(savedSamples(), static_cast<std::uint64_t>(4 * breaks));
    std::filesystem::copy_file(folder_ / kFile, folder_ / "rest.qfilm");
    rendered({"rest.exr", "--resume", "--checkpoint-file", "rest.qfilm"});
    const io::ExrPicture rest = layers("rest.exr");
    ASSERT_EQ(rest.channels.size(), whole.channels.size());
    for (std::size_t i = 0; i < whole.channels.size(); ++i) {
      const auto &a = whole.channels[i].samples, &b = rest.channels[i].samples;
      EXPECT_EQ(rest.channels[i].name, whole.channels[i].name);
      EXPECT_TRUE(a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0)
          << whole.channels[i].name << ", " << breaks;
    }
  }
}

TEST_F(Checkpoint, LeftoversOfKilledWritersGo) {
  const pid_t writer = fork();
  if (writer == 0) {
    const TemporaryFile left(folder_ / kFile);
    _exit(0);  // as if killed: nothing is removed
  }
  ASSERT_EQ(waitpid(writer, nullptr, 0), writer);
  ASSERT_EQ(fileNames().size(), 2u);
  EXPECT_TRUE(fileNames()[0].starts_with(".quintet-")) << fileNames()[0];
  ASSERT_EQ(quintet(command({"--resume", "-q", "--spp", "4"})).status, 0);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf"}));
}

TEST_F(Checkpoint, OfAnotherRenderingAreRefusedWithTheDifference) {
  interrupt();
  const std::vector<std::byte> bytes = render::encodeFilm(render::readFilm(folder_ / kFile));
  write(folder_ / "other.gltf", [] {
    nlohmann::json json = quadScene();
    json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.1, 0.3, 0.1, 1};
    return json.dump();
  }());
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> cases{
      {{"--seed", "4"}, {"seed: 0 in the checkpoint, 4 here"}},
      {{"--size", "48x35"},
       {"size: 48x36 in the checkpoint, 48x35 here", "region: 0,0,48,36 in the checkpoint, 0,0,48,35 here"}},
      {{"--region", "1,2,10,11"}, {"region: 0,0,48,36 in the checkpoint, 1,2,10,11 here"}},
      {{"--program", "ao"},
       {"program: normals in the checkpoint, ao here",
        "program files: ", "parameter distance: unknown in the checkpoint"}},
      {{"--camera", "side"}, {"camera position: 0,0,4 in the checkpoint, 4,0,0 here", "camera axes: "}},
      {{"--fov", "30"}, {"camera: perspective, 0.8 rad in the checkpoint, perspective, 0.5235988 rad here"}},
      {{"--aperture", "0.5"}, {"camera lens: 0 m"}},
      {{"--transparent"}, {"transparent: no in the checkpoint, yes here"}},
      {{"--env", "1,2,3"}, {"environment: "}}};
  for (const auto& [more, texts] : cases) {
    std::vector<std::string> arguments{"--resume", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments = command(arguments);
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 1) << result.err;
    for (const std::string& text : texts)
      EXPECT_NE(result.err.find("quintet: out.checkpoint.qfilm: " + text), std::string::npos) << text << " is not in:\n"
                                                                                              << result.err;
    EXPECT_TRUE(result.err.ends_with("quintet: out.checkpoint.qfilm: is of another rendering; --force begins anew\n"))
        << result.err;
  }
  std::vector<std::string> other = command({"--resume", "-q"});
  other[1] = "other.gltf";
  const RunResult result = quintet(other);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("quintet: out.checkpoint.qfilm: scene: "), std::string::npos) << result.err;
  EXPECT_EQ(render::encodeFilm(render::readFilm(folder_ / kFile)), bytes);  // still there
}

// What is included from outside of the program's folder is read from the disk, whatever happens to it later.
TEST_F(Checkpoint, SayWhatTheFilesWereInTheBeginning) {
  writeSkyProgram(folder_ / "sky", "payload.color = vec3(kGrey);");
  const std::filesystem::path include = folder_ / "grey.inc";
  write(folder_ / "sky/payload.glsl", "#include \"../grey.inc\"\nstruct Payload {\n  vec3 color;\n};\n");
  const std::string grey = "const float kGrey = 0.5;\n";
  write(include, grey);
  const auto interrupted = [&](const auto& change) {
    std::filesystem::remove(folder_ / kFile);
    write(include, grey);
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
  interrupted([&] { write(include, "const float kGrey = 0.25;\n"); });
  const RunResult other = resumed("4000");
  EXPECT_EQ(other.status, 1);
  EXPECT_NE(other.err.find("program files: "), std::string::npos) << other.err;
  interrupted([&] { std::filesystem::remove(include); });
  write(include, grey);
  EXPECT_EQ(resumed("4000").status, 0);
}

// Whatever their names end in.
TEST_F(Checkpoint, OfOtherIncludedFilesAreRefused) {
  writeSkyProgram(folder_ / "sky", "payload.color = vec3(kGrey);");
  write(folder_ / "sky/payload.glsl", "#include \"more.text\"\nstruct Payload {\n  vec3 color;\n};\n");
  write(folder_ / "sky/more.text", "#include \"./noise.inc\"\n");
  write(folder_ / "sky/noise.inc", "const float kGrey = 0.5;\n");
  write(folder_ / "sky/README", "Grey.");
  const std::vector<std::string> arguments = command(
      {"--program", "sky", "--spp", "8", "--checkpoint-file", "c.qfilm", "--keep-checkpoint", "--resume", "-q"});
  ASSERT_EQ(quintet(arguments).status, 0);
  write(folder_ / "sky/README", "Grey, still.");
  ASSERT_EQ(quintet(arguments).status, 0);
  write(folder_ / "sky/noise.inc", "const float kGrey = 0.25;\n");
  const RunResult result = quintet(arguments);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("quintet: c.qfilm: program files: "), std::string::npos) << result.err;
}

TEST_F(Checkpoint, OfAnotherVersionOrDamagedAreRefused) {
  interrupt();
  render::FilmFile file = render::readFilm(folder_ / kFile);
  file.identity[0].second = "0.0.9";
  render::writeFilm(folder_ / kFile, file);
  const RunResult result = quintet(command({"--resume", "-q"}));
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("quintet: 0.0.9 in the checkpoint, 0."), std::string::npos) << result.err;
  std::filesystem::resize_file(folder_ / kFile, 1000);
  expectError(quintet(command({"--resume", "-q"})), 1, {"out.checkpoint.qfilm: is truncated after 1000 bytes"});
  write(folder_ / kFile, "something else");
  expectError(quintet(command({"--resume", "-q"})), 1, {"out.checkpoint.qfilm: is not a film file"});
  expectError(quintet(command({"--checkpoint", "60", "-q"})), 1, {"out.checkpoint.qfilm: is not a film file"});
  // Somebody wants it gone.
  EXPECT_EQ(quintet(command({"--resume", "--force", "-q"})).status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / kFile));
}

TEST_F(Checkpoint, IsNotThrownAwayUnasked) {
  interrupt();
  const std::uint64_t saved = savedSamples();
  expectError(quintet(command({"--checkpoint", "60", "-q"})), 1,
              {"out.checkpoint.qfilm: holds " + std::to_string(saved) + " samples", "--resume", "--force"});
  EXPECT_EQ(savedSamples(), saved);
  EXPECT_EQ(quintet(command({"--checkpoint", "60", "-q", "--force"})).status, 0);
  // A process that was killed while it wrote may have left its temporary file.
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / kFile));
}

// The samples are not lost with the picture.
TEST_F(Checkpoint, StaysWhenThePictureCannotBeWritten) {
  const io::Image expected = whole();
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
  EXPECT_EQ(picture("results/out.png").data, expected.data);
}

// When it happens, not at the end that may be days away: here in 30 seconds.
TEST_F(Checkpoint, ThatCannotBeWrittenAreToldAtOnce) {
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

// A signal that comes when the last batch is under way interrupts nothing.
TEST_F(Checkpoint, CtrlCInTheLastBatchIsTooLate) {
  const std::vector<std::string> arguments =
      command({"--size", "1200x900", "--spp", "8", "--checkpoint", "1000", "--json-progress"});
  TerminalRun process(arguments, folder_.path());
  ASSERT_TRUE(process.waitFor("\"samples\":4,"));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("\"samples\":8,"), std::string::npos) << result.err;
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf"}));
}

TEST_F(Checkpoint, NobodyNeedsToReadTheProgress) {
  const io::Image expected = whole({"--spp", "16"});
  // A pipe whose reader has gone, and a stream that is closed.
  for (const char* shell : {"rm -f p; mkfifo p; true < p & exec 2> p; wait", "exec 2>&-"}) {
    std::filesystem::remove(folder_ / "out.png");
    RunOptions options;
    options.shell = shell;
    const RunResult result = quintet(command({"--spp", "16", "--json-progress"}), options);
    EXPECT_EQ(result.status, 0) << shell;
    EXPECT_EQ(picture("out.png").data, expected.data) << shell;
    EXPECT_EQ(quintet(command({"--spp", "16"}), options).status, 0) << shell;  // the note in the end
    EXPECT_EQ(quintet(command({"--spp", "0"}), options).status, 2) << shell;   // the error
  }
}

// The error is out of reach and the time used up: the same command again leaves all as it is, also where the time ends
// within the next batch.
TEST_F(Checkpoint, NothingIsAddedWhenTheTimeIsOver) {
  const auto again = [&](const std::string& seconds) {
    const RunResult result = quintet({"render", "scene.gltf", "--program", "normals", "--size", "48x36",
                                      "--until-error", "1e-6", "--time", seconds, "-o", "out.png", "--resume"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find("was not reached"), std::string::npos) << result.err;
  };
  again("0.05");
  const std::uint64_t before = savedSamples();
  again("0.05");
  EXPECT_EQ(savedSamples(), before);
  // A second a batch: 0.4 s do not hold half of one.
  const auto pretend = [&](const char* batch) {
    render::FilmFile file = render::readFilm(folder_ / kFile);
    for (auto& [name, value] : file.notes) {
      if (name == "seconds") value = "50";
      if (name == "batch seconds") value = batch;
    }
    render::writeFilm(folder_ / kFile, file);
  };
  pretend("1");
  again("50.4");
  EXPECT_EQ(savedSamples(), before);
  pretend("0.7");
  again("50.4");
  EXPECT_GT(savedSamples(), before);
  pretend("a while");
  expectError(quintet({"render", "scene.gltf", "--program", "normals", "--size", "48x36", "--until-error", "1e-6",
                       "--time", "50.4", "-o", "out.png", "--resume", "-q"}),
              1, {"out.checkpoint.qfilm: header: batch seconds: 'a while' is not a number"});
}

TEST_F(Checkpoint, JsonProgressIsALineForEachBatch) {
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

TEST_F(Checkpoint, OptionsThatMakeNoSense) {
  const auto refused = [&](const std::vector<std::string>& more, const std::vector<std::string>& texts) {
    expectError(quintet(quick(more)), 2, texts);
  };
  refused({"--checkpoint", "-1"}, {"--checkpoint", "-1"});
  refused({"--checkpoint", "soon"}, {"--checkpoint", "not a number"});
  refused({"--checkpoint", "5", "-o", "-"}, {"--checkpoint-file"});
  refused({"--checkpoint", "5", "--checkpoint-file", "a.png"}, {"--checkpoint-file", "a.png", ".qfilm"});
  refused({"--resume", "--checkpoint-file", "a.qfilm", "-o", "a.qfilm"}, {"a.qfilm", "output"});
  std::filesystem::create_directory_symlink(".", folder_ / "here");
  for (const char* other : {"./a.qfilm", "here/a.qfilm", "none/../a.qfilm"})
    refused({"--checkpoint-file", other, "-o", "a.qfilm"}, {"a.qfilm is the output, too"});
  refused({"--checkpoint-file", (folder_ / "a.qfilm").string(), "-o", "here/a.qfilm"}, {"is the output, too"});
  std::filesystem::remove(folder_ / "here");
  refused({"--batches", "0-1"}, {"--batches", ".qfilm"});
  refused({"--batches", "0-1", "-o", "a.png"}, {"--batches", ".qfilm"});
  for (const char* range : {"1-0", "-1-2", "0-", "-", "a", "0-1-2", "1.5-2", "0 - 1", "99999999999999999999-1"})
    refused({"--spp", "64", std::string("--batches=") + range, "-o", "a.qfilm"}, {"--batches", "A-B"});
  refused({"--spp", "30", "--batches", "4-8", "-o", "a.qfilm"},
          {"--batches", "30 samples are batches 0-7", "no batch 8"});
  refused({"--time", "1", "--batches", "0-1", "-o", "a.qfilm"}, {"--batches", "--time"});
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

TEST_F(Checkpoint, ProgramsThatAverageThemselvesHaveNone) {
  const RunResult result = quintet({"render", "scene.gltf", "--program", "lessons/09_progressive", "--size", "8x8",
                                    "-q", "--checkpoint", "1", "-o", "a.png"});
  expectError(result, 2, {"09_progressive", "averages its samples itself"});
}

}  // namespace
}  // namespace quintet::test
