// SPDX-License-Identifier: Apache-2.0
#include "io/bptc.h"

namespace quintet::io {
namespace {

// Bit i: texel i is in subset 1. Partitions of two subsets (Table 114).
constexpr std::array<std::uint16_t, 64> kTwoSubsets{
    0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80, 0xC800, 0xFFEC, 0xFE80, 0xE800, 0xFFE8,
    0xFF00, 0xFFF0, 0xF000, 0xF710, 0x008E, 0x7100, 0x08CE, 0x008C, 0x7310, 0x3100, 0x8CCE, 0x088C, 0x3110,
    0x6666, 0x366C, 0x17E8, 0x0FF0, 0x718E, 0x399C, 0xAAAA, 0xF0F0, 0x5A5A, 0x33CC, 0x3C3C, 0x55AA, 0x9696,
    0xA55A, 0x73CE, 0x13C8, 0x324C, 0x3BDC, 0x6996, 0xC33C, 0x9966, 0x0660, 0x0272, 0x04E4, 0x4E40, 0x2720,
    0xC936, 0x936C, 0x39C6, 0x639C, 0x9336, 0x9CC6, 0x817E, 0xE718, 0xCCF0, 0x0FCC, 0x7744, 0xEE22};

// Digit i: subset of texel i. Partitions of three subsets (Table 115).
constexpr std::array<std::string_view, 64> kThreeSubsets{
    "0011001102212222", "0001001122112221", "0000200122112211", "0222002200110111", "0000000011221122",
    "0011001100220022", "0022002211111111", "0011001122112211", "0000000011112222", "0000111111112222",
    "0000111122222222", "0012001200120012", "0112011201120112", "0122012201220122", "0011011211221222",
    "0011200122002220", "0001001101121122", "0111001120012200", "0000112211221122", "0022002200221111",
    "0111011102220222", "0001000122212221", "0000001101220122", "0000110022102210", "0122012200110000",
    "0012001211222222", "0110122112210110", "0000011012211221", "0022110211020022", "0110011020022222",
    "0011012201220011", "0000200022112221", "0000000211221222", "0222002200120011", "0011001200220222",
    "0120012001200120", "0000111122220000", "0120120120120120", "0120201212010120", "0011220011220011",
    "0011112222000011", "0101010122222222", "0000000021212121", "0022112200221122", "0022001100220011",
    "0220122102201221", "0101222222220101", "0000212121212121", "0101010101012222", "0222011102220111",
    "0002111200021112", "0000211221122112", "0222011101110222", "0002111211120002", "0110011001102222",
    "0000000021122112", "0110011022222222", "0022001100110022", "0022112211220022", "0000000000002112",
    "0002000100020001", "0222122202221222", "0101222222222222", "0111201122012220"};

// Anchors as hexadecimal digits, by partition: of the second of two subsets, of the second of three, of the third
// (Tables 116 to 118). That of the first subset is texel 0.
constexpr std::string_view kSecondOfTwo = "fffffffffffffffff282288f28228822ff6828ff28222ff66268ff22fffff22f";
constexpr std::string_view kSecondOfThree = "33ff83ff88666533338f336a588685ff8f356a8ff3f5ffff3f55585a5a8dfc33";
constexpr std::string_view kThirdOfThree = "f883ff38fffffff8f8f3f8f83f6affa8f3faa89a6f8f3668f3ffffffffff3ff8";

std::uint32_t digitAt(std::string_view digits, std::uint32_t i) {
  const char c = digits[i];
  return static_cast<std::uint32_t>(c <= '9' ? c - '0' : c - 'a' + 10);
}

constexpr std::array<std::int32_t, 4> kWeights2{0, 21, 43, 64};
constexpr std::array<std::int32_t, 8> kWeights3{0, 9, 18, 27, 37, 46, 55, 64};
constexpr std::array<std::int32_t, 16> kWeights4{0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};

}  // namespace

std::uint32_t subsetOf(std::uint32_t subsets, std::uint32_t partition, std::uint32_t texel) {
  if (subsets == 1) return 0;
  if (subsets == 2) return kTwoSubsets[partition] >> texel & 1u;
  return digitAt(kThreeSubsets[partition], texel);
}

std::uint32_t anchorOf(std::uint32_t subsets, std::uint32_t partition, std::uint32_t subset) {
  if (subset == 0) return 0;
  if (subsets == 2) return digitAt(kSecondOfTwo, partition);
  return digitAt(subset == 1 ? kSecondOfThree : kThirdOfThree, partition);
}

std::int32_t interpolate(std::int32_t a, std::int32_t b, std::uint32_t index, std::uint32_t bits) {
  const std::int32_t w = bits == 2 ? kWeights2[index] : bits == 3 ? kWeights3[index] : kWeights4[index];
  return (a * (64 - w) + b * w + 32) >> 6;
}

}  // namespace quintet::io
