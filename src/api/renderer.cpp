// SPDX-License-Identifier: Apache-2.0
// The renderer of the public API: settings to a job, limits to a run, edits to the job's edits.
#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <iterator>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "api/impl.h"
#include "base/error.h"
#include "base/suggestion.h"
#include "job/pixel_explainer.h"
#include "program/heat.h"
#include "scene/model/texture_coordinates.h"

namespace quintet {
namespace {

// A canceled render completes its batch if that takes at most so many seconds; otherwise the samples of the batch are lost.
constexpr double kLongestStop = 0.5;

// Estimates when the current batch, or frame of a program that accumulates, is complete.
class BatchSpeed {
 public:
  void add(const job::Progress& p) {
    const double size = p.countsFrames ? 1.0 : double{render::kBatchSamples};
    if (!last_) first_ = p;
    last_ = p;
    left_ = std::ceil(p.samples / size - 1e-6) * size - p.samples;
    if (p.sampleLimit) left_ = std::min(left_, static_cast<double>(*p.sampleLimit) - p.samples);
  }
  // 0 if it is unknown, which it is only until the second launch.
  double secondsToTheNextBatch() const {
    if (!last_ || left_ <= 0) return 0;
    const double samples = last_->samples - first_.samples, seconds = last_->seconds - first_.seconds;
    return samples > 0 ? left_ * seconds / samples : 0;
  }

 private:
  job::Progress first_;
  std::optional<job::Progress> last_;
  double left_ = 0;  // samples
};

// Passes progress on, and collects warnings.
class ApiObserver : public job::Observer {
 public:
  explicit ApiObserver(std::function<bool()> canceled, const ProgressFunction* function = nullptr)
      : function_(function), canceled_(std::move(canceled)) {}

  void progress(const job::Progress& p) override {
    batchSpeed_.add(p);
    if (stop_) return;
    try {
      const std::optional<double> error = p.error && std::isfinite(*p.error) ? p.error : std::nullopt;
      if (function_ && *function_)
        stop_ = !(*function_)({p.samples, p.seconds, p.fraction(), p.secondsLeft(), p.raysPerSecond, error});
      if (!stop_) stop_ = cancelsPreparation();
    } catch (...) {  // thrown again when the batch has ended
      failure_ = std::current_exception();
      stop_ = true;
    }
  }
  bool cancelsPreparation() override { return canceled_ && canceled_(); }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }
  void printed(const job::Printed& prints) override {
    prints_.lines.insert(prints_.lines.end(), prints.lines.begin(), prints.lines.end());
    prints_.omitted += prints.omitted;
  }
  const job::Printed& prints() const { return prints_; }
  bool showsError() const override { return false; }
  // The current batch is completed if that takes a short time.
  job::StopRequest stopRequested() override {
    if (!stop_) return job::StopRequest::none;
    return batchSpeed_.secondsToTheNextBatch() > kLongestStop ? job::StopRequest::abandon : job::StopRequest::finish;
  }
  void warning(const std::string& text) override {  // from any thread
    const std::lock_guard lock(mutex_);
    warnings_.push_back(text);
  }
  std::vector<std::string> takeWarnings() {
    const std::lock_guard lock(mutex_);
    return std::exchange(warnings_, {});
  }

 private:
  const ProgressFunction* function_;
  std::function<bool()> canceled_;
  BatchSpeed batchSpeed_;
  std::exception_ptr failure_;
  bool stop_ = false;
  job::Printed prints_;
  std::mutex mutex_;
  std::vector<std::string> warnings_;
};

job::CameraRequest toRequest(const Camera& camera) {
  static_cast<void>(toScene(camera, "camera"));  // validates
  job::CameraRequest request;
  request.lookFrom = toGlm(camera.lookFrom);
  request.lookAt = toGlm(camera.lookAt);
  request.up = toGlm(camera.up);
  request.verticalFov = glm::degrees(camera.verticalFov);
  request.apertureRadius = camera.apertureRadius;
  return request;
}

std::vector<std::string> optionalOutputs(const Settings& settings, const program::Program& program) {
  std::vector<std::string> optional = program::optionalOutputs(program);
  const auto isRequested = [&](const std::string& name) {
    return std::ranges::find(settings.outputs, name) != settings.outputs.end();
  };
  if (isRequested("all")) return optional;
  const std::vector<std::string> names = program::outputNames(program);
  for (const std::string& name : settings.outputs)
    if (std::ranges::find(names, name) == names.end())
      throw UsageError(
          fmt::format("output '{}' not found in the program '{}'{}", name, program.name, suggestion(name, names)));
  std::erase_if(optional, [&](const std::string& name) { return !isRequested(name); });
  return optional;
}

// The layers of a film that are outputs of the program.
std::vector<output::Layer> renderedLayers(const program::Program& program, const std::vector<std::string>& optional) {
  std::vector<output::Layer> layers = output::availableLayers(program);
  std::erase_if(layers, [&](const output::Layer& layer) {
    if (layer.output == 0) return true;
    const program::Output& output = program.outputs[layer.output];
    return output.optional && std::ranges::find(optional, output.name) == optional.end();
  });
  return layers;
}

job::RenderRequest toRequest(const Settings& settings, std::shared_ptr<const scene::Scene> scene,
                             const program::Program& program) {
  if (settings.width == 0 || settings.height == 0)
    throw UsageError("an image has at least one pixel in each direction");
  job::RenderRequest request;
  request.loadedScene = std::move(scene);
  request.editable = true;
  request.size = {settings.width, settings.height};
  if (settings.region)
    request.region = {settings.region->x, settings.region->y, settings.region->width, settings.region->height};
  if (settings.region && (settings.region->width == 0 || settings.region->height == 0))
    throw UsageError("a region has at least one pixel in each direction");
  request.seed = settings.seed;
  request.transparent = settings.transparent;
  request.load.maxMemory = settings.maxMemory;
  if (settings.shutter) request.shutter = job::ShutterRequest{settings.shutter->open, settings.shutter->close};
  for (const auto& [name, value] : settings.parameters) request.assignments.push_back(name + "=" + value);
  request.outputs = optionalOutputs(settings, program);
  request.camera.name = settings.cameraName;
  if (settings.camera && !settings.cameraName.empty()) throw UsageError("camera and cameraName exclude each other");
  if (settings.camera) request.camera = toRequest(*settings.camera);
  request.limits.adaptive = settings.adaptive;
  if (settings.print) {
    const Region& pixels = *settings.print;
    if (pixels.width == 0 || pixels.height == 0) throw UsageError("Settings::print must contain at least one pixel");
    request.print.emplace();
    request.print->pixels = {pixels.x, pixels.y, pixels.width, pixels.height};
    request.print->limit = settings.printLimit;
  }
  if (settings.plannedSamples > 0) request.limits.samples = settings.plannedSamples;
  if (settings.batches) {
    if (settings.plannedSamples == 0)
      throw UsageError("batches: plannedSamples must be the number of samples of the whole render");
    if (settings.batches->first > settings.batches->last) throw UsageError("batches: first is above last");
    request.batches = job::BatchRange{settings.batches->first, settings.batches->last};
  }
  const std::vector<output::Layer> layers = renderedLayers(program, request.outputs);
  request.outputNotes.layers = output::layersText(layers);
  request.outputNotes.names =
      std::ranges::find(layers, output::Layer::Source::coverage, &output::Layer::source) != layers.end();
  return request;
}

// Counted from the first sample of a part, which the job does not do.
job::RenderLimits toJob(const Limits& limits, const job::RenderRequest& request) {
  job::RenderLimits result;
  result.samples = limits.samples;
  if (result.samples && request.batches) {
    const std::uint64_t first = request.batches->first * render::kBatchSamples;
    result.samples = first + std::min(*limits.samples, std::numeric_limits<std::uint64_t>::max() - first);
  }
  result.seconds = limits.seconds;
  result.error = limits.error;
  result.adaptive = request.limits.adaptive;
  return result;
}

StopReason reasonOf(const job::RenderResult& result) {
  if (result.interrupted || result.abandoned) return StopReason::canceled;
  switch (result.reached) {
    case job::ReachedLimit::samples: return StopReason::samples;
    case job::ReachedLimit::seconds: return StopReason::time;
    case job::ReachedLimit::error: return StopReason::error;
    case job::ReachedLimit::unknownError: break;
  }
  return StopReason::unknownError;
}

void append(std::vector<std::string>& texts, std::vector<std::string> more) {
  texts.insert(texts.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

// A call that renders is at work.
class Rendering {
 public:
  explicit Rendering(bool& flag) : flag_(flag) { flag_ = true; }
  ~Rendering() { flag_ = false; }
  Rendering(const Rendering&) = delete;
  Rendering& operator=(const Rendering&) = delete;

 private:
  bool& flag_;
};

}  // namespace

struct Renderer::Impl {
  Impl(job::Engine& engineOfDevice, job::ResolvedJob resolved, const Settings& settings, job::Observer& observer)
      : engine(engineOfDevice),
        printLimit(settings.printLimit),
        canceled(settings.canceled),
        layers(renderedLayers(resolved.program, resolved.request.outputs)),
        assignments(resolved.request.assignments),
        job(engine, std::move(resolved), observer) {
    for (const output::Layer& layer : output::availableLayers(job.resolved().program))
      if (layer.source == output::Layer::Source::variance || layer.source == output::Layer::Source::sampleCount)
        layers.push_back(layer);
  }

  // Brings the edits to the device. Keeps the warnings, also if this fails.
  void update() {
    ApiObserver observer(canceled);
    try {
      job.update(observer);
    } catch (...) {
      append(warnings, observer.takeWarnings());
      throw;
    }
    append(warnings, observer.takeWarnings());
  }

  // Creates a job for `request` that renders the same scene on the device: with all edits, and at the same frame.
  std::unique_ptr<job::RenderJob> makeJobOfSameScene(job::RenderRequest request, job::Observer& observer) {
    std::shared_ptr<job::PreparedScene> scene = job.scene();
    auto result = std::make_unique<job::RenderJob>(engine, job::resolve(std::move(request), job.resolved().program),
                                                   observer, scene);
    if (scene->onDevice->animated() && !result->resolved().accumulatesFrames()) result->setFrame(job.frame());
    return result;
  }

  // Calls of progress functions must not change what is rendered, because the call at work counts on it.
  job::RenderJob& idleJob() {
    if (rendering)
      throw UsageError(
          "a progress function can neither change the renderer nor render: let it return false, and do so after "
          "render() has returned");
    return job;
  }

  job::Engine& engine;
  std::uint64_t printLimit;  // Settings::printLimit
  std::function<bool()> canceled;
  bool rendering = false;  // a call of render() or search() is at work, and its progress function may be
  std::vector<output::Layer> layers;
  std::vector<std::string> assignments;
  std::vector<std::string> warnings;  // for the next report
  job::RenderJob job;
};

Renderer::Renderer(Device& device, const Scene& scene, const Program& program, const Settings& settings) {
  ApiObserver observer(settings.canceled);
  program::Program withHeat = program::withHeatMaps(program.impl().program, settings.outputs);
  const job::RenderRequest request = toRequest(settings, scene.impl().scene, withHeat);
  impl_ = std::make_unique<Impl>(device.impl().engine, job::resolve(request, std::move(withHeat)), settings, observer);
  impl().warnings = observer.takeWarnings();
}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;
Renderer::Impl& Renderer::impl() const { return requireObject(impl_, "Renderer"); }

RenderReport Renderer::render(const Limits& limits, const ProgressFunction& progress) {
  job::RenderJob& job = impl().idleJob();
  const job::RenderRequest& request = job.resolved().request;
  if (!limits.samples && !limits.seconds && !limits.error && !request.batches && !progress)
    throw UsageError("a render without limits requires a progress function, which stops it");
  if ((limits.seconds && !(*limits.seconds > 0)) || (limits.error && !(*limits.error > 0)))
    throw UsageError("limits of time and error must be above 0");
  if (limits.error && job.resolved().accumulatesFrames())
    throw UsageError("the program averages its samples itself, so the error of its image is unknown");
  ApiObserver observer(impl().canceled, &progress);
  RenderReport report;
  const auto complete = [&](const job::RenderResult& result) {
    report.reason = reasonOf(result);
    report.samples = job.sampleCount();
    report.seconds = result.provenance.seconds;
    report.rays = result.provenance.rays;
    report.droppedSamples = result.provenance.droppedSamples;
    report.error = result.provenance.error;
    report.warnings = std::exchange(impl().warnings, {});
    append(report.warnings, observer.takeWarnings());
    append(report.warnings, job::resultWarnings(result));
  };
  {
    const Rendering rendering(impl().rendering);
    const job::RenderResult result = job.run(toJob(limits, request), observer);
    if (result.abandoned) {
      job::RenderResult before = job.result(true);
      before.abandoned = true;
      complete(before);
    } else {
      complete(result);
    }
  }
  report.printed = toApi(observer.prints().lines);
  report.omittedPrints = observer.prints().omitted;
  observer.rethrow();
  return report;
}

RenderReport Renderer::render(std::uint32_t count) {
  return render({.samples = static_cast<std::uint64_t>(std::llround(sampleCount())) + count});
}

double Renderer::sampleCount() const { return impl().job.sampleCount(); }
std::vector<Diagnostic> Renderer::diagnostics() const { return impl().job.diagnostics(); }
Image Renderer::image(const std::string& output) const { return toImage(*impl().job.film(), output); }

Film Renderer::film() const {
  job::RenderResult result = impl().job.result(true);
  result.film = job::viewOf(result.film->state(), result.provenance.transparent);
  return Film::Impl::make(std::move(result), impl().layers);
}

Explanation Renderer::explain(std::uint32_t x, std::uint32_t y, std::uint32_t sample) {
  impl().idleJob();
  impl().update();
  ApiObserver observer(impl().canceled);
  job::RenderRequest request = impl().job.resolved().request;
  request.region = {};
  request.batches.reset();
  request.print = job::PrintRequest{.pixels = {x, y, 1, 1}, .limit = impl().printLimit};
  request = job::requestForPixel(std::move(request), impl().job.resolved().program, {x, y});
  const std::unique_ptr<job::RenderJob> job = impl().makeJobOfSameScene(std::move(request), observer);
  Explanation result = toApi(job::PixelExplainer(impl().engine, *job).explain({x, y}, sample, observer));
  result.printed = toApi(observer.prints().lines);
  result.omittedPrints = observer.prints().omitted;
  return result;
}

SearchReport Renderer::search(const SearchSettings& settings, const ProgressFunction& progress) {
  if (!(settings.threshold > 0.0f && std::isfinite(settings.threshold)))
    throw UsageError(fmt::format("the threshold {} of fireflies must be above 0", settings.threshold));
  impl().idleJob();
  impl().update();
  ApiObserver observer(impl().canceled, &progress);
  job::RenderRequest request = impl().job.resolved().request;
  request.batches.reset();
  request.print.reset();
  const std::unique_ptr<job::RenderJob> job = impl().makeJobOfSameScene(std::move(request), observer);
  const bool fireflies = settings.fireflies && !job->resolved().accumulatesFrames();
  const job::SearchOptions options{settings.notFinite, fireflies, settings.threshold, settings.limit, settings.samples};
  const Rendering rendering(impl().rendering);
  SearchReport report = toApi(job::searchSamples(impl().engine, *job, options, observer));
  observer.rethrow();
  return report;
}

void Renderer::setCamera(const Camera& camera) { impl().idleJob().setCamera(toRequest(camera)); }

void Renderer::setParameter(const std::string& name, const std::string& value) {
  std::vector<std::string> assignments = impl().assignments;
  std::erase_if(assignments, [&](const std::string& assignment) { return assignment.starts_with(name + "="); });
  assignments.push_back(name + "=" + value);
  impl().idleJob().setParameters(assignments);
  impl().assignments = std::move(assignments);
}

void Renderer::setTransform(int instance, const Transform& worldFromObject) {
  if (instance < 0) throw UsageError(fmt::format("instance {} does not exist", instance));
  impl().idleJob().setTransform(static_cast<std::size_t>(instance), toGlm(worldFromObject));
}

void Renderer::setMaterial(int index, const Material& material) {
  if (index < 0) throw UsageError(fmt::format("material {} does not exist", index));
  job::RenderJob& job = impl().idleJob();
  const auto i = static_cast<std::size_t>(index);
  const scene::Material changed = toScene(material);
  if (i < job.hostScene().materials.size()) scene::requireCoordinates(job.hostScene(), i, changed);
  job.setMaterial(i, changed);
}

void Renderer::setFrame(float frame) { impl().idleJob().setFrame(frame); }
void Renderer::restart() { impl().idleJob().restart(); }

void Renderer::saveCheckpoint(const std::filesystem::path& file) const { film().write(file); }

bool Renderer::resume(const std::filesystem::path& file) {
  ApiObserver observer(impl().canceled);
  const bool resumed = impl().idleJob().resume(file, observer);
  append(impl().warnings, observer.takeWarnings());
  return resumed;
}

}  // namespace quintet
