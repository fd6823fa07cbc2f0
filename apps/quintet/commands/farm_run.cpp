// SPDX-License-Identifier: Apache-2.0
// `quintet farm run`: renders a part of a plan, unless it is done. A failure is recorded for `farm status` and `farm merge`.
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "base/plural.h"
#include "base/stopwatch.h"
#include "cli/command.h"
#include "cli/console.h"
#include "cli/failure.h"
#include "cli/parser.h"
#include "cli/values.h"
#include "commands/farm.h"
#include "commands/render.h"
#include "farm/part_check.h"
#include "farm/part_failure.h"
#include "farm/part_lock.h"
#include "job/identity.h"
#include "job/render_job.h"
#include "program/load.h"

namespace quintet::cli {
namespace {

constexpr double kLockSeconds = 30.0;  // for a killed process to end

struct FarmRunOptions {
  std::filesystem::path plan;
  std::string part;
  ConsoleOptions console;
  std::string device;
  bool force = false;
};

OptionTable declareFarmRun(FarmRunOptions& options) {
  OptionTable table("farm run",
                    "Renders a part of a plan of 'farm plan'. A part that is done is skipped; one that was interrupted "
                    "continues from its checkpoint.");
  table.add({planArgument(options.plan),
             {.names = "PART", .help = "Number of the part, from 0", .target = &options.part, .required = true},
             {.names = "--device",
              .value = "NAMES",
              .help = "Devices of this machine, instead of those of the plan",
              .target = &options.device},
             {.names = "--force",
              .help = "Render the part again although its file belongs to a different plan",
              .target = &options.force},
             {.names = "--json-progress",
              .help = "Print a line of JSON on standard error for each batch",
              .target = &options.console.jsonProgress},
             {.names = "-q,--quiet", .help = "Print neither progress nor notes", .target = &options.console.quiet}});
  table.addExamples({{"quintet farm run farm 3", "part 3 of farm/plan.json"}});
  return table;
}

// The render of a part: the planned one with the files of the part.
RenderOptions optionsOf(const farm::Plan& plan, std::size_t part, const FarmRunOptions& run) {
  RenderOptions options = plannedOptions(plan);
  const farm::Part& work = plan.parts[part];
  job::RenderRequest& request = options.request;
  if (plan.kind == farm::PartKind::frames) {
    request.frames.first = static_cast<std::uint32_t>(work.first);
    request.frames.count = static_cast<std::uint32_t>(work.last - work.first + 1);
  } else {
    request.batches = job::BatchRange{work.first, work.last};
    request.film = options.output.file = farm::partFile(plan, part);
    options.output.everyFrame = false;
    options.output.exr.reset();  // of the merged image
    options.output.pngBits.reset();
  }
  request.checkpoint.file = farm::checkpointFile(plan, part);
  request.checkpoint.resume = request.checkpoint.force = true;  // start over if the checkpoint cannot be used
  request.overwriteFilm = true;                                 // the file was checked
  request.farmPlan = farm::planId(plan);
  if (!run.device.empty()) options.device = run.device;
  options.console = run.console;
  options.prepared = [&plan](const job::RenderJob& job) {
    farm::requireSameContent(plan, job.scene()->hash, job.scene()->environmentHash,
                             job::programHash(job.resolved().program, {}));
  };
  if (plan.kind == farm::PartKind::frames)
    options.written = [&plan, part](const job::RenderResult& result, const std::vector<output::FrameFiles>& frames) {
      if (result.interrupted) return;
      std::vector<farm::WrittenFrame> list;
      for (const output::FrameFiles& frame : frames) list.push_back({frame.frame, frame.files});
      farm::writeFrameList(plan, part, list);
    };
  return options;
}

// Returns the exit status.
int renderPart(const farm::Plan& plan, std::size_t part, const FarmRunOptions& run, Arguments arguments,
               const Stopwatch& clock) {
  farm::requireSameVersion(plan, farm::machineName());
  const farm::PartCheck check = farm::checkPart(plan, part, farm::CheckDepth::content);
  if (check.state == farm::PartState::foreign && !run.force)
    throw FileError(farm::partFile(plan, part), "belongs to a different plan or part", Remedy::overwrite);
  if (check.state == farm::PartState::done) {
    if (!run.console.quiet) printMessage(fmt::format("{} is done", farm::partName(plan, part)));
    return 0;
  }
  if (!check.problem.empty() && check.state != farm::PartState::missing && !run.console.quiet)
    printMessage(fmt::format("{}; rendering it again", check.problem));
  farm::waitUntilFree(plan, part, kLockSeconds, [&](const std::string& text) {
    if (!run.console.quiet) printMessage(text);
  });
  farm::recordFailure(plan, part, {farm::machineName(), "", 0});  // what remains if the process is killed
  std::error_code failed;
  std::filesystem::current_path(plan.workingFolder, failed);
  if (failed) throw FileError(plan.workingFolder, "cannot be entered: " + failed.message());
  RenderOptions options = optionsOf(plan, part, run);
  options.request.commandLine = commandLine("farm run", arguments);
  return renderImages(options, program::loadProgram(options.program), clock);
}

}  // namespace

OptionTable farmRunOptions() {
  FarmRunOptions options;
  return declareFarmRun(options).withoutTargets();
}

int farmRunCommand(Arguments arguments) {
  const Stopwatch clock;
  FarmRunOptions options;
  if (!parse(declareFarmRun(options), arguments)) return 0;
  if (options.plan.empty() || options.part.empty())
    throw UsageError("plan or part missing; see 'quintet farm run --help'");
  const farm::Plan plan = farm::readPlan(options.plan);
  const auto part =
      static_cast<std::size_t>(parseInteger("PART", options.part, 0, static_cast<double>(farm::kMaxParts)).value());
  if (part >= plan.parts.size())
    throw UsageError(fmt::format("part {} does not exist: the plan has {}, from 0 to {}", part,
                                 counted(plan.parts.size(), "part"), plan.parts.size() - 1));
  int status = kRuntimeError;
  try {
    status = renderPart(plan, part, options, arguments, clock);
  } catch (const std::exception& error) {
    farm::recordFailure(plan, part, {farm::machineName(), error.what(), failureStatus(error)});
    throw;
  }
  if (status == 0)
    farm::removeFailure(plan, part);
  else
    farm::recordFailure(plan, part, {farm::machineName(), "the render ended early; its log has the cause", status});
  return status;
}

}  // namespace quintet::cli
