// SPDX-License-Identifier: Apache-2.0
#include "base/stream_hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace quintet {
namespace {

TEST(StreamHashTest, EqualsTheHashOfAllBytes) {
  std::vector<std::byte> bytes(100'000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7 + i / 256);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{17}, bytes.size()})
    for (const std::size_t step : {std::size_t{1}, std::size_t{999}, std::size_t{200'000}}) {
      const std::span all = std::span(bytes).first(size);
      StreamHash hash(size);
      for (std::size_t at = 0; at < size; at += step) hash.add(all.subspan(at, std::min(step, size - at)));
      EXPECT_EQ(hash.finish().hex(), Hasher().add(std::span<const std::byte>(all)).finish().hex())
          << size << " " << step;
    }
}

}  // namespace
}  // namespace quintet
