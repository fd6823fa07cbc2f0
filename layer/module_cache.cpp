// SPDX-License-Identifier: Apache-2.0
#include "module_cache.h"

namespace quintet::layer {
namespace {

std::size_t bytesOf(const CachedStage& stage) {
  return sizeof stage + stage.module.spirv.size() * sizeof(std::uint32_t) + stage.module.problem.size();
}

}  // namespace

std::optional<CachedStage> ModuleCache::find(const Hash& key) {
  const std::scoped_lock lock(mutex_);
  const auto found = byKey_.find(key);
  if (found == byKey_.end()) return {};
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->second;
}

void ModuleCache::add(const Hash& key, const CachedStage& stage) {
  const std::scoped_lock lock(mutex_);
  if (byKey_.contains(key)) return;
  entries_.emplace_front(key, stage);
  byKey_[key] = entries_.begin();
  bytes_ += bytesOf(stage);
  while (bytes_ > maxBytes_ && !entries_.empty()) {
    bytes_ -= bytesOf(entries_.back().second);
    byKey_.erase(entries_.back().first);
    entries_.pop_back();
  }
}

}  // namespace quintet::layer
