// SPDX-License-Identifier: Apache-2.0
// Submissions to the queue: recycled command buffers, the timeline semaphore that counts submissions, and the objects
// to destroy after the work that may use them.
#ifndef QUINTET_GPU_SUBMISSIONS_H
#define QUINTET_GPU_SUBMISSIONS_H

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "gpu/present/frame_semaphores.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

// Thread-safe. `record` is called without the lock, so it can use the context in any way.
class Submissions {
 public:
  Submissions(const VolkDeviceTable& vk, VkDevice device, VkQueue queue, std::uint32_t queueFamily);
  ~Submissions();  // call shutDown first
  Submissions(const Submissions&) = delete;
  Submissions& operator=(const Submissions&) = delete;

  // These functions are documented in Context.
  std::uint64_t submit(const std::function<void(VkCommandBuffer)>& record, const FrameSemaphores& semaphores);
  void wait(std::uint64_t value, double timeoutSeconds);
  std::uint64_t completed() const;
  std::uint64_t submitted() const { return submitted_.load(); }
  void retire(std::function<void()> destroy);

  // Waits for all work and destroys all retired objects. Returns false if the device hangs: a wait has timed out and
  // the work has not ended since. Then nothing was destroyed, and nothing may be.
  bool shutDown();

 private:
  // One command buffer with its pool. It can be reused when `value` is reached.
  struct Slot {
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    std::uint64_t value = 0;
    bool recording = false;
  };
  struct Retired {
    std::uint64_t value;  // kOpen until the open recordings are submitted
    std::function<void()> destroy;
  };
  static constexpr std::uint64_t kOpen = ~std::uint64_t{0};

  Slot& acquireSlot();
  Slot& addSlot();
  void enqueue(Slot& slot, const FrameSemaphores& semaphores);
  void closeRecording(Slot& slot);  // requires the lock
  void collect();
  bool reached(std::uint64_t value, double timeoutSeconds) const;

  const VolkDeviceTable& vk_;
  VkDevice device_;
  VkQueue queue_;
  std::uint32_t queueFamily_;
  VkSemaphore timeline_ = VK_NULL_HANDLE;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Slot>> slots_;
  std::deque<Retired> retired_;
  unsigned openRecordings_ = 0;
  std::atomic<std::uint64_t> submitted_{0};
  std::atomic<double> longestTimeout_{0.0};  // seconds, of the waits that timed out
};

}  // namespace quintet::gpu
#endif
