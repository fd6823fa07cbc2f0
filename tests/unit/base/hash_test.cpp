// SPDX-License-Identifier: Apache-2.0
#include "base/hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace quintet {
namespace {

// The values are part of file names and image metadata, so they must not change between versions.
TEST(HashTest, IsStable) {
  EXPECT_EQ(Hasher().finish().hex(), "99aa06d3014798d86001c324468d497f");  // XXH3-128 of no data, from its test vectors
  EXPECT_EQ(Hasher().add("quintet").add(std::uint64_t{5}).finish(),
            Hasher().add("quintet").add(std::uint64_t{5}).finish());
}

TEST(HashTest, SeparatesStringsByTheirLength) {
  EXPECT_NE(Hasher().add("ab").add("c").finish(), Hasher().add("a").add("bc").finish());
  EXPECT_NE(Hasher().add("").finish(), Hasher().finish());
  EXPECT_NE(Hasher().add("").add("a").finish(), Hasher().add("a").add("").finish());
}

TEST(HashTest, DependsOnEveryBit) {
  const std::vector<std::byte> zeros(100);
  const Hash expected = Hasher().add(zeros).finish();
  for (std::size_t bit = 0; bit < 800; ++bit) {
    std::vector<std::byte> changed = zeros;
    changed[bit / 8] = static_cast<std::byte>(1 << bit % 8);
    EXPECT_NE(Hasher().add(changed).finish(), expected) << bit;
  }
}

TEST(HashTest, PartsHaveTheHashOfAllBytes) {
  std::vector<std::byte> bytes(100'000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7 + i / 256);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{17}, bytes.size()})
    for (const std::size_t step : {std::size_t{1}, std::size_t{999}, std::size_t{200'000}}) {
      const std::span all = std::span(bytes).first(size);
      Hasher hash;
      hash.add(std::uint64_t{size});
      for (std::size_t at = 0; at < size; at += step) hash.append(all.subspan(at, std::min(step, size - at)));
      EXPECT_EQ(hash.finish(), Hasher().add(std::span<const std::byte>(all)).finish()) << size << " " << step;
    }
}

TEST(HashTest, ContinuesAfterFinishAndMove) {
  Hasher hasher;
  const Hash a = hasher.add("a").finish();
  EXPECT_EQ(hasher.finish(), a);
  Hasher moved = std::move(hasher);
  EXPECT_EQ(moved.add("b").finish(), Hasher().add("a").add("b").finish());
}

TEST(HashTest, PrintsLeadingZeros) { EXPECT_EQ((Hash{0x1, 0xab}).hex(), "000000000000000100000000000000ab"); }

}  // namespace
}  // namespace quintet
