// The session from the options to the linked program: what is checked, loaded, built and compiled. What becomes of it is
// in session_pictures.cpp, session_film.cpp and session_record.cpp.
#include "session.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "diagnostics_view.h"
#include "program_setup.h"
#include "scene/names.h"
#include "standard_error.h"
#include "values.h"

namespace quintet::app {
namespace {

// Device memory of the largest buffer of a film: sums of four channels.
constexpr std::uint64_t kSumBytes = 4 * sizeof(shared::FixedSum);
// Host memory of the finished picture: floats and display bytes.
constexpr std::uint64_t kPictureBytes = 20;

void checkMemory(const gpu::DeviceInfo& device, uvec2 size, std::uint64_t filmBytesPerPixel) {
  const std::uint64_t pixels = std::uint64_t{size.x} * size.y;
  const std::uint64_t film = pixels * filmBytesPerPixel;
  const std::uint64_t needed = film + (device.quirks.software ? pixels * kPictureBytes : 0);
  const std::uint64_t room = device.memoryBytes - device.memoryBytes / 16;
  const bool tooLargeBuffer = device.maxBufferBytes > 0 && pixels * kSumBytes > device.maxBufferBytes;
  if (needed <= room && !tooLargeBuffer) return;
  throw MemoryError(fmt::format(
      "an image of {}x{} needs {} on {}, which has {} and buffers of at most {}; render parts "
      "of it with --region",
      size.x, size.y, bytesText(needed), device.name, bytesText(device.memoryBytes), bytesText(device.maxBufferBytes)));
}

}  // namespace

bool isProgramSource(const std::filesystem::path& name) {
  constexpr std::string_view kExtensions[] = {".toml",  ".glsl",  ".h",     ".rgen", ".rint",
                                              ".rahit", ".rchit", ".rmiss", ".rcall"};
  return !name.string().starts_with('.') &&
         std::ranges::find(kExtensions, name.extension().string()) != std::end(kExtensions);
}

Session::Session(const RenderOptions& options)
    : options_(options), progress_(options.quiet || options.farm.jsonProgress) {}

void Session::prepare() {
  earlyShaders_ = {};  // of a program as it was; waits for it
  program_ = program::loadProgram(options_.program);
  parameters_ = parameterValues(program_, options_);
  if (options_.adaptive && !program_.adaptive)
    throw UsageError(
        fmt::format("--adaptive: the program '{}' takes the same samples in all pixels (docs/programs.md: adaptive)",
                    program_.name));
  if (options_.error && program_.accumulation == program::Accumulation::program)
    throw UsageError(fmt::format(
        "--until-error: the program '{}' averages its samples itself, their spread is not known", program_.name));
  chosenOutputs();
  aovs_ = chooseAovs(program_, options_.aovs);
  checkChannels(aovs_);
  checkOutput(options_.output);
  SceneSource source = chooseScene(options_.scene, program_);
  if (source != sceneSource_) sceneLoaded_ = false;
  sceneSource_ = std::move(source);
}

void Session::openDevice() {
  loading_.start(sceneSource_, options_);  // goes on while the driver starts
  gpu::ContextOptions contextOptions;
  contextOptions.device = options_.device;
  contextOptions.log = [this](LogLevel level, const std::string& text) {
    if (level == LogLevel::warning) warnings_.add(text);
  };
  context_ = std::make_unique<gpu::Context>(contextOptions);
  record_.device = context_->info().name;
  record_.driver = context_->info().driver;
  record_.startSeconds = clock_.seconds();
  checkSizes(picturePart(options_.size));

  const std::filesystem::path cache = cacheFolder();
  const auto part = [&cache](const char* name) { return cache.empty() ? cache : cache / name; };
  shader::CompilerOptions compilerOptions;
  compilerOptions.cacheFolder = part("shaders");
  compiler_ = std::make_unique<shader::Compiler>(compilerOptions);
  pipelineCache_ = std::make_unique<gpu::PipelineCache>(*context_, part("pipelines"));
  compileEarly();
}

// Beside the reading, uploading and building of the scene. Its errors are told by link(), after those of the scene.
void Session::compileEarly() {
  earlyShaders_ = std::async(std::launch::async, [this, features = loading_.features(), settings = settings()] {
    return render::compileShaders(program_, *compiler_, settings,
                                  render::shaderDefines(features.get(), context_->info().quirks));
  });
}

void Session::checkSizes(uvec2 size) const {
  checkMemory(context_->info(), size, render::Film::bytesPerPixel(program_, wantedOutputs()));
  if (outputKind(options_.output) == OutputKind::exr)
    io::checkExrSize(size.x, size.y, channelCount(aovs_, 4), options_.exr.options.tileSize);
}

// The size of what is rendered, as far as it is known by then.
uvec2 Session::picturePart(uvec2 size) const {
  return options_.region.width > 0 ? uvec2{options_.region.width, options_.region.height} : size;
}

void Session::loadScene() {
  progress_.stage("loading " + sceneSource_.name);
  LoadedScene loaded = loading_.finish(sceneSource_, options_);
  SceneInfo info;
  info.import = loaded.scene.seconds;
  info.hash = loaded.hash;
  info.hashSeconds = loaded.hashSeconds;
  info.files = loaded.scene.report.files;
  info.camera = loaded.camera.camera;
  info.cameraDescription = loaded.camera.description;
  info.environment = loaded.environment.description;
  info.environmentHash = loaded.environmentHash;
  info.size = loaded.size;
  info.viewSeconds = loaded.viewSeconds;
  info.loadSeconds = loaded.seconds;
  checkSizes(picturePart(info.size));
  if (!aovs_.empty()) info.names = {scene::instanceNames(loaded.scene), scene::materialNames(loaded.scene)};
  describe(loaded.scene, loaded.environment);

  progress_.stage("building acceleration structures");
  const Stopwatch building;
  auto built =
      std::make_unique<render::DeviceScene>(*context_, std::move(loaded.scene), loaded.environment.environment);
  renderer_.reset();
  deviceScene_ = std::move(built);
  sceneInfo_ = std::move(info);
  sceneLoaded_ = true;
  record_.loadSeconds = sceneInfo_.loadSeconds;
  record_.buildSeconds = building.seconds();
  loaded = {};
  returnFreedMemory();
}

void Session::describe(const scene::Scene& scene, const ChosenEnvironment& environment) {
  const std::string& name = sceneSource_.name;
  const std::string unshown = unshownText(options_.output, options_.toneMap || options_.exposure != 0);
  if (!unshown.empty()) progress_.note(unshown);
  const bool usesLight = program_.accumulation == program::Accumulation::film;  // lecture programs bring their own
  if (environment.isDefault && usesLight)
    progress_.note(
        fmt::format("{}: nothing gives light, taking the default environment (--env none for darkness)", name));
  if (scene.instances.empty()) warnings_.add(fmt::format("{}: the scene shows no surface", name));
  const scene::Report& report = scene.report;
  const std::size_t ignored = report.ignored.size() + report.extensionsIgnored.size();
  if (ignored + report.repaired.size() > 0)
    progress_.note(fmt::format("{}: {} ignored, {} repaired; 'quintet info {}' says what", name, ignored,
                               report.repaired.size(), shellQuoted(sceneSource_.file.string())));
}

render::RenderSettings Session::settings() const {
  render::RenderSettings settings;
  settings.width = sceneInfo_.size.x;
  settings.height = sceneInfo_.size.y;
  settings.region = options_.region;
  settings.camera = sceneInfo_.camera;
  settings.seed = options_.seed;
  settings.plannedSamples =
      options_.adaptive ? shared::kIndependentPixels : static_cast<std::uint32_t>(options_.samples.value_or(0));
  settings.transparent = options_.transparent;
  settings.parameters = parameters_;
  settings.outputs = wantedOutputs();
  settings.frameCount = options_.drawnFrames.value_or(0);
  // On a CPU the first launch compiles, and other processes take their share.
  settings.timeoutSeconds = options_.timeout.value_or(context_->info().quirks.software ? 600.0 : 60.0);
  return settings;
}

void Session::link() {
  progress_.stage("compiling shaders");
  render::RenderSettings wanted = settings();
  render::CompiledShaders early;
  if (earlyShaders_.valid()) {
    early = earlyShaders_.get();
    wanted.compiled = &early;
  }
  renderer_ = std::make_unique<render::Renderer>(*deviceScene_, program_, *compiler_, pipelineCache_.get(), wanted);
  startedRendering_ = clock_.seconds();
  identity_.clear();
  // Pictures of parameters may be edited while a long rendering goes on: they were read now.
  if (options_.farm.checkpointSeconds || outputKind(options_.output) == OutputKind::film) identity();
  std::vector<shader::Diagnostic> found = renderer_->diagnostics();
  std::erase_if(found, [](const shader::Diagnostic& d) { return d.severity == shader::Severity::note; });
  record_.diagnostics = found;
  if (!found.empty()) tell(found);
}

void Session::tell(const std::vector<shader::Diagnostic>& diagnostics) {
  progress_.clear();
  const bool failed = hasErrors(diagnostics);
  if (failed && options_.json) {
    writeFile("-", diagnosticsJson(diagnostics));
  } else {
    printError("{}", diagnosticsText(diagnostics, sourcesOf(program_), colorOnStandardError()));
  }
  if (failed) printError("quintet: {}: {}\n", plain(program_.name), countText(diagnostics));
}

void Session::beginFrame(std::uint32_t frame) {
  if (deviceScene_->animated()) deviceScene_->setFrame(static_cast<float>(frame));
  if (program_.accumulation == program::Accumulation::film) renderer_->restart();
}

std::vector<std::filesystem::path> Session::sceneFiles() const {
  std::vector<std::filesystem::path> files = app::sceneFiles(sceneSource_);
  for (const std::filesystem::path& file : sceneInfo_.files)
    if (std::ranges::find(files, file) == files.end()) files.push_back(file);
  std::error_code ignored;
  const std::filesystem::path environment = options_.environment.source;
  if (std::filesystem::is_regular_file(environment, ignored)) files.push_back(environment);
  return files;
}

std::vector<std::filesystem::path> Session::files() const {
  std::vector<std::filesystem::path> files = sceneFiles();
  for (const auto& [name, text] : program_.files)
    if (isProgramSource(name)) files.emplace_back(program_.path(name));
  for (const program::ImageValue& image : parameters_.images())
    if (!image.file.empty()) files.emplace_back(image.ofProgram ? program_.path(image.file) : image.file);
  if (!options_.setFile.empty()) files.push_back(options_.setFile);
  if (renderer_) files.insert(files.end(), renderer_->files().begin(), renderer_->files().end());
  std::erase_if(files, [](const auto& file) { return file.string().starts_with('<'); });  // in memory
  return files;
}

}  // namespace quintet::app
