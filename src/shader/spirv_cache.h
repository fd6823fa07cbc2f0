// SPIR-V on disk, one file per key: "<folder>/<32 hex digits>.qspv". Entries are verified when read;
// a broken one counts as absent. Failures to write cost nothing but the cache.
#ifndef QUINTET_SHADER_SPIRV_CACHE_H
#define QUINTET_SHADER_SPIRV_CACHE_H

#include <atomic>

#include "base/hash.h"
#include "shader/compiler.h"

namespace quintet::shader {

struct SpirvEntry {
  std::vector<std::uint32_t> spirv;
  std::vector<Diagnostic> diagnostics;  // warnings
};

class SpirvCache {
 public:
  static constexpr std::uintmax_t kMaxBytes = std::uintmax_t{256} << 20;

  // `folder` empty: no cache. It is made on the first store.
  explicit SpirvCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::optional<SpirvEntry> load(const Hash& key) const;
  void store(const Hash& key, const SpirvEntry& entry) const;

  // Removes the entries that were not used for longest until at most `maxBytes` remain.
  void prune(std::uintmax_t maxBytes = kMaxBytes) const;

 private:
  std::filesystem::path fileOf(const Hash& key) const { return folder_ / (key.hex() + ".qspv"); }
  std::filesystem::path folder_;
  mutable std::atomic<unsigned> stores_{0};
};

}  // namespace quintet::shader
#endif
