// SPDX-License-Identifier: Apache-2.0
#include "job/benchmark.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "job/device_limits.h"
#include "job/engine.h"
#include "job/resolve.h"
#include "job/runnable_program.h"
#include "job/scene_source.h"
#include "job/view.h"
#include "program/load.h"
#include "render/renderer/renderer.h"
#include "render/tone_map/tone_map.h"
#include "rt/pipeline.h"
#include "scene/load.h"

namespace quintet::job {
namespace {

using Json = nlohmann::ordered_json;

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

uvec2 sizeOf(uvec2 requested, bool softwareDevice) {
  uvec2 size = requested.x > 0 ? requested : softwareDevice ? uvec2(512, 512) : uvec2(1920, 1080);
  if (size.y == 0) size.y = size.x;
  return size;
}

// Scene, view and settings that all measurements share.
struct Setup {
  const BenchmarkRequest& request;
  scene::Scene scene;
  scene::Environment environment;
  scene::Camera camera;
  uvec2 size;
  shader::Compiler compiler;

  Setup(const BenchmarkRequest& r, bool softwareDevice)
      : request(r), scene(scene::loadScene(r.scene, r.load)), compiler(makeCompiler(cacheFolder())) {
    size = sizeOf(r.size, softwareDevice);
    camera = chooseCamera(scene, {}, static_cast<float>(size.x) / static_cast<float>(size.y)).camera;
    environment = chooseEnvironment(scene, {r.environment, {}, {}}, r.load.maxMemory).environment;
  }

  render::RenderSettings settings(const program::Program& program, uvec2 pixels) const {
    render::RenderSettings settings;
    settings.width = pixels.x;
    settings.height = pixels.y;
    settings.camera = camera;
    settings.parameters = program::ParameterValues(program.parameters);
    settings.launchSeconds = 1.0;
    settings.timeoutSeconds = 300;
    return settings;
  }

  render::DeviceScene onDevice(gpu::Context& context, const render::DeviceSceneOptions& options = {}) const {
    return render::DeviceScene(context, scene::Scene(scene), environment, options);
  }

  render::Renderer renderer(render::DeviceScene& device, const program::Program& program,
                            const render::RenderSettings& settings, const render::Defines& extra = {}) const {
    CheckedProgram checked = compileAndCheck(program, compiler, render::renderDefines(device.defines(), {}, extra),
                                             device.facts(), deviceLimits(device.context().info()));
    return render::Renderer(device, std::move(checked.runnable), compiler, nullptr, settings);
  }
};

// Seconds of the device for one more sample per pixel.
double sampleSeconds(render::Renderer& renderer) {
  const double before = renderer.statistics().deviceSeconds;
  renderer.renderBatch(1);
  renderer.finish();
  return renderer.statistics().deviceSeconds - before;
}

double medianSampleSeconds(render::Renderer& renderer, int repeat) {
  sampleSeconds(renderer);  // the driver compiles during the first launch
  std::vector<double> seconds;
  for (int i = 0; i < repeat; ++i) seconds.push_back(sampleSeconds(renderer));
  return median(seconds);
}

Json rayKind(std::uint32_t rays, std::uint32_t hits) {
  return {{"rays", rays}, {"hits", hits}, {"misses", rays - hits}};
}

// Why minimal shaders cannot trace the rays of a program in this scene; empty if they can.
std::string whyNotComparable(const program::SceneFacts& facts) {
  const auto has = [&](auto member) { return std::ranges::any_of(facts.geometries, member); };
  std::string part;
  if (has(&program::GeometryFacts::procedural))
    part = "procedural geometry";
  else if (!std::ranges::all_of(facts.geometries, &program::GeometryFacts::opaque))
    part = "materials with alpha or thin walls";
  if (part.empty()) return {};
  return "the comparison with minimal shaders works for opaque triangles only, and the scene has " + part;
}

// The program's rate against that of its own rays. Batches differ in their samples; the recorded one is the first, and the
// program is timed with the same sample: each measurement is the first batch of a fresh renderer.
Json rateRatio(const Setup& setup, render::DeviceScene& scene) {
  constexpr std::uint32_t kCapacity = 32;  // recorded rays per pixel
  gpu::Context& context = scene.context();
  if (const std::string reason = whyNotComparable(scene.facts()); !reason.empty())
    throw UsageError(fmt::format("{}: {}", setup.request.scene.string(), reason), Remedy::measureLaunches);
  const program::Program program = program::loadProgram(setup.request.program);
  const program::Program replay = program::loadProgram("replay");
  gpu::BufferOptions recordOptions;
  recordOptions.size =
      sizeof(shared::RayKinds) + VkDeviceSize{setup.size.x} * setup.size.y * kCapacity * sizeof(shared::RayRecord);
  recordOptions.name = "ray records";
  const gpu::Buffer records(context, recordOptions);
  context.submitAndWait([&](gpu::Commands& commands) { commands.fill(records, 0); });

  render::RenderSettings recording = setup.settings(program, setup.size);
  recording.rayRecords = &records;
  recording.rayRecordCapacity = kCapacity;
  render::Renderer recorder = setup.renderer(scene, program, recording, {{"QUINTET_RECORD_RAYS", "1"}});
  recorder.renderBatch(1);
  const std::uint64_t rays = recorder.rays().rays;
  const shared::RayKinds kinds = records.downloadAs<shared::RayKinds>(1)[0];
  if (kinds.camera == 0)
    throw UsageError(
        fmt::format("the program '{}' traces no rays with traceClosest and traceVisible; use 'quintet bench PROGRAM "
                    "SCENE' to measure its launches",
                    setup.request.program));

  render::Renderer tracer = setup.renderer(scene, program, setup.settings(program, setup.size));
  render::RenderSettings replaying = setup.settings(replay, setup.size);
  replaying.rayRecords = &records;
  replaying.rayRecordCapacity = kCapacity;
  render::Renderer replayer = setup.renderer(scene, replay, replaying);

  sampleSeconds(tracer);
  sampleSeconds(replayer);
  const std::uint64_t replayedRays = replayer.rays().rays;
  // In alternation, so that both see the same machine.
  std::vector<double> tracerRates, replayRates;
  for (int i = 0; i < setup.request.repeat; ++i) {
    const std::uint64_t before = tracer.rays().rays;
    const double seconds = sampleSeconds(tracer);
    tracerRates.push_back(static_cast<double>(tracer.rays().rays - before) / seconds);
    replayRates.push_back(static_cast<double>(replayedRays) / sampleSeconds(replayer));
  }
  const double tracerRate = median(tracerRates);
  const double replayRate = median(replayRates);
  return {{"raysPerSample", rays},
          {"rays",
           {{"camera", rayKind(kinds.camera, kinds.cameraHits)},
            {"continuation", rayKind(kinds.continuation, kinds.continuationHits)},
            {"shadow", rayKind(kinds.shadow, kinds.shadowHits)}}},
          {"replayedRays", replayedRays},
          {"pathTracerMraysPerSecond", tracerRate * 1e-6},
          {"minimalMraysPerSecond", replayRate * 1e-6},
          {"ratio", tracerRate / replayRate},
          {"compileSeconds", tracer.statistics().compileSeconds},
          {"pipelineSeconds", tracer.statistics().pipelineSeconds},
          {"firstLaunchSeconds", tracer.statistics().firstLaunchSeconds}};
}

// What the driver reports about the pipeline.
Json pipelineFacts(const rt::Pipeline& pipeline) {
  Json executables = Json::object();
  for (const rt::PipelineExecutable& e : rt::pipelineStatistics(pipeline)) {
    Json object = {{"subgroupSize", e.subgroupSize}};
    for (const auto& [name, value] : e.statistics) object[name] = value;
    std::string key = e.name;
    for (int i = 2; executables.contains(key); ++i) key = fmt::format("{} {}", e.name, i);
    executables[key] = std::move(object);
  }
  Json stack = Json::object();
  for (const auto& [name, bytes] : rt::groupStackSizes(pipeline)) stack[name] = bytes;
  return {{"executables", executables.empty() ? Json("not reported by the driver") : std::move(executables)},
          {"stackBytes", std::move(stack)}};
}

// Bytes that travel with a ray, by payload type: the largest of all stages.
Json payloadFacts(const program::CompiledProgram& compiled) {
  std::map<std::string, std::uint64_t> bytes;
  for (const program::PayloadSize& payload : program::payloadSizes(compiled))
    bytes[payload.type] = std::max(bytes[payload.type], payload.bytes);
  return bytes;
}

Json launchFacts(std::span<const render::LaunchTiming> launches, std::uint32_t width) {
  std::vector<double> invocations, seconds, idle;
  for (const render::LaunchTiming& launch : launches) {
    invocations.push_back(static_cast<double>(launch.rows) * width);
    seconds.push_back(launch.traceSeconds);
    idle.push_back(launch.idleSeconds);
  }
  return {{"count", launches.size()},
          {"medianInvocations", median(invocations)},
          {"medianSamplesPerPixel", launches[launches.size() / 2].samples},
          {"medianSeconds", median(seconds)},
          {"largestSeconds", *std::ranges::max_element(seconds)},
          {"medianIdleSeconds", median(idle)}};
}

// Where the time of a render goes: passes, launches, samples per second, pipeline.
Json profile(const Setup& setup, render::DeviceScene& scene) {
  const program::Program program = program::loadProgram(setup.request.program);
  render::RenderSettings settings = setup.settings(program, setup.size);
  settings.launchSeconds = render::RenderSettings().launchSeconds;
  settings.profile = true;
  render::Renderer renderer = setup.renderer(scene, program, settings);
  renderer.renderBatch();  // the driver compiles, and the launches find their size
  renderer.finish();
  const std::size_t warm = renderer.launches().size();
  const std::uint64_t raysBefore = renderer.rays().rays;
  const double wallBefore = renderer.statistics().renderSeconds;
  for (int i = 0; i < setup.request.repeat; ++i) renderer.renderBatch();
  renderer.finish();
  const double samples =
      static_cast<double>(setup.size.x) * setup.size.y * render::kBatchSamples * setup.request.repeat;
  const double wall = renderer.statistics().renderSeconds - wallBefore;
  const std::span<const render::LaunchTiming> launches = std::span(renderer.launches()).subspan(warm);
  double begin = 0, trace = 0, end = 0, idle = 0;
  for (const render::LaunchTiming& l : launches) begin += l.beginSeconds, trace += l.traceSeconds, end += l.endSeconds;
  for (const render::LaunchTiming& l : launches.subspan(1)) idle += l.idleSeconds;
  const double busy = begin + trace + end;

  Stopwatch watch;
  const io::Image image = renderer.image();
  const double download = watch.lap();
  render::toDisplay(image, render::ToneMap::aces, 0.0f, true);
  const double toneMap = watch.lap();

  Json pipeline = pipelineFacts(renderer.linked().pipeline());
  pipeline["payloadBytes"] = payloadFacts(program::compile(program, setup.compiler, scene.defines()));
  const render::DeviceSceneStatistics& s = scene.statistics();
  return {{"samplesPerBatch", render::kBatchSamples},
          {"batches", setup.request.repeat},
          {"passes",
           {{"uploadSeconds", s.uploadSeconds},
            {"orderSeconds", s.build.orderSeconds},
            {"bottomLevelBuildSeconds", s.build.buildSeconds},
            {"topLevelBuildSeconds", s.topLevelSeconds},
            {"beginBatchSeconds", begin},
            {"traceSeconds", trace},
            {"filmAddSeconds", end},
            {"downloadSeconds", download},
            {"toneMapSeconds", toneMap}}},
          {"deviceBusySeconds", busy},
          {"deviceIdleSeconds", idle},
          {"wallSeconds", wall},
          {"busyShare", busy / wall},
          {"samplesPerSecond", samples / wall},
          {"MraysPerSecond", static_cast<double>(renderer.rays().rays - raysBefore) / trace * 1e-6},
          {"launches", launchFacts(launches, setup.size.x)},
          {"pipeline", std::move(pipeline)}};
}

// Mrays/s of one ambient occlusion sample (a primary and a secondary ray per pixel) in this scene.
double occlusionRate(const Setup& setup, gpu::Context& context, const scene::Scene& scene, bool keepInputOrder,
                     uvec2 pixels) {
  render::DeviceSceneOptions options;
  options.keepInputOrder = keepInputOrder;
  render::DeviceScene device(context, scene::Scene(scene), setup.environment, options);
  const program::Program program = program::loadProgram("ao");
  render::Renderer renderer = setup.renderer(device, program, setup.settings(program, pixels));
  const double seconds = medianSampleSeconds(renderer, keepInputOrder ? 1 : setup.request.repeat);
  const std::uint64_t rays = renderer.rays().rays / std::max<std::uint64_t>(1, renderer.statistics().samples);
  return static_cast<double>(rays) / seconds * 1e-6;
}

// Triangles and instances in random order, as a careless exporter might write them.
scene::Scene shuffled(scene::Scene scene) {
  std::mt19937 random(1);
  for (scene::Mesh& mesh : scene.meshes)
    for (scene::Geometry& geometry : mesh.geometries)
      std::shuffle(geometry.triangles.begin(), geometry.triangles.end(), random);
  std::shuffle(scene.instances.begin(), scene.instances.end(), random);
  return scene;
}

Json orderGain(const Setup& setup, gpu::Context& context) {
  const scene::Scene random = shuffled(setup.scene);
  // Few pixels: where the driver keeps the order, random order is slower by a factor of hundreds.
  const uvec2 pixels = context.info().quirks.keepsPrimitiveOrder ? uvec2(96, 96) : setup.size;
  const double fileOrder = occlusionRate(setup, context, setup.scene, true, pixels);
  const double randomOrder = occlusionRate(setup, context, random, true, pixels);
  const double spatialOrder = occlusionRate(setup, context, random, false, pixels);
  return {{"pixels", {pixels.x, pixels.y}},
          {"fileOrderMraysPerSecond", fileOrder},
          {"randomOrderMraysPerSecond", randomOrder},
          {"spatialOrderMraysPerSecond", spatialOrder},
          {"gainOverRandom", spatialOrder / randomOrder},
          {"gainOverFile", spatialOrder / fileOrder}};
}

// lavapipe gives each thread one contiguous part of a launch. gpu::prepareDriverEnvironment asks for more threads than
// cores, so that parts of uneven cost even out. Measures the gain over one thread per core with interleaved rows.
Json balanceGain(const Setup& setup, gpu::Context& context) {
  const double balanced = occlusionRate(setup, context, setup.scene, false, setup.size);
  const char* preset = std::getenv("LP_NUM_THREADS");
  const std::string threads = preset ? preset : "";
  setenv("LP_NUM_THREADS", std::to_string(hardwareThreads()).c_str(), 1);
  double interleaved = 0;
  {
    gpu::ContextOptions options;
    options.device = setup.request.device;
    gpu::Context other(options);
    interleaved = occlusionRate(setup, other, setup.scene, false, setup.size);
  }
  setenv("LP_NUM_THREADS", threads.c_str(), 1);
  return {{"threads", threads},
          {"interleavedMraysPerSecond", interleaved},
          {"balancedMraysPerSecond", balanced},
          {"gain", balanced / interleaved}};
}

// A program with its scene on the device, for runProgramBenchmark.
class ProgramBenchmark {
 public:
  explicit ProgramBenchmark(const ProgramBenchmarkRequest& request)
      : request_(request),
        program_(program::loadProgram(request.program)),
        parameters_(parameterValues(program_, request.render)),
        source_(chooseSceneSource(request.render.scene, program_, request.render.load)),
        context_([&] {
          gpu::ContextOptions options;
          options.device = request.device;
          return options;
        }()),
        compiler_(makeCompiler(cacheFolder())),
        size_(sizeOf(request.render.size, context_.info().software)) {
    scene::Scene scene = loadScene(source_);
    camera_ =
        chooseCamera(scene, request.render.camera, static_cast<float>(size_.x) / static_cast<float>(size_.y)).camera;
    const scene::Environment environment =
        chooseEnvironment(scene, request.render.environment, request.render.load.maxMemory).environment;
    scene_.emplace(context_, std::move(scene), environment);
  }

  Json run() {
    Json result = {{"device", context_.info().name}, {"driver", context_.info().driver},
                   {"program", request_.program},    {"parameters", parameters_.describe()},
                   {"scene", source_.path()},        {"size", {size_.x, size_.y}}};
    render::Renderer renderer = makeRenderer(false);
    const std::vector<double> seconds = measure(renderer);
    const double typical = median(seconds);
    const render::RenderStatistics& statistics = renderer.statistics();
    result["compileSeconds"] = statistics.compileSeconds;
    result["pipelineSeconds"] = statistics.pipelineSeconds;
    result["firstLaunchSeconds"] = statistics.firstLaunchSeconds;
    result["launch"] = {{"count", seconds.size()},
                        {"strips", strips_},
                        {"medianSeconds", typical},
                        {"minSeconds", *std::ranges::min_element(seconds)},
                        {"maxSeconds", *std::ranges::max_element(seconds)}};
    result["samplesPerSecond"] = static_cast<double>(size_.x) * size_.y / typical;
    const shared::Instrument counts = countRays();
    result["rays"] = raysJson(counts);
    result["MraysPerSecond"] = static_cast<double>(counts.traceCount) / typical * 1e-6;
    result["pipeline"] = pipelineFacts(renderer.linked().pipeline());
    result["pipeline"]["payloadBytes"] = payloadFacts(program::compile(program_, compiler_, scene_->defines()));
    return result;
  }

 private:
  render::Renderer makeRenderer(bool instrument) {
    render::RenderSettings settings;
    settings.width = size_.x;
    settings.height = size_.y;
    settings.camera = camera_;
    settings.seed = request_.render.seed;
    settings.parameters = parameters_;
    settings.maxMemory = request_.render.load.maxMemory;
    settings.launchSeconds = 1.0;
    settings.timeoutSeconds = 300;
    settings.profile = !instrument;
    settings.instrument = instrument;
    CheckedProgram checked = compileAndCheck(
        program_, compiler_, render::renderDefines(scene_->defines(), {}), scene_->facts(),
        deviceLimits(context_.info()), instrument ? program::Instrumentation::checks : program::Instrumentation::none);
    return render::Renderer(*scene_, std::move(checked.runnable), compiler_, nullptr, settings);
  }

  // Seconds of the device for the traces of one sample per pixel.
  double traceSeconds(render::Renderer& renderer) {
    const std::size_t before = renderer.launches().size();
    renderer.renderBatch(1);
    renderer.finish();
    const std::span<const render::LaunchTiming> launches = std::span(renderer.launches()).subspan(before);
    strips_ = launches.size();
    double seconds = 0;
    for (const render::LaunchTiming& launch : launches) seconds += launch.traceSeconds;
    return seconds;
  }

  std::vector<double> measure(render::Renderer& renderer) {
    // The driver compiles in the first launch. The second one measures the rate that decides the size of the next ones.
    for (int i = 0; i < 2; ++i) traceSeconds(renderer);
    std::vector<double> seconds;
    for (int i = 0; i < request_.repeat; ++i) seconds.push_back(traceSeconds(renderer));
    return seconds;
  }

  // Counted by the runtime checks, which are slow, in the first sample.
  shared::Instrument countRays() {
    render::Renderer renderer = makeRenderer(true);
    renderer.renderBatch(1);
    return renderer.instrumentCounts();
  }

  Json raysJson(const shared::Instrument& counts) const {
    Json types = Json::object();
    for (std::size_t i = 0; i < program_.rays.size(); ++i) types[program_.rays[i].name] = counts.rays[i];
    return {{"total", counts.traceCount},
            {"perPixel", static_cast<double>(counts.traceCount) / (static_cast<double>(size_.x) * size_.y)},
            {"byType", std::move(types)},
            {"deepestTrace", counts.deepest},
            {"anyHitCalls", counts.anyHitCount}};
  }

  const ProgramBenchmarkRequest& request_;
  const program::Program program_;
  const program::ParameterValues parameters_;
  const SceneSource source_;
  gpu::Context context_;
  const shader::Compiler compiler_;
  const uvec2 size_;
  scene::Camera camera_;
  std::optional<render::DeviceScene> scene_;
  std::size_t strips_ = 0;  // launches of the latest sample
};

}  // namespace

Json runProgramBenchmark(const ProgramBenchmarkRequest& request) { return ProgramBenchmark(request).run(); }

Json runBenchmark(const BenchmarkRequest& request) {
  gpu::ContextOptions contextOptions;
  contextOptions.device = request.device;
  gpu::Context context(contextOptions);
  Stopwatch watch;
  const Setup setup(request, context.info().software);
  const double loadSeconds = watch.lap();
  const scene::TriangleCount triangles = scene::countTriangles(setup.scene);

  Json result = {{"device", context.info().name},   {"driver", context.info().driver},
                 {"scene", request.scene.string()}, {"size", {setup.size.x, setup.size.y}},
                 {"triangles", triangles.stored},   {"instancedTriangles", triangles.instanced},
                 {"loadSeconds", loadSeconds}};
  {
    const program::Program program = program::loadProgram(request.program);
    render::DeviceScene scene = setup.onDevice(context, {.singleAnyHit = program::requiredSingleAnyHit(program)});
    const std::string reason = request.profile ? whyNotComparable(scene.facts()) : "";
    result["pathTracer"] = reason.empty() ? rateRatio(setup, scene) : Json{{"notCompared", reason}};
    if (request.profile) result["profile"] = profile(setup, scene);
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
  if (request.profile) return result;
  watch.lap();
  {
    const program::Program program = program::loadProgram(request.program);
    render::DeviceScene scene = setup.onDevice(context, {.singleAnyHit = program::requiredSingleAnyHit(program)});
    render::Renderer renderer = setup.renderer(scene, program, setup.settings(program, setup.size));
    renderer.renderBatch(1);
    renderer.finish();
  }
  result["warmFirstSampleSeconds"] = watch.lap();
  result["primitiveOrder"] = orderGain(setup, context);
  if (context.info().software && context.info().quirks.launchParts == 0)
    result["launchBalance"] = balanceGain(setup, context);
  return result;
}

}  // namespace quintet::job
