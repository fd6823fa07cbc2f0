// SPDX-License-Identifier: Apache-2.0
// 128-bit content hash (XXH3) for the names of cache entries and for the scene hash in image metadata. It is not
// cryptographic.
#ifndef QUINTET_BASE_HASH_H
#define QUINTET_BASE_HASH_H

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace quintet {

struct Hash {
  std::uint64_t high = 0;
  std::uint64_t low = 0;
  auto operator<=>(const Hash&) const = default;
  std::string hex() const;  // 32 lowercase digits
};

// Hashes a sequence of values. The length of each string is hashed too, so ("ab", "c") and ("a", "bc") differ.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(Hasher&&) noexcept;
  Hasher& operator=(Hasher&&) noexcept;
  Hasher& add(std::string_view text);
  Hasher& add(std::span<const std::byte> bytes);
  Hasher& add(std::uint64_t value);
  // Without its length: the next part of bytes that are not in memory at once. add(n), with their total number n, followed by all
  // parts equals add(bytes).
  Hasher& append(std::span<const std::byte> part);
  Hash finish() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace quintet
#endif
