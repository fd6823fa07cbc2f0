// SPDX-License-Identifier: Apache-2.0
#include "base/stream_hash.h"

#include <array>
#include <new>

#include <xxhash.h>

namespace quintet {

struct StreamHash::State {
  State() : xxh(XXH3_createState()) {
    if (!xxh || XXH3_128bits_reset(xxh) == XXH_ERROR) throw std::bad_alloc();
  }
  ~State() { XXH3_freeState(xxh); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  XXH3_state_t* xxh;
};

StreamHash::StreamHash(std::uint64_t bytes) : state_(std::make_unique<State>()) {
  std::array<std::uint8_t, 8> size;  // little-endian, as Hasher adds it
  for (std::size_t i = 0; i < size.size(); ++i) size[i] = static_cast<std::uint8_t>(bytes >> (8 * i));
  XXH3_128bits_update(state_->xxh, size.data(), size.size());
}

StreamHash::~StreamHash() = default;

void StreamHash::add(std::span<const std::byte> bytes) {
  if (!bytes.empty()) XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size());
}

Hash StreamHash::finish() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return {hash.high64, hash.low64};
}

}  // namespace quintet
