// SPDX-License-Identifier: Apache-2.0
#include "job/engine.h"

#include <cstdlib>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "base/embedded.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "gpu/device_list.h"
#include "gpu/error.h"

namespace quintet {
std::span<const EmbeddedFile> shippedPrograms();  // src/program/shipped
}

namespace quintet::job {

Engine::Engine(EngineOptions options) : options_(std::move(options)), compiler_(makeCompiler(options_.caches)) {
  open();
}

void Engine::open() {
  // The default launch policy: if no thread can be started, the devices are opened by context().
  opening_ = std::async([this, clock = Stopwatch()] {
    Contexts contexts = openDevices();
    startSeconds_ = clock.seconds();
    return contexts;
  });
}

std::unique_ptr<gpu::Context> Engine::openDevice(const std::string& device) const {
  gpu::ContextOptions contextOptions;
  contextOptions.device = device;
  contextOptions.log = options_.log;
  return std::make_unique<gpu::Context>(contextOptions);
}

Engine::Contexts Engine::openDevices() const {
  const char* preset = std::getenv("QUINTET_DEVICE");
  const std::string request = options_.device.empty() && preset ? preset : options_.device;
  Contexts contexts;
  if (!options_.severalDevices || !gpu::isDeviceList(request)) {
    contexts.push_back(openDevice(options_.device));
    return contexts;
  }
  const std::vector<gpu::DeviceInfo> devices = gpu::Context::devices();
  const std::vector<std::size_t> chosen = gpu::chooseDevices(devices, request, options_.mixedDevices);
  std::vector<std::future<std::unique_ptr<gpu::Context>>> opening;
  for (const std::size_t device : chosen)
    opening.push_back(std::async([this, device] { return openDevice(gpu::requestOf(device)); }));
  std::string failure;
  for (std::size_t i = 0; i < opening.size(); ++i) {
    try {
      contexts.push_back(opening[i].get());
    } catch (const Error& error) {
      if (failure.empty())
        failure = fmt::format("device {} of {} (index {}, {}): {}", i + 1, chosen.size(), chosen[i],
                              devices[chosen[i]].name, error.what());
    }
  }
  if (!failure.empty()) throw gpu::NoDeviceError(failure + "; name the devices to use without it");
  return contexts;
}

void Engine::require() {
  if (!contexts_.empty()) return;
  if (!opening_.valid()) open();
  contexts_ = opening_.get();
  pipelineCaches_.resize(contexts_.size());
}

gpu::Context& Engine::context(std::size_t device) {
  require();
  return *contexts_.at(device);
}

std::size_t Engine::deviceCount() {
  require();
  return contexts_.size();
}

void Engine::close() {
  opening_ = {};  // waits
  pipelineCaches_.clear();
  contexts_.clear();
}

gpu::PipelineCache& Engine::pipelineCache(std::size_t device) {
  gpu::Context& opened = context(device);
  std::unique_ptr<gpu::PipelineCache>& cache = pipelineCaches_.at(device);
  if (!cache)
    cache = std::make_unique<gpu::PipelineCache>(
        opened, options_.caches.empty() ? std::filesystem::path() : options_.caches / "pipelines");
  return *cache;
}

shader::Compiler makeCompiler(const std::filesystem::path& caches) {
  shader::CompilerOptions options;
  if (!caches.empty()) options.cacheFolder = caches / "shaders";
  if (!std::getenv("QUINTET_NO_SHIPPED_SHADERS")) options.shipped = shippedPrograms();
  return shader::Compiler(options);
}

}  // namespace quintet::job
