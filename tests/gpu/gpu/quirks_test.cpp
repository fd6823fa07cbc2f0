// SPDX-License-Identifier: Apache-2.0
// Driver defects that the environment variables of prepareDriverEnvironment() work around (docs/design/quirks.md). With
// QUINTET_NO_DRIVER_WORKAROUNDS=1 the tests show whether a driver still has them.
#include <gtest/gtest.h>

#include "harness.h"

namespace quintet::gpu {
namespace {

// lavapipe 25.0.7 with LLVM 15 on CPUs with AVX-512 loses the masks of this expression, which swaps the pixels of 64 ×
// 8 blocks, and writes outside the image.
TEST(GpuQuirks, KeepsIntegerMasks) {
  struct Pair {
    std::uint32_t x, y;
  };
  constexpr std::uint32_t kWidth = 512;
  const auto swizzled = test::runCompute<Pair>(R"(
    #define Out uvec2
    Out run(uint index) {
      uint x = index % 512u, y = index / 512u;
      return uvec2(((x >> 6) * 8u + (y & 7u)) * 8u + (x & 7u), (y & ~7u) + ((x & 63u) >> 3));
    }
  )",
                                               kWidth * 512);
  std::size_t wrong = 0;
  for (std::uint32_t i = 0; i < swizzled.size(); ++i) {
    const std::uint32_t x = i % kWidth, y = i / kWidth;
    if (swizzled[i].x != ((x >> 6) * 8 + (y & 7)) * 8 + (x & 7) || swizzled[i].y != (y & ~7u) + ((x & 63) >> 3))
      ++wrong;
  }
  EXPECT_EQ(wrong, 0u);
}

// Signed and unsigned shifts, masks and multiplications of many widths.
TEST(GpuQuirks, ComputesIntegersLikeTheHost) {
  struct Values {
    std::uint32_t a, b, c, d;
  };
  const auto results = test::runCompute<Values>(R"(
    struct Out { uint a, b, c, d; };
    uint hash(uint x) { x ^= x >> 16; x *= 0x7feb352du; x ^= x >> 15; x *= 0x846ca68bu; return x ^ (x >> 16); }
    Out run(uint i) {
      uint h = hash(i);
      return Out(h, uint(int(h) >> int(i & 31u)), (h & ~(0xFFu << (i & 15u))) + ((h >> 7) & 63u) * 3u,
                 bitfieldExtract(h, int(i & 15u), 9) ^ (h << (i & 7u)));
    }
  )",
                                                1 << 18);
  std::size_t wrong = 0;
  for (std::uint32_t i = 0; i < results.size(); ++i) {
    std::uint32_t h = i;
    h ^= h >> 16, h *= 0x7feb352du, h ^= h >> 15, h *= 0x846ca68bu, h ^= h >> 16;
    const Values expected = {h, static_cast<std::uint32_t>(static_cast<std::int32_t>(h) >> (i & 31)),
                             (h & ~(0xFFu << (i & 15))) + ((h >> 7) & 63) * 3,
                             ((h >> (i & 15)) & 511) ^ (h << (i & 7))};
    const Values& r = results[i];
    if (r.a != expected.a || r.b != expected.b || r.c != expected.c || r.d != expected.d) ++wrong;
  }
  EXPECT_EQ(wrong, 0u);
}

}  // namespace
}  // namespace quintet::gpu
