// SPDX-License-Identifier: Apache-2.0
// The device with its compiler and caches. Jobs that run one after the other share an engine.
#ifndef QUINTET_JOB_ENGINE_H
#define QUINTET_JOB_ENGINE_H

#include <filesystem>
#include <future>
#include <memory>
#include <string>

#include "base/file.h"
#include "base/log.h"
#include "gpu/context.h"
#include "gpu/pipeline_cache.h"
#include "shader/compiler.h"

namespace quintet::job {

struct EngineOptions {
  std::string device;                            // gpu::ContextOptions::device
  std::filesystem::path caches = cacheFolder();  // compiled shaders and pipelines; empty: in memory
  LogSink log = {};                              // driver messages; called from any thread
};

class Engine {
 public:
  // Opens the device in the background; errors are thrown by context().
  explicit Engine(EngineOptions options);
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  // Waits for the device. Throws gpu::NoDeviceError, gpu::VulkanError; a later call then tries to open it again.
  gpu::Context& context();
  // Closes the device, for example because it was lost; the next context() opens it again. All objects that use it must
  // have been destroyed.
  void close();
  const shader::Compiler& compiler() const { return compiler_; }
  gpu::PipelineCache& pipelineCache();

  // Wall clock from the engine's construction until the device was open, seconds; 0 before.
  double startSeconds() const { return startSeconds_; }

 private:
  void open();

  const EngineOptions options_;
  shader::Compiler compiler_;
  double startSeconds_ = 0;
  std::unique_ptr<gpu::Context> context_;
  std::unique_ptr<gpu::PipelineCache> pipelineCache_;
  std::future<std::unique_ptr<gpu::Context>> opening_;  // last: its thread uses the members above
};

// A compiler with the cache of `caches` (EngineOptions::caches), for checks that need no device.
shader::Compiler makeCompiler(const std::filesystem::path& caches);

}  // namespace quintet::job
#endif
