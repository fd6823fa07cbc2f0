// SPDX-License-Identifier: Apache-2.0
// `quintet find`: samples that are not finite, and fireflies, with the command that explains each of them.
#include <unistd.h>

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "cli/candidates.h"
#include "cli/exit_status.h"
#include "cli/parser.h"
#include "cli/render_options.h"
#include "cli/terminal.h"
#include "cli/values.h"
#include "cli/work.h"
#include "job/sample_search.h"
#include "output/search_report.h"
#include "program/load.h"

namespace quintet::cli {
namespace {

constexpr double kMaxThreshold = 1e6;
constexpr double kMaxLimit = 1000;

struct FindOptions : RenderOptions {
  bool notFinite = false, fireflies = false;  // neither means both
  job::SearchOptions search;
  std::string command;  // that explains a sample, without pixel and sample
};

struct FindTexts : RenderTexts {
  std::string threshold, limit;
};

OptionTable declareFind(FindOptions& options, FindTexts& texts) {
  OptionTable table("find",
                    "Finds samples that are not finite (NaN or infinite), and fireflies, and prints the command that "
                    "explains each of them. No image is written. The status is 1 if a sample is found.");
  table.add({{.names = "SCENE",
              .help = "Scene file: .gltf, .glb or .scene.toml (default: the program's own)",
              .target = &texts.scene,
              .candidates = {.extensions = kSceneExtensions}}});
  table.add(
      "Search",
      {{.names = "--nan",
        .help = "Find samples that are not finite (default: both kinds)",
        .target = &options.notFinite},
       {.names = "--fireflies",
        .help = "Find samples that alone make their pixel much brighter than its surroundings",
        .target = &options.fireflies},
       {.names = "--threshold",
        .value = "X",
        .help = "Firefly: one sample makes the pixel more than X times as bright as its surroundings (default: 2)",
        .target = &texts.threshold},
       {.names = "--limit",
        .value = "N",
        .help =
            "Number of groups of adjacent pixels of each kind to explain; the others are only counted (default: 10)",
        .target = &texts.limit},
       {.names = "--json", .help = "Print one JSON object on standard output", .target = &options.console.json}});
  declareSize(table, texts, options, "Search only this part, in pixels from the top left");
  declareFrame(table, texts, "Search");
  declareQuality(table, texts, options);
  declareView(table, texts, options);
  declareAnimation(table, texts, options);
  declareProgramName(table, options);
  declareParameters(table, options);
  declareDevice(table, texts, options);
  table.add("Run",
            {{.names = "-q,--quiet", .help = "Print neither progress nor notes", .target = &options.console.quiet}});
  table.addExamples({
      {"quintet find scene.glb", "both kinds, in a render of 64 samples per pixel"},
      {"quintet find scene.glb --nan --spp 256 --size 640x360", "only NaN and infinite samples"},
      {"quintet find scene.glb --fireflies --threshold 5 --json", "for scripts"},
  });
  return table;
}

// The arguments that `explain-pixel` has, too.
std::vector<std::string> sharedArguments(Arguments arguments) {
  const std::vector<std::string> flags{"--nan", "--fireflies", "--json", "-q", "--quiet"};
  const std::vector<std::string> values{"--threshold", "--limit", "--region"};
  std::vector<std::string> shared;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string name = arguments[i].substr(0, arguments[i].find('='));
    if (std::ranges::find(flags, arguments[i]) != flags.end()) continue;
    if (std::ranges::find(values, name) == values.end())
      shared.push_back(arguments[i]);
    else if (name == arguments[i])
      ++i;  // its value follows
  }
  return shared;
}

std::optional<FindOptions> parseFind(Arguments arguments) {
  FindOptions options;
  FindTexts texts;
  if (!parse(declareFind(options, texts), arguments)) return std::nullopt;
  options.request.scene = texts.scene;
  options.console.stopNote = "reporting what was found; press Ctrl-C again to quit without a report";
  options.command = commandLine("explain-pixel", sharedArguments(arguments));
  options.output.file = "image.png";  // of the render that is searched; it is not written
  convert(texts, options);
  if (options.request.limits.samples)
    options.request.frames.accumulated = static_cast<std::uint32_t>(*options.request.limits.samples);
  job::SearchOptions& search = options.search;
  if (options.notFinite || options.fireflies) {
    search.notFinite = options.notFinite;
    search.fireflies = options.fireflies;
  }
  if (const auto threshold = parseReal("--threshold", texts.threshold, 1e-3, kMaxThreshold))
    search.threshold = static_cast<float>(*threshold);
  if (const auto limit = parseInteger("--limit", texts.limit, 0, kMaxLimit)) search.limit = *limit;
  convertFrames(texts, options);
  return options;
}

}  // namespace

OptionTable findOptions() {
  FindOptions options;
  FindTexts texts;
  return declareFind(options, texts).withoutTargets();
}

int findCommand(Arguments arguments) {
  const std::optional<FindOptions> options = parseFind(arguments);
  if (!options) return 0;
  const program::Program program = program::loadProgram(options->program);
  Console console(options->console);
  console.setProgram(&program);
  try {
    job::Engine engine({.device = options->device, .log = [&](LogLevel level, const std::string& text) {
                          if (level == LogLevel::warning) console.warning(text);
                        }});
    job::RenderJob job(engine, job::resolve(options->request, program), console);
    const GracefulStop stop;  // from here on, Ctrl-C ends the search and explains what was found
    console.setGracefulStop(&stop);
    setWorkStage("searching samples");
    const job::SearchResult result = job::searchSamples(engine, job, options->search, console);
    console.clear();
    const auto commandFor = [&](const job::FoundSample& found) {
      return fmt::format("{} --pixel {},{} --sample {}", options->command, found.pixel.x, found.pixel.y, found.sample);
    };
    writeFile("-", options->console.json
                       ? output::searchJson(result, commandFor)
                       : output::searchText(result, commandFor, terminalWidth(STDOUT_FILENO).value_or(100)));
    if (result.interrupted) return stop.exitStatus();
    return result.notFiniteCount + result.fireflyCount > 0 ? kRuntimeError : 0;
  } catch (const ProgramError& error) {
    console.diagnostics(error.diagnostics());
    return kRuntimeError;
  }
}

}  // namespace quintet::cli
