// SPDX-License-Identifier: Apache-2.0
#include "base/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <new>

namespace quintet {

struct Hasher::State {
  State() : xxh(XXH3_createState()) {
    if (!xxh || XXH3_128bits_reset(xxh) == XXH_ERROR) throw std::bad_alloc();
  }
  ~State() { XXH3_freeState(xxh); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  XXH3_state_t* xxh;
};

std::string Hash::hex() const { return fmt::format("{:016x}{:016x}", high, low); }

Hasher::Hasher() : state_(std::make_unique<State>()) {}
Hasher::~Hasher() = default;
Hasher::Hasher(Hasher&&) noexcept = default;
Hasher& Hasher::operator=(Hasher&&) noexcept = default;

Hasher& Hasher::add(std::string_view text) { return add(std::as_bytes(std::span(text.data(), text.size()))); }

Hasher& Hasher::add(std::span<const std::byte> bytes) {
  return add(static_cast<std::uint64_t>(bytes.size())).append(bytes);
}

Hasher& Hasher::append(std::span<const std::byte> part) {
  if (!part.empty()) XXH3_128bits_update(state_->xxh, part.data(), part.size());
  return *this;
}

// Little-endian on every host, so that names in a shared cache agree.
Hasher& Hasher::add(std::uint64_t value) {
  std::array<std::uint8_t, 8> bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  return append(std::as_bytes(std::span(bytes)));
}

Hash Hasher::finish() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return {hash.high64, hash.low64};
}

}  // namespace quintet
