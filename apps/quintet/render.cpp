// `quintet render`: options, device, scene, batches, picture, report.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <mutex>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "commands.h"
#include "gpu/context.h"
#include "gpu/pipeline_cache.h"
#include "metadata.h"
#include "output.h"
#include "program_setup.h"
#include "progress.h"
#include "render/renderer.h"
#include "render_loop.h"
#include "render_options.h"
#include "scene/content_hash.h"
#include "scene/gltf.h"
#include "scene_setup.h"
#include "shader/compiler.h"
#include "signals.h"
#include "values.h"

namespace quintet::app {
namespace {

// Device memory of the film: the sums of a batch and of the total, RGBA floats.
constexpr std::uint64_t kFilmBytes = 32;
// Host memory of the finished picture: floats and display bytes.
constexpr std::uint64_t kPictureBytes = 20;

// Warnings come from the driver's threads, too; they are kept for the report and shown when the bar is gone.
class Warnings {
 public:
  void add(const std::string& text) {
    const std::lock_guard lock(mutex_);
    texts_.push_back(text);
  }
  std::vector<std::string> texts() const {
    const std::lock_guard lock(mutex_);
    return texts_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> texts_;
};

void checkReadable(const std::filesystem::path& file) {
  if (::access(file.c_str(), R_OK) != 0)
    throw FileError(file, "cannot be read: " + std::generic_category().message(errno));
}

void checkMemory(const gpu::DeviceInfo& device, uvec2 size, std::size_t outputCount) {
  const std::uint64_t pixels = std::uint64_t{size.x} * size.y;
  const std::uint64_t film = pixels * kFilmBytes * std::max<std::size_t>(outputCount, 1);
  const std::uint64_t needed = film + (device.quirks.software ? pixels * kPictureBytes : 0);
  const std::uint64_t room = device.memoryBytes - device.memoryBytes / 16;
  const bool tooLargeBuffer = device.maxBufferBytes > 0 && pixels * kFilmBytes / 2 > device.maxBufferBytes;
  if (needed <= room && !tooLargeBuffer) return;
  throw MemoryError(fmt::format("an image of {}x{} needs {} on {}, which has {} and buffers of at most {}; render parts "
                                "of it with --region",
                                size.x, size.y, bytesText(needed), device.name, bytesText(device.memoryBytes),
                                bytesText(device.maxBufferBytes)));
}

// The steps of one rendering, in order; `record` fills on the way.
class Job {
 public:
  explicit Job(const RenderOptions& options) : options_(options), progress_(options.quiet) {}

  int run() {
    prepare();
    openDevice();
    loadScene();
    upload();
    const GracefulStop stop;
    const RenderOutcome outcome = renderBatches(*renderer_, {options_.samples, options_.seconds}, stop, progress_);
    finish(outcome);
    return stop.exitStatus();
  }

 private:
  // All that can be wrong without a device.
  void prepare() {
    program_ = program::loadProgram(options_.program);
    settings_.parameters = parameterValues(program_, options_);
    settings_.seed = options_.seed;
    settings_.transparent = options_.transparent;
    settings_.region = options_.region;
    display_ = {chooseToneMap(program_, options_), options_.exposure, !options_.transparent};
    checkOutput(options_.output);
    checkReadable(options_.scene);
  }

  void openDevice() {
    gpu::ContextOptions contextOptions;
    contextOptions.device = options_.device;
    contextOptions.log = [this](LogLevel level, const std::string& text) {
      if (level == LogLevel::warning) warnings_.add(text);
    };
    context_ = std::make_unique<gpu::Context>(contextOptions);
    // On a CPU the first launch compiles, and other processes take their share.
    settings_.timeoutSeconds = options_.timeout.value_or(context_->info().quirks.software ? 600.0 : 60.0);
    record_.device = context_->info().name;
    record_.driver = context_->info().driver;
    record_.startSeconds = clock_.seconds();
    checkMemory(context_->info(), picturePart(options_.size), program_.outputs.size());
  }

  // The size of what is rendered, as far as it is known by then.
  uvec2 picturePart(uvec2 size) const {
    return options_.region.width > 0 ? uvec2{options_.region.width, options_.region.height} : size;
  }

  void loadScene() {
    progress_.stage("loading " + options_.scene.filename().string());
    const Stopwatch watch;
    scene_ = scene::loadGltf(options_.scene);
    record_.sceneHash = scene::contentHash(scene_).hex();
    const uvec2 asked = options_.size;
    const float aspect = asked.y > 0 ? static_cast<float>(asked.x) / static_cast<float>(asked.y) : 0.0f;
    const ChosenCamera camera = chooseCamera(scene_, options_.camera, aspect);
    const uvec2 size = chooseSize(asked, camera.camera);
    environment_ = chooseEnvironment(scene_, options_.environment);
    checkMemory(context_->info(), picturePart(size), program_.outputs.size());
    settings_.camera = camera.camera;
    settings_.width = size.x;
    settings_.height = size.y;
    record_.camera = camera.description;
    record_.environment = environment_.description;
    record_.loadSeconds = watch.seconds();
    describeScene();
  }

  void describeScene() {
    const std::string name = options_.scene.filename().string();
    if (outputKind(options_.output) != OutputKind::png && (options_.toneMap || options_.exposure != 0))
      progress_.note(fmt::format("{}: linear radiance, --exposure and --tonemap do not apply", options_.output.string()));
    if (environment_.isDefault)
      progress_.note(fmt::format("{}: nothing gives light, taking the default environment (--env none for darkness)", name));
    if (scene_.instances.empty()) warnings_.add(fmt::format("{}: the scene shows no surface", name));
    const scene::Report& report = scene_.report;
    const std::size_t ignored = report.ignored.size() + report.extensionsIgnored.size();
    if (ignored + report.repaired.size() > 0)
      progress_.note(fmt::format("{}: {} ignored, {} repaired; 'quintet info {}' says what", name, ignored,
                                 report.repaired.size(), shellQuoted(options_.scene.string())));
  }

  void upload() {
    progress_.stage("building acceleration structures");
    const Stopwatch watch;
    deviceScene_ = std::make_unique<render::DeviceScene>(*context_, scene_, environment_.environment);
    record_.buildSeconds = watch.seconds();
    scene_ = {};  // on the device by now
    environment_.environment = {};

    progress_.stage("compiling shaders");
    const std::filesystem::path cache = cacheFolder();
    const auto part = [&cache](const char* name) { return cache.empty() ? cache : cache / name; };
    shader::CompilerOptions compilerOptions;
    compilerOptions.cacheFolder = part("shaders");
    compiler_ = std::make_unique<shader::Compiler>(compilerOptions);
    pipelineCache_ = std::make_unique<gpu::PipelineCache>(*context_, part("pipelines"));
    renderer_ = std::make_unique<render::Renderer>(*deviceScene_, program_, *compiler_, pipelineCache_.get(), settings_);
    startedRendering_ = clock_.seconds();
  }

  void finish(const RenderOutcome& outcome) {
    progress_.stage("writing " + options_.output.string());
    fillRecord(outcome);
    if (record_.droppedSamples > 0)
      warnings_.add(fmt::format("{} samples were not finite and left out", record_.droppedSamples));
    writePicture(options_.output, renderer_->image(0), display_, metadata(record_));
    record_.totalSeconds = clock_.seconds();
    record_.warnings = warnings_.texts();
    progress_.clear();
    for (const std::string& warning : record_.warnings) fmt::print(stderr, "quintet: warning: {}\n", warning);
    if (options_.json) writeFile("-", toJson(record_));
    progress_.note(summary(record_));
  }

  void fillRecord(const RenderOutcome& outcome) {
    const render::RenderStatistics& statistics = renderer_->statistics();
    const render::DeviceSceneStatistics& built = deviceScene_->statistics();
    const render::RayCount rays = renderer_->rays();
    const render::Region& region = renderer_->film().region();
    record_.commandLine = options_.commandLine;
    record_.output = options_.output.string();
    record_.scene = options_.scene.string();
    record_.program = program_.name;
    record_.parameters = settings_.parameters.describe();
    if (outputKind(options_.output) == OutputKind::png) record_.toneMap = render::toneMapNames()[static_cast<std::size_t>(display_.toneMap)];
    record_.exposure = display_.exposure;
    record_.transparent = options_.transparent;
    record_.width = settings_.width;
    record_.height = settings_.height;
    record_.region = {region.x, region.y, region.width, region.height};
    record_.seed = options_.seed;
    record_.samples = statistics.samples;
    record_.rays = rays.rays;
    record_.droppedSamples = rays.droppedSamples;
    record_.interrupted = outcome.interrupted;
    record_.compileSeconds = statistics.compileSeconds;
    record_.pipelineSeconds = statistics.pipelineSeconds;
    record_.firstPixelSeconds = startedRendering_ + outcome.firstPixelSeconds;
    record_.renderSeconds = outcome.seconds;
    record_.deviceSeconds = statistics.deviceSeconds;
    record_.geometryBytes = built.geometryBytes;
    record_.textureBytes = built.textureBytes;
    record_.accelerationBytes = built.accelerationBytes;
    record_.filmBytes = renderer_->film().bytes();
  }

  const RenderOptions& options_;
  const Stopwatch clock_;
  Progress progress_;
  Warnings warnings_;
  RenderRecord record_;
  DisplayOptions display_;
  double startedRendering_ = 0;  // on clock_

  program::Program program_;
  render::RenderSettings settings_;
  scene::Scene scene_;
  ChosenEnvironment environment_;
  std::unique_ptr<gpu::Context> context_;  // outlives all that follows
  std::unique_ptr<render::DeviceScene> deviceScene_;
  std::unique_ptr<shader::Compiler> compiler_;
  std::unique_ptr<gpu::PipelineCache> pipelineCache_;
  std::unique_ptr<render::Renderer> renderer_;
};

}  // namespace

int renderCommand(Arguments arguments) {
  const std::optional<RenderOptions> options = parseRenderOptions(arguments);
  if (!options) return 0;
  if (options->programHelp) {
    writeFile("-", programHelp(program::loadProgram(options->program)));
    return 0;
  }
  return Job(*options).run();
}

}  // namespace quintet::app
