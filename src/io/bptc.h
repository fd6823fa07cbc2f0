// SPDX-License-Identifier: Apache-2.0
// Private to src/io: what BC6H and BC7 share (Khronos Data Format Specification 1.3, chapter 20): bits of a block (also
// those of UASTC), partitions of its texels, interpolation.
#ifndef QUINTET_IO_BPTC_H
#define QUINTET_IO_BPTC_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace quintet::io {

// Reads the 128 bits of a block from the lowest one on.
class BlockBits {
 public:
  explicit BlockBits(const std::byte* block) {
    for (std::size_t i = 0; i < 16; ++i) words_[i / 8] |= std::to_integer<std::uint64_t>(block[i]) << (8 * (i % 8));
  }
  // At most 32 bits.
  std::uint32_t read(std::uint32_t count) {
    const std::uint64_t value = words_[0] & ((std::uint64_t{1} << count) - 1);
    words_[0] = words_[0] >> count | words_[1] << 1 << (63 - count);
    words_[1] >>= count;
    return static_cast<std::uint32_t>(value);
  }

 private:
  std::array<std::uint64_t, 2> words_{};  // those that remain, the next one lowest
};

// Subset of a texel of 16, in rows, for 1 to 3 subsets.
std::uint32_t subsetOf(std::uint32_t subsets, std::uint32_t partition, std::uint32_t texel);
// Texel of a subset whose index has one bit less, because its highest bit is 0.
std::uint32_t anchorOf(std::uint32_t subsets, std::uint32_t partition, std::uint32_t subset);
inline bool isAnchor(std::uint32_t subsets, std::uint32_t partition, std::uint32_t texel) {
  return anchorOf(subsets, partition, subsetOf(subsets, partition, texel)) == texel;
}

// (a · (64 - w) + b · w + 32) / 64 with the weight of an index of 2, 3 or 4 bits.
std::int32_t interpolate(std::int32_t a, std::int32_t b, std::uint32_t index, std::uint32_t bits);

}  // namespace quintet::io
#endif
