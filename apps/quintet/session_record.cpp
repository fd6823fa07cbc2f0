// What the session knows of its rendering, for the pictures' metadata, films and --json.
#include "base/memory.h"
#include "render/film_error.h"
#include "session.h"

namespace quintet::app {

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
