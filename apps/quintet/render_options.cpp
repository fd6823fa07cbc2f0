#include "render_options.h"

#include <unistd.h>

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
  app.add_option("SCENE", raw.scene, "The scene: .gltf or .glb")->type_name("");
  const auto add = [&app](const char* name, std::string& value, const char* form, const char* help) {
    app.add_option(name, value, help)->type_name(form)->group("Image");
  };
  add("-o,--output", raw.output, "FILE", ".png, .exr or .hdr; - is PNG on standard output (default: SCENE.png, here)");
  add("--size", raw.size, "WxH", "Pixels; or W alone (default: 1280x720, or 1280 on the camera's longer side)");
  add("--region", raw.region, "X,Y,W,H", "Render and write only this part, in pixels from the top left");
  app.add_flag("--transparent", options.transparent, "Alpha 0 where nothing is, instead of the environment")->group("Image");
  add("--exposure", raw.exposure, "STOPS", "Multiply by 2^STOPS (PNG only; default: 0)");
  add("--tonemap", raw.toneMap, "NAME", "linear, aces, agx or neutral (PNG only; default: neutral for colour)");
}

void declareQuality(CLI::App& app, Raw& raw, RenderOptions& options) {
  const auto add = [&app](const char* name, auto& value, const char* form, const char* help) {
    app.add_option(name, value, help)->type_name(form)->group("Quality");
  };
  add("--spp", raw.spp, "N", "Samples per pixel (default: 64; none with --time)");
  add("--time", raw.time, "SECONDS", "Render for so long; with --spp, what comes first");
  add("--seed", raw.seed, "N", "Of the random numbers (default: 0)");
  add("--bounces", options.bounces, "N", "Short for --set bounces=N");
  add("--clamp", options.clamp, "X", "Short for --set clamp=X");
}

void declareScene(CLI::App& app, Raw& raw, RenderOptions& options) {
  const auto add = [&app](const char* group, const char* name, std::string& value, const char* form, const char* help) {
    app.add_option(name, value, help)->type_name(form)->group(group);
  };
  add("Camera", "--camera", options.camera.camera, "NAME", "Index or name in the file (default: the first, else automatic)");
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

void declareRest(CLI::App& app, Raw& raw, RenderOptions& options) {
  const char* program = "Program";
  app.add_option("--program", options.program, "Built-in program, or folder of one (default: pathtracer)")
      ->type_name("NAME")
      ->group(program);
  app.add_option("--set", options.assignments, "A parameter of the program; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("NAME=VALUE")
      ->group(program);
  app.add_flag("--help-program", options.programHelp, "Print the program's parameters and leave")->group(program);
  const char* run = "Run";
  app.add_option("--device", options.device, "Index or part of the name: 0, h200, lavapipe, cpu, gpu")
      ->type_name("NAME")
      ->group(run);
  app.add_option("--timeout", raw.timeout, "A launch that takes longer hangs (default: 60; on a CPU 600)")
      ->type_name("SECONDS")
      ->group(run);
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
  declareQuality(app, raw, options);
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
  if (options.output == "-" && ::isatty(STDOUT_FILENO) == 1)
    throw UsageError("-o -: the standard output is a terminal; send it to a file or a program");
  interpretImage(raw, options);
  interpretView(raw, options);
  return options;
}

}  // namespace quintet::app
