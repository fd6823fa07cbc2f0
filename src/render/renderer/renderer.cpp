// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/renderer.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "base/stopwatch.h"
#include "quintet/shared/heat.h"
#include "render/film/adaptive_plan.h"
#include "render/renderer/shader_log.h"
#include "render/scene/camera.h"
#include "render/tone_map/tone_map.h"

namespace quintet::render {
namespace {

gpu::Buffer makeHeatBuffer(gpu::Context& context, const Region& film) {
  return {context, {.size = std::uint64_t{film.width} * film.height * sizeof(shared::HeatPixel), .name = "heat maps"}};
}

}  // namespace

Renderer::Renderer(DeviceScene& scene, program::RunnableProgram program, const shader::Compiler& compiler,
                   const gpu::PipelineCache* cache, const RenderSettings& settings)
    : scene_(scene),
      context_(scene.context()),
      runnable_(std::move(program)),
      settings_(decideSettings(settings, runnable_.description, context_.info().software)),
      linked_(context_, scene.set(), runnable_.description, runnable_.compiled, runnable_.recursionDepth, cache,
              settings_.profile),
      table_(linked_.makeTable(scene.facts().geometries)),
      film_(context_, scene.set(), compiler, settings_.region, runnable_.description, settings_.outputs),
      parameterTextures_(context_, scene.parameterSlots(), runnable_.description, settings_.parameters,
                         settings_.maxMemory),
      queue_(context_, settings_, statistics_) {
  statistics_.compileSeconds = runnable_.compiled.seconds;
  statistics_.pipelineSeconds = linked_.pipelineSeconds();
  const program::Program& description = runnable_.description;
  scene.prepareFor(static_cast<std::uint32_t>(description.rays.size()), description.keepsInstanceOrder,
                   description.anyHitForAll, description.mergesInstances && !settings_.instrument);
  if (storesMotion()) scene.keepPreviousPositions();
  if (settings_.instrument)
    instrument_.emplace(context_, std::uint64_t{settings_.region.width} * settings_.region.height,
                        linked_.recursionDepth(), description, scene.facts());
  if (runnable_.countsRecursion) recursion_.emplace(context_, settings_.region);
  if (runnable_.countsHeat) heat_ = makeHeatBuffer(context_, settings_.region);
  uploadFrame();
  parameterBuffer_ =
      gpu::makeBuffer(context_, settings_.parameters.pack(parameterTextures_.indices()), 0, "parameters");
}

void Renderer::uploadFrame() { uploadFrame(settings_.camera, Stored::all); }

void Renderer::uploadFrame(const scene::Camera& camera, Stored stored) {
  shownRevision_ = scene_.revision();
  const Media media = scene_.mediaAt(vec3(camera.worldFromCamera[3]));
  shared::Frame frame = scene_.frameTemplate();
  frame.camera = frame.previousCamera = makeCamera(camera, settings_.width, settings_.height);
  if (settings_.cameraAt && storesMotion())
    frame.previousCamera = makeCamera(settings_.cameraAt(scene_.previousFrame()), settings_.width, settings_.height);
  frame.width = settings_.width;
  frame.height = settings_.height;
  frame.seed = settings_.seed;
  frame.plannedSamples = settings_.plannedSamples;
  frame.frameCount = settings_.frameCount;
  frame.flags = settings_.transparent ? shared::kFrameTransparent : 0;
  frame.rayRecords = settings_.rayRecords ? settings_.rayRecords->address() : 0;
  frame.rayRecordCapacity = settings_.rayRecords ? settings_.rayRecordCapacity : 0;
  frame.log = settings_.log ? settings_.log->address() : 0;
  frame.heat = heat_ ? heat_.address() : 0;
  if (instrument_) frame.instrument = instrument_->address();
  if (recursion_) frame.instrument = recursion_->address();
  frame.cameraMedia = {media[0], media[1], media[2], media[3]};
  film_.describe(frame);
  if (stored != Stored::all) {
    for (std::size_t i = 0; i < program().outputs.size(); ++i)
      if ((program().outputs[i].pixel == program::OutputPixel::center) != (stored == Stored::centers))
        frame.outputs[i] = 0;
  }
  if (stored == Stored::centers) frame.statistics = frame.log = 0;
  frameBuffer_ = gpu::makeBuffer(context_, std::as_bytes(std::span(&frame, 1)), 0, "frame");
}

void Renderer::showTime(double frame, Stored stored) {
  queue_.finish();
  scene_.setFrame(frame, stored == Stored::samples ? Previous::skip : Previous::update);
  uploadFrame(settings_.cameraAt ? settings_.cameraAt(frame) : settings_.camera, stored);
}

void Renderer::showSample(std::uint32_t index, Stored stored) {
  if (settings_.shutter) showTime(sampleTime(*settings_.shutter, index, settings_.seed), stored);
}

bool Renderer::storesCenters() const {
  for (std::size_t i = 0; i < program().outputs.size(); ++i)
    if (program().outputs[i].pixel == program::OutputPixel::center && film_.stores(i)) return true;
  return false;
}

bool Renderer::storesMotion() const {
  for (std::size_t i = 0; i < program().outputs.size(); ++i)
    if (program().outputs[i].name == kMotionOutput && film_.stores(i)) return true;
  return false;
}

double Renderer::filmPixels() const { return static_cast<double>(film_.region().width) * film_.region().height; }

Renderer::Target Renderer::wholeRegion(std::uint32_t firstSample) {
  const Region& region = film_.region();
  return {region.width,
          region.height,
          {region.x, region.y},
          0,
          {{region.height, firstSample}},
          [this](gpu::Commands& commands) { film_.beginBatch(commands); },
          {}};
}

void Renderer::launch(const Target& target, std::uint32_t row, std::uint32_t rows, SampleRange samples,
                      const Record& before, const Record& after) {
  if (scene_.revision() != shownRevision_) {
    queue_.finish();
    uploadFrame();
  }
  const std::uint32_t count = samples.end - samples.begin;
  const std::uint32_t perLaunch = settings_.log || runnable_.countsHeat ? 1 : program().samplesPerLaunch;
  const Record trace = [&](gpu::Commands& commands) {
    for (std::uint32_t done = 0; done < count;) {
      shared::Launch constants{};
      constants.frameAddress = frameBuffer_.address();
      constants.parameterAddress = parameterBuffer_.address();
      constants.sampleCount = std::min(count - done, perLaunch);
      constants.tiles = target.tiles;
      if (done > 0) commands.barrier(gpu::Stage::rayTracing, gpu::Stage::rayTracing);
      // There is no barrier between batches, so that they run at the same time.
      std::uint32_t begin = row;
      for (const Target::Batch& batch : target.batches) {
        const std::uint32_t end = std::min(batch.endRow, row + rows);
        if (end <= begin) continue;
        constants.offset = target.offset + uvec2(0, begin);
        constants.firstSample = batch.firstSample + samples.begin + done;
        rt::trace(commands, linked_.pipeline(), table_, std::as_bytes(std::span(&constants, 1)), target.width,
                  end - begin);
        begin = end;
      }
      done += constants.sampleCount;
    }
  };
  if (context_.info().software && !std::exchange(compiled_, true))
    queue_.compile([&](gpu::Commands& commands) { rt::traceNothing(commands, linked_.pipeline(), table_); });
  queue_.submit({rows, count, static_cast<double>(target.width) * rows * count, before, trace, after});
}

bool Renderer::renderBatch(std::uint32_t sampleCount, const BatchProgress& progress) {
  if (accumulates()) return renderFrames(sampleCount, progress);
  assert(sampleCount >= 1 && sampleCount <= kBatchSamples);
  const auto first = static_cast<std::uint32_t>(nextBatch_ * kBatchSamples);
  Target target = wholeRegion(first);
  target.end = [&](gpu::Commands& commands) { film_.endBatch(commands, {first, first + sampleCount}); };
  if (!renderSamples(target, sampleCount, progress)) return false;
  ++nextBatch_;
  return true;
}

bool Renderer::renderFrames(std::uint32_t count, const BatchProgress& progress) {
  bool proceed = true;
  for (std::uint32_t i = 0; i < count && proceed; ++i) {
    const BatchProgress frameProgress = [&](double fraction) {
      return proceed = !progress || progress((i + fraction) / count);
    };
    if (!renderFrame(static_cast<std::uint32_t>(statistics_.samples), frameProgress)) return false;
  }
  return proceed;
}

bool Renderer::renderFrame(std::uint32_t index, const BatchProgress& progress) {
  assert(accumulates());
  const Stopwatch clock;
  Target target = wholeRegion(index);
  target.end = [&](gpu::Commands& commands) { film_.endBatch(commands, {index, index + 1}); };
  for (std::uint32_t row = 0; row < target.height;) {
    const std::uint32_t rows = queue_.sizes().rows(target.width, row, target.height, 1);
    launch(target, row, rows, {0, 1}, row == 0 ? target.begin : Record(),
           row + rows == target.height ? target.end : Record());
    row += rows;
    if (progress && !progress(static_cast<double>(row) / target.height) && row < target.height) return false;
  }
  queue_.sizes().endPass(static_cast<double>(target.width) * target.height, filmPixels());
  statistics_.batches++;
  statistics_.samples++;
  statistics_.renderSeconds += clock.seconds();
  return true;
}

void Renderer::renderPixel(uvec2 pixel, std::uint32_t index) {
  showSample(index, Stored::all);
  const Target target = wholeRegion(index);
  launch({1, 1, pixel, 0, {{1, index}}, {}, {}}, 0, 1, {0, 1}, target.begin, {});
  finishLaunches();
}

void Renderer::renderSample(std::uint32_t index) {
  assert(!accumulates());
  renderSamples(wholeRegion(index), 1, {});
  finishLaunches();
}

bool Renderer::renderSamples(const Target& target, std::uint32_t count, const BatchProgress& progress) {
  const Stopwatch clock;
  const bool complete = settings_.shutter ? renderTimes(target, count, progress)
                                          : renderStrips(target, {0, count}, target.begin, target.end, progress);
  if (!complete) return false;
  statistics_.batches++;
  statistics_.samples = film_.counts().samples();
  statistics_.renderSeconds += clock.seconds();
  return true;
}

bool Renderer::renderStrips(const Target& target, SampleRange samples, const Record& begin, const Record& end,
                            const BatchProgress& progress) {
  const std::uint32_t count = samples.end - samples.begin;
  for (std::uint32_t row = 0; row < target.height;) {
    const std::uint32_t rows = queue_.sizes().rows(target.width, row, target.height, count);
    // If even one row takes too long, or while the rate is unknown, samples are launched one by one: the sums and their
    // order are the same, and a shader that is slow or never ends is detected soon.
    const double pixels = static_cast<double>(rows) * target.width;
    const bool unknown = queue_.sizes().exploring() && count > 1;
    std::uint32_t step = !unknown && queue_.sizes().isShort(pixels * count) ? count : 1;
    for (std::uint32_t s = 0, next = 0; s < count; s = next) {
      next = s + step;
      const bool first = row == 0 && s == 0, last = row + rows == target.height && s + step >= count;
      const std::uint32_t sample = samples.begin + s;
      launch(target, row, rows, {sample, sample + std::min(step, count - s)}, first ? begin : Record(),
             last ? end : Record());
      if (unknown && s == 0) {  // the other samples, now that one of them was measured
        finishLaunches();
        if (queue_.sizes().isShort(pixels * (count - 1), true)) step = count - 1;
      }
      if (progress && next < count && !progress((row + rows * static_cast<double>(next) / count) / target.height))
        return false;
    }
    row += rows;
    if (progress && !progress(static_cast<double>(row) / target.height) && row < target.height) return false;
  }
  queue_.sizes().endPass(static_cast<double>(target.width) * target.height, filmPixels());
  return true;
}

bool Renderer::renderTimes(const Target& target, std::uint32_t count, const BatchProgress& progress) {
  assert(target.batches.size() == 1);
  const std::uint32_t first = target.batches[0].firstSample;
  // Programs store the values of pixel centers with sample 0, which is therefore rendered a second time.
  const std::uint32_t passes = first == 0 && storesCenters() ? count + 1 : count;
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    const bool centers = pass == count;
    const std::uint32_t sample = centers ? 0 : pass;
    if (centers)
      showTime(settings_.shutter->middle(), Stored::centers);
    else
      showSample(first + sample, Stored::samples);
    const BatchProgress part = [&](double fraction) { return !progress || progress((pass + fraction) / passes); };
    if (!renderStrips(target, {sample, sample + 1}, pass == 0 ? target.begin : Record(),
                      pass + 1 == passes ? target.end : Record(), part))
      return false;
  }
  return true;
}

bool Renderer::needsOneBatch() const {
  return settings_.shutter || settings_.log || settings_.instrument || settings_.rayRecords || runnable_.countsHeat;
}

bool Renderer::renderCells(const std::vector<std::uint32_t>& limits, const BatchProgress& progress) {
  assert(program().adaptive && limits.size() == 2 * std::size_t{tileCount(film_.region())});
  const AdaptiveBatches next = nextAdaptiveBatches(film_.region(), film_.counts(), limits, needsOneBatch());
  assert(!next.tiles.empty());
  Target target = tileTarget(next.tiles);
  target.end = [&, end = target.end](gpu::Commands& commands) {
    end(commands);
    film_.setCellBatches(next.counts);
  };
  return renderSamples(target, kBatchSamples, progress);
}

Renderer::Target Renderer::tileTarget(std::span<const shared::FilmTile> tiles) {
  // The buffer is written directly, without a copy to wait for, so that earlier launches can stay in flight.
  const auto bytes = std::as_bytes(tiles);
  tileBuffer_ = gpu::Buffer(context_, {.size = bytes.size(), .memory = gpu::Memory::upload, .name = "film tiles"});
  std::memcpy(tileBuffer_.mapped(), bytes.data(), bytes.size());
  const auto rows = [](std::size_t count) { return static_cast<std::uint32_t>(count) * shared::kTileSize; };
  Target target{shared::kTileSize, rows(tiles.size()), {0, 0}, tileBuffer_.address(), {}, {}, {}};
  for (std::size_t first = 0, end = 0; first < tiles.size(); first = end) {
    end = endOfBatch(tiles, first);
    target.batches.push_back({rows(end), tiles[first].batch * kBatchSamples});
  }
  target.begin = [this, tiles](gpu::Commands& commands) { film_.beginTiles(commands, tiles.size()); };
  target.end = [this, tiles](gpu::Commands& commands) { film_.endTiles(commands, tileBuffer_.address(), tiles); };
  return target;
}

bool Renderer::renderPart(const Part& part, const BatchProgress& progress) {
  assert(!accumulates() && part.count > 0);
  if (!part.tiles.empty())
    return renderSamples(tileTarget(part.tiles.subspan(part.first, part.count)), kBatchSamples, progress);
  Target target = wholeRegion(part.samples.begin);
  target.offset.y += part.first;
  target.height = target.batches[0].endRow = part.count;
  target.begin = [&](gpu::Commands& commands) { film_.beginRows(commands, part.first, part.count); };
  target.end = [&](gpu::Commands& commands) { film_.endRows(commands, part.samples, part.first, part.count); };
  return renderSamples(target, part.samples.end - part.samples.begin, progress);
}

FilmState Renderer::takeFilm() {
  FilmState state = saveFilm();
  state.counts = {};
  film_.clear();
  return state;
}

void Renderer::finishLaunches() const {
  const Stopwatch clock;
  queue_.finish();
  statistics_.renderSeconds += clock.seconds();
}

FilmState Renderer::saveFilm() const {
  finishLaunches();
  return film_.save();
}

void Renderer::restoreFilm(const FilmState& state) {
  film_.restore(state);
  statistics_.samples = state.counts.samples();
  statistics_.batches = state.counts.batches();
  nextBatch_ = state.counts.ranges.empty() ? 0 : (state.counts.ranges.back().end + kBatchSamples - 1) / kBatchSamples;
}

void Renderer::restart() {
  queue_.finish();
  film_.clear();
  statistics_.samples = 0;
  statistics_.batches = 0;
  nextBatch_ = 0;
  if (recursion_) tracesSkippedBefore_ = recursion_->skippedTraces();
}

void Renderer::setCamera(const scene::Camera& camera) {
  settings_.camera = camera;
  restartAndUploadFrame();
}

void Renderer::setShutter(const std::optional<ShutterInterval>& shutter,
                          std::function<scene::Camera(double frame)> cameraAt) {
  assert(!shutter || (shutter->close > shutter->open && !accumulates()));
  settings_.shutter = shutter;
  settings_.cameraAt = std::move(cameraAt);
  restartAndUploadFrame();
}

void Renderer::setParameters(const program::ParameterValues& values) {
  finish();
  gpu::Buffer buffer = gpu::makeBuffer(context_, values.pack(parameterTextures_.indices()), 0, "parameters");
  parameterTextures_.replace(runnable_.description, values);
  parameterBuffer_ = std::move(buffer);
  settings_.parameters = values;
  restart();
}

void Renderer::restartAndUploadFrame() {
  restart();
  uploadFrame();
}

void Renderer::setSize(uvec2 size) {
  assert(!settings_.instrument && !settings_.rayRecords);
  RenderSettings settings = settings_;
  settings.width = size.x;
  settings.height = size.y;
  settings.region = {};
  settings = decideSettings(std::move(settings), program(), context_.info().software);
  finish();
  std::optional<RecursionBuffer> recursion;
  if (recursion_) recursion.emplace(context_, settings.region);
  gpu::Buffer heat = runnable_.countsHeat ? makeHeatBuffer(context_, settings.region) : gpu::Buffer();
  film_.resize(settings.region);
  recursion_ = std::move(recursion);
  heat_ = std::move(heat);
  settings_ = std::move(settings);
  restartAndUploadFrame();
}

void Renderer::setPlannedSamples(std::uint32_t count) {
  (accumulates() ? settings_.frameCount : settings_.plannedSamples) = count;
  restartAndUploadFrame();
}

io::Image Renderer::image(std::size_t output) const {
  finishLaunches();
  io::Image result = film_.download(output);
  if (program().outputs[output].kind == program::OutputKind::display) decodeDisplay(result, settings_.transparent);
  return result;
}

io::Image Renderer::displayImage(std::size_t output) const {
  finishLaunches();
  io::Image result = film_.downloadMean(output);
  if (program().outputs[output].kind == program::OutputKind::display) decodeDisplay(result, settings_.transparent);
  return result;
}

RayCount Renderer::rays() const {
  finishLaunches();
  return film_.countRays();
}

std::vector<NotFinitePixels> Renderer::notFinitePixels() const {
  finishLaunches();
  return film_.notFinitePixels();
}

std::uint64_t Renderer::skippedTraces() const {
  finishLaunches();
  return recursion_ ? recursion_->skippedTraces() - tracesSkippedBefore_ : 0u;
}

shared::Instrument Renderer::instrumentCounts() const {
  finishLaunches();
  return instrument_ ? instrument_->download().counts : shared::Instrument{};
}

std::vector<Diagnostic> Renderer::runtimeDiagnostics() const {
  finishLaunches();
  if (!instrument_) return {};
  std::vector<Diagnostic> result = instrumentDiagnostics(instrument_->download(), runnable_, scene_.facts());
  for (Diagnostic& diagnostic : outputDiagnostics(program(), film_)) result.push_back(std::move(diagnostic));
  return result;
}

}  // namespace quintet::render
