// `quintet bench`: how close the path tracer comes to the same device's own ceiling. The path tracer's rays of one
// sample are recorded and traced again, in the same order, by minimal shaders; the ratio of both rates is
// taken within one run. Also: what the spatial order of primitives and the balance of launches gain.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>

#include "base/file.h"
#include "base/parallel.h"
#include "bench.h"
#include "cli.h"
#include "program/program.h"

namespace quintet::app {
namespace {

using Json = Bench::Json;

constexpr const char* kExamples =
    "  quintet bench scene.glb                        a table\n"
    "  quintet bench scene.glb --json --repeat 9      the same as JSON, medians of nine\n"
    "  quintet bench scene.glb --profile              time by pass, rays by kind, launches, registers\n";

double medianSampleSeconds(render::Renderer& renderer, int repeat) {
  sampleSeconds(renderer);  // what the driver compiles at the first launch
  std::vector<double> seconds;
  for (int i = 0; i < repeat; ++i) seconds.push_back(sampleSeconds(renderer));
  return median(seconds);
}

// Rays of the batches so far per batch.
std::uint64_t raysPerSample(const render::Renderer& renderer) {
  return renderer.rays().rays / std::max<std::uint64_t>(1, renderer.statistics().samples);
}

// Mrays/s of one ambient occlusion sample (a primary and a secondary ray per pixel) on this scene.
double occlusionRate(const Bench& bench, gpu::Context& context, const scene::Scene& scene, bool keepInputOrder,
                     uvec2 pixels) {
  render::DeviceSceneOptions options;
  options.keepInputOrder = keepInputOrder;
  render::DeviceScene device(context, scene, bench.environment, options);
  const program::Program program = program::loadProgram("ao");
  render::Renderer renderer(device, program, bench.compiler, nullptr, bench.settings(program, pixels));
  const double seconds = medianSampleSeconds(renderer, keepInputOrder ? 1 : bench.options.repeat);
  return static_cast<double>(raysPerSample(renderer)) / seconds * 1e-6;
}

// Triangles and instances in random order: what a careless exporter may write.
scene::Scene shuffled(scene::Scene scene) {
  std::mt19937 random(1);
  for (scene::Mesh& mesh : scene.meshes)
    for (scene::Geometry& geometry : mesh.geometries)
      std::shuffle(geometry.triangles.begin(), geometry.triangles.end(), random);
  std::shuffle(scene.instances.begin(), scene.instances.end(), random);
  return scene;
}

Json orderGain(const Bench& bench, gpu::Context& context) {
  const scene::Scene random = shuffled(bench.scene);
  // Few pixels: random order is slower by a factor of hundreds where the driver keeps it.
  const uvec2 pixels = context.info().quirks.keepsPrimitiveOrder ? uvec2(96, 96) : bench.size;
  const double given = occlusionRate(bench, context, bench.scene, true, pixels);
  const double worst = occlusionRate(bench, context, random, true, pixels);
  const double ordered = occlusionRate(bench, context, random, false, pixels);
  return {{"pixels", {pixels.x, pixels.y}},     {"fileOrderMraysPerSecond", given},
          {"randomOrderMraysPerSecond", worst}, {"spatialOrderMraysPerSecond", ordered},
          {"gainOverRandom", ordered / worst},  {"gainOverFile", ordered / given}};
}

// The library asks lavapipe for more threads than cores, so that a launch's uneven parts even out; without
// that, one contiguous part for each core.
Json balanceGain(const Bench& bench, gpu::Context& context) {
  const double balanced = occlusionRate(bench, context, bench.scene, false, bench.size);
  const char* set = std::getenv("LP_NUM_THREADS");
  const std::string threads = set ? set : "";
  setenv("LP_NUM_THREADS", std::to_string(hardwareThreads()).c_str(), 1);
  gpu::ContextOptions options;
  options.device = bench.options.device;
  double unbalanced = 0;
  {
    gpu::Context plain(options);
    unbalanced = occlusionRate(bench, plain, bench.scene, false, bench.size);
  }
  setenv("LP_NUM_THREADS", threads.c_str(), 1);
  return {{"threads", threads},
          {"oneThreadPerCoreMraysPerSecond", unbalanced},
          {"balancedMraysPerSecond", balanced},
          {"gain", balanced / unbalanced}};
}

std::string asTable(const Json& json, const std::string& prefix = {}) {
  std::string text;
  for (const auto& [key, value] : json.items()) {
    const std::string name = prefix.empty() ? key : prefix + "." + key;
    if (value.is_object())
      text += asTable(value, name);
    else
      text += fmt::format("{:<48} {}\n", name,
                          value.is_number_float() ? fmt::format("{:.4g}", value.get<double>())
                          : value.is_string()     ? value.get<std::string>()
                                                  : value.dump());
  }
  return text;
}

Json measure(const BenchOptions& options) {
  gpu::ContextOptions contextOptions;
  contextOptions.device = options.device;
  gpu::Context context(contextOptions);
  const auto start = std::chrono::steady_clock::now();
  Bench bench(options, context.info().quirks.software);
  const double loadSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const scene::TriangleCount triangles = scene::countTriangles(bench.scene);

  Json result = {{"device", context.info().name}, {"driver", context.info().driver},
                 {"scene", options.scene},        {"size", {bench.size.x, bench.size.y}},
                 {"triangles", triangles.stored}, {"instancedTriangles", triangles.instanced},
                 {"loadSeconds", loadSeconds}};
  {
    render::DeviceScene scene(context, bench.scene, bench.environment);
    result["pathTracer"] = pathTracerRatio(bench, scene);
    if (options.profile) result["profile"] = profile(bench, scene);
    const render::DeviceSceneStatistics& s = scene.statistics();
    result["accelerationStructures"] = {
        {"orderSeconds", s.build.orderSeconds},
        {"buildSeconds", s.build.buildSeconds},
        {"topLevelSeconds", s.topLevelSeconds},
        {"bytes", s.accelerationBytes},
        {"bytesPerTriangle",
         static_cast<double>(s.accelerationBytes) / static_cast<double>(std::max<std::uint64_t>(1, triangles.stored))}};
    result["uploadSeconds"] = s.uploadSeconds;
  }
  if (options.profile) return result;
  const auto again = std::chrono::steady_clock::now();
  {
    render::DeviceScene scene(context, bench.scene, bench.environment);
    const program::Program program = program::loadProgram(options.program);
    render::Renderer renderer(scene, program, bench.compiler, nullptr, bench.settings(program, bench.size));
    renderer.renderBatch(1);
    renderer.finish();
  }
  result["warmFirstSampleSeconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - again).count();
  result["primitiveOrder"] = orderGain(bench, context);
  if (context.info().quirks.software) result["launchBalance"] = balanceGain(bench, context);
  return result;
}

}  // namespace

int benchCommand(Arguments arguments) {
  CLI::App app("Measures rays per second against the device's own ceiling for the same rays.", "quintet bench");
  BenchOptions options;
  app.add_option("SCENE", options.scene, "A scene of triangles without alpha (replay knows no other)")->required();
  app.add_option("--device", options.device, "Index or part of the name");
  app.add_option("--env", options.environment, "Environment, as in `quintet render`");
  app.add_option("--size", options.size, "WxH; default 512x512 on a CPU, else 1920x1080");
  app.add_option("--repeat", options.repeat, "Measurements; the median counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--program", options.program, "What is measured; its rays go through traceClosest and traceVisible")
      ->capture_default_str();
  app.add_flag("--profile", options.profile, "Where the time goes, instead of what order and balance gain");
  app.add_flag("--json", options.json, "One JSON object instead of a table");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return 0;
  const Json result = measure(options);
  writeFile("-", options.json ? result.dump() + "\n" : asTable(result));
  return 0;
}

}  // namespace quintet::app
