// SPDX-License-Identifier: Apache-2.0
// `quintet farm merge`: the verified parts of a plan become its image; of an animation, the frames are verified.
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "base/stopwatch.h"
#include "cli/command.h"
#include "cli/parser.h"
#include "cli/values.h"
#include "commands/farm.h"
#include "commands/merge.h"
#include "farm/part_check.h"
#include "farm/part_failure.h"
#include "farm/part_merge.h"
#include "farm/status.h"

namespace quintet::cli {
namespace {

struct FarmMergeOptions {
  std::filesystem::path plan;
  std::filesystem::path output;
  ConsoleOptions console;
  std::string maxMemory;
  bool partial = false;
  bool force = false;
};

OptionTable declareFarmMerge(FarmMergeOptions& options) {
  OptionTable table(
      "farm merge",
      "Verifies the parts of a plan and joins them to the image that one render would have written. One error "
      "names all parts that are missing, damaged or foreign.");
  table.add({planArgument(options.plan),
             {.names = "-o,--output",
              .value = "FILE",
              .help = "Output file: .png, .exr, .hdr or .qfilm (default: the image of the plan)",
              .target = &options.output,
              .candidates = {.extensions = {"png", "exr", "hdr", "qfilm"}}},
             {.names = "--partial",
              .help = "Write the image of the parts that are done, without the missing ones",
              .target = &options.partial},
             {.names = "--force", .help = "Overwrite a film although its samples are lost", .target = &options.force},
             {.names = "--max-memory", .value = "BYTES", .help = kMaxMemoryHelp, .target = &options.maxMemory},
             {.names = "--json",
              .help = "Print one JSON object on standard output at the end",
              .target = &options.console.json},
             {.names = "-q,--quiet", .help = "Print no notes on standard error", .target = &options.console.quiet}});
  table.addExamples({{"quintet farm merge farm", "writes the image of farm/plan.json"},
                     {"quintet farm merge farm --partial -o preview.png", "an image of the parts so far"}});
  return table;
}

int verifyFrames(const farm::Plan& plan, const FarmMergeOptions& options, Console& console) {
  console.stage("checking frames");
  const farm::Status status = farm::readStatus(plan, farm::CheckDepth::content);
  farm::requireUsable(plan, status.parts, status.unexpected, options.partial);
  console.clear();
  if (options.console.json) writeFile("-", farm::statusJson(status));
  const std::uint64_t frames = plan.parts.back().last - plan.parts.front().first + 1;
  console.note(fmt::format("{}: {} verified", plan.image.string(), counted(frames, "frame")));
  return 0;
}

}  // namespace

OptionTable farmMergeOptions() {
  FarmMergeOptions options;
  return declareFarmMerge(options).withoutTargets();
}

int farmMergeCommand(Arguments arguments) {
  const Stopwatch clock;
  FarmMergeOptions options;
  if (!parse(declareFarmMerge(options), arguments)) return 0;
  if (options.plan.empty()) throw UsageError("no plan given; see 'quintet farm merge --help'");
  const farm::Plan plan = farm::readPlan(options.plan);
  farm::requireSameVersion(plan, farm::machineName());
  Console console(options.console);
  if (plan.kind == farm::PartKind::frames) return verifyFrames(plan, options, console);
  output::OutputRequest output = plannedOptions(plan).output;
  if (!options.output.empty()) output.file = options.output;
  const output::FileKind kind = output::fileKind(output.file);
  if (kind != output::FileKind::exr) output.exr.reset();
  if (kind != output::FileKind::exr) output.layers.clear();  // a film keeps those of its parts
  if (kind != output::FileKind::png) output.pngBits.reset();
  output::checkMergeRequest(output);
  const std::size_t maxMemory = parseBytes("--max-memory", options.maxMemory).value_or(0);
  job::RenderResult result =
      farm::mergeParts(plan, options.partial, console, commandLine("farm merge", arguments), maxMemory);
  return writeMerged(std::move(result),
                     {output, farm::partFile(plan, 0), options.partial, options.force, options.console.json, maxMemory},
                     console, clock);
}

}  // namespace quintet::cli
