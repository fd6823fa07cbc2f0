// SPDX-License-Identifier: Apache-2.0
// Stages that were prepared for the check, by the SPIR-V, the entry point and the constants: engines create their pipelines again
// when a material changes, with thousands of modules that stay the same. Thread-safe.
#ifndef QUINTET_LAYER_MODULE_CACHE_H
#define QUINTET_LAYER_MODULE_CACHE_H

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "base/hash.h"
#include "check/pipeline_graph.h"

namespace quintet::layer {

struct CachedStage {
  check::ModuleStage module;  // without its name
  std::uint64_t recordBytes = 0;
  bool indexByRecord = false;
};

class ModuleCache {
 public:
  static constexpr std::size_t kDefaultBytes = std::size_t{64} << 20;
  explicit ModuleCache(std::size_t maxBytes = kDefaultBytes) : maxBytes_(maxBytes) {}

  std::optional<CachedStage> find(const Hash& key);
  // Drops the stages that were not used for the longest time, if all together have too many bytes.
  void add(const Hash& key, const CachedStage& stage);

 private:
  using Entry = std::pair<Hash, CachedStage>;

  const std::size_t maxBytes_;
  std::mutex mutex_;
  std::list<Entry> entries_;  // the last one was not used for the longest time
  std::map<Hash, std::list<Entry>::iterator> byKey_;
  std::size_t bytes_ = 0;
};

}  // namespace quintet::layer
#endif
