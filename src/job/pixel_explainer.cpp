// SPDX-License-Identifier: Apache-2.0
#include "job/pixel_explainer.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "gpu/error.h"
#include "job/device_limits.h"
#include "job/explanation_builder.h"
#include "job/runnable_program.h"

namespace quintet::job {
namespace {

// 16 MiB: about 6,000 bounces of the path tracer.
constexpr std::uint32_t kLogWords = 1u << 22;

// Whether the text of a program that accumulates mentions the functions that read any pixel of the previous frame. In the
// lecture form, gsnGetPreviousPixel reads the own pixel.
bool readsOtherPixels(const program::Program& program) {
  return std::ranges::any_of(program.files, [](const auto& file) {
    return file.second.find("loadPrevious") != file.second.npos ||
           file.second.find("previousOutputs") != file.second.npos;
  });
}

program::RunnableProgram instrumentedProgram(Engine& engine, const RenderJob& job) {
  const render::DeviceScene& scene = *job.scene()->onDevice;
  return compileAndCheck(job.resolved().program, engine.compiler(),
                         render::renderDefines(scene.defines(), job.resolved().request.outputs), scene.facts(),
                         deviceLimits(engine.context().info()), program::Instrumentation::explain)
      .runnable;
}

void requireInside(uvec2 size, uvec2 pixel) {
  if (pixel.x < size.x && pixel.y < size.y) return;
  throw UsageError(fmt::format("pixel {},{} is not inside the image of {}x{}", pixel.x, pixel.y, size.x, size.y));
}

vec4 batchValue(const render::Renderer& renderer, std::size_t output, uvec2 pixel) {
  const render::Region& region = renderer.film().region();
  const std::vector<vec4> pixels = renderer.film().downloadBatch(output);
  return pixels[std::size_t{pixel.y - region.y} * region.width + (pixel.x - region.x)];
}

}  // namespace

RenderRequest requestForPixel(RenderRequest request, const program::Program& program, uvec2 pixel) {
  if (request.region.width > 0) throw UsageError("region: not supported when a pixel is explained; remove it");
  if (request.batches) throw UsageError("batches: not supported when a pixel is explained; remove them");
  if (request.size.x > 0 && request.size.y > 0) requireInside(request.size, pixel);
  const bool accumulates = program.accumulation == program::Accumulation::program;
  if (!accumulates || !readsOtherPixels(program)) request.region = {pixel.x, pixel.y, 1, 1};
  return request;
}

PixelExplainer::PixelExplainer(Engine& engine, RenderJob& job)
    : engine_(engine),
      job_(job),
      log_(engine.context(), job.region(), kLogWords),
      program_(instrumentedProgram(engine, job)) {
  job.showRequestedFrame();  // for programs that accumulate, renderEarlierFrames() sets the frame
  render::RenderSettings settings = job.renderer().settings();
  settings.log = &log_;
  instrumented_ = std::make_unique<render::Renderer>(*job.scene()->onDevice, program_, engine.compiler(),
                                                     &engine.pipelineCache(), settings);
}

PixelExplanation PixelExplainer::explain(uvec2 pixel, std::uint32_t sample, Observer& observer) {
  requireInside(job_.scene()->size, pixel);
  try {
    if (job_.resolved().accumulatesFrames()) renderEarlierFrames(sample);
    return record(pixel, sample);
  } catch (const TimeoutError& error) {
    observer.deviceHung(hangDiagnostic(job_.resolved().program, error.seconds()));
    throw;
  }
}

// Renders the frames before `count`, and moves the scene to that frame.
void PixelExplainer::renderEarlierFrames(std::uint32_t count) {
  render::Renderer& renderer = job_.renderer();
  renderer.restart();
  render::DeviceScene& scene = *job_.scene()->onDevice;
  for (std::uint32_t frame = 0; frame <= count; ++frame) {
    renderer.finish();
    if (scene.animated()) scene.setFrame(static_cast<float>(frame));
    if (frame < count) renderer.renderFrame(frame);
  }
  instrumented_->restoreFilm(renderer.saveFilm());
}

PixelExplanation PixelExplainer::record(uvec2 pixel, std::uint32_t sample) {
  render::Renderer& renderer = job_.renderer();
  const std::uint64_t discarded = renderer.rays().droppedSamples;
  renderer.renderPixel(pixel, sample);
  log_.take();
  instrumented_->renderPixel(pixel, sample);
  const render::LogContents log = log_.take();

  PixelExplanation result = facts();
  result.pixel = pixel;
  result.sample = sample;
  result.discarded = renderer.rays().droppedSamples > discarded;
  result.lostRecords = log.dropped;
  const std::vector<program::Output>& outputs = job_.resolved().program.outputs;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const bool written = outputs[i].pixel == program::OutputPixel::mean ||
                         (outputs[i].pixel == program::OutputPixel::center && sample == 0);
    if (!written || !renderer.film().stores(i)) continue;
    result.outputs.push_back({outputs[i].name, batchValue(renderer, i, pixel), batchValue(*instrumented_, i, pixel)});
  }
  const PreparedScene& scene = *job_.scene();
  result.events = buildEvents(log, program_, {scene.instanceNames, scene.materialNames, scene.lightNames}, pixel);
  return result;
}

PixelExplanation PixelExplainer::facts() const {
  const ResolvedJob& job = job_.resolved();
  PixelExplanation result;
  result.scene = job.scene.path();
  result.program = job.program.name;
  result.parameters = job.parameters.describe();
  result.camera = job_.scene()->cameraDescription;
  result.device = engine_.context().info().name;
  result.driver = engine_.context().info().driver;
  result.version = QUINTET_VERSION;
  result.size = job_.scene()->size;
  result.frames = job.accumulatesFrames();
  result.plannedSamples =
      result.frames ? job.request.frames.accumulatedCount().value_or(0) : job.request.limits.samples.value_or(0);
  result.seed = job.request.seed;
  return result;
}

}  // namespace quintet::job
