// SPDX-License-Identifier: Apache-2.0
// The numbers of quintet/sampling/sobol.glsl, computed step by step from their definition: one digit, bit or coefficient
// at a time. The shaders compute with all of them at once, and must give the same bits.
#ifndef QUINTET_TESTS_GPU_SAMPLING_SOBOL_REFERENCE_H
#define QUINTET_TESTS_GPU_SAMPLING_SOBOL_REFERENCE_H

#include <array>
#include <bit>
#include <cstdint>

#include "base/math.h"
#include "quintet/shared/frame.h"

namespace quintet::test {

class SobolReference {
 public:
  SobolReference(uvec2 pixel, std::uint32_t index, std::uint32_t seed, std::uint32_t planned)
      : pixel_(pixel),
        index_(index),
        own_(hash(hash(pixel.x | pixel.y << 16) ^ hash(seed + kGolden))),
        tile_(hash(hash(pixel.x / kTile | pixel.y / kTile << 16) ^ hash(hash(seed) + kGolden))) {
    if (planned == shared::kIndependentPixels) tile_ = own_;
    // The bits below the highest one in which the index and the planned number differ.
    while (ownCount_ < 32 && (index ^ planned) >> ownCount_ > 1) ownCount_++;
  }

  vec2 at(std::uint32_t dimension) const {
    const std::uint32_t seed = hash(tile_ + kGolden * dimension);
    const uvec2 digits = digitsOf(seed);
    return {unit(permuteUpwards(digits.x, hash(seed ^ 0x2C1B3C6Du))),
            unit(permuteUpwards(digits.y, hash(seed ^ 0x297A2D39u)))};
  }

 private:
  static constexpr std::uint32_t kGolden = 0x9E3779B9u;
  static constexpr std::uint32_t kLevels = 6;
  static constexpr std::uint32_t kTile = 1u << kLevels;

  static std::uint32_t hash(std::uint32_t x) {
    x = (x ^ x >> 16) * 0x21F0AAADu;
    x = (x ^ x >> 15) * 0xD35A2D97u;
    return x ^ x >> 15;
  }

  static std::uint32_t permuteUpwards(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3D20ADEAu;
    x = (x + seed) * (seed >> 16 | 1u);
    x ^= x * 0x05526C56u;
    return x ^ x * 0x53A22864u;
  }

  static std::uint32_t reverse(std::uint32_t x) {
    std::uint32_t result = 0;
    for (int i = 0; i < 32; ++i) result |= (x >> i & 1u) << (31 - i);
    return result;
  }

  static float unit(std::uint32_t digits) { return static_cast<float>(reverse(digits) >> 8) * 0x1p-24f; }

  // Pascal's triangle modulo 2: bit j is the sum of the bits k of the index for which C(k,j) is odd.
  static std::uint32_t pascal(std::uint32_t index) {
    std::uint32_t result = 0;
    for (std::uint32_t j = 0; j < 32; ++j)
      for (std::uint32_t k = 0; k < 32; ++k)
        if ((j & k) == j) result ^= (index >> k & 1u) << j;
    return result;
  }

  // The digits c_i of the pixel, bits 2i and 2i + 1: each bit of its Morton index is flipped depending on the bits above it.
  std::uint32_t permutedDigits(std::uint32_t seed) const {
    std::uint32_t morton = 0;
    for (std::uint32_t i = 0; i < kLevels; ++i)
      morton |= (pixel_.x >> i & 1u) << 2 * i | (pixel_.y >> i & 1u) << (2 * i + 1);
    std::uint32_t digits = 0;
    for (std::uint32_t bit = 0; bit < 2 * kLevels; ++bit) {
      const std::uint32_t andAbove = reverse(morton >> bit << bit) >> (32 - 2 * kLevels);  // the highest in bit 0
      digits |= (permuteUpwards(andAbove, seed << 16 | seed >> 16) >> (2 * kLevels - 1 - bit) & 1u) << bit;
    }
    return digits;
  }

  // The first 32 coefficients of the sum of c_i/q^(i+1), q = t² + t + 1, c_i = (bit 0) + (bit 1) t, at t = 0 or at t = 1.
  std::uint32_t series(std::uint32_t seed, bool atOne) const {
    std::uint32_t result = 0;
    for (std::uint32_t level = 0; level < kLevels; ++level) {
      const std::uint32_t c = permutedDigits(seed) >> 2 * level & 3u;
      std::array<std::uint32_t, 32> term{(c & 1u) ^ (atOne ? c >> 1 : 0u), c >> 1};
      for (std::uint32_t i = 0; i <= level; ++i)  // divide by q
        for (std::size_t k = 0; k < 32; ++k) term[k] ^= (k > 0 ? term[k - 1] : 0u) ^ (k > 1 ? term[k - 2] : 0u);
      for (std::size_t k = 0; k < 32; ++k) result ^= term[k] << k;
    }
    return result;
  }

  uvec2 digitsOf(std::uint32_t seed) const {
    const std::uint32_t ofTile = reverse(permuteUpwards(reverse(index_), seed));
    const std::uint32_t ofPixel = reverse(permuteUpwards(reverse(index_), hash(seed ^ own_)));
    const std::uint32_t own = (1u << ownCount_) - 1u;
    const std::uint32_t index = (ofTile & ~own) | (ofPixel & own);
    return {index ^ series(seed, false), pascal(index) ^ series(seed, true)};
  }

  uvec2 pixel_;
  std::uint32_t index_;
  std::uint32_t own_, tile_;  // seeds
  std::uint32_t ownCount_ = 0;
};

}  // namespace quintet::test
#endif
