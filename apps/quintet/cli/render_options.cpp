// SPDX-License-Identifier: Apache-2.0
#include "cli/render_options.h"

#include <unistd.h>

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/values.h"
#include "render/film/film_file.h"

namespace quintet::cli {
namespace {

constexpr double kMaxSamples = 1u << 24;
constexpr std::uint64_t kDefaultSamples = 64;
constexpr double kMinError = 1e-6;
constexpr double kMaxReal = 1e30;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

std::optional<float> parseFloat(const std::string& option, const std::string& text, double min, double max) {
  const std::optional<double> value = parseReal(option, text, min, max);
  return value ? std::optional(static_cast<float>(*value)) : std::nullopt;
}

// Declares an option with a value in a group.
template <class T>
void add(CLI::App& app, const char* group, const char* name, T& value, const char* form, const std::string& help) {
  app.add_option(name, value, help)->type_name(form)->group(group);
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

void declareImage(CLI::App& app, RenderTexts& texts, RenderOptions& options) {
  const char* group = "Image";
  add(app, group, "--size", texts.size, "WxH",
      "Size in pixels, or the width alone (default: 1280x720, or 1280 on the longer\nside of the camera's image)");
  add(app, group, "--region", texts.region, "X,Y,W,H", "Render and write only this part, in pixels from the top left");
  app.add_flag("--transparent", options.request.transparent, "Alpha 0 in the background instead of the environment")
      ->group(group);
  declareDisplay(app, texts, group, "default: 0, and neutral for colors");
}

void declareDisplay(CLI::App& app, RenderTexts& texts, const char* group, const char* otherwise) {
  add(app, group, "--exposure", texts.exposure, "STOPS", fmt::format("Multiply by 2^STOPS (PNG only; {})", otherwise));
  add(app, group, "--tonemap", texts.toneMap, "NAME", "Tone mapping: linear, aces, agx or neutral (PNG only)");
  add(app, group, "--png-bits", texts.pngBits, "N", "Bits per channel of PNG files: 8 or 16 (default: 8)");
}

void declareQuality(CLI::App& app, RenderTexts& texts, RenderOptions& options) {
  const char* group = "Quality";
  add(app, group, "--spp", texts.spp, "N",
      "Number of samples per pixel (default: 64; none with --time or --until-error)");
  add(app, group, "--time", texts.time, "SECONDS", "Time limit of rendering");
  add(app, group, "--until-error", texts.untilError, "E",
      "Target for the relative error of the image, e.g. 0.02; the error of 95 % of its\n"
      "tiles must be below 2 E (stated with 95 % confidence). The status is 3 if another\n"
      "limit ends the render first");
  app.add_flag("--adaptive", options.request.limits.adaptive,
               "Distribute samples by the error of each tile; --spp is then the average")
      ->group(group);
  add(app, group, "--seed", texts.seed, "N", "Seed of the random number generator (default: 0)");
  add(app, group, "--bounces", texts.bounces, "N", "Same as --set bounces=N");
  add(app, group, "--clamp", texts.clamp, "X", "Same as --set clamp=X");
}

void declareView(CLI::App& app, RenderTexts& texts, RenderOptions& options) {
  const char* camera = "Camera";
  add(app, camera, "--camera", options.request.camera.name, "NAME",
      "Index or name of a camera in the file (default: the first, else automatic)");
  add(app, camera, "--look-from", texts.lookFrom, "X,Y,Z", "Position of the camera, meters");
  add(app, camera, "--look-at", texts.lookAt, "X,Y,Z",
      "Point at the center of the image (default: center of the scene)");
  add(app, camera, "--up", texts.up, "X,Y,Z", "Up direction of the image (default: 0,1,0)");
  add(app, camera, "--fov", texts.fov, "DEGREES", "Vertical field of view (default: the camera's, or 45)");
  add(app, camera, "--aperture", texts.aperture, "METERS", "Radius of the lens (default: the camera's, or 0: pinhole)");
  add(app, camera, "--focus", texts.focus, "METERS", "Focus distance (default: the distance of --look-at)");
  const char* light = "Light";
  add(app, light, "--env", options.request.environment.source, "WHAT",
      "Environment: an equirectangular image, none, default, or R,G,B (default: the\n"
      "scene's; 'default' if the scene has no lights)");
  add(app, light, "--env-intensity", texts.envIntensity, "X", "Factor for the environment (default: 1)");
  add(app, light, "--env-rotation", texts.envRotation, "DEGREES",
      "Rotation about the y axis, counter-clockwise seen from above");
}

void declareProgram(CLI::App& app, RenderOptions& options) {
  const char* group = "Program";
  app.add_option("--set", options.request.assignments, "Parameter of the program; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("NAME=VALUE")
      ->group(group);
  app.add_option("--set-file", options.request.parameterFile, "Parameters as a JSON object; --set overrides them")
      ->type_name("FILE.json")
      ->group(group);
  app.add_flag("--all-outputs", options.output.allOutputs, "Write every output of the program: out.NAME.png")
      ->group(group);
}

void declareProcess(CLI::App& app, RenderTexts& texts, RenderOptions& options, const std::string& timeoutHelp) {
  const char* group = "Run";
  app.add_option("--device", options.device, "Index or part of the name: 0, h200, lavapipe, cpu, gpu")
      ->type_name("NAME")
      ->group(group);
  app.add_option("--timeout", texts.timeout, timeoutHelp)->type_name("SECONDS")->group(group);
  app.add_flag("-q,--quiet", options.console.quiet, "Print neither progress nor notes")->group(group);
}

void declareCheckpoints(CLI::App& app, RenderTexts& texts, RenderOptions& options) {
  const char* group = "Long renders";
  job::CheckpointRequest& checkpoint = options.request.checkpoint;
  add(app, group, "--checkpoint", texts.checkpoint, "SECONDS",
      "Write a checkpoint every N seconds, 0: after each batch (default with the\n"
      "options below: 60); it is removed when the image is written");
  add(app, group, "--checkpoint-file", checkpoint.file, "FILE",
      "Name of the checkpoint (default: OUTPUT.checkpoint.qfilm)");
  app.add_flag("--keep-checkpoint", checkpoint.keep, "Keep the checkpoint when the image is written")->group(group);
  app.add_flag("--resume", checkpoint.resume,
               "Continue from the checkpoint, to the same bytes as without interruption; start\n"
               "from the first sample if it does not exist")
      ->group(group);
  add(app, group, "--batches", texts.batches, "A-B",
      "Render only batches A to B of --spp (4 samples each, from 0, B included) into\n"
      "-o FILE.qfilm; 'quintet merge' joins the parts");
  app.add_flag("--force", checkpoint.force, "Overwrite a checkpoint or film although its samples are lost")
      ->group(group);
  app.add_flag("--json-progress", options.console.jsonProgress, "Print a line of JSON on standard error for each batch")
      ->group(group);
}

void declareExr(CLI::App& app, RenderTexts& texts, bool ofFilms) {
  const char* group = "OpenEXR";
  app.add_option("--aov", texts.layers,
                 ofFilms ? "Layers of the films to write (default: all); may be repeated"
                         : "Layers to write besides the image; 'list' prints their names. May be\nrepeated")
      ->expected(1)
      ->take_all()
      ->delimiter(',')
      ->type_name(ofFilms ? "NAMES|all" : "NAMES|all|list")
      ->group(group);
  add(app, group, "--exr-type", texts.exrType, "half|float", "Type of colors (default: half); data are always floats");
  add(app, group, "--exr-compression", texts.exrCompression, "NAME[:LEVEL]",
      "Compression: none, rle, zips, zip, piz, dwaa or dwab (default: zip); levels:\n"
      "zip:1 to 9, dwaa:45 (lossy, colors only)");
  add(app, group, "--exr-tiles", texts.exrTiles, "N", "Write tiles of N x N pixels (default: scan lines)");
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
  convertCheckpoints(texts, options);
  if (output::fileKind(options.output.file) == output::FileKind::film) request.film = options.output.file;
  request.overwriteFilm = request.checkpoint.force;
}

void checkStandardOutput(const RenderOptions& options) {
  const std::filesystem::path& file = options.output.file;
  if (!output::isStandardOutput(file)) return;
  if (options.console.json)
    throw UsageError(fmt::format("--json and -o {} both write to standard output", file.string()));
  if (::isatty(STDOUT_FILENO) == 1)
    throw UsageError(
        fmt::format("-o {}: standard output is a terminal; redirect it to a file or a program", file.string()));
}

}  // namespace quintet::cli
