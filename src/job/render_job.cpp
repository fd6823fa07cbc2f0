// SPDX-License-Identifier: Apache-2.0
#include "job/render_job.h"

#include <algorithm>
#include <cassert>
#include <future>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/cancellation.h"
#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "gpu/device_list.h"
#include "gpu/error.h"
#include "job/device_limits.h"
#include "job/early_pipeline.h"
#include "job/film_store.h"
#include "job/identity.h"
#include "job/runnable_program.h"
#include "job/scene_loading.h"
#include "job/scene_notes.h"
#include "job/shared_devices.h"
#include "program/heat.h"
#include "render/scene/camera.h"
#include "scene/animation/animated_bounds.h"
#include "scene/model/names.h"

namespace quintet::job {
namespace {

// Host memory of a finished image per pixel: floats and display bytes.
constexpr std::uint64_t kImageBytes = 20;
// Reading the ray counter waits for the devices: at most this often, and for at most a two-hundredth of the time.
constexpr double kRateSeconds = 1.0;
constexpr double kRateShare = 200.0;
constexpr double kPreviewSeconds = 1.0;  // between previews of frames
// The error estimate for the progress takes at most a fiftieth of the time.
constexpr double kEstimateSeconds = 2.0;
constexpr double kEstimateShare = 50.0;

void checkMemory(const gpu::DeviceInfo& device, uvec2 size, const program::Program& program,
                 const std::vector<std::string>& outputs) {
  // Largest buffer of a film: sums of four channels.
  constexpr std::uint64_t kSumBytes = 4 * sizeof(shared::FixedSum);
  const std::uint64_t pixels = std::uint64_t{size.x} * size.y;
  const std::uint64_t needed =
      render::Film::bytesFor({0, 0, size.x, size.y}, program, outputs) + (device.software ? pixels * kImageBytes : 0);
  const std::uint64_t available = device.memoryBytes - device.memoryBytes / 16;
  const bool tooLargeBuffer = device.maxBufferBytes > 0 && pixels * kSumBytes > device.maxBufferBytes;
  if (needed <= available && !tooLargeBuffer) return;
  throw MemoryError(
      fmt::format("an image of {}x{} requires {}, but {} has {} and buffers of at most {}", size.x, size.y,
                  bytesText(needed), device.name, bytesText(device.memoryBytes), bytesText(device.maxBufferBytes)),
      Remedy::renderRegion);
}

// Size of what is rendered, as far as it is known.
uvec2 renderedSize(const RenderRequest& request, uvec2 imageSize) {
  return request.region.width > 0 ? uvec2{request.region.width, request.region.height} : imageSize;
}

std::string describe(const RenderLimits& limits) {
  std::string text;
  if (limits.samples) text += fmt::format("{} samples ", *limits.samples);
  if (limits.seconds) text += fmt::format("{} s ", *limits.seconds);
  if (limits.error) text += fmt::format("error {} ", *limits.error);
  return text;
}

// The kinds of devices, each once.
void describeDevices(const DeviceTeam& team, Provenance& p) {
  std::vector<std::string> names, drivers;
  const auto add = [](std::vector<std::string>& texts, const std::string& text) {
    if (std::ranges::find(texts, text) == texts.end()) texts.push_back(text);
  };
  for (const TeamMember& member : team.members()) {
    add(names, member.scene->context().info().name);
    add(drivers, member.scene->context().info().driver);
  }
  p.device = fmt::format("{}", fmt::join(names, kDeviceSeparator));
  p.driver = fmt::format("{}", fmt::join(drivers, kDeviceSeparator));
  p.deviceCount.reset();
  if (team.isShared()) p.deviceCount = team.members().size();
}

std::string lossText(std::size_t device, const Error& error) {
  return fmt::format("device {} of the list was lost: {}; the others render without it", device + 1, error.what());
}

}  // namespace

RenderJob::RenderJob(Engine& engine, ResolvedJob job, Observer& observer) : engine_(engine), job_(std::move(job)) {
  prepare(observer);
}

RenderJob::RenderJob(Engine& engine, ResolvedJob job, Observer& observer, std::shared_ptr<PreparedScene>& scene)
    : engine_(engine), job_(std::move(job)), scene_(scene) {
  try {
    prepare(observer);
  } catch (...) {
    scene = scene_;
    throw;
  }
  scene = scene_;
}

void RenderJob::prepare(Observer& observer) {
  const RenderRequest& request = job_.request;
  Cancellation cancellation([&] { return observer.cancelsPreparation(); });
  const Cancellation::Scope scope(&cancellation);
  if (!request.checkpoint.file.empty())
    checkpoint_.emplace(request.checkpoint, observer);  // its lock fails before anything is loaded
  if (scene_ && scene_->singleAnyHit < program::requiredSingleAnyHit(job_.program)) scene_ = nullptr;
  std::optional<SceneLoading> loading;
  if (!scene_) loading.emplace(job_.scene, request);  // continues while the driver starts
  gpu::Context& context = engine_.context();
  deviceCount_ = deviceCount(observer);
  if (scene_ && scene_->devices.size() < deviceCount_) {
    scene_ = nullptr;
    loading.emplace(job_.scene, request);
  }
  const auto checkMemoryFor = [&](uvec2 size) {
    for (std::size_t i = 0; i < deviceCount_; ++i)
      checkMemory(engine_.context(i).info(), size, job_.program, request.outputs);
  };
  checkMemoryFor(renderedSize(request, request.size));

  // Compiled while the scene is read and uploaded; errors of the scene are reported first.
  // Probes change the stages, and further devices create their pipelines when they are linked.
  const bool early = loading && !request.print && !program::hasHeatMap(job_.program, request.outputs);
  const gpu::PipelineCache& pipelineCache = engine_.pipelineCache();
  struct Compilation {
    program::CompiledProgram compiled;
    std::unique_ptr<EarlyPipeline> pipeline;
  };
  std::future<Compilation> compiling = std::async(std::launch::async, [&] {
    const Cancellation::Scope compilingScope(&cancellation);
    const render::Defines scene =
        scene_ ? scene_->onDevice->defines() : render::shaderDefines(loading->features().get(), context.info().quirks);
    Compilation result;
    result.compiled = program::compile(job_.program, engine_.compiler(), render::renderDefines(scene, request.outputs));
    throwIfCanceled();
    if (early) result.pipeline = EarlyPipeline::make(context, job_.program, result.compiled, pipelineCache);
    return result;
  });
  if (loading) {
    observer.stage("loading " + job_.scene.name);
    LoadedScene loaded = loading->finish();
    checkMemoryFor(renderedSize(request, loaded.size));
    noteScene(loaded, job_, observer);
    prepareScene(std::move(loaded), observer);
  }
  observer.stage(kCompilingStage);
  Compilation compilation = getUnlessCanceled(compiling);
  throwIfCanceled();
  link(std::move(compilation.compiled), observer);
  if (request.shutter) {
    requireAnimation("a shutter would change nothing; remove it");
    frameOutdated_ = true;  // the renderer does not have the shutter yet
  }
  provenance_ = makeProvenance();
  linkedSeconds_ = clock_.seconds();
}

std::size_t RenderJob::deviceCount(Observer& observer) {
  const std::size_t count = engine_.deviceCount();
  if (count == 1) return 1;
  std::string reason;
  if (job_.accumulatesFrames())
    reason = fmt::format("{}: the program averages its frames itself, each from the one before", job_.program.name);
  else if (job_.request.print)
    reason = "prints are shown in the order of the batches";
  if (reason.empty()) return count;
  if (!std::exchange(devicesNoted_, true))
    observer.note(fmt::format("{}, so one of the {} devices renders", reason, count));
  return 1;
}

// Uploads the scene to all devices side by side. They share the scene in host memory; the only device consumes it.
void RenderJob::makeScenes(PreparedScene& prepared, LoadedScene& loaded, Observer& observer) const {
  const render::DeviceSceneOptions options{
      .singleAnyHit = prepared.singleAnyHit, .editable = job_.request.editable, .compiler = &engine_.compiler()};
  const scene::Environment& environment = loaded.environment.environment;
  if (deviceCount_ == 1) {
    prepared.onDevice =
        std::make_unique<render::DeviceScene>(engine_.context(), std::move(loaded.scene), environment, options);
    prepared.devices = {0};
    return;
  }
  std::vector<std::future<std::unique_ptr<render::DeviceScene>>> uploads;
  const scene::Scene& scene = loaded.scene;
  for (std::size_t i = 0; i < deviceCount_; ++i)
    uploads.push_back(
        std::async(std::launch::async, [&, canceled = Cancellation::current(), &context = engine_.context(i)] {
          const Cancellation::Scope scope(canceled);
          return std::make_unique<render::DeviceScene>(context, scene, environment, options);
        }));
  for (std::size_t i = 0; i < deviceCount_; ++i) {
    const bool isLast = i + 1 == deviceCount_;
    try {
      std::unique_ptr<render::DeviceScene> uploaded = uploads[i].get();
      if (prepared.onDevice)
        prepared.onFurther.push_back(std::move(uploaded));
      else
        prepared.onDevice = std::move(uploaded);
      prepared.devices.push_back(i);
    } catch (const TimeoutError&) {
      throw;
    } catch (const DeviceLostError& error) {
      if (isLast && !prepared.onDevice) throw;
      observer.warning(lossText(i, error));
    }
  }
}

void RenderJob::prepareScene(LoadedScene loaded, Observer& observer) {
  observer.stage("building acceleration structures");
  const Stopwatch building;
  auto prepared = std::make_shared<PreparedScene>();
  prepared->source = job_.scene;
  prepared->camera = loaded.camera.camera;
  prepared->cameraDescription = loaded.camera.description;
  prepared->environment = loaded.environment.description;
  prepared->environmentSource = job_.request.environment.source;
  prepared->hash = loaded.hash;
  prepared->environmentHash = loaded.environmentHash;
  prepared->size = loaded.size;
  prepared->files = loaded.scene.report.files;
  prepared->ignoredAnimations = loaded.scene.report.ignoredAnimations;
  prepared->nodeAnimation = loaded.scene.nodeAnimation;
  if (std::ranges::any_of(loaded.scene.cameras, &scene::Camera::animated)) {
    prepared->movingCameras = loaded.scene.cameras;
    prepared->bounds = job_.request.bounds ? *job_.request.bounds : scene::animatedBounds(loaded.scene);
  }
  prepared->instanceNames = scene::instanceNames(loaded.scene);
  prepared->materialNames = scene::materialNames(loaded.scene);
  for (const scene::Light& light : loaded.scene.lights) prepared->lightNames.push_back(light.name);
  prepared->seconds.load = loaded.seconds;
  prepared->singleAnyHit = program::requiredSingleAnyHit(job_.program);
  const scene::ImportSeconds import = loaded.scene.seconds;
  makeScenes(*prepared, loaded, observer);
  if (!job_.request.editable) loaded.environment.environment.image = {};
  prepared->environmentInUse = std::move(loaded.environment);
  prepared->seconds.build = building.seconds();
  const render::DeviceSceneStatistics& built = prepared->onDevice->statistics();
  prepared->seconds.stages = {{"document", import.document},
                              {"meshes", import.meshes},
                              {"images", import.images},
                              {"hash", loaded.hashSeconds},
                              {"view", loaded.viewSeconds},
                              {"lights", built.lightSeconds},
                              {"upload", built.uploadSeconds - built.lightSeconds},
                              {"order", built.build.orderSeconds},
                              {"bottomLevel", built.build.buildSeconds}};
  scene_ = std::move(prepared);
  loaded = {};
  releaseFreedMemory();
}

CheckedProgram RenderJob::checkProgram(const render::DeviceScene& scene, program::CompiledProgram compiled) const {
  CheckedProgram checked =
      checkCompiled(job_.program, std::move(compiled), scene.facts(), deviceLimits(scene.context().info()));
  countRecursion(checked, engine_.compiler(), render::renderDefines(scene.defines(), job_.request.outputs));
  return checked;
}

// Links the program on all devices side by side. `runnable`: for devices of the kind of the first one.
std::vector<TeamMember> RenderJob::makeMembers(program::RunnableProgram runnable,
                                               const render::RenderSettings& settings, Observer& observer) {
  const auto linkOn = [&](render::DeviceScene& scene, gpu::PipelineCache& cache, program::RunnableProgram program) {
    return std::make_unique<render::Renderer>(scene, std::move(program), engine_.compiler(), &cache, settings);
  };
  std::vector<TeamMember> members;
  render::DeviceScene& first = *scene_->onDevice;
  if (deviceCount_ == 1) {
    gpu::PipelineCache& cache = engine_.pipelineCache(scene_->devices.front());
    members.push_back({&first, linkOn(first, cache, std::move(runnable))});
    return members;
  }
  const auto programOn = [&](const render::DeviceScene& scene) {
    if (gpu::isSameKind(scene.context().info(), first.context().info())) return runnable;
    const render::Defines defines = render::renderDefines(scene.defines(), job_.request.outputs);
    CheckedProgram checked = checkProgram(scene, program::compile(job_.program, engine_.compiler(), defines));
    addProbes(checked, engine_.compiler(), defines,
              requestedProbes(job_.request, job_.program, scene.context().info()));
    return std::move(checked.runnable);
  };
  std::vector<render::DeviceScene*> scenes{&first};
  for (const auto& scene : scene_->onFurther) scenes.push_back(scene.get());
  std::vector<std::future<std::unique_ptr<render::Renderer>>> links;
  for (std::size_t i = 0; i < scenes.size(); ++i)
    links.push_back(
        std::async(std::launch::async, [&, scene = scenes[i], &cache = engine_.pipelineCache(scene_->devices[i])] {
          return linkOn(*scene, cache, programOn(*scene));
        }));
  for (std::size_t i = 0; i < links.size(); ++i) {
    try {
      members.push_back({scenes[i], links[i].get()});
    } catch (const TimeoutError&) {
      throw;
    } catch (const DeviceLostError& error) {
      if (i + 1 == links.size() && members.empty()) throw;
      observer.warning(lossText(scene_->devices[i], error));
    }
  }
  return members;
}

render::RenderSettings RenderJob::rendererSettings() const {
  const RenderRequest& request = job_.request;
  render::RenderSettings settings;
  settings.width = scene_->size.x;
  settings.height = scene_->size.y;
  settings.region = request.region;
  settings.camera = scene_->camera;
  settings.seed = request.seed;
  settings.plannedSamples = request.limits.adaptive ? shared::kIndependentPixels
                                                    : static_cast<std::uint32_t>(request.limits.samples.value_or(0));
  settings.transparent = request.transparent;
  settings.shutter = shutter();
  settings.cameraAt = movingCamera();
  settings.parameters = job_.parameters;
  settings.maxMemory = request.load.maxMemory;
  settings.outputs = request.outputs;
  settings.frameCount = request.frames.accumulatedCount().value_or(0);
  if (request.launchSeconds > 0) settings.launchSeconds = request.launchSeconds;
  settings.timeoutSeconds = request.launchTimeout;
  return settings;
}

void RenderJob::link(program::CompiledProgram compiled, Observer& observer, PendingPipeline* draft) {
  const RenderRequest& request = job_.request;
  render::DeviceScene& scene = *scene_->onDevice;
  deviceCount_ = std::min(deviceCount(observer), scene_->devices.size());
  std::vector<std::filesystem::path> includedFiles = compiled.files;
  const std::vector<Hash> includedHashes = compiled.fileHashes;
  CheckedProgram checked = checkProgram(scene, std::move(compiled));
  const render::Defines defines = render::renderDefines(scene.defines(), request.outputs);
  std::vector<Diagnostic> warnings = std::move(checked.diagnostics);
  std::erase_if(warnings, [](const Diagnostic& d) { return d.severity == Severity::note; });
  if (!warnings.empty()) observer.diagnostics(warnings);

  render::RenderSettings settings = rendererSettings();
  const bool callsPrint = program::prints(checked.runnable.compiled);
  if (!request.print && !printsNoted_ && callsPrint) {
    printsNoted_ = true;
    observer.printsDisabled();
  }
  program::PrintTable table =
      addProbes(checked, engine_.compiler(), defines, requestedProbes(request, job_.program, scene.context().info()));
  std::unique_ptr<PrintLog> prints;
  if (request.print) static_cast<void>(printedPixels(*request.print, printableRegion(settings)));
  if (request.print && table.empty()) {
    observer.note(fmt::format("{}: no shader calls debugPrintfEXT", job_.program.name));
  } else if (request.print) {
    prints = std::make_unique<PrintLog>(scene.context(), *request.print, printableRegion(settings), std::move(table));
    settings.log = &prints->log();
  }
  program::RunnableProgram& runnable = checked.runnable;
  std::unique_ptr<CompleteProgram> complete;
  const bool isProbed = prints || runnable.countsHeat || runnable.countsRecursion;
  if (draft && !isProbed && runnable.recursionDepth == 1 && draft->ready()) {
    complete.reset(
        new CompleteProgram{runnable,
                            {scene.context(), scene.set(), runnable.description, runnable.compiled,
                             engine_.pipelineCache(scene_->devices.front()), PendingPipeline::Launch::none}});
    runnable.compiled.stages = draft->compiled().stages;
  }
  team_ = makeTeam(makeMembers(std::move(runnable), settings, observer));
  complete_ = std::move(complete);
  prints_ = std::move(prints);
  callsPrint_ = callsPrint;
  includedFiles_ = std::move(includedFiles);
  diagnostics_ = std::move(warnings);
  provenance_.programHash = programHash(job_.program, includedHashes);
  ++linkCount_;
}

void RenderJob::setSize(uvec2 size) {
  for (std::size_t i = 0; i < deviceCount_; ++i)
    checkMemory(engine_.context(i).info(), size, job_.program, job_.request.outputs);
  if (team_) changeRenderers([&](render::Renderer& renderer) { renderer.setSize(size); });
  job_.request.size = size;
  job_.request.region = {};
  if (!team_) return;  // update() failed and is repeated by the next run()
  scene_->size = size;
  restart();
  provenanceOutdated_ = true;
}

// The pixels that a request for prints can have.
render::Region RenderJob::printableRegion(const render::RenderSettings& settings) const {
  constexpr std::uint32_t kAnySize = 1u << 20;
  if (printsInAnySize_) return {0, 0, kAnySize, kAnySize};
  return render::decideSettings(settings, job_.program, false).region;
}

void RenderJob::setPrint(std::optional<PrintRequest> print, Observer& observer) {
  assert(job_.request.editable && (!print || print->all || print->pixels.width > 0));
  printsInAnySize_ = true;
  std::swap(job_.request.print, print);
  if (!team_) return;  // update() failed and is repeated by the next run()
  observer.stage(kCompilingStage);
  try {
    team_->finish();
    link(program::compile(job_.program, engine_.compiler(),
                          render::renderDefines(scene_->onDevice->defines(), job_.request.outputs)),
         observer);
  } catch (...) {
    std::swap(job_.request.print, print);
    throw;
  }
  restart();
  provenanceOutdated_ = true;
}

void RenderJob::setProgram(program::Program program, const ProgramRequest& with, Observer& observer) {
  RenderRequest request = job_.request;
  request.outputs = with.outputs;
  request.parameterFile = with.parameterFile;
  request.assignments = with.assignments;
  std::optional<ShutterRequest> suspended;
  if (!request.shutter) request.shutter = suspendedShutter_;
  if (program.accumulation == program::Accumulation::program) suspended = std::exchange(request.shutter, std::nullopt);
  ResolvedJob changed = resolve(std::move(request), std::move(program));
  changed.scene = job_.scene;
  frameOutdated_ = true;  // a program that accumulates has moved the scene to a frame of its own
  if (!team_) {           // update() failed and is repeated by the next run()
    job_ = std::move(changed);
    suspendedShutter_ = suspended;
    return;
  }
  observer.stage(kCompilingStage);
  std::unique_ptr<PendingPipeline> draft;
  program::DraftListener onDraft;
  if (with.draft && canDraft(changed))
    onDraft = [&](program::CompiledProgram compiled) {
      if (!tracesOnlyFromRayGeneration(changed.program, compiled)) return;
      const render::DeviceScene& scene = *scene_->onDevice;
      draft = std::make_unique<PendingPipeline>(scene.context(), scene.set(), changed.program, std::move(compiled),
                                                engine_.pipelineCache(scene_->devices.front()),
                                                PendingPipeline::Launch::empty);
    };
  program::CompiledProgram compiled = program::compile(changed.program, engine_.compiler(),
                                                       render::renderDefines(scene_->onDevice->defines(), with.outputs),
                                                       program::Instrumentation::none, onDraft);
  std::swap(job_, changed);
  try {
    team_->finish();
    link(std::move(compiled), observer, draft.get());
  } catch (...) {
    std::swap(job_, changed);
    throw;
  }
  if (suspended && !suspendedShutter_)
    observer.note(
        fmt::format("{}: without motion blur, because the program averages its frames itself", job_.program.name));
  suspendedShutter_ = suspended;
  // Its any-hit shaders may need other acceleration structures.
  sceneOutdated_ = sceneOutdated_ || scene_->singleAnyHit < program::requiredSingleAnyHit(job_.program);
  restart();
  provenanceOutdated_ = true;
}

// Drivers of GPUs take longer for a module with fewer optimizations, and probes replace the stages.
bool RenderJob::canDraft(const ResolvedJob& job) const {
  return deviceCount_ == 1 && scene_->onDevice->context().info().software && !job.request.print &&
         !program::hasHeatMap(job.program, job.request.outputs);
}

void RenderJob::completeProgram(Observer& observer) {
  if (!complete_ || !team_) return;
  team_->finish();
  complete_->pipeline.ready();
  team_ = makeTeam(makeMembers(complete_->program, rendererSettings(), observer));
  complete_.reset();
  ++linkCount_;
  frameOutdated_ = true;
  restart();
  provenanceOutdated_ = true;
}

Provenance RenderJob::makeProvenance() const {
  const RenderRequest& request = job_.request;
  Provenance p = identityOf(job_, team_->first(), scene_->camera, scene_->size);
  p.programHash = provenance_.programHash;
  // Frames of an animation are different scenes: the film of one does not continue another.
  const bool isStart = frame_ == 0 || !scene_->onDevice->animated();
  p.sceneHash = isStart ? scene_->hash : fmt::format("{}, frame {}", scene_->hash, frame_);
  p.environmentHash = scene_->environmentHash;
  p.commandLine = request.commandLine;
  p.farmPlan = request.farmPlan;
  p.scene = job_.scene.path();
  p.environment = scene_->environment;
  p.camera = scene_->cameraDescription;
  if (scene_->onDevice->animated()) p.framesPerSecond = request.framesPerSecond;
  p.parameters = job_.parameters.describe();
  describeDevices(*team_, p);
  p.targetError = request.limits.error;
  p.limits = describe(request.limits);
  const OutputNotes& notes = request.outputNotes;
  p.exposure = notes.exposure;
  p.toneMap = notes.toneMap;
  p.allOutputs = notes.allOutputs;
  p.layers = notes.layers;
  if (notes.names) {
    p.instanceNames = scene_->instanceNames;
    p.materialNames = scene_->materialNames;
  }
  if (!job_.accumulatesFrames()) {
    const render::CameraMatrices matrices = render::cameraMatrices(scene_->camera, scene_->size.x, scene_->size.y);
    p.worldToCamera = matrices.cameraFromWorld;
    p.worldToNdc = matrices.ndcFromWorld;
  }
  return p;
}

RenderResult RenderJob::makeResult(double seconds, const StartPoint& start, bool withError) const {
  RenderResult result;
  result.provenance = provenance_;
  team_->join();
  result.film = team_->view();
  result.plan = start.plan;
  result.accumulatesFrames = job_.accumulatesFrames();
  result.diagnostics = diagnostics_;
  if (withError && !result.accumulatesFrames) result.error = team_->estimateError();

  const render::Renderer& first = team_->first();
  const render::RenderStatistics& statistics = first.statistics();
  // Checkpoints and previews do not need them.
  const bool isFinal = withError || result.accumulatesFrames;
  if (isFinal) result.skippedTraces = team_->skippedTraces();
  result.recursionDepth = first.linked().recursionDepth();
  setCounts(result, team_->rays(), isFinal ? team_->notFinitePixels() : std::vector<render::NotFinitePixels>());
  Provenance& p = result.provenance;
  p.seconds = seconds;
  p.batchSeconds = start.batchSeconds;
  p.samples = job_.request.limits.adaptive
                  ? static_cast<std::uint64_t>(render::averageSamples(team_->region(), team_->counts()))
                  : (team_->isShared() ? team_->counts().samples() : statistics.samples);
  if (result.error.known()) {
    p.error = result.error.upper;
    p.tileError = result.error.tiles;
  }

  const render::DeviceSceneStatistics& built = scene_->onDevice->statistics();
  Timings& t = result.seconds;
  t = scene_->seconds;
  t.start = engine_.startSeconds();
  t.compile = statistics.compileSeconds;
  t.pipeline = statistics.pipelineSeconds;
  t.firstPixel = firstPixelSeconds_;
  t.render = seconds;
  for (const TeamMember& member : team_->members()) t.device += member.renderer->statistics().deviceSeconds;
  t.stages.insert(t.stages.begin(), {"start", t.start});
  t.stages.insert(t.stages.end(), {{"topLevel", built.topLevelSeconds},
                                   {"compile", t.compile},
                                   {"pipeline", t.pipeline},
                                   {"firstLaunch", statistics.firstLaunchSeconds}});

  MemoryUse& m = result.memory;
  m.peakHost = peakResidentBytes();
  for (std::size_t i = 0; i <= gpu::kPurposeCount; ++i)
    m.devicePeak.emplace_back(i < gpu::kPurposeCount ? gpu::purposeName(static_cast<gpu::Purpose>(i)) : "unused", 0);
  for (const TeamMember& member : team_->members()) {
    const gpu::DeviceMemory device = member.scene->context().memory();
    m.peakDevice += device.peak;
    for (std::size_t i = 0; i < gpu::kPurposeCount; ++i) m.devicePeak[i].second += device.atPeak[i];
    m.devicePeak.back().second += device.unusedAtPeak();
  }
  m.deviceIsHost = scene_->onDevice->context().info().software;
  m.geometry = built.geometryBytes;
  m.textures = built.textureBytes;
  m.acceleration = built.accelerationBytes;
  m.primitiveMaps = built.primitiveMapBytes;
  result.filmBytes = first.film().bytes();
  return result;
}

void RenderJob::beginFilm() {
  start_ = firstSample();
  team_->startAt(start_.begin / render::kBatchSamples);
}

StartPoint RenderJob::firstSample() const {
  StartPoint start;
  if (job_.request.batches) start.begin = start.done = job_.request.batches->first * render::kBatchSamples;
  return start;
}

RenderLimits RenderJob::withinPart(RenderLimits limits) const {
  const RenderRequest& request = job_.request;
  if (!request.batches) return limits;
  // resolve() requires the number of samples of the whole render.
  const std::uint64_t end = std::min(*request.limits.samples, (request.batches->last + 1) * render::kBatchSamples);
  limits.samples = std::min(limits.samples.value_or(end), end);
  return limits;
}

// Where run() begins. The first call resumes from the checkpoint and checks that a film to write loses no samples.
StartPoint RenderJob::startPoint(const RenderLimits& limits, Observer& observer) {
  const RenderRequest& request = job_.request;
  if (std::exchange(started_, true)) return start_;
  beginFilm();
  if (checkpoint_) {
    const render::FilmState empty = team_->view()->state();
    if (const std::optional<StoredFilm> film =
            checkpoint_->load(provenance_, empty, start_, limits, observer, request.load.maxMemory)) {
      team_->restoreFilm(film->file.film);
      start_ = resumePoint(*film, provenance_, request.checkpoint.file, start_, observer);
    }
  }
  if (!request.film.empty() && !request.overwriteFilm) {
    // As far as the number is known now: the samples that are planned, or that exist already.
    const auto begin = static_cast<std::uint32_t>(start_.begin),
               end = static_cast<std::uint32_t>(std::max(limits.samples.value_or(0), start_.done));
    rejectLoss(request.film, toFacts(provenance_, ProvenanceField::Role::identity),
               {{{begin, end}}, team_->counts().cellBatches}, request.load.maxMemory);
  }
  return start_;
}

void RenderJob::discardPrints() {
  if (!prints_) return;
  team_->finish();
  prints_->restart();
}

void RenderJob::flushPrints(Observer& observer) {
  if (!prints_) return;
  team_->finish();
  PrintNumbers numbers;
  numbers.accumulates = job_.accumulatesFrames();
  if (scene_->onDevice->animated()) numbers.frame = static_cast<std::uint32_t>(frame_);
  prints_->flush(observer, numbers);
}

template <class Function>
auto RenderJob::reportingHang(Observer& observer, const Function& function) {
  try {
    return function();
  } catch (const TimeoutError& error) {
    observer.deviceHung(hangDiagnostic(job_.program, error));
    throw;
  }
}

RenderResult RenderJob::run(const RenderLimits& limits, Observer& observer) {
  return reportingHang(observer, [&] {
    update(observer);
    describeEdits();
    if (job_.accumulatesFrames()) return runFrames(limits, observer);
    const FrameRequest& frames = job_.request.frames;
    if (frames.seconds) {
      showRequestedFrame();
      return runFilm(limits, observer);
    }
    if (frames.lastFrame() > 0) requireFrames();
    if (frames.first || frames.lastFrame() > 0 || frames.every) return runAnimation(limits, observer);
    return runFilm(limits, observer);
  });
}

std::optional<double> RenderJob::renderBatch(std::uint64_t samples, Observer& observer) {
  return reportingHang(observer, [&] {
    update(observer);
    const std::optional<double> seconds =
        job_.accumulatesFrames() ? renderNextFrame(samples, observer) : renderFilmBatch(samples, observer);
    if (seconds)
      flushPrints(observer);
    else if (prints_)
      prints_->discard();
    return seconds;
  });
}

std::optional<double> RenderJob::renderFilmBatch(std::uint64_t samples, Observer& observer) {
  assert(!job_.request.batches && !job_.request.limits.adaptive);
  RenderLimits limits;
  limits.samples = samples;
  StartPoint start = startPoint(limits, observer);
  SamplingSchedule schedule(*team_, limits, start);
  if (!schedule.next(0.0)) return 0.0;
  const Stopwatch clock;
  const bool complete =
      schedule.render([&](double /*fraction*/) { return observer.stopRequested() != StopRequest::abandon; });
  team_->finish();
  reportLosses(observer);
  if (!complete && team_->isShared()) restart();
  if (!complete) return std::nullopt;
  start.done = schedule.nextSample();
  start.batchSeconds = clock.seconds();
  start.seconds += start.batchSeconds;
  start_ = start;
  return start.batchSeconds;
}

std::optional<double> RenderJob::renderNextFrame(std::uint64_t count, Observer& observer) {
  if (nextFrame_ >= count) return 0.0;
  const Stopwatch clock;
  if (scene_->onDevice->animated()) scene_->onDevice->setFrame(nextFrame_);
  const bool complete = team_->first().renderFrame(
      nextFrame_, [&](double /*fraction*/) { return observer.stopRequested() != StopRequest::abandon; });
  team_->finish();
  if (!complete) return std::nullopt;
  ++nextFrame_;
  start_.seconds += clock.seconds();
  return clock.seconds();
}

void RenderJob::reportLosses(Observer& observer) const {
  for (const std::string& text : team_->takeWarnings()) observer.warning(text);
}

// How long several devices may render until the next decision about checkpoints and time.
double RenderJob::roundSeconds(const RenderLimits& limits, double elapsed) const {
  double seconds = DeviceTeam::kRoundSeconds;
  if (limits.seconds) seconds = std::min(seconds, std::max(0.0, *limits.seconds - elapsed));
  if (checkpoint_) seconds = std::min(seconds, checkpoint_->request().seconds);
  return seconds;
}

// If several devices fail, nothing is left of their film.
bool RenderJob::renderRound(SamplingSchedule& schedule, const render::BatchProgress& progress) {
  try {
    return schedule.render(progress);
  } catch (...) {
    if (team_->isShared()) forgetSamples();
    throw;
  }
}

RenderResult RenderJob::runFilm(const RenderLimits& requested, Observer& observer) {
  const RenderLimits limits = withinPart(requested);
  StartPoint start = startPoint(limits, observer);
  const bool wasEmpty = start.done == start.begin;
  const Stopwatch clock;
  const auto elapsed = [&, before = start.seconds] { return before + clock.seconds(); };
  SamplingSchedule schedule(*team_, limits, start);
  const auto resultNow = [&](double seconds, bool withError) {
    start.plan = schedule.plan();
    return makeResult(seconds, start, withError);
  };
  const auto finish = [&](double seconds, ReachedLimit reached) {
    RenderResult done = resultNow(seconds, true);
    done.targetMissed = limits.error && !done.error.reaches(*limits.error);
    done.reached = limits.error && !done.targetMissed ? ReachedLimit::error : reached;
    start_ = start;
    start_.seconds = seconds;
    return done;
  };
  const auto timeIsUp = [&](double seconds) {
    return limits.seconds && seconds + 0.5 * start.batchSeconds >= *limits.seconds;
  };
  const auto atTimeLimit = [&] {  // the number of samples may be reached, too
    return limits.samples && start.done >= *limits.samples ? ReachedLimit::samples : ReachedLimit::seconds;
  };
  if (!wasEmpty && timeIsUp(start.seconds)) return finish(start.seconds, atTimeLimit());

  Progress progress;
  progress.sampleLimit = schedule.sampleLimit();
  progress.secondLimit = limits.seconds;
  double rateTaken = 0, rateCost = 0, estimated = 0, estimateSeconds = 0;
  bool abandoned = false, interrupted = false, outOfTime = false, previewed = !wasEmpty;
  while (schedule.next(roundSeconds(limits, elapsed()))) {
    const double begin = elapsed();
    const double before = schedule.samples();
    const bool complete = renderRound(schedule, [&](double fraction) {
      if (firstPixelSeconds_ == 0) firstPixelSeconds_ = clock_.seconds();
      progress.samples = before + fraction * schedule.batchSamples();
      progress.seconds = elapsed();
      if (schedule.estimate()) progress.error = schedule.estimate()->upper;
      progress.targetSamples = schedule.targetSamples();
      observer.progress(progress);
      abandoned = observer.stopRequested() == StopRequest::abandon;
      return !abandoned;
    });
    reportLosses(observer);
    if (!complete || abandoned) {
      if (team_->isShared()) {
        forgetSamples();
      } else {                                             // without the samples of this batch
        if (complete) start.done = schedule.nextSample();  // the last progress of a batch cannot cancel it
        start.plan = schedule.plan();
        start_ = start;
        start_.seconds = complete ? elapsed() : begin;
      }
      RenderResult useless;
      useless.abandoned = true;
      return useless;
    }
    const double now = elapsed();
    if (firstPixelSeconds_ == 0) firstPixelSeconds_ = clock_.seconds();
    start.done = schedule.nextSample();
    start.batchSeconds = (now - begin) / static_cast<double>(team_->roundBatches());
    if (!std::exchange(previewed, true) && observer.wantsPreviews()) observer.preview(resultNow(now, true));
    if (checkpoint_ && checkpoint_->isDue()) checkpoint_->save(resultNow(now, false), observer);
    observer.batch({static_cast<std::uint64_t>(schedule.samples()), now,
                    checkpoint_ ? std::optional(checkpoint_->savedSamples()) : std::nullopt});
    flushPrints(observer);
    if ((outOfTime = timeIsUp(now))) break;
    if (observer.stopRequested() == StopRequest::finish) {
      interrupted = schedule.next(0.0);  // otherwise everything is rendered
      break;
    }
    if (now - rateTaken > std::max(kRateSeconds, kRateShare * rateCost)) {
      progress.raysPerSecond = static_cast<double>(team_->rays().rays) / now;
      rateTaken = now;
      rateCost = elapsed() - now;
    }
    if (observer.showsError() && !limits.error &&
        now - estimated > kEstimateSeconds + kEstimateShare * estimateSeconds) {
      schedule.estimateError();
      estimated = elapsed();
      estimateSeconds = estimated - now;
    }
  }
  team_->finish();
  RenderResult done = finish(elapsed(), outOfTime ? atTimeLimit() : schedule.reached());
  done.interrupted = done.provenance.interrupted = interrupted;
  if (checkpoint_ && checkpoint_->mustStay(done)) checkpoint_->saveIfChanged(done, observer);
  return done;
}

// A program that accumulates: one launch of the image per frame.
RenderResult RenderJob::runFrames(const RenderLimits& limits, Observer& observer) {
  const FrameRequest& frames = job_.request.frames;
  std::optional<std::uint64_t> count = frames.accumulatedCount();
  if (!count) count = limits.samples;
  const Stopwatch clock;
  const auto elapsed = [&, before = start_.seconds] { return before + clock.seconds(); };
  const auto timeIsUp = [&] { return limits.seconds && elapsed() >= *limits.seconds; };
  if ((count && nextFrame_ >= *count) || (nextFrame_ > 0 && timeIsUp())) {
    RenderResult done = result();
    done.reached = count && nextFrame_ >= *count ? ReachedLimit::samples : ReachedLimit::seconds;
    return done;
  }
  Progress progress;
  progress.countsFrames = true;
  progress.sampleLimit = count;
  progress.secondLimit = limits.seconds;
  bool previewed = false;
  double lastPreview = 0;
  for (std::uint32_t frame = nextFrame_;; ++frame) {
    if (scene_->onDevice->animated()) scene_->onDevice->setFrame(frame);
    bool abandoned = false;
    const bool complete = team_->first().renderFrame(frame, [&](double fraction) {
      if (firstPixelSeconds_ == 0) firstPixelSeconds_ = clock_.seconds();
      progress.samples = frame + fraction;
      progress.seconds = elapsed();
      observer.progress(progress);
      abandoned = observer.stopRequested() == StopRequest::abandon;
      return !abandoned;
    });
    if (complete) nextFrame_ = frame + 1;
    start_.seconds = elapsed();
    if (abandoned) {
      RenderResult useless;
      useless.abandoned = true;
      return useless;
    }
    observer.batch({nextFrame_, start_.seconds, std::nullopt});
    flushPrints(observer);
    const bool isComplete = count && nextFrame_ >= *count;
    const bool isLast = isComplete || timeIsUp();
    const bool interrupted = !isLast && observer.stopRequested() == StopRequest::finish;
    const bool preview = !isLast && !interrupted && !frames.every && observer.wantsPreviews() &&
                         (!previewed || elapsed() - lastPreview >= kPreviewSeconds);
    if (!isLast && !interrupted && !frames.every && !preview) continue;
    team_->finish();
    start_.seconds = elapsed();
    RenderResult done = result();
    done.reached = isComplete ? ReachedLimit::samples : ReachedLimit::seconds;
    done.interrupted = done.provenance.interrupted = interrupted;
    if (frames.every) observer.frame(done);
    if (isLast || interrupted) return done;
    if (preview) {
      observer.preview(done);
      previewed = true;
      lastPreview = elapsed();
    }
  }
}

void RenderJob::requireTeam() const {
  if (!team_) throw Error("a change of the scene failed; the next render repeats it");
}

render::Renderer& RenderJob::renderer() {
  requireTeam();
  return team_->first();
}

const render::Region& RenderJob::region() const {
  requireTeam();
  return team_->region();
}

std::shared_ptr<FilmView> RenderJob::film() const {
  requireTeam();
  return team_->view();
}

double RenderJob::sampleCount() const {
  if (!team_) return 0;  // a failed edit has discarded all samples
  if (job_.accumulatesFrames()) return static_cast<double>(team_->first().statistics().samples);
  return render::averageSamples(team_->region(), team_->counts());
}

RenderResult RenderJob::result(bool withError) const {
  requireTeam();
  describeEdits();
  RenderResult result = makeResult(start_.seconds, start_, withError);
  if (job_.accumulatesFrames() && nextFrame_ > 0) result.provenance.frame = nextFrame_ - 1;
  return result;
}

bool RenderJob::resume(const std::filesystem::path& file, Observer& observer) {
  if (job_.accumulatesFrames())
    throw UsageError(fmt::format("the program '{}' averages its samples itself, so checkpoints are not available",
                                 job_.program.name));
  update(observer);
  describeEdits();
  CheckpointRequest request;
  request.file = file;
  request.resume = true;
  RenderLimits limits;
  limits.adaptive = job_.request.limits.adaptive;
  const StartPoint first = firstSample();
  const std::optional<StoredFilm> film = loadCheckpoint(request, provenance_, team_->view()->state(), first,
                                                        withinPart(limits), observer, job_.request.load.maxMemory);
  if (!film) return false;
  restart();
  team_->restoreFilm(film->file.film);
  start_ = resumePoint(*film, provenance_, file, first, observer);
  started_ = true;
  return true;
}

void RenderJob::outputsWritten(const RenderResult& result, Observer& observer) {
  if (checkpoint_ && !checkpoint_->mustStay(result)) checkpoint_->remove(observer);
}

void RenderJob::outputsFailed(const RenderResult& result, Observer& observer) {
  if (checkpoint_) checkpoint_->saveIfChanged(result, observer);
}

std::vector<std::filesystem::path> RenderJob::sceneFiles() const {
  std::vector<std::filesystem::path> files = sourceFiles(scene_->source);
  for (const std::filesystem::path& file : scene_->files)
    if (std::ranges::find(files, file) == files.end()) files.push_back(file);
  std::error_code ignored;
  const std::filesystem::path environment = job_.request.environment.source;
  if (std::filesystem::is_regular_file(environment, ignored)) files.push_back(environment);
  return files;
}

std::vector<std::filesystem::path> RenderJob::programFiles() const {
  std::vector<std::filesystem::path> files = job::programFiles(job_);
  files.insert(files.end(), includedFiles_.begin(), includedFiles_.end());
  return files;
}

std::vector<std::filesystem::path> RenderJob::files() const {
  std::vector<std::filesystem::path> files = sceneFiles();
  for (const std::filesystem::path& file : programFiles()) files.push_back(file);
  return files;
}

}  // namespace quintet::job
