// SPDX-License-Identifier: Apache-2.0
// `quintet run`: a user's program or a built-in one, on a scene or on the built-in one; with --watch again after each save.
#include <unistd.h>

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "base/text.h"
#include "cli/candidates.h"
#include "cli/failure.h"
#include "cli/help_text.h"
#include "cli/parser.h"
#include "cli/supervisor.h"
#include "cli/terminal.h"
#include "cli/values.h"
#include "cli/work.h"
#include "commands/render.h"
#include "gpu/error.h"
#include "job/watch.h"
#include "output/file_names.h"
#include "output/layers.h"
#include "output/report.h"
#include "output/write.h"
#include "program/heat.h"
#include "program/help.h"
#include "program/load.h"

namespace quintet::cli {
namespace {

struct RunOptions : RenderOptions {
  bool list = false;  // print the built-in programs
  bool watch = false;
  bool namedByProgram = false;  // no output file was given
};

void convertFrameCount(const RenderTexts& texts, RunOptions& options) {
  job::FrameRequest& request = options.request.frames;
  convertFrames(texts, options);
  if (!texts.spp.empty()) request.accumulated = static_cast<std::uint32_t>(*options.request.limits.samples);
  if (!request.accumulated && !options.request.limits.seconds) request.accumulated = 1;
  request.every = options.output.everyFrame = options.output.everyFrame || output::hasFramePattern(options.output.file);
}

OptionTable declareRun(RunOptions& options, RenderTexts& texts) {
  OptionTable table("run",
                    "Runs a program: a folder with program.toml, a file NAME.rt.glsl, or a built-in one by name.");
  table.redirectHelp(&options.programHelp);  // with a program, its help
  table.add({{.names = "PROGRAM",
              .help = "Folder or file of a program, or name of a built-in one (--list)",
              .target = &options.program,
              .candidates = programCandidates(),
              .required = true},
             {.names = "SCENE",
              .help = "Scene file: .gltf, .glb or .scene.toml (default: the program's own, or built in)",
              .target = &texts.scene,
              .candidates = {.extensions = kSceneExtensions}}});
  table.add(
      "Image",
      {{.names = "-o",
        .value = "FILE",
        .help =
            "Output file: .png, .exr or .hdr; #### is the frame number; .mp4, .webm or .gif is a video of --frames; - "
            "is PNG on standard output, -.exr OpenEXR (default: PROGRAM.png in the current folder)",
        .target = &texts.output,
        .candidates = {.extensions = {"png", "exr", "hdr", "mp4", "webm", "gif"}}}});
  declareImageOptions(table, texts, options);
  declareProgram(table, options);
  table.add("Program", {{.names = "--output",
                         .value = "NAME",
                         .help = "Output of the program to write (default: the first)",
                         .target = &options.output.output,
                         .candidates = {.names = program::heatMapNames()}},
                        {.names = "--list", .help = "List the built-in programs and exit", .target = &options.list}});
  table.add(
      "Run",
      {{.names = "--watch", .help = "Keep running: render again whenever a file is saved", .target = &options.watch}});
  declarePrint(table, texts);
  declareProcess(table, texts, options);
  table.add("Run", {{.names = "--json",
                     .help = "Print JSON on standard output at the end (or with --help, --list)",
                     .target = &options.console.json}});
  table.addExamples({
      {"quintet run --list", "the built-in programs"},
      {"quintet run ao", "a built-in program on the built-in scene: ao.png"},
      {"quintet run ao --help", "its parameters and outputs"},
      {"quintet run my_program/ scene.glb --set tint=1,0.5,0 --size 640x360 --spp 16"},
      {"quintet run my_program/ --watch", "render again whenever a file is saved"},
      {"quintet run lesson.rt.glsl --frames 45 -o light.####.png"},
      {"quintet run my_program/ --set-file values.json --all-outputs -o out.exr"},
  });
  return table;
}

std::optional<RunOptions> parseRunOptions(Arguments arguments) {
  RunOptions options;
  RenderTexts texts;
  options.program.clear();
  const OptionTable table = declareRun(options, texts);
  parse(table, arguments);
  if (options.programHelp && options.program.empty()) {
    writeFile("-", helpText(table, helpWidth()));
    return std::nullopt;
  }
  if (options.programHelp || options.list) return options;
  if (options.program.empty()) throw UsageError("no program given; 'quintet run --list' lists the built-in ones");
  options.layerList = std::ranges::find(texts.layers, "list") != texts.layers.end();
  if (options.layerList) return options;
  options.request.commandLine = commandLine("run", arguments);
  options.request.scene = texts.scene;
  options.namedByProgram = texts.output.empty();
  options.output.file = options.namedByProgram ? "out.png" : texts.output;
  chooseVideo(options);
  if (output::fileKind(options.output.file) == output::FileKind::film)
    throw UsageError(
        fmt::format("{}: run writes images; use 'quintet render' for films", options.output.file.string()));
  convert(texts, options);
  convertFrameCount(texts, options);
  checkStandardStreams(options);
  if (options.watch && options.video) throw UsageError("--watch writes images; a video requires a run of its own");
  if (options.watch && output::isStandardOutput(options.output.file))
    throw UsageError("--watch writes the same file repeatedly: it cannot be standard output");
  return options;
}

// Renders, waits for a saved file, renders again, until Ctrl-C.
class Watch {
 public:
  explicit Watch(const RunOptions& options)
      : options_(options),
        console_(options.console),
        engine_({.device = options.device,
                 .log =
                     [this](LogLevel level, const std::string& text) {
                       if (level == LogLevel::warning) console_.warning(text);
                     },
                 .severalDevices = true,
                 .mixedDevices = options.mixedDevices}),
        live_(engine_, options.program, [this] { return resolve(); }) {
    console_.isObsolete = [this] { return live_.watcher().pending(); };
    console_.onPreview = console_.onFrame = [this](const job::RenderResult& result) { write(result); };
  }

  int run() {
    try {
      return renderUntilStopped();
    } catch (const DeviceLostError& error) {  // as if the driver had crashed
      reportFailure(error, options_.console.json ? FailureJson::object : FailureJson::none);
      return kCrashed;
    }
  }

 private:
  int renderUntilStopped() {
    bool good = firstReload();
    stop_.emplace();
    console_.setGracefulStop(&*stop_);
    console_.note(
        fmt::format("watching {}; press Ctrl-C to stop", counted(live_.watcher().watched().files.size(), "file")));
    while (true) {
      if (good) render();
      while (!stop_->requested() && live_.watcher().wait(kSignalSeconds).empty()) {
      }
      if (stop_->requested()) break;
      changed_ = true;
      clock_ = Stopwatch();
      console_.clearReport();
      good = reload();
      if (stop_->requested()) break;
    }
    console_.clear();
    return hasImage_ ? (interrupted_ ? stop_->exitStatus() : 0) : kRuntimeError;
  }

  bool reload() {
    setWatchedFiles(live_.watcher().watched());
    const bool good = live_.reload(console_);
    setWatchedFiles(live_.watcher().watched());
    return good;
  }

  // After a crash, an error of a file or an option is not the end: the next save can fix it.
  bool firstReload() {
    try {
      return reload();
    } catch (const Error& error) {
      if (!restartedAfterCrash()) throw;
      reportFailure(error, options_.console.json ? FailureJson::object : FailureJson::none);
      return false;
    }
  }

  job::ResolvedJob resolve() {
    program_ = output::withRequestedHeatMaps(program::loadProgram(options_.program), options_.output);
    console_.setProgram(&program_);
    output::OutputRequest output = options_.output;
    if (options_.namedByProgram) output.file = output::defaultImage(program_.name);
    plan_ = output::planOutputs(output, program_, options_.request.frames);
    return job::resolve(requestFor(options_, plan_), program_);
  }

  void render() {
    files_.clear();
    job::RenderResult result = live_.job()->run(options_.request.limits, console_);
    if (result.abandoned) return;
    interrupted_ = result.interrupted;
    if (!live_.job()->resolved().request.frames.every) write(result);
    addWarnings(result, console_);
    console_.clear();
    if (options_.console.json) writeFile("-", output::resultJson(result, files_, clock_.seconds()));
    console_.note(output::resultSummary(result, files_));
  }

  void write(const job::RenderResult& result) {
    output::addWritten(files_, output::writeOutputs(plan_, result, console_));
    hasImage_ = true;
    if (!std::exchange(changed_, false)) return;
    console_.note(fmt::format("{} saved: {} after {:.2f} s", live_.watcher().changedNames(),
                              printable(files_.back().path.string()), live_.watcher().secondsSinceChange()));
  }

  const RunOptions& options_;
  std::optional<GracefulStop> stop_;  // from the first render on, Ctrl-C ends the command in order
  Console console_;
  program::Program program_;
  output::OutputPlan plan_;
  std::vector<output::WrittenFile> files_;
  Stopwatch clock_;       // since the start or the last change
  bool changed_ = false;  // since the last image
  bool hasImage_ = false;
  bool interrupted_ = false;
  job::Engine engine_;
  job::LiveJob live_;
};

}  // namespace

OptionTable runOptions() {
  RunOptions options;
  RenderTexts texts;
  return declareRun(options, texts).withoutTargets();
}

int runCommand(Arguments arguments) {
  const Stopwatch clock;
  std::optional<RunOptions> options = parseRunOptions(arguments);
  if (!options) return 0;
  const bool json = options->console.json;
  if (options->list) {
    writeFile("-", json ? program::listAsJson() + "\n"
                        : program::listAsText(terminalWidth(STDOUT_FILENO).value_or(std::string::npos)));
    return 0;
  }
  if (options->watch && !options->programHelp && !options->layerList) return Watch(*options).run();
  const program::Program program = program::loadProgram(options->program);
  if (options->programHelp) {
    writeFile("-", json ? program::describeAsJson(program) + "\n" : programHelpText(program, "run"));
    return 0;
  }
  if (options->layerList) {
    writeFile("-", output::layerList(program));
    return 0;
  }
  if (options->namedByProgram) options->output.file = output::defaultImage(program.name);
  return renderImages(*options, program, clock);
}

}  // namespace quintet::cli
