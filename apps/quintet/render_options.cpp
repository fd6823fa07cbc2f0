#include "render_options.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "cli.h"
#include "program/program.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr std::uint64_t kMaxSamples = 1u << 24;  // float sums hold no more
constexpr std::uint64_t kDefaultSamples = 64;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

constexpr const char* kExamples =
    "  quintet render scene.glb                                scene.png\n"
    "  quintet render scene.glb -o out.exr --size 1920x1080 --spp 256\n"
    "  quintet render scene.glb --time 60 --env sky.hdr        as many samples as a minute allows\n"
    "  quintet render scene.glb --look-from 2,1,3 --look-at 0,0.5,0 --fov 35\n"
    "  quintet render scene.glb --program ao --set distance=0.5  another program with a parameter\n"
    "  quintet render --program pathtracer --help-program      what parameters it has\n"
    "  quintet render scene.glb -o - --quiet | display         PNG on standard output\n";

// Options as text, before their values are looked at.
struct Raw {
  std::string scene, output, size, spp, time, lookFrom, lookAt, up, fov, aperture, focus, envIntensity, envRotation,
      exposure, toneMap, seed, region, timeout;
};

void declareImage(CLI::App& app, Raw& raw, RenderOptions& options) {
  app.add_option("SCENE", raw.scene, "The scene: .gltf or .glb");
  const std::string image = "Image";
  app.add_option("-o,--output", raw.output,
                 "File to write: .png, .exr, .hdr, or - for PNG on standard output (default: the scene's name with .png, here)")
      ->group(image);
  app.add_option("--size", raw.size,
                 "WxH pixels, or W alone (default: 1280x720, or 1280 along the longer side of the file's camera)")
      ->group(image);
  app.add_option("--region", raw.region, "X,Y,W,H: render and write only this part, in pixels from the top left")->group(image);
  app.add_flag("--transparent", options.transparent, "Alpha 0 where nothing is, instead of the environment")->group(image);
  app.add_option("--exposure", raw.exposure, "Stops; picture times 2^EXPOSURE (PNG only; default: 0)")->group(image);
  app.add_option("--tonemap", raw.toneMap,
                 "linear, aces, agx or neutral (PNG only; default: neutral for colour, linear for other outputs)")
      ->group(image);
  const std::string quality = "Quality";
  app.add_option("--spp", raw.spp, "Samples per pixel (default: 64; none with --time)")->group(quality);
  app.add_option("--time", raw.time, "Seconds to render for; with --spp, what comes first")->group(quality);
  app.add_option("--seed", raw.seed, "Of the random numbers (default: 0)")->group(quality);
  app.add_option("--bounces", options.bounces, "Short for --set bounces=N")->group(quality);
  app.add_option("--clamp", options.clamp, "Short for --set clamp=X")->group(quality);
}

void declareScene(CLI::App& app, Raw& raw, RenderOptions& options) {
  const std::string camera = "Camera";
  app.add_option("--camera", options.camera.camera, "Index or name of a camera in the file (default: the first, else automatic)")
      ->group(camera);
  app.add_option("--look-from", raw.lookFrom, "X,Y,Z of the eye, metres")->group(camera);
  app.add_option("--look-at", raw.lookAt, "X,Y,Z of the point looked at (default: the middle of the scene)")->group(camera);
  app.add_option("--up", raw.up, "X,Y,Z that is up in the image (default: 0,1,0)")->group(camera);
  app.add_option("--fov", raw.fov, "Vertical field of view, degrees (default: 45, or the file's)")->group(camera);
  app.add_option("--aperture", raw.aperture, "Radius of the lens, metres (default: 0, all is sharp)")->group(camera);
  app.add_option("--focus", raw.focus, "Distance that is sharp, metres (default: the point looked at)")->group(camera);
  const std::string light = "Light";
  app.add_option("--env", options.environment.source,
                 "Environment: an image (equirectangular), 'none', 'default', or R,G,B (default: the scene's; "
                 "'default' if nothing in the scene gives light)")
      ->group(light);
  app.add_option("--env-intensity", raw.envIntensity, "Factor for the environment (default: 1)")->group(light);
  app.add_option("--env-rotation", raw.envRotation, "Degrees about the y axis, counter-clockwise seen from above")->group(light);
}

void declareRest(CLI::App& app, Raw& raw, RenderOptions& options) {
  const std::string program = "Program";
  app.add_option("--program", options.program, "Name or folder of a program (default: pathtracer)")->group(program);
  app.add_option("--set", options.assignments, "NAME=VALUE for a parameter of the program; may be repeated")
      ->expected(1)
      ->take_all()
      ->group(program);
  app.add_flag("--help-program", options.programHelp, "Print the program's parameters and leave")->group(program);
  const std::string run = "Run";
  app.add_option("--device", options.device, "Index or part of the name: 0, h200, lavapipe, cpu, gpu (see 'quintet info')")
      ->group(run);
  app.add_option("--timeout", raw.timeout, "Seconds after which a launch counts as hanging (default: 60; on a CPU, which also compiles in it, 600)")->group(run);
  app.add_flag("-q,--quiet", options.quiet, "No progress and no notes on standard error")->group(run);
  app.add_flag("--json", options.json, "At the end, one JSON object on standard output")->group(run);
}

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
  if (value && std::floor(*value) != *value) throw UsageError(fmt::format("{}: '{}' is not a whole number", option, text));
  return value ? std::optional(static_cast<std::uint64_t>(*value)) : std::nullopt;
}
std::optional<vec3> point(const std::string& option, const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(parseVec3(option, text));
}

void interpretView(const Raw& raw, RenderOptions& options) {
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

void interpretImage(const Raw& raw, RenderOptions& options) {
  if (!raw.size.empty()) options.size = parseSize("--size", raw.size);
  if (!raw.region.empty()) options.region = parseRegion("--region", raw.region);
  options.samples = whole("--spp", raw.spp, 1, static_cast<double>(kMaxSamples));
  options.seconds = number("--time", raw.time, 0.0, kUnlimited);
  if (!options.samples && !options.seconds) options.samples = kDefaultSamples;
  options.exposure = real("--exposure", raw.exposure, -100.0, 100.0).value_or(0.0f);
  options.seed = static_cast<std::uint32_t>(whole("--seed", raw.seed, 0, 4294967295.0).value_or(0));
  options.timeout = number("--timeout", raw.timeout, 0.001, kUnlimited);
  if (raw.toneMap.empty()) return;
  options.toneMap = render::toneMapByName(raw.toneMap);
  if (!options.toneMap)
    throw UsageError(fmt::format("--tonemap: there is no '{}'{}; there are {}", raw.toneMap,
                                 suggestion(raw.toneMap, render::toneMapNames()),
                                 fmt::join(render::toneMapNames(), ", ")));
}

}  // namespace

std::optional<RenderOptions> parseRenderOptions(Arguments arguments) {
  CLI::App app("Renders a glTF scene with the path tracer, or with another program.", "quintet render");
  RenderOptions options;
  Raw raw;
  declareImage(app, raw, options);
  declareScene(app, raw, options);
  declareRest(app, raw, options);
  setUp(app, kExamples);
  if (!parse(app, arguments)) return std::nullopt;
  options.commandLine = commandLine("render", arguments);
  if (options.programHelp) return options;
  if (raw.scene.empty()) throw UsageError("no scene given; see 'quintet render --help'");
  options.scene = raw.scene;
  options.output = app.count("--output") > 0 ? std::filesystem::path(raw.output)
                                             : options.scene.filename().replace_extension(".png");
  if (options.json && options.output == "-")
    throw UsageError("--json and -o - both want the standard output");
  interpretImage(raw, options);
  interpretView(raw, options);
  return options;
}

}  // namespace quintet::app
