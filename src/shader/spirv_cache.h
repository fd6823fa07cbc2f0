// SPDX-License-Identifier: Apache-2.0
// Disk cache of SPIR-V with one file per key: "<folder>/<32 hex digits>.qspv". Entries are verified when they are
// read; a corrupt entry counts as missing. Failures to write are ignored.
#ifndef QUINTET_SHADER_SPIRV_CACHE_H
#define QUINTET_SHADER_SPIRV_CACHE_H

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/hash.h"

namespace quintet::shader {

struct SpirvEntry {
  std::vector<std::uint32_t> spirv;
  std::vector<Diagnostic> diagnostics;  // warnings
};

class SpirvCache {
 public:
  static constexpr std::uintmax_t kMaxBytes = std::uintmax_t{256} << 20;

  // An empty folder disables the cache. The folder is created by the first store.
  explicit SpirvCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::optional<SpirvEntry> load(const Hash& key) const;
  void store(const Hash& key, const SpirvEntry& entry) const;

  // Removes the least recently used entries until at most `maxBytes` remain.
  void prune(std::uintmax_t maxBytes = kMaxBytes) const;

 private:
  std::filesystem::path fileOf(const Hash& key) const { return folder_ / (key.hex() + ".qspv"); }
  std::filesystem::path folder_;
  mutable std::atomic<unsigned> stores_{0};
};

}  // namespace quintet::shader
#endif
