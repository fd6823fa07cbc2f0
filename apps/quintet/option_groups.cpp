#include "option_groups.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "output.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr std::uint64_t kMaxSamples = 1u << 24;  // float sums hold no more
constexpr std::uint64_t kDefaultSamples = 64;
constexpr double kLeastError = 1e-6;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

std::optional<double> number(const std::string& option, const std::string& text, double min, double max) {
  if (text.empty()) return std::nullopt;
  return parseNumber(option, text, min, max);
}
std::optional<float> real(const std::string& option, const std::string& text, double min, double max) {
  const auto value = number(option, text, min, max);
  return value ? std::optional(static_cast<float>(*value)) : std::nullopt;
}
std::optional<std::uint64_t> whole(const std::string& option, const std::string& text, double min, double max) {
  const auto value = number(option, text, min, max);
  if (value && std::floor(*value) != *value)
    throw UsageError(fmt::format("{}: '{}' is not a whole number", option, text));
  return value ? std::optional(static_cast<std::uint64_t>(*value)) : std::nullopt;
}
std::optional<vec3> point(const std::string& option, const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(parseVec3(option, text));
}

void interpretView(const RawOptions& raw, RenderOptions& options) {
  constexpr double kHuge = 1e30;
  constexpr double kSmall = 1e-12;
  options.camera.lookFrom = point("--look-from", raw.lookFrom);
  options.camera.lookAt = point("--look-at", raw.lookAt);
  options.camera.up = point("--up", raw.up).value_or(vec3(0, 1, 0));
  options.camera.fov = real("--fov", raw.fov, 0.01, 179.0);
  options.camera.aperture = real("--aperture", raw.aperture, 0.0, kHuge);
  options.camera.focus = real("--focus", raw.focus, kSmall, kHuge);
  options.environment.intensity = real("--env-intensity", raw.envIntensity, 0.0, kHuge);
  options.environment.rotation = real("--env-rotation", raw.envRotation, -36000.0, 36000.0);
}

void interpretImage(const RawOptions& raw, RenderOptions& options) {
  if (!raw.size.empty()) options.size = parseSize("--size", raw.size);
  if (!raw.region.empty()) options.region = parseRegion("--region", raw.region);
  options.samples = whole("--spp", raw.spp, 1, static_cast<double>(kMaxSamples));
  options.seconds = number("--time", raw.time, 0.0, kUnlimited);
  options.error = number("--until-error", raw.untilError, kLeastError, 1.0);
  if (!options.samples && !options.seconds && !options.error) options.samples = kDefaultSamples;
  options.exposure = real("--exposure", raw.exposure, -100.0, 100.0).value_or(0.0f);
  options.seed = static_cast<std::uint32_t>(whole("--seed", raw.seed, 0, 4294967295.0).value_or(0));
  options.timeout = number("--timeout", raw.timeout, 0.001, kUnlimited);
  if (!raw.toneMap.empty()) options.toneMap = parseToneMap("--tonemap", raw.toneMap);
}

}  // namespace

void declareImage(CLI::App& app, RawOptions& raw, RenderOptions& options) {
  const auto add = [&app](const char* name, std::string& value, const char* form, const char* help) {
    app.add_option(name, value, help)->type_name(form)->group("Image");
  };
  add("--size", raw.size, "WxH", "Pixels; or W alone (default: 1280x720, or 1280 on the camera's longer side)");
  add("--region", raw.region, "X,Y,W,H", "Render and write only this part, in pixels from the top left");
  app.add_flag("--transparent", options.transparent, "Alpha 0 where nothing is, instead of the environment")
      ->group("Image");
  add("--exposure", raw.exposure, "STOPS", "Multiply by 2^STOPS (PNG only; default: 0)");
  add("--tonemap", raw.toneMap, "NAME", "linear, aces, agx or neutral (PNG only; default: neutral for colour)");
}

void declareExr(CLI::App& app, RawOptions& raw, AovNames names) {
  const auto add = [&app](const char* name, std::string& value, const char* form, const char* help) {
    app.add_option(name, value, help)->type_name(form)->group("OpenEXR");
  };
  const bool ofProgram = names == AovNames::ofProgram;
  app.add_option("--aov", raw.aovs,
                 ofProgram
                     ? "Layers to write beside the picture, all of them, or print what there are;\nmay be repeated"
                     : "Which layers of the films to write (default: all); may be repeated")
      ->expected(1)
      ->take_all()
      ->delimiter(',')
      ->type_name(ofProgram ? "NAMES|all|list" : "NAMES|all")
      ->group("OpenEXR");
  add("--exr-type", raw.exrType, "half|float", "Of colours (default: half); data are floats always");
  add("--exr-compression", raw.exrCompression, "NAME[:LEVEL]",
      "none, rle, zips, zip, piz, dwaa or dwab (default: zip); zip:1 to 9,\n"
      "dwaa:45 (lossy, colours only)");
  add("--exr-tiles", raw.exrTiles, "N", "Tiles of N x N pixels (default: scan lines)");
}

bool asksForAovList(const RawOptions& raw) { return std::ranges::find(raw.aovs, "list") != raw.aovs.end(); }

void declareQuality(CLI::App& app, RawOptions& raw, RenderOptions& options) {
  const auto add = [&app](const char* name, auto& value, const char* form, const char* help) {
    app.add_option(name, value, help)->type_name(form)->group("Quality");
  };
  add("--spp", raw.spp, "N", "Samples per pixel (default: 64; none with --time or --until-error)");
  add("--time", raw.time, "SECONDS", "Render for so long; with --spp, what comes first");
  add("--until-error", raw.untilError, "E",
      "Render until the picture's relative error is at most E, and twice that in 95 % of\n"
      "its tiles (0.02: 2 %; stated with 95 % confidence); with --spp or --time, at most that");
  app.add_flag("--adaptive", options.adaptive,
               "Give more samples to the tiles that need them; --spp is then their average\n(goes on with --resume, "
               "has no --batches)")
      ->group("Quality");
  add("--seed", raw.seed, "N", "Of the random numbers (default: 0)");
  add("--bounces", options.bounces, "N", "Short for --set bounces=N");
  add("--clamp", options.clamp, "X", "Short for --set clamp=X");
}

void declareView(CLI::App& app, RawOptions& raw, RenderOptions& options) {
  const auto add = [&app](const char* group, const char* name, std::string& value, const char* form, const char* help) {
    app.add_option(name, value, help)->type_name(form)->group(group);
  };
  add("Camera", "--camera", options.camera.camera, "NAME",
      "Index or name in the file (default: the first, else automatic)");
  add("Camera", "--look-from", raw.lookFrom, "X,Y,Z", "The eye, metres");
  add("Camera", "--look-at", raw.lookAt, "X,Y,Z", "The point looked at (default: the middle of the scene)");
  add("Camera", "--up", raw.up, "X,Y,Z", "What is up in the image (default: 0,1,0)");
  add("Camera", "--fov", raw.fov, "DEGREES", "Vertical field of view (default: 45, or the file's)");
  add("Camera", "--aperture", raw.aperture, "METRES", "Radius of the lens (default: 0, all is sharp)");
  add("Camera", "--focus", raw.focus, "METRES", "Distance that is sharp (default: the point looked at)");
  add("Light", "--env", options.environment.source, "WHAT",
      "An equirectangular image, none, default, or R,G,B (default: what the scene\n"
      "has; 'default' if nothing in it gives light)");
  add("Light", "--env-intensity", raw.envIntensity, "X", "Factor for the environment (default: 1)");
  add("Light", "--env-rotation", raw.envRotation, "DEGREES", "About the y axis, counter-clockwise seen from above");
}

void declareProgram(CLI::App& app, RawOptions& raw, RenderOptions& options) {
  const char* group = "Program";
  app.add_option("--set", options.assignments, "A parameter of the program; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("NAME=VALUE")
      ->group(group);
  app.add_option("--set-file", raw.setFile, "Parameters as a JSON object; --set wins")
      ->type_name("FILE.json")
      ->group(group);
  app.add_flag("--all-outputs", options.allOutputs, "Write every output of the program: out.NAME.png")->group(group);
}

void declareProcess(CLI::App& app, RawOptions& raw, RenderOptions& options, const std::string& timeoutHelp) {
  const char* group = "Run";
  app.add_option("--device", options.device, "Index or part of the name: 0, h200, lavapipe, cpu, gpu")
      ->type_name("NAME")
      ->group(group);
  app.add_option("--timeout", raw.timeout, timeoutHelp)->type_name("SECONDS")->group(group);
  app.add_flag("-q,--quiet", options.quiet, "No progress and no notes on standard error")->group(group);
}

void interpret(const RawOptions& raw, RenderOptions& options) {
  options.setFile = raw.setFile;
  options.aovs = raw.aovs;
  if (!raw.exrType.empty()) options.exr.colors = parseExrType(raw.exrType);
  if (!raw.exrCompression.empty()) parseExrCompression(raw.exrCompression, options.exr.options);
  if (!raw.exrTiles.empty()) options.exr.options.tileSize = parseExrTiles(raw.exrTiles);
  interpretImage(raw, options);
  interpretView(raw, options);
}

void checkExrOptions(const RawOptions& raw, const RenderOptions& options) {
  if (!options.aovs.empty() && options.allOutputs)
    throw UsageError("--aov writes one file of layers, --all-outputs one file each: they exclude each other");
  if (!options.aovs.empty() && !options.outputName.empty())
    throw UsageError("--aov adds to the program's first output: --output cannot choose another");
  const auto is = [&](OutputKind kind) { return !options.output.empty() && outputKind(options.output) == kind; };
  const bool film = is(OutputKind::film);  // keeps layers for a file that is made later
  const char* given = !raw.aovs.empty() && !film    ? "--aov"
                      : !raw.exrType.empty()        ? "--exr-type"
                      : !raw.exrCompression.empty() ? "--exr-compression"
                      : !raw.exrTiles.empty()       ? "--exr-tiles"
                                                    : nullptr;
  if (!given || is(OutputKind::exr)) return;
  throw UsageError(fmt::format("{} is for OpenEXR files: -o must name a .exr file", given));
}

void checkStandardOutput(const std::filesystem::path& output, bool json, bool allOutputs) {
  if (output != "-") return;
  if (json) throw UsageError("--json and -o - both want the standard output");
  if (allOutputs) throw UsageError("--all-outputs writes several files: -o - takes one picture");
  if (::isatty(STDOUT_FILENO) == 1)
    throw UsageError("-o -: the standard output is a terminal; send it to a file or a program");
}

}  // namespace quintet::app
