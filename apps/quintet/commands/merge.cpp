// SPDX-License-Identifier: Apache-2.0
// `quintet merge`: parts of a render become the image, or the film, that one render would have written.
#include "job/merge.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "cli/render_options.h"
#include "cli/values.h"
#include "output/plan.h"
#include "output/report.h"
#include "output/write.h"

namespace quintet::cli {
namespace {

constexpr const char* kExamples =
    "  quintet merge a.qfilm b.qfilm -o scene.png                in any order; the bytes of one render\n"
    "  quintet merge part*.qfilm -o scene.exr\n"
    "  quintet merge a.qfilm b.qfilm -o ab.qfilm                 more parts can follow\n"
    "  quintet merge out.checkpoint.qfilm --partial -o preview.png  an image of an unfinished render\n";

struct Options {
  std::vector<std::filesystem::path> parts;
  output::OutputRequest output;
  ConsoleOptions console;
  bool partial = false;
  bool force = false;
};

std::optional<Options> parseOptions(Arguments arguments) {
  CLI::App app("Joins parts of a render, made by 'render --batches' on any number of machines.", "quintet merge");
  Options options;
  RenderTexts texts;
  app.add_option("PART", options.parts, "Films (.qfilm): parts or checkpoints")->type_name("");
  app.add_option("-o,--output", texts.output,
                 "Output file: .png, .exr, .hdr or .qfilm; - is PNG on\nstandard output, -.exr OpenEXR")
      ->type_name("FILE");
  declareDisplay(app, texts, "Image", "default: as rendered; stored by a film");
  app.add_flag("--all-outputs", options.output.allOutputs,
               "Write every output of the films: out.NAME.png (stored by a film)");
  app.add_flag("--partial", options.partial, "Write the image even if samples are missing");
  app.add_flag("--force", options.force, "Overwrite a film although its samples are lost");
  app.add_flag("--json", options.console.json, "Print one JSON object on standard output at the end");
  app.add_flag("-q,--quiet", options.console.quiet, "Print no notes on standard error");
  declareExr(app, texts, true);
  setUp(app, kExamples);
  if (!parse(app, arguments)) return std::nullopt;
  if (options.parts.empty()) throw UsageError("no parts given; see 'quintet merge --help'");
  if (texts.output.empty()) throw UsageError("no output given (-o FILE); see 'quintet merge --help'");
  if (std::ranges::find(texts.layers, "list") != texts.layers.end())
    throw UsageError("--aov list: use 'quintet render --aov list' to list the layers of a program");
  options.output.file = texts.output;
  convertOutput(texts, options.output);
  RenderOptions standardOutput;
  standardOutput.output.file = options.output.file;
  standardOutput.console = options.console;
  checkStandardOutput(standardOutput);
  output::checkMergeRequest(options.output);
  return options;
}

}  // namespace

int mergeCommand(Arguments arguments) {
  const Stopwatch clock;
  const std::optional<Options> options = parseOptions(arguments);
  if (!options) return 0;
  Console console(options->console);
  job::RenderResult result = job::merge(options->parts, console, commandLine("merge", arguments));
  const output::OutputPlan plan = output::planOutputs(options->output, result, options->parts.front());
  if (const std::string missing = job::missingText(result); !missing.empty()) {
    if (plan.kind != output::FileKind::film && !options->partial)
      throw Error(missing + "; use --partial to write the image anyway");
    console.note(missing);
  }
  if (const std::string text = output::ignoredDisplayText(options->output); !text.empty()) console.note(text);
  if (!options->force) output::checkFilmLoss(plan, result);
  output::storeNotes(plan, result);
  const std::vector<output::WrittenFile> files = output::writeOutputs(plan, result, console);
  console.clear();
  if (options->console.json) writeFile("-", output::resultJson(result, files, clock.seconds()));
  console.note(output::resultSummary(result, files));
  return 0;
}

}  // namespace quintet::cli
