// SPDX-License-Identifier: Apache-2.0
#include "base/memory.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <array>
#include <cstring>
#include <vector>

namespace quintet {
namespace {

TEST(ProcessMemory, CountsTouchedPages) {
  constexpr std::size_t kBytes = std::size_t{64} << 20, kSlack = std::size_t{8} << 20;
  const std::uint64_t before = residentBytes();
  ASSERT_GT(before, 0u);
  void* memory = ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  EXPECT_LT(residentBytes(), before + kSlack);  // reserved, but not touched
  std::memset(memory, 1, kBytes);
  EXPECT_GE(residentBytes() + kSlack, before + kBytes);
  ::munmap(memory, kBytes);
  EXPECT_LT(residentBytes(), before + kSlack);
  EXPECT_GE(peakResidentBytes() + kSlack, before + kBytes);
}

TEST(ProcessMemory, ReleasesWholePagesOnly) {
  constexpr std::size_t kBytes = std::size_t{64} << 20, kSlack = std::size_t{8} << 20;
  std::vector<std::byte> block(kBytes, std::byte{7});
  const std::uint64_t before = residentBytes();
  releasePages(std::span(block).subspan(1, kBytes - 2));
  EXPECT_LT(residentBytes(), before - kBytes + kSlack);
  EXPECT_EQ(block.front(), std::byte{7});
  EXPECT_EQ(block.back(), std::byte{7});
  EXPECT_EQ(block[kBytes / 2], std::byte{0});
  std::array<std::byte, 16> small;
  small.fill(std::byte{3});
  releasePages(small);
  releasePages({});
  EXPECT_EQ(small[8], std::byte{3});
}

}  // namespace
}  // namespace quintet
