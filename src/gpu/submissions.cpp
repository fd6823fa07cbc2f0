// SPDX-License-Identifier: Apache-2.0
#include "gpu/submissions.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "gpu/barrier.h"
#include "gpu/error.h"

namespace quintet::gpu {
namespace {

constexpr std::size_t kMaxPending = 64;  // command buffers in flight before submit waits for the oldest

std::uint64_t nanoseconds(double seconds) {
  if (seconds <= 0.0 || seconds > 1e9) return std::numeric_limits<std::uint64_t>::max();
  return static_cast<std::uint64_t>(std::llround(seconds * 1e9));
}

}  // namespace

Submissions::Submissions(const VolkDeviceTable& vk, VkDevice device, VkQueue queue, std::uint32_t queueFamily)
    : vk_(vk), device_(device), queue_(queue), queueFamily_(queueFamily) {
  VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  info.pNext = &type;
  check(vk_.vkCreateSemaphore(device_, &info, nullptr, &timeline_), "create the timeline semaphore");
}

Submissions::~Submissions() {
  for (const auto& slot : slots_) vk_.vkDestroyCommandPool(device_, slot->pool, nullptr);
  vk_.vkDestroySemaphore(device_, timeline_, nullptr);
}

std::uint64_t Submissions::submit(const std::function<void(VkCommandBuffer)>& record,
                                  const FrameSemaphores& semaphores) {
  collect();
  Slot& slot = acquireSlot();
  try {
    check(vk_.vkResetCommandPool(device_, slot.pool, 0), "reset a command pool");
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(vk_.vkBeginCommandBuffer(slot.commands, &begin), "begin a command buffer");
    recordBarrier(vk_, slot.commands, Stage::all, Stage::all);  // see the memory that earlier submissions wrote
    record(slot.commands);
    check(vk_.vkEndCommandBuffer(slot.commands), "end a command buffer");
    const std::lock_guard lock(mutex_);
    enqueue(slot, semaphores);
    closeRecording(slot);
    return slot.value;
  } catch (...) {
    const std::lock_guard lock(mutex_);
    closeRecording(slot);
    throw;
  }
}

void Submissions::enqueue(Slot& slot, const FrameSemaphores& semaphores) {
  const std::uint64_t value = submitted_.load() + 1;
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = slot.commands;
  VkSemaphoreSubmitInfo wait{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  wait.semaphore = semaphores.wait;
  wait.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  VkSemaphoreSubmitInfo signals[2] = {wait, wait};
  signals[0].semaphore = timeline_;
  signals[0].value = value;
  signals[1].semaphore = semaphores.signal;
  VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.waitSemaphoreInfoCount = semaphores.wait ? 1 : 0;
  info.pWaitSemaphoreInfos = &wait;
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &commands;
  info.signalSemaphoreInfoCount = semaphores.signal ? 2 : 1;
  info.pSignalSemaphoreInfos = signals;
  check(vk_.vkQueueSubmit2(queue_, 1, &info, VK_NULL_HANDLE), "submit work to the device");
  submitted_.store(value);
  slot.value = value;
}

void Submissions::closeRecording(Slot& slot) {
  if (!slot.recording) return;
  slot.recording = false;
  if (--openRecordings_ > 0) return;
  for (auto item = retired_.rbegin(); item != retired_.rend() && item->value == kOpen; ++item)
    item->value = submitted_.load();
}

Submissions::Slot& Submissions::acquireSlot() {
  std::unique_lock lock(mutex_);
  for (;;) {
    const std::uint64_t done = completed();
    Slot* oldest = nullptr;
    for (const auto& slot : slots_) {
      if (slot->recording) continue;
      if (!oldest || slot->value < oldest->value) oldest = slot.get();
    }
    if (!oldest || (oldest->value > done && slots_.size() < kMaxPending)) oldest = &addSlot();
    if (oldest->value <= done) {
      oldest->recording = true;
      ++openRecordings_;
      return *oldest;
    }
    const std::uint64_t value = oldest->value;
    lock.unlock();
    reached(value, 0.0);
    lock.lock();
  }
}

Submissions::Slot& Submissions::addSlot() {
  auto slot = std::make_unique<Slot>();
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  pool.queueFamilyIndex = queueFamily_;
  check(vk_.vkCreateCommandPool(device_, &pool, nullptr, &slot->pool), "create a command pool");
  slots_.push_back(std::move(slot));
  Slot& added = *slots_.back();
  VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  info.commandPool = added.pool;
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  const VkResult result = vk_.vkAllocateCommandBuffers(device_, &info, &added.commands);
  if (result != VK_SUCCESS) {
    vk_.vkDestroyCommandPool(device_, added.pool, nullptr);
    slots_.pop_back();
  }
  check(result, "allocate a command buffer");
  return added;
}

bool Submissions::reached(std::uint64_t value, double timeoutSeconds) const {
  VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
  info.semaphoreCount = 1;
  info.pSemaphores = &timeline_;
  info.pValues = &value;
  const VkResult result = vk_.vkWaitSemaphores(device_, &info, nanoseconds(timeoutSeconds));
  check(result, "wait for the device");
  return result == VK_SUCCESS;
}

void Submissions::wait(std::uint64_t value, double timeoutSeconds) {
  assert(value <= submitted());
  if (!reached(value, timeoutSeconds)) {
    longestTimeout_.store(std::max(longestTimeout_.load(), timeoutSeconds));
    throw TimeoutError(timeoutSeconds);
  }
  collect();
}

std::uint64_t Submissions::completed() const {
  std::uint64_t value = 0;
  check(vk_.vkGetSemaphoreCounterValue(device_, timeline_, &value), "query the progress of the device");
  return value;
}

void Submissions::retire(std::function<void()> destroy) {
  {
    const std::lock_guard lock(mutex_);
    retired_.push_back({openRecordings_ > 0 ? kOpen : submitted_.load(), std::move(destroy)});
  }
  collect();
}

// Destructors call this, so it never throws. On a lost device retired objects stay until shutDown.
void Submissions::collect() {
  std::uint64_t done = 0;
  if (vk_.vkGetSemaphoreCounterValue(device_, timeline_, &done) != VK_SUCCESS) return;
  std::deque<Retired> due;
  {
    const std::lock_guard lock(mutex_);
    while (!retired_.empty() && retired_.front().value <= done) {
      due.push_back(std::move(retired_.front()));
      retired_.pop_front();
    }
  }
  for (Retired& item : due) item.destroy();
}

bool Submissions::shutDown() {
  const double timeout = longestTimeout_.load();
  try {
    // After a timeout the device gets the same time once more, so that the process ends even if the device hangs.
    if (timeout > 0.0 && !reached(submitted(), timeout)) return false;
  } catch (const Error&) {
    // The objects of a lost device may be destroyed.
  }
  vk_.vkDeviceWaitIdle(device_);
  while (!retired_.empty()) {
    const std::function<void()> destroy = std::move(retired_.front().destroy);
    retired_.pop_front();
    destroy();
  }
  return true;
}

}  // namespace quintet::gpu
