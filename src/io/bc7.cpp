// SPDX-License-Identifier: Apache-2.0
// BC7 (Khronos Data Format Specification 1.3, section 20.1).
#include <algorithm>
#include <utility>

#include "io/block_decode.h"
#include "io/bptc.h"

namespace quintet::io {
namespace {

// Numbers of bits of each mode (Table 111).
struct Mode {
  std::uint32_t subsets, partition, rotation, indexSelection, color, alpha;
  bool endpointP, sharedP;  // an additional lowest bit for each endpoint, or for both endpoints of a subset
  std::uint32_t index, secondIndex;
};
constexpr std::array<Mode, 8> kModes{{
    {3, 4, 0, 0, 4, 0, true, false, 3, 0},
    {2, 6, 0, 0, 6, 0, false, true, 3, 0},
    {3, 6, 0, 0, 5, 0, false, false, 2, 0},
    {2, 6, 0, 0, 7, 0, true, false, 2, 0},
    {1, 0, 2, 1, 5, 6, false, false, 2, 3},
    {1, 0, 2, 0, 7, 8, false, false, 2, 2},
    {1, 0, 0, 0, 7, 7, true, false, 4, 0},
    {2, 6, 0, 0, 5, 5, true, false, 2, 0},
}};

struct Endpoints {
  std::array<std::array<std::uint32_t, 4>, 6> values{};  // by subset and end, RGBA
};

// Extends `bits` bits to 8 by repeating the highest ones.
std::uint32_t extend(std::uint32_t value, std::uint32_t bits) {
  value <<= 8 - bits;
  return value | value >> bits;
}

Endpoints readEndpoints(const Mode& mode, BlockBits& bits) {
  Endpoints endpoints;
  const std::uint32_t count = 2 * mode.subsets;
  for (std::size_t c = 0; c < 4; ++c)
    for (std::uint32_t e = 0; e < count; ++e) endpoints.values[e][c] = bits.read(c < 3 ? mode.color : mode.alpha);
  const std::uint32_t p = mode.endpointP || mode.sharedP ? 1 : 0;
  std::uint32_t shared = 0;
  for (std::uint32_t e = 0; e < count && p > 0; ++e) {
    if (mode.endpointP || e % 2 == 0) shared = bits.read(1);
    for (std::uint32_t& value : endpoints.values[e]) value = value << 1 | shared;
  }
  for (std::uint32_t e = 0; e < count; ++e) {
    for (std::size_t c = 0; c < 3; ++c) endpoints.values[e][c] = extend(endpoints.values[e][c], mode.color + p);
    endpoints.values[e][3] = mode.alpha == 0 ? 255 : extend(endpoints.values[e][3], mode.alpha + p);
  }
  return endpoints;
}

}  // namespace

void decodeBc7Block(const std::byte* block, std::uint8_t* rgba) {
  BlockBits bits(block);
  std::uint32_t number = 0;
  while (number < kModes.size() && bits.read(1) == 0) ++number;
  if (number == kModes.size()) {  // reserved: transparent black
    std::fill_n(rgba, 64, std::uint8_t{0});
    return;
  }
  const Mode& mode = kModes[number];
  const std::uint32_t partition = bits.read(mode.partition), rotation = bits.read(mode.rotation);
  const bool swapIndices = bits.read(mode.indexSelection) != 0;
  const Endpoints endpoints = readEndpoints(mode, bits);
  std::array<std::uint32_t, 16> first{}, second{};
  for (std::uint32_t i = 0; i < 16; ++i)
    first[i] = bits.read(mode.index - (isAnchor(mode.subsets, partition, i) ? 1 : 0));
  for (std::uint32_t i = 0; i < 16 && mode.secondIndex > 0; ++i)
    second[i] = bits.read(mode.secondIndex - (i == 0 ? 1 : 0));

  for (std::uint32_t i = 0; i < 16; ++i) {
    const std::uint32_t subset = subsetOf(mode.subsets, partition, i);
    const auto &a = endpoints.values[2 * subset], &b = endpoints.values[2 * subset + 1];
    const std::pair primary(first[i], mode.index), other(second[i], mode.secondIndex);
    const auto color = swapIndices ? other : primary;
    const auto alpha = mode.secondIndex == 0 || swapIndices ? primary : other;
    std::uint8_t* texel = rgba + 4 * i;
    for (std::size_t c = 0; c < 4; ++c) {
      const auto& [index, size] = c < 3 ? color : alpha;
      texel[c] = static_cast<std::uint8_t>(
          interpolate(static_cast<std::int32_t>(a[c]), static_cast<std::int32_t>(b[c]), index, size));
    }
    if (rotation > 0) std::swap(texel[3], texel[rotation - 1]);
  }
}

}  // namespace quintet::io
