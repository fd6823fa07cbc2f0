#include "run_options.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "option_groups.h"
#include "output.h"
#include "picture_names.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr const char* kExamples =
    "  quintet run --list                                 the built-in programs\n"
    "  quintet run ao                                     a built-in program on the built-in scene: ao.png\n"
    "  quintet run ao --help                              its parameters and outputs\n"
    "  quintet run my_program/ scene.glb --set tint=1,0.5,0 --size 640x360 --spp 16\n"
    "  quintet run my_program/ --watch                    again whenever a file is saved\n"
    "  quintet run lesson.rt.glsl --frames 45 -o light.%04d.png\n"
    "  quintet run my_program/ --set-file values.json --all-outputs -o out.exr\n";

// A shader that does not end within this does not end at all: seconds.
constexpr double kTimeout = 30.0;
constexpr double kMaxFrames = 1e6;

std::uint32_t parseFrames(const std::string& text) {
  const double value = parseNumber("--frames", text, 1, kMaxFrames);
  if (std::floor(value) != value) throw UsageError(fmt::format("--frames: '{}' is not a whole number", text));
  return static_cast<std::uint32_t>(value);
}

bool isHelp(const std::string& argument) { return argument == "-h" || argument == "--help"; }

}  // namespace

std::optional<RunOptions> parseRunOptions(Arguments arguments) {
  CLI::App app("Runs a program: a folder with program.toml, or a built-in one by name.", "quintet run");
  RunOptions options;
  RenderOptions& render = options.render;
  RawOptions raw;
  std::string frames;
  render.program.clear();
  app.add_option("PROGRAM", render.program, "Folder, or name of a built-in program (--list)")->type_name("");
  app.add_option("SCENE", raw.scene, "The scene: .gltf, .glb or .scene.toml (default: a small built-in one)")
      ->type_name("");
  app.add_option("-o", raw.output, ".png, .exr or .hdr; - is PNG on standard output (default: PROGRAM.png, here)")
      ->type_name("FILE")
      ->group("Image");
  declareImage(app, raw, render);
  app.add_option("--frames", frames,
                 "Frames: of a program that draws frame after frame, or of a scene that moves\n(default: 1)")
      ->type_name("N")
      ->group("Image");
  app.add_flag("--all-frames", options.allFrames, "Write each frame: out.0000.png (so does a name with %04d)")
      ->group("Image");
  declareExr(app, raw);
  declareQuality(app, raw, render);
  declareView(app, raw, render);
  declareProgram(app, raw, render);
  app.add_option("--output", render.outputName, "The output to write (default: the program's first)")
      ->type_name("NAME")
      ->group("Program");
  app.add_flag("--list", options.list, "List the built-in programs and leave")->group("Program");
  app.add_flag("--watch", options.watch, "Keep running: render again whenever a file is saved")->group("Run");
  declareProcess(app, raw, render, "A launch that takes longer hangs (default: 30)");
  app.add_flag("--json", render.json, "At the end (or with --help, --list) JSON on standard output")->group("Run");
  setUp(app, kExamples);

  // --help with a program is about that program.
  std::vector<std::string> given(arguments.begin(), arguments.end());
  const bool help = std::erase_if(given, isHelp) > 0;
  if (!parse(app, given)) return std::nullopt;
  if (help && render.program.empty()) {
    parse(app, std::vector<std::string>{"--help"});
    return std::nullopt;
  }
  render.programHelp = help;
  if (help || options.list) return options;
  render.aovList = asksForAovList(raw);
  if (render.program.empty()) throw UsageError("no program given; 'quintet run --list' names the built-in ones");
  if (render.aovList) return options;
  render.commandLine = commandLine("run", arguments);
  render.scene = raw.scene;
  render.output = raw.output;
  interpret(raw, render);
  checkExrOptions(raw, render);
  if (!frames.empty()) render.frames = parseFrames(frames);
  render.drawnFrames = render.frames;
  if (!render.frames && !raw.spp.empty()) render.drawnFrames = static_cast<std::uint32_t>(*render.samples);
  if (!render.drawnFrames && !render.seconds) render.drawnFrames = 1;
  options.allFrames = options.allFrames || hasFramePlace(render.output);
  if (!render.timeout) render.timeout = kTimeout;
  if (!render.outputName.empty() && render.allOutputs)
    throw UsageError("--output and --all-outputs exclude each other");
  checkStandardOutput(render.output, render.json, render.allOutputs);
  if (!render.output.empty() && outputKind(render.output) == OutputKind::film)
    throw UsageError(fmt::format("{}: run writes pictures; films are for render", render.output.string()));
  if (options.allFrames && render.output == "-")
    throw UsageError("--all-frames writes several files: -o - takes one picture");
  if (options.watch && render.output == "-")
    throw UsageError("--watch writes a file again and again: -o - takes one picture");
  return options;
}

}  // namespace quintet::app
