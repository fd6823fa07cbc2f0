// SPDX-License-Identifier: Apache-2.0
#include "gpu/pipeline_store.h"

#include <cassert>
#include <limits>

namespace quintet::gpu {

PipelineStore::~PipelineStore() {
  for (const auto& [key, entry] : entries_) vk_.vkDestroyPipeline(device_, entry.handle, nullptr);
}

VkPipeline PipelineStore::acquire(const Hash& key, const std::function<VkPipeline()>& make) {
  const auto use = [this](Entry& entry) {
    if (entry.users++ == 0) --unused_;
    return entry.handle;
  };
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = entries_.find(key); known != entries_.end()) return use(known->second);
  }
  const VkPipeline made = make();  // takes long, so it runs without the lock
  const std::lock_guard lock(mutex_);
  const auto [known, isNew] = entries_.try_emplace(key, Entry{made, 1, 0});
  if (isNew) return made;
  vk_.vkDestroyPipeline(device_, made, nullptr);  // another thread was faster
  return use(known->second);
}

void PipelineStore::release(const Hash& key) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_.at(key);
  assert(entry.users > 0);
  if (--entry.users > 0) return;
  entry.released = ++releases_;
  if (++unused_ <= kKept) return;
  auto oldest = entries_.end();
  std::uint64_t first = std::numeric_limits<std::uint64_t>::max();
  for (auto e = entries_.begin(); e != entries_.end(); ++e)
    if (e->second.users == 0 && e->second.released < first) oldest = e, first = e->second.released;
  retire_(
      [&vk = vk_, device = device_, handle = oldest->second.handle] { vk.vkDestroyPipeline(device, handle, nullptr); });
  entries_.erase(oldest);
  --unused_;
}

}  // namespace quintet::gpu
