// SPDX-License-Identifier: Apache-2.0
#include "cli/render_options.h"

#include <unistd.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/candidates.h"
#include "cli/values.h"
#include "output/file_names.h"
#include "program/heat.h"
#include "render/film/film_file.h"

namespace quintet::cli {
namespace {

constexpr double kMaxSamples = 1u << 24;
constexpr std::uint64_t kDefaultSamples = 64;
constexpr double kMaxPrints = 1e6;
constexpr double kMinError = 1e-6;
constexpr double kMaxReal = 1e30;
constexpr double kMaxRateFactor = 63;
constexpr double kMaxSeconds = 1e6;
constexpr double kMinRate = 1e-3, kMaxRate = 1e4;  // frames per second
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

std::optional<float> parseFloat(const std::string& option, const std::string& text, double min, double max) {
  const std::optional<double> value = parseReal(option, text, min, max);
  return value ? std::optional(static_cast<float>(*value)) : std::nullopt;
}

void convertView(const RenderTexts& texts, job::RenderRequest& request) {
  request.camera.lookFrom = parsePoint("--look-from", texts.lookFrom);
  request.camera.lookAt = parsePoint("--look-at", texts.lookAt);
  request.camera.up = parsePoint("--up", texts.up).value_or(vec3(0, 1, 0));
  request.camera.verticalFov = parseFloat("--fov", texts.fov, 0.01, 179.0);
  request.camera.apertureRadius = parseFloat("--aperture", texts.aperture, 0.0, kMaxReal);
  request.camera.focusDistance = parseFloat("--focus", texts.focus, 1e-12, kMaxReal);
  request.environment.intensity = parseFloat("--env-intensity", texts.envIntensity, 0.0, kMaxReal);
  request.environment.rotation = parseFloat("--env-rotation", texts.envRotation, -36000.0, 36000.0);
}

void convertCheckpoints(const RenderTexts& texts, RenderOptions& options) {
  job::RenderRequest& request = options.request;
  job::CheckpointRequest& checkpoint = request.checkpoint;
  if (!texts.batches.empty()) request.batches = parseBatches("--batches", texts.batches);
  if (request.batches && output::fileKind(options.output.file) != output::FileKind::film)
    throw UsageError(fmt::format("--batches: a part is written as a film: -o FILE{}", render::kFilmExtension));
  if (const auto seconds = parseReal("--checkpoint", texts.checkpoint, 0.0, kUnlimited))
    checkpoint.seconds = *seconds;
  else if (!checkpoint.resume && !checkpoint.keep && checkpoint.file.empty())
    return;
  if (!checkpoint.file.empty()) return;
  const std::filesystem::path& output = options.output.file;
  if (output::isStandardOutput(output) || !output.has_extension())
    throw UsageError(
        fmt::format("{}: the name of the checkpoint cannot be derived from it; use --checkpoint-file FILE{}",
                    output.string(), render::kFilmExtension));
  checkpoint.file = output;
  checkpoint.file.replace_extension(fmt::format(".checkpoint{}", render::kFilmExtension));
}

}  // namespace

void declareLoading(OptionTable& table, LoadTexts& texts, scene::LoadOptions& options, const char* strictHelp) {
  table.add("Scene",
            {{.names = "--scene",
              .value = "NAME",
              .help = "Index or name of the scene of the glTF file (default: the file's); 'quintet info' lists them",
              .target = &options.scene},
             {.names = "--variant",
              .value = "NAME",
              .help = "Material variant of the glTF file; 'quintet info' lists them",
              .target = &options.variant},
             {.names = "--strict", .help = strictHelp, .target = &options.strict},
             {.names = "--missing-textures",
              .value = "WHAT",
              .help = "For a texture whose image is missing or invalid: error, or warn, which uses the "
                      "factors of the material (default: error)",
              .target = &texts.missingTextures,
              .candidates = {.names = {"error", "warn"}}},
             {.names = "--max-memory", .value = "BYTES", .help = kMaxMemoryHelp, .target = &texts.maxMemory},
             {.names = "--allow-external",
              .help = "Read buffers and images of glTF files from outside of their folders",
              .target = &options.allowExternal}});
}

void convertLoading(const LoadTexts& texts, scene::LoadOptions& options) {
  if (!texts.missingTextures.empty() &&
      parseChoice("--missing-textures", texts.missingTextures, {"error", "warn"}) == 1)
    options.missingTextures = scene::MissingTextures::warn;
  if (options.strict && options.missingTextures == scene::MissingTextures::warn)
    throw UsageError("--strict and --missing-textures warn exclude each other");
  options.maxMemory = parseBytes("--max-memory", texts.maxMemory).value_or(0);
}

void declareSize(OptionTable& table, RenderTexts& texts, RenderOptions& options, const char* regionHelp) {
  table.add(
      "Image",
      {{.names = "--size",
        .value = "WxH",
        .help =
            "Size in pixels, or the width alone (default: 1280x720, or 1280 on the longer side of the camera's image)",
        .target = &texts.size}});
  if (regionHelp)
    table.add("Image", {{.names = "--region", .value = "X,Y,W,H", .help = regionHelp, .target = &texts.region}});
  table.add("Image", {{.names = "--transparent",
                       .help = "Alpha 0 in the background instead of the environment",
                       .target = &options.request.transparent}});
}

void declareFrame(OptionTable& table, RenderTexts& texts, const char* verb) {
  table.add("Image", {{.names = "--frame",
                       .value = "N",
                       .help = fmt::format("{} only this frame of an animated scene; the first one is 0", verb),
                       .target = &texts.frame},
                      {.names = "--at",
                       .value = "SECONDS",
                       .help = fmt::format("{} an animated scene at this time", verb),
                       .target = &texts.at}});
}

void declareFrames(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  table.add("Image",
            {{.names = "--frames",
              .value = "N|A-B",
              .help = "Number of frames, for an animated scene or a program that draws frame after frame (default: 1); "
                      "A-B or A:B renders only frames A to B of an animated scene",
              .target = &texts.frames},
             {.names = "--all-frames",
              .help = "Write out.0000.png and so on also for a program that averages its frames itself; #### "
                      "or %04d in the name does the same",
              .target = &options.output.everyFrame},
             {.names = "--crf",
              .value = "N",
              .help = "Constant rate factor of a video: from 0 (best) to 51 for .mp4 (default: 18), to 63 for .webm "
                      "(default: 24)",
              .target = &texts.rateFactor}});
}

void declareAnimation(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  table.add("Scene",
            {{.names = "--animation",
              .value = "NAME",
              .help = "Name or index of the glTF animation, or none for the rest pose (default: the first one if "
                      "a frame or a time is given); 'quintet info' lists them",
              .target = &options.request.animation,
              .candidates = {.names = {"none"}}},
             {.names = "--fps",
              .value = "N",
              .help = "Frames per second of animations, of times, and of videos (default: 24)",
              .target = &texts.fps},
             {.names = "--shutter",
              .value = "OPEN,CLOSE",
              .help = "Motion blur: the shutter is open from OPEN to CLOSE, in frames relative to the frame; 0,0.5 is "
                      "an angle of 180 degrees (default: none)",
              .target = &texts.shutter}});
}

void declareImage(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  declareSize(table, texts, options, "Render and write only this part, in pixels from the top left");
  declareDisplay(table, texts, "Image", "default: 0, and neutral for colors");
}

void declareDisplay(OptionTable& table, RenderTexts& texts, const char* group, const char* otherwise) {
  table.add(group, {{.names = "--exposure",
                     .value = "STOPS",
                     .help = fmt::format("Multiply by 2^STOPS (PNG only; {})", otherwise),
                     .target = &texts.exposure},
                    {.names = "--tonemap",
                     .value = "NAME",
                     .help = "Tone mapping: linear, aces, agx or neutral (PNG only)",
                     .target = &texts.toneMap,
                     .candidates = {.names = render::toneMapNames()}},
                    {.names = "--png-bits",
                     .value = "N",
                     .help = "Bits per channel of PNG files: 8 or 16 (default: 8)",
                     .target = &texts.pngBits,
                     .candidates = {.names = {"8", "16"}}}});
}

void declareQuality(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  table.add(
      "Quality",
      {{.names = "--spp",
        .value = "N",
        .help = "Number of samples per pixel (default: 64; none with --time or --until-error)",
        .target = &texts.spp},
       {.names = "--time", .value = "SECONDS", .help = "Time limit of rendering", .target = &texts.time},
       {.names = "--until-error",
        .value = "E",
        .help =
            "Target for the relative error of the image, e.g. 0.02; the error of 95 % of its tiles must be below 2 E "
            "(stated with 95 % confidence). The status is 3 if another limit ends the render first",
        .target = &texts.untilError},
       {.names = "--adaptive",
        .help = "Distribute samples by the error of each tile; --spp is then the average",
        .target = &options.request.limits.adaptive},
       {.names = "--seed",
        .value = "N",
        .help = "Seed of the random number generator (default: 0)",
        .target = &texts.seed},
       {.names = "--bounces", .value = "N", .help = "Same as --set bounces=N", .target = &texts.bounces},
       {.names = "--clamp", .value = "X", .help = "Same as --set clamp=X", .target = &texts.clamp}});
}

void declareView(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  declareLoading(table, texts.load, options.request.load);
  table.add(
      "Camera",
      {{.names = "--camera",
        .value = "NAME",
        .help = "Name of a camera in the file or of its glTF node, or index; 'quintet info' lists them (default: the "
                "first, else automatic)",
        .target = &options.request.camera.name},
       {.names = "--look-from", .value = "X,Y,Z", .help = "Position of the camera, meters", .target = &texts.lookFrom},
       {.names = "--look-at",
        .value = "X,Y,Z",
        .help = "Point at the center of the image (default: center of the scene)",
        .target = &texts.lookAt},
       {.names = "--up", .value = "X,Y,Z", .help = "Up direction of the image (default: 0,1,0)", .target = &texts.up},
       {.names = "--fov",
        .value = "DEGREES",
        .help = "Vertical field of view (default: the camera's, or 45)",
        .target = &texts.fov},
       {.names = "--aperture",
        .value = "METERS",
        .help = "Radius of the lens (default: the camera's, or 0: pinhole)",
        .target = &texts.aperture},
       {.names = "--focus",
        .value = "METERS",
        .help = "Focus distance (default: the distance of --look-at)",
        .target = &texts.focus}});
  table.add(
      "Light",
      {{.names = "--env",
        .value = "WHAT",
        .help =
            "Environment: an equirectangular image, none, default, or R,G,B (default: the scene's; 'default' if the "
            "scene does not light itself)",
        .target = &options.request.environment.source,
        .candidates = {.names = {"none", "default"}, .extensions = {"hdr", "exr", "png", "jpg", "jpeg", "webp"}}},
       {.names = "--env-intensity",
        .value = "X",
        .help = "Factor for the environment (default: 1)",
        .target = &texts.envIntensity},
       {.names = "--env-rotation",
        .value = "DEGREES",
        .help = "Rotation about the y axis, counter-clockwise seen from above",
        .target = &texts.envRotation}});
}

void declareProgramName(OptionTable& table, RenderOptions& options) {
  table.add("Program", {{.names = "--program",
                         .value = "NAME",
                         .help = "Built-in program, folder with program.toml, or .rt.glsl file (default: pathtracer)",
                         .target = &options.program,
                         .candidates = programCandidates()}});
}

void declareParameters(OptionTable& table, RenderOptions& options) {
  table.add("Program", {{.names = "--set",
                         .value = "NAME=VALUE",
                         .help = "Parameter of the program; may be repeated",
                         .target = &options.request.assignments},
                        {.names = "--set-file",
                         .value = "FILE.json",
                         .help = "Parameters as a JSON object; --set overrides them",
                         .target = &options.request.parameterFile,
                         .candidates = {.extensions = {"json"}}}});
}

void declareProgram(OptionTable& table, RenderOptions& options) {
  declareParameters(table, options);
  table.add("Program", {{.names = "--all-outputs",
                         .help = "Write every output of the program: out.NAME.png",
                         .target = &options.output.allOutputs}});
}

void declareDevice(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  table.add("Run", {{.names = "--device",
                     .value = "NAME",
                     .help = fmt::format("{}: 0, h200, lavapipe, cpu, gpu", kDeviceHelp),
                     .target = &options.device,
                     .candidates = {.names = deviceNames()}},
                    {.names = "--timeout", .value = "SECONDS", .help = kLaunchLimitHelp, .target = &texts.timeout}});
}

void declareDevices(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  table.add("Run",
            {{.names = "--device",
              .value = "NAMES",
              .help = fmt::format("{}: 0, h200, lavapipe, cpu, gpu. Several render together: a list such as 0,2; or "
                                  "all, those of one kind",
                                  kDeviceHelp),
              .target = &options.device,
              .candidates = {.names = deviceNames({"all"})}},
             {.names = "--mixed-devices",
              .help = "Allow different kinds of devices in --device, which can differ in the last bit of a sample",
              .target = &options.mixedDevices},
             {.names = "--timeout", .value = "SECONDS", .help = kLaunchLimitHelp, .target = &texts.timeout}});
}

void declareProcess(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  declareDevices(table, texts, options);
  table.add("Run",
            {{.names = "-q,--quiet", .help = "Print neither progress nor notes", .target = &options.console.quiet}});
}

void declareImageOptions(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  declareImage(table, texts, options);
  declareFrames(table, texts, options);
  declareFrame(table, texts, "Render");
  declareExr(table, texts);
  declareQuality(table, texts, options);
  declareView(table, texts, options);
  declareAnimation(table, texts, options);
}

void declareRendering(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  declareImageOptions(table, texts, options);
  declareProgramName(table, options);
  declareProgram(table, options);
}

void declarePrint(OptionTable& table, RenderTexts& texts) {
  table.add("Program",
            {{.names = "--print",
              .value = "PIXELS",
              .help = "Show what the program prints (debugPrintfEXT) for the pixels X,Y or X,Y,W,H, or for all "
                      "(default: nothing; without a value: center, the pixel at the center)",
              .target = &texts.print,
              .withoutValue = "center",
              .candidates = {.names = {"center", "all"}}},
             {.names = "--print-limit",
              .value = "N",
              .help = "Number of lines that --print shows (default: 200)",
              .target = &texts.printLimit}});
}

void declareCheckpoints(OptionTable& table, RenderTexts& texts, RenderOptions& options) {
  job::CheckpointRequest& checkpoint = options.request.checkpoint;
  table.add(
      "Long renders",
      {{.names = "--checkpoint",
        .value = "SECONDS",
        .help = "Write a checkpoint every N seconds, 0: after each batch (default with the options below: 60); it is "
                "removed when the image is written",
        .target = &texts.checkpoint},
       {.names = "--checkpoint-file",
        .value = "FILE",
        .help = "Name of the checkpoint (default: OUTPUT.checkpoint.qfilm)",
        .target = &checkpoint.file,
        .candidates = {.extensions = {"qfilm"}}},
       {.names = "--keep-checkpoint",
        .help = "Keep the checkpoint when the image is written",
        .target = &checkpoint.keep},
       {.names = "--resume",
        .help =
            "Continue from the checkpoint, to the same bytes as without interruption; start from the first sample if "
            "it does not exist",
        .target = &checkpoint.resume},
       {.names = "--batches",
        .value = "A-B",
        .help = "Render only batches A to B of --spp (4 samples each, from 0, B included) into -o FILE.qfilm; 'quintet "
                "merge' joins the parts",
        .target = &texts.batches},
       {.names = "--force",
        .help = "Overwrite a checkpoint or film although its samples are lost",
        .target = &checkpoint.force},
       {.names = "--json-progress",
        .help = "Print a line of JSON on standard error for each batch",
        .target = &options.console.jsonProgress}});
}

void declareExr(OptionTable& table, RenderTexts& texts, bool ofFilms) {
  std::vector<std::string> layers{"all"};
  if (!ofFilms) {
    layers = program::heatMapNames();
    layers.insert(layers.begin(), {"all", "list"});
  }
  table.add(
      "OpenEXR",
      {{.names = "--aov",
        .value = ofFilms ? "NAMES|all" : "NAMES|all|list",
        .help = ofFilms ? "Layers of the films to write (default: all); may be repeated"
                        : "Layers to write besides the image; 'list' prints their names. May be repeated",
        .target = &texts.layers,
        .candidates = {.names = layers},
        .delimiter = ','},
       {.names = "--exr-type",
        .value = "half|float",
        .help = "Type of colors (default: half); data are always floats",
        .target = &texts.exrType,
        .candidates = {.names = {"half", "float"}}},
       {.names = "--exr-compression",
        .value = "NAME[:LEVEL]",
        .help = "Compression: none, rle, zips, zip, piz, dwaa or dwab (default: zip); levels: zip:1 to 9, dwaa:45 "
                "(lossy, colors only)",
        .target = &texts.exrCompression,
        .candidates = {.names = io::exrCompressionNames()}},
       {.names = "--exr-tiles",
        .value = "N",
        .help = "Write tiles of N x N pixels (default: scan lines)",
        .target = &texts.exrTiles}});
}

void chooseVideo(RenderOptions& options) {
  const std::filesystem::path file = options.output.file;
  if (!output::videoFormat(file)) return;
  options.video.emplace().file = file;
  options.output.file = output::frameImages(file);
}

void convertFrames(const RenderTexts& texts, RenderOptions& options) {
  job::FrameRequest& frames = options.request.frames;
  if (texts.frame.empty() + texts.frames.empty() + texts.at.empty() < 2)
    throw UsageError("--frame, --frames and --at exclude each other");
  if (texts.frames.find_first_of("-:", 1) != std::string::npos) {
    std::tie(frames.first, frames.count) = parseFrames("--frames", texts.frames, kMaxFrames);
  } else if (const auto count = parseInteger("--frames", texts.frames, 1, kMaxFrames)) {
    frames.count = static_cast<std::uint32_t>(*count);
  }
  if (const auto frame = parseInteger("--frame", texts.frame, 0, kMaxFrames)) {
    frames.first = static_cast<std::uint32_t>(*frame);
    frames.count = 1;
  }
  options.request.shutter = parseShutter("--shutter", texts.shutter);
  frames.seconds = parseReal("--at", texts.at, 0.0, kMaxSeconds);
  if (const auto rate = parseReal("--fps", texts.fps, kMinRate, kMaxRate)) options.request.framesPerSecond = *rate;
  const auto rateFactor = parseInteger("--crf", texts.rateFactor, 0, kMaxRateFactor);
  if (rateFactor && !options.video) throw UsageError("--crf requires a video: -o FILE.mp4 or FILE.webm");
  if (!options.video) return;
  const std::string file = options.video->file.string();
  if (!frames.first && !frames.count) throw UsageError(fmt::format("{}: a video requires --frames", file));
  if (options.output.allOutputs) throw UsageError(fmt::format("{}: a video shows one output, not all", file));
  options.output.everyFrame = true;
  options.video->framesPerSecond = options.request.framesPerSecond;
  options.video->resumable = options.request.checkpoint.resume;
  if (rateFactor) options.video->rateFactor = static_cast<unsigned>(*rateFactor);
}

void convertOutput(const RenderTexts& texts, output::OutputRequest& output) {
  output.layers = texts.layers;
  output.exposure = parseReal("--exposure", texts.exposure, -job::kMaxExposure, job::kMaxExposure);
  output.toneMap = parseToneMap("--tonemap", texts.toneMap);
  if (!texts.pngBits.empty()) output.pngBits = parseChoice("--png-bits", texts.pngBits, {"8", "16"}) == 0 ? 8u : 16u;
  output.exr = parseExrFormat(texts.exrType, texts.exrCompression, texts.exrTiles);
}

void convert(const RenderTexts& texts, RenderOptions& options) {
  job::RenderRequest& request = options.request;
  convertOutput(texts, options.output);
  convertLoading(texts.load, request.load);
  if (!texts.size.empty()) request.size = parseSize("--size", texts.size);
  if (!texts.region.empty()) request.region = parseRegion("--region", texts.region);
  job::RenderLimits& limits = request.limits;
  limits.samples = parseInteger("--spp", texts.spp, 1, kMaxSamples);
  limits.seconds = parseReal("--time", texts.time, 0.0, kUnlimited);
  limits.error = parseReal("--until-error", texts.untilError, kMinError, 1.0);
  if (!limits.samples && !limits.seconds && !limits.error) limits.samples = kDefaultSamples;
  request.seed = static_cast<std::uint32_t>(parseInteger("--seed", texts.seed, 0, 4294967295.0).value_or(0));
  request.launchTimeout = parseReal("--timeout", texts.timeout, 0.001, kUnlimited).value_or(0.0);
  convertView(texts, request);
  if (!texts.bounces.empty()) request.assignments.push_back("bounces=" + texts.bounces);
  if (!texts.clamp.empty()) request.assignments.push_back("clamp=" + texts.clamp);
  request.print = parsePrint("--print", texts.print);
  options.console.collectPrints = request.print.has_value();
  if (const auto limit = parseInteger("--print-limit", texts.printLimit, 1, kMaxPrints)) {
    if (!request.print) throw UsageError("--print-limit requires --print");
    request.print->limit = *limit;
  }
  convertCheckpoints(texts, options);
  if (output::fileKind(options.output.file) == output::FileKind::film) request.film = options.output.file;
  request.overwriteFilm = request.checkpoint.force;
}

void convertRendering(const RenderTexts& texts, RenderOptions& options) {
  options.request.scene = texts.scene;
  chooseVideo(options);
  // Without --frames there is one frame, so a pattern in the name is the number 0 or the last frame.
  const bool isPattern = !texts.output.empty() && output::hasFramePattern(options.output.file) &&
                         output::fileKind(options.output.file) != output::FileKind::film;
  options.output.everyFrame = options.output.everyFrame || isPattern;
  convert(texts, options);
  convertFrames(texts, options);
  // Frames are written, not only the last one, unless a single file is named.
  job::FrameRequest& frames = options.request.frames;
  frames.every = options.output.everyFrame && (frames.count || frames.first);
  if (options.request.limits.samples) frames.accumulated = static_cast<std::uint32_t>(*options.request.limits.samples);
}

void checkStandardStreams(const RenderOptions& options) {
  const std::filesystem::path& file = options.output.file;
  if (!output::isStandardOutput(file)) return;
  if (options.console.json)
    throw UsageError(fmt::format("--json and -o {} both write to standard output", file.string()));
  if (::isatty(STDOUT_FILENO) == 1)
    throw UsageError(
        fmt::format("-o {}: standard output is a terminal; redirect it to a file or a program", file.string()));
}

}  // namespace quintet::cli
