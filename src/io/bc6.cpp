// SPDX-License-Identifier: Apache-2.0
// BC6H (Khronos Data Format Specification 1.3, section 20.2): RGB half floats, signed or not.
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "io/block_decode.h"
#include "io/bptc.h"

namespace quintet::io {
namespace {

// One mode (Tables 119 to 124). `layout`: where the bits after the mode go: "r0:9-0" are bits 0 to 9 of the red of
// endpoint 0, lowest first; "r0:10-15" starts with bit 15.
struct Mode {
  std::uint32_t number;  // 2 bits for numbers below 2, otherwise 5 bits
  std::uint32_t regions;
  bool transformed;  // endpoints 1 to 3 are differences to endpoint 0
  std::int32_t endpointBits;
  std::array<std::int32_t, 3> deltaBits;
  std::string_view layout;
};
constexpr std::array<Mode, 14> kModes{{
    {0,
     2,
     true,
     10,
     {5, 5, 5},
     "g2:4 b2:4 b3:4 r0:9-0 g0:9-0 b0:9-0 r1:4-0 g3:4 g2:3-0 g1:4-0 b3:0 g3:3-0 b1:4-0 b3:1 b2:3-0 r2:4-0 b3:2 r3:4-0 "
     "b3:3"},
    {1,
     2,
     true,
     7,
     {6, 6, 6},
     "g2:5 g3:4 g3:5 r0:6-0 b3:0 b3:1 b2:4 g0:6-0 b2:5 b3:2 g2:4 b0:6-0 b3:3 b3:5 b3:4 r1:5-0 g2:3-0 g1:5-0 g3:3-0 "
     "b1:5-0 b2:3-0 r2:5-0 r3:5-0"},
    {2,
     2,
     true,
     11,
     {5, 4, 4},
     "r0:9-0 g0:9-0 b0:9-0 r1:4-0 r0:10 g2:3-0 g1:3-0 g0:10 b3:0 g3:3-0 b1:3-0 b0:10 b3:1 b2:3-0 r2:4-0 b3:2 r3:4-0 "
     "b3:3"},
    {6,
     2,
     true,
     11,
     {4, 5, 4},
     "r0:9-0 g0:9-0 b0:9-0 r1:3-0 r0:10 g3:4 g2:3-0 g1:4-0 g0:10 g3:3-0 b1:3-0 b0:10 b3:1 b2:3-0 r2:3-0 b3:0 b3:2 "
     "r3:3-0 g2:4 b3:3"},
    {10,
     2,
     true,
     11,
     {4, 4, 5},
     "r0:9-0 g0:9-0 b0:9-0 r1:3-0 r0:10 b2:4 g2:3-0 g1:3-0 g0:10 b3:0 g3:3-0 b1:4-0 b0:10 b2:3-0 r2:3-0 b3:1 b3:2 "
     "r3:3-0 b3:4 b3:3"},
    {14,
     2,
     true,
     9,
     {5, 5, 5},
     "r0:8-0 b2:4 g0:8-0 g2:4 b0:8-0 b3:4 r1:4-0 g3:4 g2:3-0 g1:4-0 b3:0 g3:3-0 b1:4-0 b3:1 b2:3-0 r2:4-0 b3:2 r3:4-0 "
     "b3:3"},
    {18,
     2,
     true,
     8,
     {6, 5, 5},
     "r0:7-0 g3:4 b2:4 g0:7-0 b3:2 g2:4 b0:7-0 b3:3 b3:4 r1:5-0 g2:3-0 g1:4-0 b3:0 g3:3-0 b1:4-0 b3:1 b2:3-0 r2:5-0 "
     "r3:5-0"},
    {22,
     2,
     true,
     8,
     {5, 6, 5},
     "r0:7-0 b3:0 b2:4 g0:7-0 g2:5 g2:4 b0:7-0 g3:5 b3:4 r1:4-0 g3:4 g2:3-0 g1:5-0 g3:3-0 b1:4-0 b3:1 b2:3-0 r2:4-0 "
     "b3:2 r3:4-0 b3:3"},
    {26,
     2,
     true,
     8,
     {5, 5, 6},
     "r0:7-0 b3:1 b2:4 g0:7-0 b2:5 g2:4 b0:7-0 b3:5 b3:4 r1:4-0 g3:4 g2:3-0 g1:4-0 b3:0 g3:3-0 b1:5-0 b2:3-0 r2:4-0 "
     "b3:2 r3:4-0 b3:3"},
    {30,
     2,
     false,
     6,
     {6, 6, 6},
     "r0:5-0 g3:4 b3:0 b3:1 b2:4 g0:5-0 g2:5 b2:5 b3:2 g2:4 b0:5-0 g3:5 b3:3 b3:5 b3:4 r1:5-0 g2:3-0 g1:5-0 g3:3-0 "
     "b1:5-0 b2:3-0 r2:5-0 r3:5-0"},
    {3, 1, false, 10, {10, 10, 10}, "r0:9-0 g0:9-0 b0:9-0 r1:9-0 g1:9-0 b1:9-0"},
    {7, 1, true, 11, {9, 9, 9}, "r0:9-0 g0:9-0 b0:9-0 r1:8-0 r0:10 g1:8-0 g0:10 b1:8-0 b0:10"},
    {11, 1, true, 12, {8, 8, 8}, "r0:9-0 g0:9-0 b0:9-0 r1:7-0 r0:10-11 g1:7-0 g0:10-11 b1:7-0 b0:10-11"},
    {15, 1, true, 16, {4, 4, 4}, "r0:9-0 g0:9-0 b0:9-0 r1:3-0 r0:10-15 g1:3-0 g0:10-15 b1:3-0 b0:10-15"},
}};

using Endpoints = std::array<std::array<std::int32_t, 3>, 4>;

std::int32_t number(std::string_view text) {
  std::int32_t value = 0;
  for (const char c : text) value = 10 * value + (c - '0');
  return value;
}

Endpoints readEndpoints(std::string_view layout, BlockBits& bits) {
  Endpoints endpoints{};
  while (!layout.empty()) {
    const std::string_view field = layout.substr(0, layout.find(' '));
    layout.remove_prefix(std::min(field.size() + 1, layout.size()));
    std::int32_t& value = endpoints[static_cast<std::size_t>(field[1] - '0')][field[0] == 'r'   ? 0u
                                                                              : field[0] == 'g' ? 1u
                                                                                                : 2u];
    const std::string_view range = field.substr(3);
    const std::size_t dash = range.find('-');
    const std::int32_t from = number(range.substr(0, dash));
    const std::int32_t to = dash == std::string_view::npos ? from : number(range.substr(dash + 1));
    for (std::int32_t k = 0; k <= std::abs(from - to); ++k)
      value |= static_cast<std::int32_t>(bits.read(1)) << (to + (from < to ? -k : k));
  }
  return endpoints;
}

std::int32_t signExtend(std::int32_t value, std::int32_t bits) {
  const std::int32_t sign = 1 << (bits - 1);
  return ((value & ((sign << 1) - 1)) ^ sign) - sign;
}

// Section 20.2.2: the endpoints as numbers of mode.endpointBits bits.
void resolve(const Mode& mode, bool isSigned, Endpoints& endpoints) {
  const std::int32_t mask = (1 << mode.endpointBits) - 1;
  const std::size_t count = 2 * mode.regions;
  for (std::size_t c = 0; c < 3; ++c) {
    if (mode.transformed)
      for (std::size_t e = 1; e < count; ++e)
        endpoints[e][c] = (endpoints[0][c] + signExtend(endpoints[e][c], mode.deltaBits[c])) & mask;
    for (std::size_t e = 0; e < count && isSigned; ++e)
      endpoints[e][c] = signExtend(endpoints[e][c], mode.endpointBits);
  }
}

// To 16 bits, or 15 bits and a sign.
std::int32_t unquantize(std::int32_t value, std::int32_t bits, bool isSigned) {
  if (bits >= 15 + (isSigned ? 1 : 0) || value == 0) return value;
  if (!isSigned) return value == (1 << bits) - 1 ? 0xFFFF : ((value << 15) + 0x4000) >> (bits - 1);
  const std::int32_t magnitude = std::abs(value);
  const std::int32_t scaled = magnitude >= (1 << (bits - 1)) - 1 ? 0x7FFF : ((magnitude << 15) + 0x4000) >> (bits - 1);
  return value < 0 ? -scaled : scaled;
}

float fromHalf(std::int32_t bits) {
  const std::int32_t exponent = bits >> 10 & 31, mantissa = bits & 1023;
  const float magnitude = exponent == 0 ? std::ldexp(static_cast<float>(mantissa), -24)
                                        : std::ldexp(static_cast<float>(mantissa + 1024), exponent - 25);
  return bits & 0x8000 ? -magnitude : magnitude;
}

// An interpolated value as a half float: scaled by 31/64, or 31/32 with a sign, so that it stays finite.
float finish(std::int32_t value, bool isSigned) {
  if (!isSigned) return fromHalf((value * 31) >> 6);
  const std::int32_t magnitude = (std::abs(value) * 31) >> 5;
  return fromHalf(value < 0 ? 0x8000 | magnitude : magnitude);
}

}  // namespace

void decodeBc6Block(const std::byte* block, bool isSigned, float* rgb) {
  BlockBits bits(block);
  std::uint32_t number = bits.read(2);
  if (number > 1) number |= bits.read(3) << 2;
  const auto mode = std::ranges::find(kModes, number, &Mode::number);
  if (mode == kModes.end()) {  // reserved: black
    std::fill_n(rgb, 48, 0.0f);
    return;
  }
  Endpoints endpoints = readEndpoints(mode->layout, bits);
  const std::uint32_t partition = mode->regions == 2 ? bits.read(5) : 0;
  resolve(*mode, isSigned, endpoints);
  const std::uint32_t indexBits = mode->regions == 2 ? 3 : 4;
  for (std::uint32_t i = 0; i < 16; ++i) {
    const std::uint32_t index = bits.read(indexBits - (isAnchor(mode->regions, partition, i) ? 1 : 0));
    const std::uint32_t region = subsetOf(mode->regions, partition, i);
    for (std::size_t c = 0; c < 3; ++c)
      rgb[3 * i + c] =
          finish(interpolate(unquantize(endpoints[2 * region][c], mode->endpointBits, isSigned),
                             unquantize(endpoints[2 * region + 1][c], mode->endpointBits, isSigned), index, indexBits),
                 isSigned);
  }
}

}  // namespace quintet::io
