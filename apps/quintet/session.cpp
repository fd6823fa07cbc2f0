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
#include "exr_camera.h"
#include "picture_names.h"
#include "program_setup.h"
#include "render/film_error.h"
#include "scene/content_hash.h"
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

std::vector<std::size_t> Session::chosenOutputs() const {
  const std::vector<std::string> names = program::outputNames(program_);
  std::vector<std::size_t> chosen;
  if (options_.allOutputs) {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (program_.outputs[i].pixel != program::OutputPixel::coverage) chosen.push_back(i);
  } else if (options_.outputName.empty()) {
    chosen.push_back(0);
  } else {
    const auto found = std::ranges::find(names, options_.outputName);
    if (found == names.end())
      throw UsageError(fmt::format("--output: the program '{}' has no output '{}'{}; there are {} (-o names the file)",
                                   program_.name, options_.outputName, suggestion(options_.outputName, names),
                                   fmt::join(names, ", ")));
    chosen.push_back(static_cast<std::size_t>(found - names.begin()));
    if (program_.outputs[chosen.back()].pixel == program::OutputPixel::coverage)
      throw UsageError(fmt::format("--output: '{}' counts ids and is no picture: use --aov {}", options_.outputName,
                                   options_.outputName));
  }
  return chosen;
}

std::vector<std::string> Session::wantedOutputs() const {
  std::vector<std::size_t> wanted = chosenOutputs();
  for (const AovLayer& layer : aovs_) wanted.push_back(layer.output);
  std::vector<std::string> names;
  for (const std::size_t output : wanted)
    if (program_.outputs[output].optional) names.push_back(program_.outputs[output].name);
  return names;
}

void Session::write(const RenderOutcome& outcome, std::optional<std::uint32_t> frame) {
  if (outputKind(options_.output) == OutputKind::film) return writeFilm(outcome);
  progress_.stage("writing " + options_.output.string());
  fillRecord(outcome);
  record_.frame = frame ? frame : outcome.frame;
  record_.files.clear();
  for (const std::size_t output : chosenOutputs()) {
    const std::string& name = program_.outputs[output].name;
    const std::filesystem::path file = pictureName(options_.output, options_.allOutputs ? name : "", frame);
    const DisplayOptions display{chooseToneMap(program_.outputs[output], options_), options_.exposure,
                                 !options_.transparent};
    const bool toned = outputKind(file) == OutputKind::png;
    record_.toneMap = toned ? render::toneMapNames()[static_cast<std::size_t>(display.toneMap)] : "";
    record_.outputName = name;
    record_.files.push_back(file.string());
    if (outputKind(file) == OutputKind::exr)
      writeBytes(file, exrFile(output));
    else
      writePicture(file, renderer_->image(output), display, metadata(record_));
  }
  record_.totalSeconds = clock_.seconds();
}

std::vector<std::byte> Session::exrFile(std::size_t output) const {
  io::ExrPicture picture =
      exrPicture(renderer_->film().region(), sceneInfo_.size.x, sceneInfo_.size.y, metadata(record_));
  addCamera(picture, shownCamera(program_, sceneInfo_.camera, sceneInfo_.size));
  const bool exact = !program::holdsColor(program_.outputs[output]);
  addBeauty(picture, renderer_->image(output), options_.transparent, options_.exr.colors, exact);
  const AovSource source = aovSource(*renderer_);
  for (const AovLayer& layer : aovs_) addAov(picture, layer, source, sceneInfo_.names, options_.exr.colors);
  return io::encodeExr(picture, options_.exr.options);
}

void Session::report() {
  if (record_.wantedError && !record_.interrupted && !record_.error.reaches(*record_.wantedError))
    warnings_.add(unreachedText(record_));
  if (record_.droppedSamples > 0)
    warnings_.add(fmt::format("{} samples were not finite and left out", record_.droppedSamples));
  record_.warnings = warnings_.take();
  progress_.clear();
  for (const std::string& warning : record_.warnings) printError("quintet: warning: {}\n", warning);
  if (options_.json) writeFile("-", toJson(record_));
  progress_.note(summary(record_));
}

void Session::fillRecord(const RenderOutcome& outcome) {
  const render::RenderStatistics& statistics = renderer_->statistics();
  const render::DeviceSceneStatistics& built = deviceScene_->statistics();
  const render::RayCount rays = renderer_->rays();
  const render::Region& region = renderer_->film().region();
  record_.commandLine = options_.commandLine;
  record_.scene = sceneSource_.file.empty() ? sceneSource_.name : sceneSource_.file.string();
  record_.sceneHash = sceneInfo_.hash;
  record_.camera = sceneInfo_.cameraDescription;
  record_.environment = sceneInfo_.environment;
  record_.program = program_.name;
  record_.parameters = parameters_.describe();
  record_.exposure = options_.exposure;
  record_.transparent = options_.transparent;
  record_.width = sceneInfo_.size.x;
  record_.height = sceneInfo_.size.y;
  record_.region = {region.x, region.y, region.width, region.height};
  record_.seed = options_.seed;
  record_.samples = options_.adaptive ? outcome.samples : statistics.samples;
  record_.adaptive = options_.adaptive;
  record_.wantedError = options_.error;
  if (program_.accumulation == program::Accumulation::film) record_.error = renderer_->film().estimateError();
  record_.accumulates = program_.accumulation == program::Accumulation::program;
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
  fillLoading();
}

void Session::fillLoading() {
  const render::DeviceSceneStatistics& built = deviceScene_->statistics();
  record_.stages = {{"start", record_.startSeconds},       {"document", sceneInfo_.import.document},
                    {"meshes", sceneInfo_.import.meshes},  {"images", sceneInfo_.import.images},
                    {"hash", sceneInfo_.hashSeconds},      {"view", sceneInfo_.viewSeconds},
                    {"lights", built.lightSeconds},        {"upload", built.uploadSeconds - built.lightSeconds},
                    {"order", built.build.orderSeconds},   {"bottomLevel", built.build.buildSeconds},
                    {"topLevel", built.topLevelSeconds},   {"compile", record_.compileSeconds},
                    {"pipeline", record_.pipelineSeconds}, {"firstLaunch", renderer_->statistics().firstLaunchSeconds}};
  MemoryUse& memory = record_.memory;
  memory.peakHost = peakResidentBytes();
  const gpu::DeviceMemory device = context_->memory();
  memory.peakDevice = device.peak;
  memory.devicePeak.clear();
  for (std::size_t p = 0; p < gpu::kPurposeCount; ++p)
    memory.devicePeak.emplace_back(gpu::purposeName(static_cast<gpu::Purpose>(p)), device.atPeak[p]);
  memory.devicePeak.emplace_back("unused", device.unusedAtPeak());
  memory.deviceIsHost = context_->info().quirks.software;
  memory.geometry = built.geometryBytes;
  memory.textures = built.textureBytes;
  memory.acceleration = built.accelerationBytes + built.primitiveMapBytes;
}

}  // namespace quintet::app
