// SPDX-License-Identifier: Apache-2.0
// The hash of Hasher().add(bytes) for bytes that are not in memory at once.
#ifndef QUINTET_BASE_STREAM_HASH_H
#define QUINTET_BASE_STREAM_HASH_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "base/hash.h"

namespace quintet {

class StreamHash {
 public:
  // `bytes`: their total number, which is part of the hash.
  explicit StreamHash(std::uint64_t bytes);
  ~StreamHash();
  StreamHash(const StreamHash&) = delete;
  StreamHash& operator=(const StreamHash&) = delete;

  void add(std::span<const std::byte> bytes);
  // Equals Hasher().add(all bytes).finish() once all bytes are added.
  Hash finish() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace quintet
#endif
