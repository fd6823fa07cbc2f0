// SPDX-License-Identifier: Apache-2.0
// `quintet render`: a request becomes a job, the job a result, and the result files.
#include "commands/render.h"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/file.h"
#include "base/wrap.h"
#include "cli/candidates.h"
#include "cli/failure.h"
#include "cli/parser.h"
#include "cli/terminal.h"
#include "cli/values.h"
#include "cli/work.h"
#include "job/render_job.h"
#include "job/scene_batch.h"
#include "output/file_names.h"
#include "output/frame_files.h"
#include "output/layers.h"
#include "output/report.h"
#include "output/scene_files.h"
#include "output/write.h"
#include "program/heat.h"
#include "program/help.h"
#include "program/load.h"

namespace quintet::cli {
namespace {

// The command line as it was parsed.
struct RenderCommand {
  RenderOptions options;
  RenderTexts texts;
  std::vector<std::filesystem::path> scenes;
};

OptionTable declareRender(RenderCommand& command) {
  RenderOptions& options = command.options;
  RenderTexts& texts = command.texts;
  OptionTable table("render", "Renders scenes with the path tracer, or with another program.");
  table.add({{.names = "SCENE",
              .help = "Scene files: .gltf, .glb or .scene.toml",
              .target = &command.scenes,
              .candidates = {.extensions = kSceneExtensions},
              .required = true}});
  table.add(
      "Image",
      {{.names = "-o,--output",
        .value = "FILE",
        .help =
            "Output file: .png, .exr, .hdr or .qfilm (the whole film, for 'quintet merge'); #### is the frame number, "
            "{scene} the name of the scene file, {folder} that of its folder; .mp4, .webm or .gif is a video of "
            "--frames; - is PNG on standard output, -.exr OpenEXR (default: SCENE.png in the current folder)",
        .target = &texts.output,
        .candidates = {.extensions = {"png", "exr", "hdr", "qfilm", "mp4", "webm", "gif"}}}});
  declareRendering(table, texts, options);
  table.add(
      "Program",
      {{.names = "--help-program", .help = "Print the program's parameters and exit", .target = &options.programHelp}});
  declarePrint(table, texts);
  declareProcess(table, texts, options);
  table.add("Run", {{.names = "--json",
                     .help = "Print one JSON object on standard output at the end",
                     .target = &options.console.json}});
  declareCheckpoints(table, texts, options);
  table.addExamples({
      {"quintet render scene.glb", "scene.png"},
      {"quintet render scene.glb -o out.exr --size 1920x1080 --spp 256"},
      {"quintet render a.glb b.glb -o 'out/{scene}.png'", "several scenes, faster than one by one"},
      {"quintet render scene.glb -o out.exr --aov albedo,normal", "with layers; --aov list prints their names"},
      {"quintet render scene.glb --time 60 --env sky.hdr", "as many samples as possible in a minute"},
      {"quintet render scene.glb --look-from 2,1,3 --look-at 0,0.5,0 --fov 35"},
      {"quintet render fox.glb --at 0.5 -o fox.png", "an animated scene at half a second"},
      {"quintet render fox.glb --frames 0-47 --resume -o f####.png", "two seconds; finished frames are skipped"},
      {"quintet render fox.glb --frames 48 -o fox.mp4", "a video, with ffmpeg"},
      {"quintet render scene.glb --program ao --set distance=0.5", "another program with a parameter"},
      {"quintet render --program pathtracer --help-program", "the program's parameters"},
      {"quintet render scene.glb -o - --quiet | display", "PNG on standard output"},
      {"quintet render scene.glb --spp 4096 --checkpoint 60 --resume", "continue after an interruption"},
      {"quintet render scene.glb --spp 64 --batches 0-7 -o a.qfilm",
       "the first half of a render; 8-15 is the second half"},
      {"quintet merge a.qfilm b.qfilm -o scene.png", "joins both halves: the same bytes as one render"},
  });
  return table;
}

// The options of each scene. Throws UsageError for what is wrong with any of them.
std::vector<RenderOptions> optionsOfScenes(const RenderCommand& command, Arguments arguments) {
  const std::vector<std::filesystem::path>& scenes = command.scenes;
  if (scenes.empty()) throw UsageError("no scene given; see 'quintet render --help'");
  std::vector<std::filesystem::path> files, checkpoints;
  if (!command.texts.output.empty() || scenes.size() > 1) files = output::sceneFiles(command.texts.output, scenes);
  if (const auto& file = command.options.request.checkpoint.file; !file.empty())
    checkpoints = output::sceneFiles(file, scenes);
  std::vector<RenderOptions> all;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    RenderOptions& options = all.emplace_back(command.options);
    RenderTexts texts = command.texts;
    texts.scene = scenes[i].string();
    const std::filesystem::path named = scenes[i] == kStandardInput ? "stdin" : scenes[i];
    options.output.file = files.empty() ? named.filename().replace_extension(".png") : files[i];
    if (!texts.output.empty()) texts.output = options.output.file.string();
    if (!checkpoints.empty()) options.request.checkpoint.file = checkpoints[i];
    options.request.commandLine = commandLine("render", arguments);
    convertRendering(texts, options);
    checkStandardStreams(options);
    // The pattern can name a folder for each scene. If it cannot be created, writing reports it.
    std::error_code ignored;
    if (texts.output != command.texts.output)
      std::filesystem::create_directories(std::filesystem::path(texts.output).parent_path(), ignored);
  }
  return all;
}

// Of the rendered part; 0 if it depends on the scene.
uvec2 requestedSize(const job::RenderRequest& request) {
  return request.region.width > 0 ? uvec2{request.region.width, request.region.height} : request.size;
}

// Throws UsageError for what is wrong with the options, so that no scene is rendered before.
void checkOptions(const RenderOptions& options, const program::Program& named) {
  try {
    const program::Program program = output::withRequestedHeatMaps(named, options.output);
    const output::OutputPlan plan = output::planOutputs(options.output, program, options.request.frames);
    job::resolve(requestFor(options, plan), program);
  } catch (const FileError&) {  // of this scene: reported when its turn comes
  }
}

// Of several scenes. Returns the exit status.
int renderScenes(std::span<const std::filesystem::path> scenes, std::span<const RenderOptions> options,
                 const program::Program& program) {
  for (const RenderOptions& one : options) checkOptions(one, program);
  const SceneProgress before = sceneProgress();  // of a process that has ended in the middle of a scene
  RenderDevices devices;
  int interruptedStatus = 0;
  job::SceneBatch batch;
  batch.count = scenes.size();
  batch.first = before.next;
  batch.render = [&](std::size_t scene) {
    const Stopwatch clock;
    sceneBegins(scene, scenes[scene].string());
    if (options[scene].console.jsonProgress) printError(output::sceneJson(scenes[scene]));
    const int status = renderImages(options[scene], program, clock, devices);
    sceneEnds(scene, status == kRuntimeError);
    if (status > 128) interruptedStatus = status;
    return status > 128                  ? job::SceneEnd::interrupted
           : status == kRuntimeError     ? job::SceneEnd::failed
           : status == kTargetNotReached ? job::SceneEnd::targetMissed
                                         : job::SceneEnd::rendered;
  };
  batch.failed = [&](std::size_t scene, const std::exception& error) {
    reportFailure(error, options[scene].console.json ? FailureJson::object : FailureJson::none, "", scenes[scene]);
    sceneEnds(scene, true);
  };
  job::SceneBatchResult result;
  try {
    result = job::renderScenes(devices.engine(options.front()), batch);
  } catch (...) {
    scenesEnd();
    throw;
  }
  scenesEnd();
  std::vector<std::size_t> failed = before.failed;
  failed.insert(failed.end(), result.failed.begin(), result.failed.end());
  if (!failed.empty()) printFailure(job::failedScenesText(scenes, failed), kRuntimeError);
  if (result.interrupted) return interruptedStatus;
  if (!failed.empty()) return kRuntimeError;
  return result.targetMissed ? kTargetNotReached : 0;
}

}  // namespace

void addWarnings(job::RenderResult& result, Console& console) {
  for (const std::string& text : job::resultWarnings(result)) console.warning(text);
  result.printed = console.takePrints();
  result.warnings = console.warnings();
}

job::RenderRequest requestFor(const RenderOptions& options, const output::OutputPlan& plan) {
  job::RenderRequest request = options.request;
  request.frames.every =
      request.frames.every || (plan.request.everyFrame && request.frames.lastFrame() > request.frames.firstFrame());
  request.outputs = plan.optionalOutputs;
  request.outputNotes = plan.notes();
  return request;
}

std::string programHelpText(const program::Program& program, std::string_view command) {
  const std::size_t width = terminalWidth(STDOUT_FILENO).value_or(std::string::npos);
  const bool runs = command == "run";
  std::string options = "Options: ";
  if (runs && program.accumulation == program::Accumulation::program) options += "--frames N; ";
  options += fmt::format("--set NAME=VALUE for parameters; {}--all-outputs and --aov NAMES for outputs.",
                         runs ? "--output NAME, " : "");
  options += fmt::format(" Every program also has the heat maps {}.", fmt::join(program::heatMapNames(), ", "));
  return fmt::format("{}\n{}\nSee 'quintet {} --help' for the options of all programs.\n",
                     program::describeAsText(program, width), wrapped(options, width, 0), command);
}

job::Engine& RenderDevices::engine(const RenderOptions& options) {
  if (!engine_)
    engine_.emplace(job::EngineOptions{.device = options.device,
                                       .log =
                                           [this](LogLevel level, const std::string& text) {
                                             Console* console = console_;
                                             if (console && level == LogLevel::warning) console->warning(text);
                                           },
                                       .severalDevices = true,
                                       .mixedDevices = options.mixedDevices});
  return *engine_;
}

int renderImages(const RenderOptions& options, const program::Program& named, const Stopwatch& clock) {
  RenderDevices devices;
  return renderImages(options, named, clock, devices);
}

int renderImages(const RenderOptions& options, const program::Program& named, const Stopwatch& clock,
                 RenderDevices& devices) {
  const program::Program program = output::withRequestedHeatMaps(named, options.output);
  const output::OutputPlan plan = output::planOutputs(options.output, program, options.request.frames);
  std::optional<output::VideoWriter> video;
  if (options.video) {
    output::checkVideoRequest(*options.video, options.request.transparent);
    video.emplace(*options.video, plan);
  }
  Console console(options.console);
  console.setProgram(&program);
  try {
    const job::RenderRequest request = requestFor(options, plan);
    job::ResolvedJob resolved = job::resolve(request, program);
    if (const std::string text = output::ignoredDisplayText(options.output); !text.empty()) console.note(text);
    output::checkSize(plan, requestedSize(options.request));
    const RenderDevices::Use use(devices, console);
    job::RenderJob job(devices.engine(options), std::move(resolved), console);
    output::checkSize(plan, {job.region().width, job.region().height});
    if (options.prepared) options.prepared(job);
    const GracefulStop stop;  // from here on, Ctrl-C completes the batch
    console.setGracefulStop(&stop);

    setWorkStage("rendering");
    std::vector<output::WrittenFile> files;
    const auto write = [&](const job::RenderResult& result) {
      output::addWritten(files, output::writeOutputs(plan, result, console));
    };
    std::vector<output::FrameFiles> frames;
    const auto filesOf = [&](std::uint64_t frame) {
      return video ? std::vector<std::filesystem::path>{} : output::frameFiles(plan, frame);
    };
    console.wasWritten = [&](const job::Provenance& frame) {
      if (video ? !video->addWritten(frame) : !output::isFrameWritten(plan, frame)) return false;
      frames.push_back({*frame.frame, filesOf(*frame.frame), 0.0, true});
      return true;
    };
    console.onFrame = [&, before = 0.0](const job::RenderResult& result) mutable {
      if (video)
        video->add(result, console);
      else
        write(result);
      if (!result.provenance.frame) return;
      // A program that accumulates renders a frame from those before it.
      const double earlier = result.accumulatesFrames ? std::exchange(before, result.provenance.seconds) : 0.0;
      frames.push_back(
          {*result.provenance.frame, filesOf(*result.provenance.frame), result.provenance.seconds - earlier});
    };
    job::RenderResult result = job.run(options.request.limits, console);
    try {
      if (!options.request.overwriteFilm)
        output::checkFilmLoss(plan, result, options.request.load.maxMemory);  // the render can have stopped early
      if (!request.frames.every) write(result);
    } catch (...) {
      job.outputsFailed(result, console);
      throw;
    }
    if (video && video->finish(result.interrupted, console)) files = {{options.video->file, ""}};
    if (options.written) options.written(result, frames);
    job.outputsWritten(result, console);

    addWarnings(result, console);
    console.clear();
    if (options.console.json) writeFile("-", output::resultJson(result, files, clock.seconds(), frames));
    console.note(output::resultSummary(result, files, frames));
    if (result.interrupted) return stop.exitStatus();
    return result.targetMissed || result.earlierTargetMissed ? kTargetNotReached : 0;
  } catch (const ProgramError& error) {
    console.diagnostics(error.diagnostics());
    return kRuntimeError;
  }
}

OptionTable renderOptions() {
  RenderCommand command;
  return declareRender(command).withoutTargets();
}

int renderCommand(Arguments arguments) {
  const Stopwatch clock;
  RenderCommand command;
  RenderOptions& options = command.options;
  if (!parse(declareRender(command), arguments)) return 0;
  options.layerList = std::ranges::find(command.texts.layers, "list") != command.texts.layers.end();
  std::vector<RenderOptions> scenes;
  if (!options.programHelp && !options.layerList) scenes = optionsOfScenes(command, arguments);
  const program::Program program = program::loadProgram(options.program);
  if (options.programHelp) {
    writeFile("-", programHelpText(program, "render"));
  } else if (options.layerList) {
    writeFile("-", output::layerList(program));
  } else if (scenes.size() == 1) {
    return renderImages(scenes.front(), program, clock);
  } else {
    return renderScenes(command.scenes, scenes, program);
  }
  return 0;
}

}  // namespace quintet::cli
