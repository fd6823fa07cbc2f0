#include "render/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>

#include "gpu/timer.h"
#include "io/codec.h"
#include "program/check.h"
#include "render/camera.h"
#include "render/instrument.h"
#include "render/parameter_textures.h"
#include "render/tone_map.h"

namespace quintet::render {
namespace {

using Clock = std::chrono::steady_clock;
using Record = std::function<void(gpu::Commands&)>;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Region checkedRegion(const RenderSettings& settings) {
  if (settings.width == 0 || settings.height == 0 || settings.width > io::kMaxImageSide ||
      settings.height > io::kMaxImageSide)
    throw UsageError(fmt::format("image size {}x{}: each side must be 1 to {} pixels", settings.width, settings.height,
                                 io::kMaxImageSide));
  const Region& r = settings.region;
  if (r.width == 0 && r.height == 0) return {0, 0, settings.width, settings.height};
  if (r.width == 0 || r.height == 0 || r.x >= settings.width || r.y >= settings.height ||
      r.width > settings.width - r.x || r.height > settings.height - r.y)
    throw UsageError(fmt::format("region {},{},{},{} is not inside the image of {}x{}", r.x, r.y, r.width, r.height,
                                 settings.width, settings.height));
  return r;
}

std::string firstError(const std::vector<shader::Diagnostic>& diagnostics) {
  for (const shader::Diagnostic& d : diagnostics)
    if (d.severity == shader::Severity::error) return d.format();
  return "the program does not compile";
}

Defines definesFor(const RenderSettings& settings, const Defines& sceneDefines) {
  Defines defines = settings.defines;
  defines.insert(defines.end(), sceneDefines.begin(), sceneDefines.end());
  for (const std::string& output : settings.outputs) defines.emplace_back("QUINTET_OUTPUT_" + output, "1");
  return defines;
}

// At most as many launches as there are timers.
constexpr std::uint32_t kMostInFlight = 2;

// A launch that the device has not been seen to end.
struct InFlight {
  std::uint64_t value = 0;  // of the timeline
  Clock::time_point start;  // of its recording
  gpu::Timer* timer = nullptr;
  std::uint32_t rows = 0;
  std::uint32_t samples = 0;
  double pixelSamples = 0;
};

}  // namespace

CompiledShaders compileShaders(const program::Program& program, const shader::Compiler& compiler,
                               const RenderSettings& settings, const Defines& sceneDefines) {
  CompiledShaders shaders{definesFor(settings, sceneDefines), {}};
  shaders.program = program::compile(program, compiler, shaders.defines, settings.instrument);
  return shaders;
}

ProgramError::ProgramError(std::vector<shader::Diagnostic> diagnostics)
    : Error(firstError(diagnostics)), diagnostics_(std::move(diagnostics)) {}

struct Renderer::Impl {
  DeviceScene& scene;
  gpu::Context& context;
  program::Program description;
  RenderSettings settings;
  std::unique_ptr<program::LinkedProgram> linked;
  std::optional<rt::ShaderBindingTable> table;
  std::unique_ptr<Film> film;
  gpu::Buffer frameBuffer;
  gpu::Buffer tileBuffer;  // of the last adaptive batch
  std::optional<ParameterTextures> parameterTextures;
  gpu::Buffer parameterBuffer;
  std::array<gpu::Timer, kMostInFlight> timers{gpu::Timer(context, 4), gpu::Timer(context, 4)};  // in turns
  std::deque<InFlight> inFlight;                                                                 // oldest first
  std::uint64_t launchCount = 0;
  RenderStatistics statistics;
  std::vector<shader::Diagnostic> diagnostics;
  std::vector<std::filesystem::path> files;
  std::vector<Hash> shaderHashes;
  std::optional<InstrumentBuffer> instrument;
  program::CompiledProgram instrumented;  // file names of stages, for notes
  std::vector<LaunchTiming> launches;
  double lastStamp = 0;              // of the device, when the launch before ended
  double pixelSamplesPerSecond = 0;  // measured; 0: unknown yet
  std::uint64_t nextBatch = 0;

  Impl(DeviceScene& deviceScene, const program::Program& program, const shader::Compiler& compiler,
       const gpu::PipelineCache* cache, const RenderSettings& renderSettings)
      : scene(deviceScene), context(deviceScene.context()), description(program), settings(renderSettings) {
    const Region region = checkedRegion(settings);
    if (settings.timeoutSeconds <= 0) settings.timeoutSeconds = context.info().quirks.software ? 600 : 60;
    if (settings.launchesInFlight == 0) settings.launchesInFlight = context.info().quirks.software ? 1 : kMostInFlight;
    settings.launchesInFlight = accumulates() ? 1 : std::min(settings.launchesInFlight, kMostInFlight);
    link(compiler, cache);
    film = std::make_unique<Film>(context, scene.set(), compiler, region, program, settings.outputs);

    shared::Frame frame = scene.frameTemplate();
    frame.camera = makeCamera(settings.camera, settings.width, settings.height);
    frame.width = settings.width;
    frame.height = settings.height;
    frame.seed = settings.seed;
    frame.plannedSamples = settings.plannedSamples;
    frame.frameCount = settings.frameCount;
    frame.flags = settings.transparent ? shared::kFrameTransparent : 0;
    frame.rayRecords = settings.rayRecords ? settings.rayRecords->address() : 0;
    frame.rayRecordCapacity = settings.rayRecords ? settings.rayRecordCapacity : 0;
    film->describe(frame);
    if (settings.instrument) {
      instrument.emplace(context, std::uint64_t{region.width} * region.height, linked->recursionDepth(),
                         program::missShaders(description).size());
      frame.instrument = instrument->address();
    }
    frameBuffer = gpu::makeBuffer(context, std::as_bytes(std::span(&frame, 1)), 0, "frame");
    if (settings.parameters.parameters().empty())
      settings.parameters = program::ParameterValues(description.parameters);
    for (const program::ImageValue& image : settings.parameters.images())
      if (!image.file.empty() && !image.ofProgram) files.emplace_back(image.file);
    parameterTextures.emplace(context, scene.parameterSlots(), description, settings.parameters);
    parameterBuffer = gpu::makeBuffer(context, settings.parameters.pack(parameterTextures->indices()), 0, "parameters");
  }

  void link(const shader::Compiler& compiler, const gpu::PipelineCache* cache) {
    const bool ready = settings.compiled && !settings.instrument &&
                       settings.compiled->defines == definesFor(settings, scene.defines());
    const CompiledShaders shaders =
        ready ? *settings.compiled : compileShaders(description, compiler, settings, scene.defines());
    settings.compiled = nullptr;
    const program::CompiledProgram& compiled = shaders.program;
    if (!compiled.ok) throw ProgramError(compiled.diagnostics);
    const program::CheckResult checked =
        program::check(description, compiled, &scene.facts(), program::deviceLimits(context.info()), true);
    if (!checked.ok()) throw ProgramError(checked.diagnostics);
    diagnostics = checked.diagnostics;
    files = compiled.files;
    shaderHashes = compiled.fileHashes;
    scene.prepareFor(static_cast<std::uint32_t>(description.rays.size()), description.keepsInstanceOrder,
                     description.anyHitForAll);
    linked = std::make_unique<program::LinkedProgram>(context, scene.set(), description, compiled,
                                                      checked.recursionDepth, cache, settings.profile);
    table.emplace(linked->makeTable(scene.facts().geometries));
    statistics.compileSeconds = compiled.seconds;
    if (settings.instrument) instrumented = compiled;
    statistics.pipelineSeconds = linked->pipelineSeconds();
  }

  // Rows of the next launch, so that `samples` samples of each pixel take about launchSeconds. What is
  // chosen changes nothing in the image.
  std::uint32_t launchRows(double width, std::uint32_t rowsLeft, std::uint32_t samples) const {
    const auto limit = static_cast<double>(context.info().limits.maxLaunchInvocations);
    double rows = pixelSamplesPerSecond > 0 ? settings.launchSeconds * pixelSamplesPerSecond / (width * samples)
                                            : 16384.0 / width;
    rows = std::clamp(rows, 1.0, std::max(1.0, limit / width));
    return std::min(rowsLeft, static_cast<std::uint32_t>(rows));
  }

  // What a launch covers: rows of the region, or tiles, one a row.
  struct Target {
    std::uint32_t width = 0;   // invocations in a row
    std::uint32_t height = 0;  // rows
    uvec2 offset{0};           // of row 0
    shared::Address tiles = 0;
  };

  Target wholeRegion() const {
    const Region& region = film->region();
    return {region.width, region.height, {region.x, region.y}, 0};
  }

  // Launches a strip with `count` samples from `first` on. Waits for the oldest launch if there are too many.
  void launch(const Target& target, std::uint32_t row, std::uint32_t rows, std::uint32_t first, std::uint32_t count,
              const Record& before, const Record& after) {
    while (inFlight.size() >= settings.launchesInFlight) finishOldest();
    gpu::Timer& timer = timers[launchCount++ % kMostInFlight];
    const auto start = Clock::now();
    const std::uint64_t value = context.submit([&](gpu::Commands& commands) {
      timer.reset(commands);
      timer.mark(commands, 0);
      if (before) before(commands);
      timer.mark(commands, 1);
      for (std::uint32_t done = 0; done < count;) {
        shared::Launch constants{};
        constants.frame = frameBuffer.address();
        constants.parameters = parameterBuffer.address();
        constants.offset = target.offset + uvec2(0, row);
        constants.firstSample = first + done;
        constants.sampleCount = std::min(count - done, description.samplesPerLaunch);
        constants.tiles = target.tiles;
        if (done > 0) commands.barrier(gpu::Stage::rayTracing, gpu::Stage::rayTracing);
        rt::trace(commands, linked->pipeline(), *table, std::as_bytes(std::span(&constants, 1)), target.width, rows);
        done += constants.sampleCount;
      }
      timer.mark(commands, 2);
      if (after) after(commands);
      timer.mark(commands, 3);
    });
    inFlight.push_back({value, start, &timer, rows, count, static_cast<double>(target.width) * rows * count});
    // The first one tells how fast the others may be; on a CPU it compiles.
    if (settings.launchesInFlight == 1 || statistics.firstLaunchSeconds == 0) finish();
  }

  void finish() {
    while (!inFlight.empty()) finishOldest();
  }

  void finishOldest() {
    const InFlight launch = inFlight.front();
    inFlight.pop_front();
    context.wait(launch.value, settings.timeoutSeconds);
    const double wall = secondsSince(launch.start);
    if (statistics.firstLaunchSeconds == 0) statistics.firstLaunchSeconds = wall;
    const double device = launch.timer->seconds(1, 2);
    if (settings.profile) noteLaunch(launch, wall);
    statistics.deviceSeconds += device;
    const double rate = launch.pixelSamples / std::max(1e-6, device > 0 ? device : wall);
    // Strips differ in cost: follow slowly upwards, at once downwards.
    pixelSamplesPerSecond = pixelSamplesPerSecond > 0 ? std::min(rate, 2.0 * pixelSamplesPerSecond) : 0.25 * rate;
  }

  void noteLaunch(const InFlight& launch, double wall) {
    const gpu::Timer& timer = *launch.timer;
    const double idle = launches.empty() ? 0.0 : std::max(0.0, timer.stamp(0) - lastStamp);
    launches.push_back(
        {launch.rows, launch.samples, timer.seconds(0, 1), timer.seconds(1, 2), timer.seconds(2, 3), idle, wall});
    lastStamp = timer.stamp(3);
  }

  // Between batches: the wait belongs to the rendering.
  void finishAndCount() {
    const auto start = Clock::now();
    finish();
    statistics.renderSeconds += secondsSince(start);
  }

  bool accumulates() const { return description.accumulation == program::Accumulation::program; }

  bool renderFrames(std::uint32_t count, const BatchProgress& progress) {
    bool goOn = true;
    for (std::uint32_t i = 0; i < count && goOn; ++i) {
      const BatchProgress part = [&](double fraction) { return goOn = !progress || progress((i + fraction) / count); };
      if (!renderFrame(static_cast<std::uint32_t>(statistics.samples), part)) return false;
    }
    return goOn;
  }

  bool renderFrame(std::uint32_t index, const BatchProgress& progress) {
    assert(accumulates());
    const auto start = Clock::now();
    const std::uint32_t height = film->region().height;
    for (std::uint32_t row = 0; row < height;) {
      const Target target = wholeRegion();
      const std::uint32_t rows = launchRows(target.width, height - row, 1);
      const Record end = [&](gpu::Commands& commands) { film->endBatch(commands, {index, index + 1}); };
      launch(target, row, rows, index, 1, row == 0 ? begin() : Record(), row + rows == height ? end : Record());
      row += rows;
      if (progress && !progress(static_cast<double>(row) / height) && row < height) return false;
    }
    statistics.batches++;
    statistics.samples++;
    statistics.renderSeconds += secondsSince(start);
    return true;
  }

  io::Image image(std::size_t output) const {
    io::Image result = film->download(output);
    if (description.outputs[output].kind == program::OutputKind::display) decodeDisplay(result, settings.transparent);
    return result;
  }

  bool renderBatch(std::uint32_t sampleCount, const BatchProgress& progress) {
    if (accumulates()) return renderFrames(sampleCount, progress);
    assert(sampleCount >= 1 && sampleCount <= kBatchSamples);
    const SampleRange samples = batchSamples(nextBatch, sampleCount);
    const Record end = [&](gpu::Commands& commands) { film->endBatch(commands, samples); };
    if (!renderSamples(wholeRegion(), samples, end, progress)) return false;
    ++nextBatch;
    return true;
  }

  static SampleRange batchSamples(std::uint64_t batch, std::uint32_t count) {
    const auto first = static_cast<std::uint32_t>(batch * kBatchSamples);
    return {first, first + count};
  }

  Record begin() {
    return [this](gpu::Commands& commands) { film->beginBatch(commands); };
  }

  // A batch in strips.
  bool renderSamples(const Target& target, SampleRange samples, const Record& end, const BatchProgress& progress) {
    const auto start = Clock::now();
    const std::uint32_t count = samples.end - samples.begin;
    for (std::uint32_t row = 0; row < target.height;) {
      // Where even one row is too long, its samples are launched one by one: same sums, same order.
      const std::uint32_t rows = launchRows(target.width, target.height - row, count);
      const double predicted = static_cast<double>(rows) * target.width * count;
      // So it is as long as the rate is not known: a shader that is slow, or never ends, is found out soon.
      const bool whole = predicted <= 2.0 * settings.launchSeconds * pixelSamplesPerSecond;
      const std::uint32_t step = whole ? count : 1;
      for (std::uint32_t s = 0; s < count; s += step) {
        const bool first = row == 0 && s == 0, last = row + rows == target.height && s + step >= count;
        launch(target, row, rows, samples.begin + s, std::min(step, count - s), first ? begin() : Record(),
               last ? end : Record());
      }
      row += rows;
      if (progress && !progress(static_cast<double>(row) / target.height) && row < target.height) return false;
    }
    statistics.batches++;
    statistics.samples = film->counts().samples();
    statistics.renderSeconds += secondsSince(start);
    return true;
  }

  bool renderCells(const std::vector<std::uint32_t>& limits, const BatchProgress& progress) {
    assert(description.adaptive && limits.size() == 2 * std::size_t{tileCount(film->region())});
    std::vector<std::uint32_t> counts = film->counts().cellBatches;
    if (counts.empty()) counts.assign(limits.size(), static_cast<std::uint32_t>(film->counts().batches()));
    std::uint32_t batch = std::numeric_limits<std::uint32_t>::max();
    for (std::size_t c = 0; c < limits.size(); ++c)
      if (counts[c] < limits[c]) batch = std::min(batch, counts[c]);
    std::vector<shared::FilmTile> tiles;
    const std::uint32_t columns = tileColumns(film->region().width);
    for (std::uint32_t t = 0; t < limits.size() / 2; ++t) {
      shared::FilmTile tile{t % columns * shared::kTileSize, t / columns * shared::kTileSize, {}};
      for (std::uint32_t c = 0; c < 2; ++c) {
        tile.drawn[c] = counts[2 * t + c] == batch && batch < limits[2 * t + c] ? 1 : 0;
        counts[2 * t + c] += tile.drawn[c];
      }
      if (tile.drawn[0] + tile.drawn[1] > 0) tiles.push_back(tile);
    }
    assert(!tiles.empty());
    // Written in place: no wait for a copy, so that the launches before this batch may still be under way.
    tileBuffer = gpu::Buffer(
        context, {.size = std::span(tiles).size_bytes(), .memory = gpu::Memory::upload, .name = "film tiles"});
    std::memcpy(tileBuffer.mapped(), tiles.data(), std::span(tiles).size_bytes());
    const Target target{
        shared::kTileSize * shared::kTileSize, static_cast<std::uint32_t>(tiles.size()), {0, 0}, tileBuffer.address()};
    const SampleRange samples = batchSamples(batch, kBatchSamples);
    const Record end = [&](gpu::Commands& commands) { film->endAdaptiveBatch(commands, samples, counts); };
    return renderSamples(target, samples, end, progress);
  }

  std::vector<shader::Diagnostic> notes() const {
    if (!instrument) return {};
    std::vector<shader::Diagnostic> result =
        instrumentDiagnostics(instrument->download(), description, instrumented, scene.facts());
    addBadOutputs(result);
    return result;
  }

  // Q002: values of the film, and samples that the program itself has left out.
  void addBadOutputs(std::vector<shader::Diagnostic>& result) const {
    const std::string file = description.path(sourceFile(description, description.rayGeneration));
    for (std::size_t output = 0; output < description.outputs.size(); ++output) {
      if (!film->stores(output) || description.outputs[output].pixel == program::OutputPixel::coverage) continue;
      const io::Image image = film->download(output);
      const std::span<const float> values = image.samples<float>();
      const auto bad = std::ranges::find_if_not(values, [](float v) { return std::isfinite(v); });
      if (bad == values.end()) continue;
      const auto count = std::ranges::count_if(values, [](float v) { return !std::isfinite(v); });
      const auto pixel = static_cast<std::uint64_t>(bad - values.begin()) / 4;
      result.push_back(
          {shader::Severity::error, file, 0, 0, "Q002",
           fmt::format("output '{}' is {} at pixel {}, {}; {} values are not finite", description.outputs[output].name,
                       *bad, film->region().x + pixel % image.width, film->region().y + pixel / image.width, count)});
    }
    if (const std::uint64_t dropped = film->countRays().droppedSamples; dropped > 0)
      result.push_back({shader::Severity::error, file, 0, 0, "Q002",
                        fmt::format("{} samples were not finite; the program left them out", dropped)});
  }
};

Renderer::Renderer(DeviceScene& scene, const program::Program& program, const shader::Compiler& compiler,
                   const gpu::PipelineCache* cache, const RenderSettings& settings)
    : impl_(std::make_unique<Impl>(scene, program, compiler, cache, settings)) {}
Renderer::~Renderer() = default;

bool Renderer::renderBatch(std::uint32_t sampleCount, const BatchProgress& progress) {
  return impl_->renderBatch(sampleCount, progress);
}
void Renderer::finish() { impl_->finishAndCount(); }
void Renderer::restart() {
  impl_->finish();
  impl_->film->clear();
  impl_->statistics.samples = 0;
  impl_->statistics.batches = 0;
  impl_->nextBatch = 0;
}
bool Renderer::renderCells(const std::vector<std::uint32_t>& limits, const BatchProgress& progress) {
  return impl_->renderCells(limits, progress);
}
void Renderer::startAt(std::uint64_t batch) { impl_->nextBatch = batch; }
// What reads from the device waits for the launches first, with the limit on their time: a launch that hangs is told.
FilmState Renderer::saveFilm() const {
  impl_->finishAndCount();
  return impl_->film->save();
}
void Renderer::restoreFilm(const FilmState& state) {
  impl_->film->restore(state);
  impl_->statistics.samples = state.counts.samples();
  impl_->statistics.batches = state.counts.batches();
  impl_->nextBatch =
      state.counts.ranges.empty() ? 0 : (state.counts.ranges.back().end + kBatchSamples - 1) / kBatchSamples;
}

const Film& Renderer::film() const { return *impl_->film; }
bool Renderer::renderFrame(std::uint32_t index, const BatchProgress& progress) {
  return impl_->renderFrame(index, progress);
}
io::Image Renderer::image(std::size_t output) const {
  impl_->finishAndCount();
  return impl_->image(output);
}
RayCount Renderer::rays() const {
  impl_->finishAndCount();
  return impl_->film->countRays();
}
const RenderStatistics& Renderer::statistics() const { return impl_->statistics; }
const std::vector<LaunchTiming>& Renderer::launches() const { return impl_->launches; }
const program::LinkedProgram& Renderer::linked() const { return *impl_->linked; }
const std::vector<shader::Diagnostic>& Renderer::diagnostics() const { return impl_->diagnostics; }
const std::vector<std::filesystem::path>& Renderer::files() const { return impl_->files; }
const std::vector<Hash>& Renderer::shaderHashes() const { return impl_->shaderHashes; }
std::vector<shader::Diagnostic> Renderer::notes() const {
  impl_->finishAndCount();
  return impl_->notes();
}
const program::Program& Renderer::program() const { return impl_->description; }

}  // namespace quintet::render
