// SPDX-License-Identifier: Apache-2.0
#include "job/engine.h"

#include <utility>

#include "base/stopwatch.h"

namespace quintet::job {

Engine::Engine(EngineOptions options) : options_(std::move(options)), compiler_(makeCompiler(options_.caches)) {
  open();
}

void Engine::open() {
  // The default launch policy: if no thread can be started, the device is opened by context().
  opening_ = std::async([this, clock = Stopwatch()] {
    gpu::ContextOptions contextOptions;
    contextOptions.device = options_.device;
    contextOptions.log = options_.log;
    auto context = std::make_unique<gpu::Context>(contextOptions);
    startSeconds_ = clock.seconds();
    return context;
  });
}

gpu::Context& Engine::context() {
  if (!context_ && !opening_.valid()) open();
  if (!context_) context_ = opening_.get();
  return *context_;
}

void Engine::close() {
  opening_ = {};  // waits
  pipelineCache_.reset();
  context_.reset();
}

gpu::PipelineCache& Engine::pipelineCache() {
  if (!pipelineCache_)
    pipelineCache_ = std::make_unique<gpu::PipelineCache>(
        context(), options_.caches.empty() ? std::filesystem::path() : options_.caches / "pipelines");
  return *pipelineCache_;
}

shader::Compiler makeCompiler(const std::filesystem::path& caches) {
  shader::CompilerOptions options;
  if (!caches.empty()) options.cacheFolder = caches / "shaders";
  return shader::Compiler(options);
}

}  // namespace quintet::job
