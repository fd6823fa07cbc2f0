// SPDX-License-Identifier: Apache-2.0
// Cache of SPIR-V on disk, with one file per key: "<folder>/<32 hex digits>.qspv". Entries are verified when they are
// read; a corrupt entry counts as missing. Failures to write are ignored. Without a folder it is in memory.
#ifndef QUINTET_SHADER_SPIRV_CACHE_H
#define QUINTET_SHADER_SPIRV_CACHE_H

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <mutex>
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
  static constexpr std::uintmax_t kMaxBytes = std::uintmax_t{256} << 20;         // on disk
  static constexpr std::uintmax_t kMaxBytesInMemory = std::uintmax_t{32} << 20;  // without a folder

  // With an empty folder, entries are kept in memory, up to kMaxBytesInMemory. The folder is created by the first store.
  // All functions are thread-safe.
  explicit SpirvCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::optional<SpirvEntry> load(const Hash& key) const;
  void store(const Hash& key, const SpirvEntry& entry) const;

  // Removes the least recently used files until at most `maxBytes` remain.
  void prune(std::uintmax_t maxBytes = kMaxBytes) const;

 private:
  std::filesystem::path fileOf(const Hash& key) const { return folder_ / (key.hex() + ".qspv"); }
  std::optional<SpirvEntry> loadFile(const Hash& key) const;
  void storeFile(const Hash& key, const SpirvEntry& entry) const;
  std::optional<SpirvEntry> loadFromMemory(const Hash& key) const;
  void storeInMemory(const Hash& key, const SpirvEntry& entry) const;

  // Entries in memory, the most recently used first.
  using Entries = std::list<std::pair<Hash, SpirvEntry>>;

  std::filesystem::path folder_;
  mutable std::atomic<unsigned> stores_{0};
  mutable std::mutex mutex_;  // of the members below
  mutable Entries entries_;
  mutable std::map<Hash, Entries::iterator> byKey_;
  mutable std::uintmax_t bytes_ = 0;  // of entries_
};

}  // namespace quintet::shader
#endif
