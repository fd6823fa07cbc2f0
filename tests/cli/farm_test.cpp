// SPDX-License-Identifier: Apache-2.0
// `quintet farm`: a plan, its parts in any order and after failures, and the image, which has the bytes of one render. Slurm
// is simulated here; tests/farm uses a real one.
#include <gmock/gmock.h>

#include <cstdlib>

#include "base/file.h"
#include "farm/plan.h"
#include "fixtures.h"
#include "io/codec.h"
#include "io/exr/exr.h"
#include "job/version.h"
#include "render/film/film_file.h"

namespace quintet::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Farm : public CliTest {
 protected:
  // Of a plan, and of the render that its image is compared with.
  static std::vector<std::string> options(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--program", "normals", "--size", "40x30"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  RunResult plan(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"farm", "plan", "scene.gltf", "-o", "farm"};
    for (const std::string& option : options(more)) arguments.push_back(option);
    return quintet(arguments);
  }
  void expectPlan(const std::vector<std::string>& more) {
    const RunResult result = plan(more);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  void runPart(const char* part) {
    const RunResult result = quintet({"farm", "run", "farm", part, "-q"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
  }
  nlohmann::json status(const RunOptions& with = {}) {
    const RunResult result = quintet({"farm", "status", "farm", "--json"}, with);
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out);
  }
  void render(const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.gltf", "-q", "-o", output};
    for (const std::string& option : options(more)) arguments.push_back(option);
    const RunResult result = quintet(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  // A folder with programs that replace those of the system, for $PATH.
  void writeProgram(const std::string& name, const std::string& text) {
    std::filesystem::create_directories(folder_ / "bin");
    write(folder_ / "bin" / name, "#!/bin/sh\n" + text + "\n");
    std::filesystem::permissions(folder_ / "bin" / name, std::filesystem::perms(0755));
  }
  RunOptions withPrograms() {
    return {.environment = {{"PATH", (folder_ / "bin").string() + ":" + std::getenv("PATH")}}};
  }
  std::string metadata(const std::string& name, const std::string& wanted) {
    for (const auto& [key, text] : io::readMetadata(readFile(folder_ / name), name))
      if (key == wanted) return text;
    return "";
  }
};

// 30 samples are 8 batches, and the last one has 2 samples.
TEST_F(Farm, PartsGiveTheBytesOfOneRender) {
  expectPlan({"--spp", "30", "--parts", "3", "--exposure", "0.5"});
  for (const char* part : {"2", "0", "1"}) runPart(part);
  const RunResult again = quintet({"farm", "run", "farm/plan.json", "1"});
  EXPECT_THAT(again.err, HasSubstr("part 1 (batches 2–4) is done"));
  ASSERT_EQ(status()["complete"], true);
  const RunResult merged = quintet({"farm", "merge", "farm"});
  ASSERT_EQ(merged.status, 0) << merged.err;
  EXPECT_THAT(merged.err, HasSubstr("30 samples per pixel"));
  render("one.png", {"--spp", "30", "--exposure", "0.5"});
  EXPECT_EQ(readImage("farm/scene.png").data, readImage("one.png").data);
  EXPECT_EQ(metadata("farm/scene.png", "FarmPlan").size(), 32u);
  EXPECT_EQ(metadata("farm/scene.png", "Samples"), "30");
  // Other outputs of the same parts.
  ASSERT_EQ(quintet({"farm", "merge", "farm", "-o", "whole.qfilm", "-q"}).status, 0);
  render("one.qfilm", {"--spp", "30", "--exposure", "0.5"});
  render::FilmFile whole = render::readFilm(folder_ / "whole.qfilm"), one = render::readFilm(folder_ / "one.qfilm");
  whole.notes = one.notes = {};
  EXPECT_EQ(render::encodeFilm(whole), render::encodeFilm(one));
}

TEST_F(Farm, LayersAndFormatOfTheImageComeFromThePlan) {
  const std::vector<std::string> image{"--spp", "8", "--aov", "variance,sample_count", "--exr-type", "float"};
  std::vector<std::string> planned = image;
  planned.insert(planned.end(), {"--parts", "2", "--image", "layers.exr"});
  expectPlan(planned);
  runPart("0");
  runPart("1");
  const RunResult merged = quintet({"farm", "merge", "farm", "-q"});
  ASSERT_EQ(merged.status, 0) << merged.err;
  render("one.exr", image);
  const auto channels = [&](const char* name) {
    std::vector<std::pair<std::string, std::vector<float>>> list;
    for (const io::ExrChannel& channel : io::decodeExr(readFile(folder_ / name), name).channels)
      list.emplace_back(channel.name, channel.samples);
    return list;
  };
  EXPECT_EQ(channels("farm/layers.exr").size(), 3u + 3u + 1u);
  EXPECT_EQ(channels("farm/layers.exr"), channels("one.exr"));
  EXPECT_EQ(io::inspectExr(readFile(folder_ / "farm/layers.exr"), "").front().channels.back().type, io::ExrType::f32);
}

TEST_F(Farm, DamagedAndInterruptedPartsAreRenderedAgain) {
  expectPlan({"--spp", "30", "--parts", "2"});
  runPart("0");
  runPart("1");
  const std::filesystem::path part = folder_ / "farm/parts/000/000001.qfilm";
  const std::vector<std::byte> good = readFile(part);
  std::vector<std::byte> bad = good;
  bad[bad.size() - 60] ^= std::byte{1};  // behind the header
  writeFile(part, bad);
  EXPECT_EQ(status()["states"]["done"], 2) << "only headers are read";
  EXPECT_THAT(quintet({"farm", "status", "farm", "--verify"}).out, HasSubstr("1 of 2 parts done, 1 damaged"));
  expectError(quintet({"farm", "merge", "farm"}), 1,
              {"1 of 2 parts usable", "part 1 (batches 4–7) is damaged", "checksum"});
  const RunResult again = quintet({"farm", "run", "farm", "1"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("rendering it again"));
  // As after SIGTERM: the part has some of its samples, and the checkpoint is lost.
  render::FilmFile film = render::readFilm(part);
  film.film.counts.ranges = {{16, 20}};
  render::writeFilm(part, film);
  EXPECT_EQ(status()["notDone"][0]["state"], "incomplete");
  runPart("1");
  ASSERT_EQ(quintet({"farm", "merge", "farm", "-q"}).status, 0);
  render("one.png", {"--spp", "30"});
  EXPECT_EQ(readImage("farm/scene.png").data, readImage("one.png").data);
}

TEST_F(Farm, PartsOfOtherPlansAndVersionsAreNamed) {
  expectPlan({"--spp", "16", "--parts", "4"});
  for (const char* part : {"0", "1", "2", "3"}) runPart(part);
  const auto file = [&](int part) { return folder_ / ("farm/parts/000/00000" + std::to_string(part) + ".qfilm"); };
  const auto change = [&](int part, const std::string& name, const std::string& value) {
    render::FilmFile film = render::readFilm(file(part));
    for (auto* facts : {&film.identity, &film.notes})
      for (auto& [key, text] : *facts)
        if (key == name) text = value;
    render::writeFilm(file(part), film);
  };
  change(0, "farm plan", std::string(32, '7'));
  change(1, "version", "0.0.9");
  std::filesystem::copy_file(file(3), file(2), std::filesystem::copy_options::overwrite_existing);
  expectError(quintet({"farm", "merge", "farm"}), 1,
              {"1 of 4 parts usable", "part 0 (batch 0) is foreign", "plan 777777777777",
               "part 1 (batch 1) has the wrong", "Quintet 0.0.9", "part 2 (batch 2) is foreign", "copy of part 3"});
  expectError(quintet({"farm", "run", "farm", "0"}), 1, {"000000.qfilm", "different plan", "--force"});
  EXPECT_EQ(quintet({"farm", "run", "farm", "0", "--force", "-q"}).status, 0);
  runPart("1");
  EXPECT_EQ(status()["states"]["done"], 3);
}

TEST_F(Farm, PlansOfOtherVersionsHaveAStatusOfTheirOwn) {
  expectPlan({"--spp", "16", "--parts", "4"});
  farm::Plan plan = farm::readPlan(folder_ / "farm");
  plan.version = "0.0.9";
  writeFile(folder_ / "farm/plan.json", farm::planText(plan));
  expectError(quintet({"farm", "run", "farm", "0"}), 5, {"made by Quintet 0.0.9", "install the same version"});
  expectError(quintet({"farm", "merge", "farm"}), 5, {"made by Quintet 0.0.9"});
  EXPECT_THAT(status()["notDone"][0]["problem"].get<std::string>(), HasSubstr("with status 5"));
  plan = farm::readPlan(folder_ / "farm");
  plan.version = job::quintetVersion();
  plan.libraryHash = std::string(32, '1');
  writeFile(folder_ / "farm/plan.json", farm::planText(plan));
  expectError(quintet({"farm", "run", "farm", "0"}), 5, {"different shader library"});
  writeFile(folder_ / "farm/plan.json", "{}");
  expectError(quintet({"farm", "run", "farm", "0"}), 1, {"is not a plan"});
}

TEST_F(Farm, ChangedScenesAreFoundBeforeTheRender) {
  expectPlan({"--spp", "16", "--parts", "4"});
  nlohmann::json scene = quadScene();
  scene["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.1, 0.3, 0.1, 1};
  write(folder_ / "scene.gltf", scene.dump());
  expectError(quintet({"farm", "run", "farm", "0", "-q"}), 1,
              {"scene.gltf: its content changed", "make the plan again"});
  EXPECT_EQ(status()["states"]["missing"], 4);
  EXPECT_THAT(status()["notDone"][0]["problem"].get<std::string>(),
              AllOf(HasSubstr("failed on"), HasSubstr("with status 1"), HasSubstr("its content changed")));
}

TEST_F(Farm, UnknownDevicesAreRecorded) {
  expectPlan({"--spp", "16", "--parts", "2", "--device", "h900"});
  expectError(quintet({"farm", "run", "farm", "0", "-q"}), 1, {"h900"});
  expectError(quintet({"farm", "merge", "farm"}), 1,
              {"0 of 2 parts usable", "part 0 (batches 0–1) is missing: failed on", "h900"});
  EXPECT_EQ(quintet({"farm", "run", "farm", "0", "-q", "--device", "0"}).status, 0);
  EXPECT_EQ(status()["notDone"].size(), 1u);
  EXPECT_EQ(status()["notDone"][0]["problem"], "");
}

TEST_F(Farm, FramesAreImages) {
  nlohmann::json scene = quadScene();
  scene["animations"] = {
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
       {"samplers", {{{"input", scene["accessors"].size()}, {"output", scene["accessors"].size() + 1}}}}}};
  const std::string times = base64(std::string("\0\0\0\0\0\0\x80\x3f", 8));  // 0 and 1
  const std::string moves = base64(std::string("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\0\0", 24));
  const std::size_t buffer = scene["buffers"].size(), view = scene["bufferViews"].size();
  scene["buffers"].push_back({{"byteLength", 8}, {"uri", "data:application/octet-stream;base64," + times}});
  scene["buffers"].push_back({{"byteLength", 24}, {"uri", "data:application/octet-stream;base64," + moves}});
  scene["bufferViews"].push_back({{"buffer", buffer}, {"byteLength", 8}});
  scene["bufferViews"].push_back({{"buffer", buffer + 1}, {"byteLength", 24}});
  scene["accessors"].push_back(
      {{"bufferView", view}, {"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}, {"min", {0}}, {"max", {1}}});
  scene["accessors"].push_back({{"bufferView", view + 1}, {"componentType", 5126}, {"count", 2}, {"type", "VEC3"}});
  write(folder_ / "scene.gltf", scene.dump());
  expectPlan({"--spp", "4", "--frames", "2-6", "--parts", "2", "--image", "f###.png"});
  runPart("1");
  EXPECT_EQ(status()["states"]["done"], 1);
  expectError(quintet({"farm", "merge", "farm"}), 1, {"part 0 (frames 2–3) is missing"});
  runPart("0");
  ASSERT_EQ(quintet({"farm", "merge", "farm"}).status, 0);
  render("one###.png", {"--spp", "4", "--frames", "2-6"});
  for (const char* frame : {"002", "003", "004", "005", "006"})
    EXPECT_EQ(readImage("farm/f" + std::string(frame) + ".png").data,
              readImage("one" + std::string(frame) + ".png").data);
  EXPECT_NE(readImage("farm/f002.png").data, readImage("farm/f006.png").data);
  std::filesystem::remove(folder_ / "farm/f005.png");
  expectError(quintet({"farm", "merge", "farm"}), 1, {"part 1 (frames 4–6) is incomplete", "f005.png: is missing"});
}

TEST_F(Farm, RejectsWrongPlans) {
  const auto expectRejected = [&](const std::vector<std::string>& more, int status,
                                  const std::vector<std::string>& text) {
    expectError(plan(more), status, text);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "farm"));
  };
  expectRejected({"--spp", "16"}, 2, {"--parts"});
  expectRejected({"--spp", "16", "--parts", "5"}, 2, {"5 parts", "4 batches"});
  expectRejected({"--spp", "16", "--parts", "0"}, 2, {"--parts"});
  expectRejected({"--time", "5", "--parts", "2"}, 2, {"--time", "--spp"});
  expectRejected({"--spp", "16", "--until-error", "0.1", "--parts", "2"}, 2, {"--until-error", "--spp"});
  expectRejected({"--spp", "16", "--adaptive", "--parts", "2"}, 2, {"--adaptive", "--spp"});
  expectRejected({"--spp", "16", "--parts", "2", "--set", "nosuch=1"}, 2, {"nosuch"});
  expectRejected({"--spp", "16", "--parts", "2", "--env", "none.hdr"}, 1, {"none.hdr"});
  expectRejected({"--spp", "16", "--parts", "2", "--image", "a.mp4"}, 2, {"a.mp4", "frames"});
  expectRejected({"--spp", "16", "--parts", "2", "--image", "a.txt"}, 2, {"a.txt", ".qfilm"});
  expectRejected({"--spp", "16", "--parts", "2", "--sbatch", "a\nb"}, 2, {"line break"});
  expectError(quintet({"farm", "plan", "scene.gltf", "--parts", "2"}), 2, {"-o FOLDER"});
  for (const std::string name : {"out.png", "OUT.EXR", "out.qfilm", "out.mp4"}) {
    expectError(quintet({"farm", "plan", "scene.gltf", "--parts", "2", "-o", name}), 2, {name, "--image"});
    EXPECT_FALSE(std::filesystem::exists(folder_ / name));
  }
  expectError(quintet({"farm", "plan", "none.gltf", "--parts", "2", "-o", "farm"}), 1, {"none.gltf"});
  expectPlan({"--spp", "16", "--parts", "2"});
  expectPlan({"--spp", "16", "--parts", "2"});
  expectError(plan({"--spp", "16", "--parts", "4"}), 1, {"plan.json", "different plan", "--force"});
  expectPlan({"--spp", "16", "--parts", "4", "--force"});
  expectError(quintet({"farm", "run", "farm", "4"}), 2, {"part 4 does not exist", "4 parts"});
  expectError(quintet({"farm", "run", "farm", "-1"}), 2, {});
  expectError(quintet({"farm", "run", "nowhere", "0"}), 1, {"nowhere"});
  expectError(quintet({"farm", "status", "scene.gltf"}), 1, {"scene.gltf", "is not a plan"});
}

TEST_F(Farm, CommandsOfAGroup) {
  expectError(quintet({"farm"}), 2, {"the command after 'farm' is missing", "plan, run, merge, status"});
  expectError(quintet({"farm", "rum"}), 2, {"unknown command 'farm rum'", "'run'"});
  EXPECT_THAT(quintet({"farm", "--help"}).out, HasSubstr("farm status"));
  EXPECT_EQ(quintet({"help", "farm", "plan"}).out, quintet({"farm", "plan", "--help"}).out);
  EXPECT_EQ(quintet({"help", "farm"}).out, quintet({"farm", "--help"}).out);
}

class FarmSlurm : public Farm {
 protected:
  RunResult submit(const std::string& path) {
    RunResult result;
    const std::string command = "PATH='" + path + "' '" + (folder_ / "farm/submit.sh").string() +
                                "' --partition=gpu > '" + (folder_ / "out").string() + "' 2> '" +
                                (folder_ / "err").string() + "'";
    result.status = WEXITSTATUS(std::system(command.c_str()));
    result.out = readTextFile(folder_ / "out");
    result.err = readTextFile(folder_ / "err");
    return result;
  }
};

TEST_F(FarmSlurm, IsMissing) {
  expectPlan({"--spp", "16", "--parts", "2"});
  std::filesystem::create_directories(folder_ / "bin");
  for (const char* name : {"bash", "dirname", "env"})
    std::filesystem::create_symlink("/usr/bin/" + std::string(name), folder_ / "bin" / name);
  const RunResult result = submit((folder_ / "bin").string());
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("sbatch was not found"), HasSubstr("parallel.sh")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "farm/slurm_jobs"));
  write(folder_ / "farm/slurm_jobs", "render 41\nmerge 42\n");
  const nlohmann::json json = status({.environment = {{"PATH", (folder_ / "bin").string()}}});
  EXPECT_THAT(json["slurm"]["problem"].get<std::string>(), HasSubstr("squeue was not found"));
}

TEST_F(FarmSlurm, JobsAndTheirStates) {
  expectPlan({"--spp", "32", "--parts", "5", "--tasks", "2", "--partition", "cpu", "--time-limit", "1:00:00",
              "--memory", "2G", "--sbatch=--gres=gpu:1"});
  const std::string render = readTextFile(folder_ / "farm/render.sbatch");
  EXPECT_THAT(render, AllOf(HasSubstr("#SBATCH --array=0-1\n"), HasSubstr("#SBATCH --partition=cpu\n"),
                            HasSubstr("#SBATCH --time=1:00:00\n"), HasSubstr("#SBATCH --mem=2G\n"),
                            HasSubstr("#SBATCH --gres=gpu:1\n")));
  writeProgram("sbatch", "echo \"$@\" >> '" + (folder_ / "calls").string() +
                             "'\nif [ \"${*#*merge}\" = \"$*\" ]; then echo '41;cluster'; else echo 42; fi");
  writeProgram("squeue", "echo '41_0|RUNNING|node7'\necho '41_1|PENDING|'\necho '42|PENDING|'");
  writeProgram("sacct", "exit 1");
  const RunResult result = submit((folder_ / "bin").string() + ":" + std::getenv("PATH"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(readTextFile(folder_ / "calls"),
              AllOf(HasSubstr("--parsable --partition=gpu render.sbatch"),
                    HasSubstr("--dependency=afterany:41 --partition=gpu merge.sbatch")));
  const nlohmann::json json = status(withPrograms());
  EXPECT_EQ(json["slurm"]["job"], "41");
  ASSERT_EQ(json["notDone"].size(), 5u);
  for (const std::size_t part : {0u, 2u, 4u}) EXPECT_EQ(json["notDone"][part]["slurm"]["nodes"], "node7");
  for (const std::size_t part : {1u, 3u}) EXPECT_EQ(json["notDone"][part]["slurm"]["state"], "PENDING");
  EXPECT_THAT(quintet({"farm", "status", "farm"}, withPrograms()).out,
              AllOf(HasSubstr("RUNNING on node7"), HasSubstr("merge: PENDING")));
  writeProgram("squeue", "echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2\nexit 1");
  EXPECT_THAT(quintet({"farm", "status", "farm"}, withPrograms()).out,
              HasSubstr("squeue failed: slurm_load_jobs error"));
  writeProgram("squeue", "echo 'slurm_load_jobs error: Invalid job id specified' >&2\nexit 1");
  writeProgram("sacct", "echo '41_1|NODE_FAIL|node8'");
  EXPECT_THAT(quintet({"farm", "status", "farm"}, withPrograms()).out,
              AllOf(HasSubstr("NODE_FAIL on node8"), Not(HasSubstr("squeue failed"))));
  writeProgram("sacct", "echo '41_0|NODE_FAIL|node8'");
  const nlohmann::json first = status(withPrograms());
  for (const std::size_t part : {0u, 2u, 4u}) EXPECT_EQ(first["notDone"][part]["slurm"]["nodes"], "node8");
  for (const std::size_t part : {1u, 3u}) EXPECT_FALSE(first["notDone"][part].contains("slurm")) << "task 1 is unknown";
}

TEST_F(FarmSlurm, TasksRunTheirPartsAndRetryCrashes) {
  expectPlan({"--spp", "32", "--parts", "5", "--tasks", "2", "--quintet", (folder_ / "bin/quintet").string()});
  const std::string calls = (folder_ / "calls").string();
  const auto task = [&](const std::string& program) {
    writeProgram("quintet", "echo \"$5\" >> '" + calls + "'\n" + program);
    std::filesystem::remove(calls);
    return WEXITSTATUS(std::system(
        ("SLURM_ARRAY_TASK_ID=1 bash '" + (folder_ / "farm/render.sbatch").string() + "' > /dev/null 2>&1").c_str()));
  };
  EXPECT_EQ(task("exit 0"), 0);
  EXPECT_EQ(readTextFile(calls), "1\n3\n");
  EXPECT_EQ(task("exit 1"), 1);
  EXPECT_EQ(readTextFile(calls), "1\n3\n") << "an error is not retried, and the other parts are rendered";
  EXPECT_EQ(task("[ \"$5\" = 3 ] || exit 137"), 137);
  EXPECT_EQ(readTextFile(calls), "1\n1\n1\n3\n");
  EXPECT_EQ(task("exit 5"), 5);
}

}  // namespace
}  // namespace quintet::test
