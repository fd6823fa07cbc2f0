// SPDX-License-Identifier: Apache-2.0
// The devices with their compiler and caches. Jobs that run one after the other share an engine.
#ifndef QUINTET_JOB_ENGINE_H
#define QUINTET_JOB_ENGINE_H

#include <cstddef>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/log.h"
#include "gpu/context.h"
#include "gpu/pipeline_cache.h"
#include "shader/compiler.h"

namespace quintet::job {

struct EngineOptions {
  std::string device;                            // gpu::ContextOptions::device; with `severalDevices` also a list
  std::filesystem::path caches = cacheFolder();  // compiled shaders and pipelines; empty: in memory
  LogSink log = {};                              // driver messages; called from any thread
  // `device`, or $QUINTET_DEVICE if it is empty, can be a list (gpu/device_list.h). Otherwise a list is a UsageError, and
  // the first device of a list in $QUINTET_DEVICE is opened.
  bool severalDevices = false;
  bool mixedDevices = false;  // a list can have devices of different kinds (gpu::isSameKind)
};

class Engine {
 public:
  // Opens the devices in the background, side by side; errors are thrown by context().
  explicit Engine(EngineOptions options);
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  // Waits for the devices, and returns the first one. Throws gpu::NoDeviceError, gpu::VulkanError, UsageError; a later call
  // then tries to open them again.
  gpu::Context& context() { return context(0); }
  // The same for any of them.
  gpu::Context& context(std::size_t device);
  std::size_t deviceCount();  // at least 1
  // Closes the devices, for example because one was lost; the next context() opens them again. All objects that use them
  // must have been destroyed.
  void close();
  const shader::Compiler& compiler() const { return compiler_; }
  gpu::PipelineCache& pipelineCache(std::size_t device = 0);  // not from several threads

  // Wall clock from the engine's construction until the devices were open, seconds; 0 before.
  double startSeconds() const { return startSeconds_; }

 private:
  using Contexts = std::vector<std::unique_ptr<gpu::Context>>;
  void open();
  Contexts openDevices() const;
  std::unique_ptr<gpu::Context> openDevice(const std::string& device) const;
  void require();  // waits for the devices

  const EngineOptions options_;
  shader::Compiler compiler_;
  double startSeconds_ = 0;
  Contexts contexts_;
  std::vector<std::unique_ptr<gpu::PipelineCache>> pipelineCaches_;  // per device; created when needed
  std::future<Contexts> opening_;                                    // last: its thread uses the members above
};

// A compiler with the cache of `caches` (EngineOptions::caches), for checks that need no device.
shader::Compiler makeCompiler(const std::filesystem::path& caches);

}  // namespace quintet::job
#endif
