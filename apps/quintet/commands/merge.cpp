// SPDX-License-Identifier: Apache-2.0
// `quintet merge`: parts of a render become the image, or the film, that one render would have written.
#include "commands/merge.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "cli/parser.h"
#include "cli/render_options.h"
#include "cli/values.h"
#include "commands/render.h"
#include "job/merge.h"
#include "output/plan.h"
#include "output/report.h"
#include "output/write.h"

namespace quintet::cli {
namespace {

struct MergeOptions {
  std::vector<std::filesystem::path> parts;
  output::OutputRequest output;
  ConsoleOptions console;
  bool partial = false;
  bool force = false;
  std::size_t maxMemory = 0;  // as of scene::LoadOptions
};

OptionTable declareMerge(MergeOptions& options, RenderTexts& texts) {
  OptionTable table("merge", "Joins parts of a render, made by 'render --batches' on any number of machines.");
  table.add({{.names = "PART",
              .help = "Films (.qfilm): parts or checkpoints",
              .target = &options.parts,
              .candidates = {.extensions = {"qfilm"}},
              .required = true},
             {.names = "-o,--output",
              .value = "FILE",
              .help = "Output file: .png, .exr, .hdr or .qfilm; - is PNG on standard output, -.exr OpenEXR",
              .target = &texts.output,
              .candidates = {.extensions = {"png", "exr", "hdr", "qfilm"}}},
             {.names = "--all-outputs",
              .help = "Write every output of the films: out.NAME.png (stored by a film)",
              .target = &options.output.allOutputs},
             {.names = "--partial", .help = "Write the image even if samples are missing", .target = &options.partial},
             {.names = "--force", .help = "Overwrite a film although its samples are lost", .target = &options.force},
             {.names = "--max-memory", .value = "BYTES", .help = kMaxMemoryHelp, .target = &texts.load.maxMemory},
             {.names = "--json",
              .help = "Print one JSON object on standard output at the end",
              .target = &options.console.json},
             {.names = "-q,--quiet", .help = "Print no notes on standard error", .target = &options.console.quiet}});
  declareDisplay(table, texts, "Image", "default: as rendered; stored by a film");
  declareExr(table, texts, true);
  table.addExamples({
      {"quintet merge a.qfilm b.qfilm -o scene.png", "in any order; the bytes of one render"},
      {"quintet merge part*.qfilm -o scene.exr"},
      {"quintet merge a.qfilm b.qfilm -o ab.qfilm", "more parts can follow"},
      {"quintet merge out.checkpoint.qfilm --partial -o preview.png", "an image of an unfinished render"},
  });
  return table;
}

std::optional<MergeOptions> parseMerge(Arguments arguments) {
  MergeOptions options;
  RenderTexts texts;
  if (!parse(declareMerge(options, texts), arguments)) return std::nullopt;
  if (options.parts.empty()) throw UsageError("no parts given; see 'quintet merge --help'");
  if (texts.output.empty()) throw UsageError("no output given (-o FILE); see 'quintet merge --help'");
  if (std::ranges::find(texts.layers, "list") != texts.layers.end())
    throw UsageError("--aov list: use 'quintet render --aov list' to list the layers of a program");
  options.output.file = texts.output;
  convertOutput(texts, options.output);
  options.maxMemory = parseBytes("--max-memory", texts.load.maxMemory).value_or(0);
  RenderOptions standardOutput;
  standardOutput.output.file = options.output.file;
  standardOutput.console = options.console;
  checkStandardStreams(standardOutput);
  output::checkMergeRequest(options.output);
  return options;
}

}  // namespace

OptionTable mergeOptions() {
  MergeOptions options;
  RenderTexts texts;
  return declareMerge(options, texts).withoutTargets();
}

int mergeCommand(Arguments arguments) {
  const Stopwatch clock;
  const std::optional<MergeOptions> options = parseMerge(arguments);
  if (!options) return 0;
  Console console(options->console);
  job::RenderResult result = job::merge(options->parts, console, commandLine("merge", arguments), options->maxMemory);
  return writeMerged(std::move(result),
                     {options->output, options->parts.front(), options->partial, options->force, options->console.json,
                      options->maxMemory},
                     console, clock);
}

int writeMerged(job::RenderResult result, const MergeOutput& options, Console& console, const Stopwatch& clock) {
  const output::OutputPlan plan = output::planOutputs(options.output, result, options.firstPart);
  if (const std::string missing = job::missingText(result); !missing.empty()) {
    if (plan.kind != output::FileKind::film && !options.partial)
      throw Error(missing + "; use --partial to write the image anyway");
    console.note(missing);
  }
  if (const std::string text = output::ignoredDisplayText(options.output); !text.empty()) console.note(text);
  if (!options.force) output::checkFilmLoss(plan, result, options.maxMemory);
  output::storeNotes(plan, result);
  const std::vector<output::WrittenFile> files = output::writeOutputs(plan, result, console);
  addWarnings(result, console);
  console.clear();
  if (options.json) writeFile("-", output::resultJson(result, files, clock.seconds()));
  console.note(output::resultSummary(result, files));
  return 0;
}

}  // namespace quintet::cli
