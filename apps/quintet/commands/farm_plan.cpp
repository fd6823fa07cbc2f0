// SPDX-License-Identifier: Apache-2.0
// `quintet farm plan`: checks a render, splits it into parts, and writes the plan with its scripts. It needs no device.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "base/text.h"
#include "cli/candidates.h"
#include "cli/command.h"
#include "cli/console.h"
#include "cli/parser.h"
#include "cli/values.h"
#include "commands/farm.h"
#include "commands/render.h"
#include "farm/scripts.h"
#include "job/identity.h"
#include "job/resolve.h"
#include "job/scene_loading.h"
#include "job/version.h"
#include "output/json_line.h"
#include "program/load.h"
#include "shader/library.h"

namespace quintet::cli {
namespace {

struct FarmPlanOptions {
  RenderOptions render;
  RenderTexts texts;
  std::string folder, image, parts, tasks, retries, program;
  farm::ScriptOptions scripts;
  bool force = false;
  bool json = false;
  bool quiet = false;
};

OptionTable declareFarmPlan(FarmPlanOptions& options) {
  OptionTable table(
      "farm plan",
      "Splits a render into parts for many machines, and writes a folder with the plan, a Slurm job array, its "
      "merge job, and a script for GNU parallel over SSH. Needs no device.");
  table.add({{.names = "SCENE",
              .help = "Scene file: .gltf, .glb or .scene.toml",
              .target = &options.texts.scene,
              .candidates = {.extensions = kSceneExtensions},
              .required = true}});
  table.add(
      "Plan",
      {{.names = "-o,--output",
        .value = "FOLDER",
        .help = "Folder of the plan, which all machines can reach",
        .target = &options.folder,
        .candidates = {.folders = true}},
       {.names = "--parts",
        .value = "N",
        .help = "Number of parts: of batches of 4 samples, or with --frames of frames (default: one per frame)",
        .target = &options.parts},
       {.names = "--image",
        .value = "FILE",
        .help = "Result, in FOLDER: .png, .exr, .hdr or .qfilm; with --frames the name of the frames, where #### is "
                "their number (default: SCENE.png)",
        .target = &options.image,
        .candidates = {.extensions = {"png", "exr", "hdr", "qfilm"}}},
       {.names = "--force", .help = "Replace a different plan in FOLDER", .target = &options.force},
       {.names = "--json", .help = "Print one JSON object on standard output", .target = &options.json},
       {.names = "-q,--quiet", .help = "Print no notes on standard error", .target = &options.quiet}});
  table.add(
      "Scripts",
      {{.names = "--quintet",
        .value = "FILE",
        .help = "The program on the machines (default: this one)",
        .target = &options.program},
       {.names = "--tasks",
        .value = "N",
        .help = "Largest number of tasks of the job array, for Slurm's MaxArraySize; with more parts a task renders "
                "several (default: 1000)",
        .target = &options.tasks},
       {.names = "--retries",
        .value = "N",
        .help = "How often a part whose process crashed or was killed is tried again (default: 2)",
        .target = &options.retries},
       {.names = "--partition", .value = "NAME", .help = "Partition of Slurm", .target = &options.scripts.partition},
       {.names = "--time-limit",
        .value = "TIME",
        .help = "Time limit of a task for Slurm, such as 2:00:00",
        .target = &options.scripts.time},
       {.names = "--memory",
        .value = "SIZE",
        .help = "Memory of a task for Slurm, such as 16G",
        .target = &options.scripts.memory},
       {.names = "--sbatch",
        .value = "OPTION",
        .help = "Further option of sbatch, such as --sbatch=--gres=gpu:1; may be repeated",
        .target = &options.scripts.sbatch}});
  declarePlanned(table, options.texts, options.render);
  table.addExamples({
      {"quintet farm plan scene.glb --spp 4096 --parts 64 -o farm", "64 parts of 64 samples"},
      {"farm/submit.sh", "submits the job array and the merge job to Slurm"},
      {"farm/parallel.sh --sshlogin 1/node1,1/node2", "the same plan with GNU parallel over SSH"},
      {"quintet farm status farm", "which parts are done"},
      {"quintet farm plan fox.glb --frames 0-239 --parts 24 --image f####.exr -o farm", "ten frames per part"},
  });
  return table;
}

// What was planned, for the user.
std::string summary(const farm::Plan& plan, const farm::ScriptOptions& scripts) {
  const bool frames = plan.kind == farm::PartKind::frames;
  std::uint64_t most = 0;
  for (const farm::Part& part : plan.parts) most = std::max(most, part.last - part.first + 1);
  const std::size_t tasks = farm::taskCount(plan, scripts);
  return fmt::format("{}: {} of {}{}, in {}; start it with {} or {}", (plan.folder / farm::kPlanFile).string(),
                     counted(plan.parts.size(), "part"), most > 1 ? "at most " : "",
                     frames ? counted(most, "frame") : counted(most, "batch", "batches"), counted(tasks, "task"),
                     shellQuoted((plan.folder / "submit.sh").string()),
                     shellQuoted((plan.folder / "parallel.sh").string()));
}

std::string summaryJson(const farm::Plan& plan, const farm::ScriptOptions& scripts) {
  return output::jsonLine({{"plan", farm::planId(plan)},
                           {"file", (plan.folder / farm::kPlanFile).string()},
                           {"image", plan.image.string()},
                           {"kind", farm::partKindName(plan.kind)},
                           {"parts", plan.parts.size()},
                           {"tasks", farm::taskCount(plan, scripts)}});
}

// In other commands, -o is the image.
void checkFolder(const std::filesystem::path& folder) {
  const bool isFile = output::kindByExtension(folder) || output::videoFormat(folder);
  if (isFile && !std::filesystem::is_directory(folder))
    throw UsageError(fmt::format("-o {}: this would be the folder of the plan; name the image with --image {}",
                                 folder.string(), folder.filename().string()));
}

// Only frames can have other limits than a number of samples.
void checkLimits(const job::RenderLimits& limits) {
  if (!limits.adaptive && !limits.error && !limits.seconds) return;
  throw UsageError(
      fmt::format("{}: the parts of an image have a fixed number of samples, the same for all pixels; use --spp alone",
                  limits.adaptive ? "--adaptive"
                  : limits.error  ? "--until-error"
                                  : "--time"));
}

std::vector<farm::Part> partsOf(const FarmPlanOptions& options, bool frames) {
  const std::optional<std::uint64_t> count =
      parseInteger("--parts", options.parts, 1, static_cast<double>(farm::kMaxParts));
  const job::RenderRequest& request = options.render.request;
  if (frames) {
    const std::uint64_t first = request.frames.firstFrame(), last = request.frames.lastFrame();
    return farm::splitWork(first, last, count.value_or(last - first + 1), "frame", "frames");
  }
  if (!count) throw UsageError("--parts is missing: into how many parts the samples are split");
  checkLimits(request.limits);
  const std::uint64_t batches = (*request.limits.samples + render::kBatchSamples - 1) / render::kBatchSamples;
  return farm::splitWork(0, batches - 1, *count, "batch", "batches");
}

// Rejects what is wrong with the render itself, and adds the content of its files to the plan.
void describeRender(farm::Plan& plan, const RenderOptions& options, bool frames) {
  const program::Program named = program::loadProgram(options.program);
  const program::Program program = output::withRequestedHeatMaps(named, options.output);
  const output::OutputPlan outputs = output::planOutputs(options.output, program, options.request.frames);
  job::RenderRequest request = requestFor(options, outputs);
  if (frames) {
    request.checkpoint.file = plan.folder / "part.checkpoint.qfilm";
  } else {
    request.film = plan.folder / "part.qfilm";
    request.batches = job::BatchRange{plan.parts.front().first, plan.parts.back().last};
  }
  const job::ResolvedJob job = job::resolve(std::move(request), program);
  const job::LoadedScene scene = job::SceneLoading(job.scene, job.request).finish();
  output::checkSize(outputs, scene.size);
  plan.sceneHash = scene.hash;
  plan.environmentHash = scene.environmentHash;
  plan.programHash = job::programHash(job.program, {});
}

}  // namespace

OptionTable farmPlanOptions() {
  FarmPlanOptions options;
  return declareFarmPlan(options).withoutTargets();
}

int farmPlanCommand(Arguments arguments) {
  FarmPlanOptions options;
  const OptionTable table = declareFarmPlan(options);
  if (!parse(table, arguments)) return 0;
  if (options.texts.scene.empty()) throw UsageError("no scene given; see 'quintet farm plan --help'");
  if (options.folder.empty()) throw UsageError("no folder given (-o FOLDER); see 'quintet farm plan --help'");
  checkFolder(options.folder);
  OptionTable planned("farm plan", "");
  declarePlanned(planned, options.texts, options.render);

  farm::Plan plan;
  plan.version = job::quintetVersion();
  plan.libraryHash = shader::libraryHash().hex();
  plan.workingFolder = std::filesystem::current_path();
  plan.folder = std::filesystem::weakly_canonical(std::filesystem::absolute(options.folder));
  plan.scene = std::filesystem::absolute(options.texts.scene).lexically_normal();
  plan.options = selectArguments(table, planned, arguments);
  plan.image = plan.folder / (options.image.empty() ? plan.scene.filename().replace_extension(".png")
                                                    : std::filesystem::path(options.image));
  const bool frames = !options.texts.frames.empty();
  plan.kind = frames ? farm::PartKind::frames : farm::PartKind::batches;
  options.texts.scene = plan.scene.string();
  convertPlanned(options.texts, options.render, plan.image, frames);
  plan.parts = partsOf(options, frames);
  if (!frames) plan.samples = *options.render.request.limits.samples;

  options.scripts.program = executableFolder() / "quintet";
  if (!options.program.empty()) {  // a name without a folder is found in $PATH
    const std::filesystem::path program = options.program;
    options.scripts.program = program.has_parent_path() ? std::filesystem::absolute(program) : program;
  }
  options.scripts.tasks = parseInteger("--tasks", options.tasks, 1, 4e6).value_or(farm::kDefaultTasks);
  options.scripts.retries = static_cast<unsigned>(parseInteger("--retries", options.retries, 0, 1000).value_or(2));
  std::error_code failed;
  const bool isNew = std::filesystem::create_directories(plan.folder, failed);
  if (failed) throw FileError(plan.folder, "cannot be created: " + failed.message());
  try {
    describeRender(plan, options.render, frames);
    farm::writePlan(plan, options.scripts, options.force);
  } catch (...) {
    if (isNew) std::filesystem::remove(plan.folder, failed);  // if it is empty
    throw;
  }
  if (options.json) writeFile("-", summaryJson(plan, options.scripts));
  if (!options.quiet) printMessage(summary(plan, options.scripts));
  return 0;
}

}  // namespace quintet::cli
