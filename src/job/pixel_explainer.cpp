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
#include "job/version.h"
#include "program/load.h"

namespace quintet::job {
namespace {

// 16 MiB: about 6,000 bounces of the path tracer.
constexpr std::uint32_t kEventLogWords = 1u << 22;

// Whether the text of a program that accumulates mentions the functions that read any pixel of the previous frame. In the
// lecture form, gsnGetPreviousPixel reads the own pixel.
bool readsOtherPixels(const program::Program& program) {
  return std::ranges::any_of(program.files, [](const auto& file) {
    return file.second.find("loadPrevious") != file.second.npos ||
           file.second.find("previousOutputs") != file.second.npos;
  });
}

// Outputs that do not measure how long the variant takes.
std::vector<std::string> explainedOutputs(const ResolvedJob& job) {
  std::vector<std::string> names = job.request.outputs;
  std::erase_if(names, [&](const std::string& name) {
    const auto& outputs = job.program.outputs;
    const auto found = std::ranges::find(outputs, name, &program::Output::name);
    return found != outputs.end() && found->kind == program::OutputKind::heat;
  });
  return names;
}

program::RunnableProgram runnableProgram(Engine& engine, const RenderJob& job,
                                         program::Instrumentation instrumentation) {
  const render::DeviceScene& scene = *job.scene()->onDevice;
  return compileAndCheck(job.resolved().program, engine.compiler(),
                         render::renderDefines(scene.defines(), explainedOutputs(job.resolved())), scene.facts(),
                         deviceLimits(engine.context().info()), instrumentation)
      .runnable;
}

void requireInside(uvec2 size, uvec2 pixel) {
  if (pixel.x < size.x && pixel.y < size.y) return;
  throw UsageError(fmt::format("pixel {},{} is not inside the image of {}x{}", pixel.x, pixel.y, size.x, size.y));
}

// Of the job, for this image and region.
render::RenderSettings settingsFor(RenderJob& job, const ExplainedImage& image, const render::Region& region) {
  render::RenderSettings settings = job.renderer().settings();
  settings.camera = image.camera.camera;
  settings.width = image.size.x;
  settings.height = image.size.y;
  settings.region = region;
  settings.outputs = explainedOutputs(job.resolved());
  settings.log = nullptr;
  return settings;
}

// Width 0 means the whole image.
render::Region regionFor(const program::Program& program, uvec2 pixel) {
  const bool accumulates = program.accumulation == program::Accumulation::program;
  return accumulates && readsOtherPixels(program) ? render::Region{} : render::Region{pixel.x, pixel.y, 1, 1};
}

bool isNotFinite(const ExplainedOutput& output) { return !isFinite(vec3(output.value)); }

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
  request.region = regionFor(program, pixel);
  return request;
}

PixelExplainer::PixelExplainer(Engine& engine, RenderJob& job)
    : engine_(engine),
      job_(job),
      image_{{job.scene()->camera, job.scene()->cameraDescription}, job.scene()->size},
      log_(engine.context(), job.region(), kEventLogWords),
      program_(runnableProgram(engine, job, program::Instrumentation::explain)),
      renderer_(job.renderer()) {
  job.showRequestedFrame();  // for programs that accumulate, renderEarlierFrames() sets the frame
  makeInstrumented(renderer_.settings());
}

PixelExplainer::PixelExplainer(Engine& engine, RenderJob& job, const ExplainedImage& image, uvec2 pixel)
    : engine_(engine),
      job_(job),
      image_(image),
      log_(engine.context(), {pixel.x, pixel.y, 1, 1}, kEventLogWords),
      program_(runnableProgram(engine, job, program::Instrumentation::explain)),
      own_(std::make_unique<render::Renderer>(
          *job.scene()->onDevice, runnableProgram(engine, job, program::Instrumentation::none), engine.compiler(),
          &engine.pipelineCache(), settingsFor(job, image, regionFor(job.resolved().program, pixel)))),
      renderer_(*own_) {
  makeInstrumented(renderer_.settings());
}

void PixelExplainer::makeInstrumented(render::RenderSettings settings) {
  settings.log = &log_;
  instrumented_ = std::make_unique<render::Renderer>(*job_.scene()->onDevice, program_, engine_.compiler(),
                                                     &engine_.pipelineCache(), settings);
}

PixelExplanation PixelExplainer::explain(uvec2 pixel, std::uint32_t sample, Observer& observer) {
  requireInside(image_.size, pixel);
  if (sample > kMaxSample) throw UsageError(fmt::format("sample {} is above {}", sample, kMaxSample));
  try {
    if (job_.resolved().accumulatesFrames()) renderEarlierFrames(sample);
    if (!own_) job_.discardPrints();
    PixelExplanation result = record(pixel, sample);
    if (!own_) job_.flushPrints(observer);
    return result;
  } catch (const TimeoutError& error) {
    observer.deviceHung(hangDiagnostic(job_.resolved().program, error));
    throw;
  }
}

// Renders the frames before `count`, and moves the scene to that frame.
void PixelExplainer::renderEarlierFrames(std::uint32_t count) {
  renderer_.restart();
  render::DeviceScene& scene = *job_.scene()->onDevice;
  for (std::uint32_t frame = 0; frame <= count; ++frame) {
    renderer_.finish();
    if (scene.animated()) scene.setFrame(static_cast<float>(frame));
    if (frame < count) renderer_.renderFrame(frame);
  }
  earlier_ = renderer_.saveFilm();
  instrumented_->restoreFilm(*earlier_);
}

PixelExplanation PixelExplainer::record(uvec2 pixel, std::uint32_t sample) {
  const std::uint64_t discarded = renderer_.rays().droppedSamples;
  renderer_.renderPixel(pixel, sample);
  log_.take();
  instrumented_->renderPixel(pixel, sample);
  const render::LogContents log = log_.take();

  PixelExplanation result = facts();
  result.pixel = pixel;
  result.sample = sample;
  result.discarded = renderer_.rays().droppedSamples > discarded;
  result.lostRecords = log.dropped;
  const std::vector<program::Output>& outputs = job_.resolved().program.outputs;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const bool written = outputs[i].pixel == program::OutputPixel::mean ||
                         (outputs[i].pixel == program::OutputPixel::center && sample == 0 &&
                          !renderer_.settings().shutter);  // then they show another time than the sample
    if (!written || !renderer_.film().stores(i)) continue;
    result.outputs.push_back({outputs[i].name, batchValue(renderer_, i, pixel), batchValue(*instrumented_, i, pixel)});
  }
  const PreparedScene& scene = *job_.scene();
  if (result.discarded || std::ranges::any_of(result.outputs, isNotFinite)) result.origin = findOrigin(pixel, sample);
  result.events = buildEvents(log, program_, {scene.instanceNames, scene.materialNames, scene.lightNames}, pixel);
  return result;
}

// Built-in programs are not the user's, and their variants take long to compile.
std::optional<ValueOrigin> PixelExplainer::findOrigin(uvec2 pixel, std::uint32_t sample) {
  const ResolvedJob& job = job_.resolved();
  if (program::isBuiltIn(job.program)) return std::nullopt;
  if (!origins_ || originsOf_ != pixel) {
    origins_.reset();
    origins_ = std::make_unique<ValueOriginFinder>(engine_, *job_.scene()->onDevice, job.program, explainedOutputs(job),
                                                   renderer_.settings(), pixel);
    originsOf_ = pixel;
  }
  return origins_->find([&](render::Renderer& renderer) {
    if (earlier_) renderer.restoreFilm(*earlier_);
    renderer.renderPixel(pixel, sample);
  });
}

PixelExplanation PixelExplainer::facts() const {
  const ResolvedJob& job = job_.resolved();
  PixelExplanation result;
  result.scene = job.scene.path();
  result.program = job.program.name;
  result.parameters = job.parameters.describe();
  result.camera = image_.camera.description;
  result.device = engine_.context().info().name;
  result.driver = engine_.context().info().driver;
  result.version = quintetVersion();
  result.size = image_.size;
  result.frames = job.accumulatesFrames();
  result.plannedSamples =
      result.frames ? job.request.frames.accumulatedCount().value_or(0) : job.request.limits.samples.value_or(0);
  result.seed = job.request.seed;
  return result;
}

}  // namespace quintet::job
