#include "render/renderer.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "base/stopwatch.h"
#include "program/check.h"
#include "render/adaptive_batch.h"
#include "render/camera.h"
#include "render/instrument.h"
#include "render/launch_queue.h"
#include "render/output_check.h"
#include "render/parameter_textures.h"
#include "render/tone_map.h"

namespace quintet::render {

using Record = LaunchQueue::Record;

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
  RenderStatistics statistics;
  LaunchQueue queue;
  std::vector<shader::Diagnostic> diagnostics;
  std::vector<std::filesystem::path> files;
  std::vector<Hash> shaderHashes;
  std::optional<InstrumentBuffer> instrument;
  program::CompiledProgram instrumented;  // file names of stages, for notes
  std::uint64_t nextBatch = 0;

  Impl(DeviceScene& deviceScene, const program::Program& program, const shader::Compiler& compiler,
       const gpu::PipelineCache* cache, const RenderSettings& renderSettings)
      : scene(deviceScene),
        context(deviceScene.context()),
        description(program),
        settings(decideSettings(renderSettings, program, context.info().quirks)),
        queue(context, settings, statistics) {
    const Region region = checkedRegion(settings);
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
    const CompiledShaders shaders = chooseShaders(description, compiler, settings, scene.defines());
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

  // Launches a strip with `count` samples from `first` on.
  void launch(const Target& target, std::uint32_t row, std::uint32_t rows, std::uint32_t first, std::uint32_t count,
              const Record& before, const Record& after) {
    const Record trace = [&](gpu::Commands& commands) {
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
    };
    queue.submit({rows, count, static_cast<double>(target.width) * rows * count, before, trace, after});
  }

  // Between batches: the wait belongs to the rendering.
  void finishAndCount() {
    const Stopwatch clock;
    queue.finish();
    statistics.renderSeconds += clock.seconds();
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
    const Stopwatch clock;
    const std::uint32_t height = film->region().height;
    for (std::uint32_t row = 0; row < height;) {
      const Target target = wholeRegion();
      const std::uint32_t rows = queue.rows(target.width, height - row, 1);
      const Record end = [&](gpu::Commands& commands) { film->endBatch(commands, {index, index + 1}); };
      launch(target, row, rows, index, 1, row == 0 ? begin() : Record(), row + rows == height ? end : Record());
      row += rows;
      if (progress && !progress(static_cast<double>(row) / height) && row < height) return false;
    }
    statistics.batches++;
    statistics.samples++;
    statistics.renderSeconds += clock.seconds();
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
    const Stopwatch clock;
    const std::uint32_t count = samples.end - samples.begin;
    for (std::uint32_t row = 0; row < target.height;) {
      // Where even one row is too long, its samples are launched one by one: same sums, same order.
      const std::uint32_t rows = queue.rows(target.width, target.height - row, count);
      // So they are as long as the rate is not known: a shader that is slow, or never ends, is found out soon.
      const std::uint32_t step = queue.isShort(static_cast<double>(rows) * target.width * count) ? count : 1;
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
    statistics.renderSeconds += clock.seconds();
    return true;
  }

  bool renderCells(const std::vector<std::uint32_t>& limits, const BatchProgress& progress) {
    assert(description.adaptive && limits.size() == 2 * std::size_t{tileCount(film->region())});
    const AdaptiveBatch next = nextAdaptiveBatch(film->region(), film->counts(), limits);
    assert(!next.tiles.empty());
    // Written in place: no wait for a copy, so that the launches before this batch may still be under way.
    const auto bytes = std::as_bytes(std::span(next.tiles));
    tileBuffer = gpu::Buffer(context, {.size = bytes.size(), .memory = gpu::Memory::upload, .name = "film tiles"});
    std::memcpy(tileBuffer.mapped(), bytes.data(), bytes.size());
    const Target target{shared::kTileSize * shared::kTileSize,
                        static_cast<std::uint32_t>(next.tiles.size()),
                        {0, 0},
                        tileBuffer.address()};
    const SampleRange samples = batchSamples(next.batch, kBatchSamples);
    const Record end = [&](gpu::Commands& commands) { film->endAdaptiveBatch(commands, samples, next.counts); };
    return renderSamples(target, samples, end, progress);
  }

  std::vector<shader::Diagnostic> notes() const {
    if (!instrument) return {};
    std::vector<shader::Diagnostic> result =
        instrumentDiagnostics(instrument->download(), description, instrumented, scene.facts());
    checkOutputs(description, *film, result);
    return result;
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
  impl_->queue.finish();
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
const std::vector<LaunchTiming>& Renderer::launches() const { return impl_->queue.timings(); }
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
