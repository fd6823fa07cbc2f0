// The pipelines of a device, each made once: whoever asks for one that exists, or that was given back not long ago,
// gets it. A driver's own caches do not replace this: lavapipe puts a pipeline's group handles, which are new ones each
// time, into the code that it compiles and looks for (docs/design/quirks.md).
#ifndef QUINTET_GPU_PIPELINE_STORE_H
#define QUINTET_GPU_PIPELINE_STORE_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>

#include "base/hash.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

class Context;

// Owned by the Context. From any thread.
class PipelineStore {
 public:
  static constexpr std::size_t kKept = 16;  // pipelines that nobody uses

  PipelineStore(const VolkDeviceTable& vk, VkDevice device) : vk_(vk), device_(device) {}
  ~PipelineStore();
  PipelineStore(const PipelineStore&) = delete;
  PipelineStore& operator=(const PipelineStore&) = delete;

  // `key` says all that `make` depends on. Each acquire() wants a release().
  VkPipeline acquire(const Hash& key, const std::function<VkPipeline()>& make);
  // Keeps it for the next one who asks. Of more than kKept it retires the one that has waited longest.
  void release(Context& context, const Hash& key);

 private:
  struct Entry {
    VkPipeline handle = VK_NULL_HANDLE;
    std::uint32_t users = 0;
    std::uint64_t released = 0;  // when the last of them went
  };
  const VolkDeviceTable& vk_;
  VkDevice device_;
  std::mutex mutex_;
  std::map<Hash, Entry> entries_;
  std::size_t unused_ = 0;
  std::uint64_t releases_ = 0;
};

}  // namespace quintet::gpu
#endif
