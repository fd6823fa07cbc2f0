// SPDX-License-Identifier: Apache-2.0
// Creates each pipeline of a device once and shares it; recently released pipelines are kept. Caches of drivers do not
// replace this: lavapipe compiles the group handles of a pipeline, which differ each time, into its code, so its cache
// never finds the pipeline (docs/design/quirks.md).
#ifndef QUINTET_GPU_PIPELINE_STORE_H
#define QUINTET_GPU_PIPELINE_STORE_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

#include "base/hash.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

// Owned by the Context. Thread-safe.
class PipelineStore {
 public:
  static constexpr std::size_t kKept = 16;  // unused pipelines

  // Calls a function after the work that is submitted so far has ended (Context::retire).
  using Retire = std::function<void(std::function<void()> destroy)>;

  PipelineStore(const VolkDeviceTable& vk, VkDevice device, Retire retire)
      : vk_(vk), device_(device), retire_(std::move(retire)) {}
  ~PipelineStore();
  PipelineStore(const PipelineStore&) = delete;
  PipelineStore& operator=(const PipelineStore&) = delete;

  // Returns the pipeline of `key`, which must identify everything that `make` depends on. Each acquire() needs a
  // release().
  VkPipeline acquire(const Hash& key, const std::function<VkPipeline()>& make);
  // Ends a use. If more than kKept pipelines are unused, the one that was released first is retired.
  void release(const Hash& key);

 private:
  struct Entry {
    VkPipeline handle = VK_NULL_HANDLE;
    std::uint32_t users = 0;
    std::uint64_t released = 0;  // number of the release that ended the last use
  };
  const VolkDeviceTable& vk_;
  VkDevice device_;
  Retire retire_;
  std::mutex mutex_;
  std::map<Hash, Entry> entries_;
  std::size_t unused_ = 0;
  std::uint64_t releases_ = 0;
};

}  // namespace quintet::gpu
#endif
