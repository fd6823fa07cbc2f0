// SPDX-License-Identifier: Apache-2.0
// UASTC LDR 4x4 (Khronos Data Format Specification 1.4, chapter 25). Colors are those of linear textures, as the reference
// transcoder writes them; the rule for sRGB would change the lowest bit.
#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "io/block_decode.h"
#include "io/bptc.h"

namespace quintet::io {
namespace {

// Subset of each texel, in rows. Bit i of `anchors`: texel i is the first one of its subset, and the highest bit of its
// weight is 0 and not stored.
struct UastcPattern {
  std::array<std::uint8_t, 16> subset{};
  std::uint32_t anchors = 0;
};

template <std::size_t N, class SubsetOf>
constexpr std::array<UastcPattern, N> makePatterns(SubsetOf subsetOf) {
  std::array<UastcPattern, N> patterns{};
  for (std::size_t p = 0; p < N; ++p)
    for (std::uint32_t i = 0, seen = 0; i < 16; ++i) {
      const std::uint32_t subset = subsetOf(p, i);
      patterns[p].subset[i] = static_cast<std::uint8_t>(subset);
      if ((seen >> subset & 1) == 0) patterns[p].anchors |= 1u << i;
      seen |= 1u << subset;
    }
  return patterns;
}

// Bit i: texel i is in subset 1. Patterns of modes 2, 4, 9 and 16, and of mode 7.
constexpr std::array<std::uint16_t, 30> kHalves{0xCCCC, 0x8888, 0x1111, 0xECC8, 0x377F, 0xFEEC, 0x0137, 0x137F,
                                                0xC800, 0x0013, 0xFE80, 0x17FF, 0x0017, 0x00FF, 0xFFF0, 0x0FFF,
                                                0xFF71, 0x8EFF, 0x08CE, 0x008C, 0x7310, 0xCEFF, 0x7331, 0x088C,
                                                0xCEEF, 0x6666, 0xF00F, 0x5555, 0x0F0F, 0x36C9};
constexpr std::array<std::uint16_t, 19> kHalvesOfMode7{0x00F0, 0x4444, 0x0133, 0xCC80, 0xF0FF, 0x2222, 0xFFC8,
                                                       0xCCCE, 0x3C03, 0x00EE, 0x7700, 0x3003, 0x00CE, 0xFF80,
                                                       0x6FFF, 0x1333, 0x11FF, 0x136C, 0x00EF};
// Digit i: subset of texel i. Patterns of mode 3.
constexpr std::array<std::string_view, 11> kThirds{"0000000011221122", "1111111100002222", "1111000000002222",
                                                   "1111222200000000", "1120112011201120", "0112011201120112",
                                                   "0211021102110211", "2000200021112111", "2012201220122012",
                                                   "1111000022221111", "0022001100110022"};

constexpr auto kWhole = makePatterns<1>([](std::size_t, std::uint32_t) { return 0u; });
constexpr auto kTwoParts =
    makePatterns<kHalves.size()>([](std::size_t p, std::uint32_t i) { return kHalves[p] >> i & 1u; });
constexpr auto kTwoPartsOfMode7 =
    makePatterns<kHalvesOfMode7.size()>([](std::size_t p, std::uint32_t i) { return kHalvesOfMode7[p] >> i & 1u; });
constexpr auto kThreeParts = makePatterns<kThirds.size()>(
    [](std::size_t p, std::uint32_t i) { return static_cast<std::uint32_t>(kThirds[p][i] - '0'); });

// Bits of the fields of each mode, in the order of the block.
struct UastcMode {
  std::uint32_t code, codeBits;
  std::uint32_t hintBits;  // of transcoders to BC1, ETC1 and ETC2
  std::span<const UastcPattern> patterns;
  std::uint32_t patternBits;
  std::uint32_t selectorBits;  // of the channel with a weight of its own
  std::uint32_t subsets;
  std::uint32_t channels;  // of endpoints: RGB, RGBA, or 2 for luminance and alpha
  // An endpoint is a digit of this radix (1: none), then bits.
  std::uint32_t radix, endpointBits;
  std::uint32_t planes, weightBits;
};
constexpr std::uint32_t kSolid = 8;
constexpr std::uint32_t kOpaqueHints = 15, kShortHints = 17, kAlphaHints = 23;
constexpr std::array<UastcMode, 19> kUastcModes{{
    {0x01, 4, kOpaqueHints, kWhole, 0, 0, 1, 3, 3, 6, 1, 4},
    {0x35, 6, kOpaqueHints, kWhole, 0, 0, 1, 3, 1, 8, 1, 2},
    {0x1D, 5, kOpaqueHints, kTwoParts, 5, 0, 2, 3, 1, 4, 1, 3},
    {0x03, 5, kOpaqueHints, kThreeParts, 4, 0, 3, 3, 3, 2, 1, 2},
    {0x13, 5, kOpaqueHints, kTwoParts, 5, 0, 2, 3, 5, 3, 1, 2},
    {0x0B, 5, kOpaqueHints, kWhole, 0, 0, 1, 3, 1, 8, 1, 3},
    {0x1B, 5, kOpaqueHints, kWhole, 0, 2, 1, 3, 5, 5, 2, 2},
    {0x07, 5, kOpaqueHints, kTwoPartsOfMode7, 5, 0, 2, 3, 5, 3, 1, 2},
    {0x17, 5, 0, kWhole, 0, 0, 0, 0, 1, 0, 0, 0},
    {0x0F, 5, kAlphaHints, kTwoParts, 5, 0, 2, 4, 1, 4, 1, 2},
    {0x02, 3, kShortHints, kWhole, 0, 0, 1, 4, 3, 4, 1, 4},
    {0x00, 2, kShortHints, kWhole, 0, 2, 1, 4, 3, 4, 2, 2},
    {0x06, 3, kShortHints, kWhole, 0, 0, 1, 4, 3, 6, 1, 3},
    {0x1F, 5, kAlphaHints, kWhole, 0, 2, 1, 4, 1, 8, 2, 1},
    {0x0D, 5, kAlphaHints, kWhole, 0, 0, 1, 4, 1, 8, 1, 2},
    {0x05, 7, kAlphaHints, kWhole, 0, 0, 1, 2, 1, 8, 1, 4},
    {0x15, 6, kAlphaHints, kTwoParts, 5, 0, 2, 2, 1, 8, 1, 2},
    {0x25, 6, kAlphaHints, kWhole, 0, 0, 1, 2, 1, 8, 2, 2},
    {0x09, 4, kOpaqueHints, kWhole, 0, 0, 1, 3, 1, 5, 1, 5},
}};

// Index of the mode by the lowest 7 bits of the block. Others are reserved or invalid.
constexpr std::uint8_t kNoMode = 255;
constexpr auto kModeOfBits = [] {
  std::array<std::uint8_t, 128> modes{};
  modes.fill(kNoMode);
  for (std::size_t m = 0; m < kUastcModes.size(); ++m)
    for (std::uint32_t bits = kUastcModes[m].code; bits < modes.size(); bits += 1u << kUastcModes[m].codeBits)
      modes[bits] = static_cast<std::uint8_t>(m);
  return modes;
}();

constexpr std::uint8_t repeatBits(std::uint32_t value, std::uint32_t bits) {
  std::uint32_t result = 0, filled = 0;
  for (; filled < 8; filled += bits) result = result << bits | value;
  return static_cast<std::uint8_t>(result >> (filled - 8));
}

// Endpoint from its digit and bits, with 8 bits: the scaling of ASTC for the combinations that UASTC uses.
constexpr std::uint8_t scaleEndpoint(std::uint32_t radix, std::uint32_t bits, std::uint32_t digit,
                                     std::uint32_t value) {
  const std::uint32_t a = value & 1 ? 511 : 0, x = value >> 1;
  std::uint32_t b = 0, c = 0;
  if (radix == 3 && bits == 2) b = x << 8 | x << 4 | x << 2 | x << 1, c = 93;
  if (radix == 3 && bits == 4) b = x << 6 | x, c = 22;
  if (radix == 3 && bits == 6) b = x << 4 | x >> 4, c = 5;
  if (radix == 5 && bits == 3) b = x << 7 | x << 1 | x >> 1, c = 26;
  if (radix == 5 && bits == 5) b = x << 5 | x >> 3, c = 6;
  return static_cast<std::uint8_t>((a & 128) | ((digit * c + b) ^ a) >> 2);
}

// By mode, then digit << endpointBits | bits.
constexpr auto kEndpoints = [] {
  std::array<std::array<std::uint8_t, 256>, kUastcModes.size()> tables{};
  for (std::size_t m = 0; m < tables.size(); ++m) {
    const UastcMode& mode = kUastcModes[m];
    if (m == kSolid) continue;
    for (std::uint32_t v = 0; v < mode.radix << mode.endpointBits; ++v)
      tables[m][v] = mode.radix == 1 ? repeatBits(v, mode.endpointBits)
                                     : scaleEndpoint(mode.radix, mode.endpointBits, v >> mode.endpointBits,
                                                     v & ((1u << mode.endpointBits) - 1));
  }
  return tables;
}();

// Weight of the second endpoint in 64ths, by number of bits and index.
constexpr auto kUastcWeights = [] {
  std::array<std::array<std::uint8_t, 32>, 6> tables{};
  for (std::uint32_t bits = 1; bits < tables.size(); ++bits)
    for (std::uint32_t v = 0; v < 1u << bits; ++v) {
      const std::uint32_t weight = repeatBits(v, bits) >> 2;
      tables[bits][v] = static_cast<std::uint8_t>(weight > 32 ? weight + 1 : weight);
    }
  return tables;
}();

constexpr std::size_t kMostEndpoints = 18;  // of mode 3

// Digits come first, several in a number: 5 of radix 3 in 8 bits, 3 of radix 5 in 7 bits.
std::array<std::uint8_t, kMostEndpoints> readEndpointValues(std::size_t number, BlockBits& bits) {
  constexpr std::array<std::uint32_t, 6> kBitsOfDigits3{0, 2, 4, 5, 7, 8}, kBitsOfDigits5{0, 3, 5, 7};
  const UastcMode& mode = kUastcModes[number];
  const std::uint32_t count = 2 * mode.subsets * mode.channels, together = mode.radix == 3 ? 5 : 3;
  std::array<std::uint32_t, kMostEndpoints> digits{};
  for (std::uint32_t first = 0; mode.radix > 1 && first < count; first += together) {
    const std::uint32_t here = std::min(together, count - first);
    std::uint32_t packed = bits.read((mode.radix == 3 ? kBitsOfDigits3 : kBitsOfDigits5)[here]);
    for (std::uint32_t i = first; i < first + here; ++i, packed /= mode.radix) digits[i] = packed % mode.radix;
  }
  std::array<std::uint8_t, kMostEndpoints> values{};
  for (std::uint32_t i = 0; i < count; ++i)
    values[i] = kEndpoints[number][digits[i] << mode.endpointBits | bits.read(mode.endpointBits)];
  return values;
}

void fillBlock(std::uint8_t* rgba, std::array<std::uint8_t, 4> color) {
  for (std::size_t i = 0; i < 16; ++i) std::ranges::copy(color, rgba + 4 * i);
}

}  // namespace

void decodeUastcBlock(const std::byte* block, std::uint8_t* rgba) {
  constexpr std::array<std::uint8_t, 4> kInvalid{255, 0, 255, 255};
  BlockBits bits(block);
  const std::size_t number = kModeOfBits[std::to_integer<std::size_t>(block[0]) & 127];
  if (number == kNoMode) return fillBlock(rgba, kInvalid);
  const UastcMode& mode = kUastcModes[number];
  bits.read(mode.codeBits);
  if (number == kSolid) {
    std::array<std::uint8_t, 4> color{};
    for (std::uint8_t& value : color) value = static_cast<std::uint8_t>(bits.read(8));
    return fillBlock(rgba, color);
  }
  bits.read(mode.hintBits);
  const std::uint32_t pattern = bits.read(mode.patternBits);
  if (pattern >= mode.patterns.size()) return fillBlock(rgba, kInvalid);
  const std::uint32_t ownWeight = mode.selectorBits > 0 ? bits.read(mode.selectorBits) : 3;

  // Both endpoints of each subset, with 16 bits.
  const std::array<std::uint8_t, kMostEndpoints> values = readEndpointValues(number, bits);
  std::array<std::array<std::uint32_t, 4>, 3> low{}, high{};
  for (std::size_t s = 0; s < mode.subsets; ++s)
    for (std::size_t c = 0; c < 4; ++c) {
      const bool opaque = c == 3 && mode.channels == 3;
      const std::size_t from = mode.channels == 2 ? c / 3 : c;
      const std::uint8_t* pair = values.data() + 2 * (s * mode.channels + from);
      low[s][c] = opaque ? 0xFFFF : pair[0] * 257u;
      high[s][c] = opaque ? 0xFFFF : pair[1] * 257u;
    }

  const UastcPattern& parts = mode.patterns[pattern];
  const std::array<std::uint8_t, 32>& weights = kUastcWeights[mode.weightBits];
  for (std::size_t i = 0; i < 16; ++i) {
    const std::uint32_t indexBits = mode.weightBits - (parts.anchors >> i & 1);
    const std::size_t subset = parts.subset[i];
    const std::array<std::uint32_t, 4> a = low[subset], b = high[subset];
    const auto mix = [&](std::size_t c, std::uint32_t weight) {
      return static_cast<std::uint8_t>((a[c] * (64 - weight) + b[c] * weight + 32) >> 14);
    };
    const std::uint32_t weight = weights[bits.read(indexBits)];
    for (std::size_t c = 0; c < 4; ++c) rgba[4 * i + c] = mix(c, weight);
    if (mode.planes == 2) rgba[4 * i + ownWeight] = mix(ownWeight, weights[bits.read(indexBits)]);
  }
}

}  // namespace quintet::io
