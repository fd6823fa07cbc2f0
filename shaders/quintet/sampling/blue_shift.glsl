// SPDX-License-Identifier: Apache-2.0
// Digital shifts that distribute one net over the pixels of a tile. The errors of neighboring pixels then cancel in the
// mean, and the remaining error is blue noise. The hierarchical order of the pixels and its random permutations are
// those of A. Ahmed & P. Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical
// Ordering of Pixels", ACM TOG 39(6), 2020. Unlike their method, this one does not need the number of samples in
// advance.
//
// Let s(t) be the polynomial over the integers modulo 2 whose coefficients are the bits of a sample's index. The
// digits of the first two Sobol dimensions are its Taylor coefficients at t = 0 and t = 1. A pixel whose
// Morton index in its tile has the base-4 digits c_0, c_1, … (c_0 distinguishes the four pixels of a 2 x 2 block) uses
// the Taylor coefficients of
//     s + c_0/q + c_1/q² + …,   q = t² + t + 1,   each digit read as a polynomial, c = (bit 0) + (bit 1) t.
// The first 2^k samples of a block of 4^j pixels are then all g/q^j + const with g of a degree below k + 2j. q is 1 at 0 and
// at 1, so division by q^j maps nets to nets, and the points of all such g are a (0,k+2j,2)-net. This works because q
// is irreducible: there is no third place of degree 1 (three coordinates of a sequence in base 2 have t = 1), but there
// is a place of degree 2, for digits in base 4 (compare S. Tezuka, "On the discrepancy of generalized Niederreiter
// sequences", J. Complexity 29, 2013). The same holds for each aligned range of 2^k samples.
#ifndef QUINTET_SAMPLING_BLUE_SHIFT_GLSL
#define QUINTET_SAMPLING_BLUE_SHIFT_GLSL

#include "hash.glsl"

const uint kTileBits = 6u;  // tiles of 64 x 64 pixels

// Moves the bits of a 16-bit number to the even bit positions.
uint spreadBits(uint x) {
  x = (x | x << 8) & 0x00FF00FFu;
  x = (x | x << 4) & 0x0F0F0F0Fu;
  x = (x | x << 2) & 0x33333333u;
  return (x | x << 1) & 0x55555555u;
}

// Morton index of the pixel in its tile.
uint mortonInTile(uvec2 pixel) {
  const uint mask = (1u << kTileBits) - 1u;
  return spreadBits(pixel.x & mask) | spreadBits(pixel.y & mask) << 1;
}

// Divides a power series, given by its first 32 coefficients, by q: 1/q = (1 + t)/(1 + t³).
uint divideByQ(uint series) {
  series ^= series << 1;
  series ^= series << 3;
  series ^= series << 6;
  series ^= series << 12;
  return series ^ series << 24;
}

// One of the 24 permutations of 0 … 3, selected by the upper 18 bits of a hash. All of them are affine over
// bits: t + (bit 0) a + (bit 1) b with a ≠ b, and neither of them 0.
uint permuteDigit(uint digit, uint random) {
  const uint a = 1u + ((random >> 14 & 0x7FFFu) * 3u >> 15);
  const uint b = 1u + (a + (random >> 29 & 1u)) % 3u;
  return random >> 30 ^ ((digit & 1u) != 0u ? a : 0u) ^ ((digit & 2u) != 0u ? b : 0u);
}

// Shifts of x and y, first digit in bit 0. The permutation of each base-4 digit of the Morton index depends on the
// digits above it.
uvec2 blueShift(uint morton, uint seed) {
  const uint marked = morton | 1u << 2u * kTileBits;
  uint series = 1u;  // 1/q, 1/q², …, with the same coefficients at 0 and at 1
  uvec2 shift = uvec2(0u);
  for (uint level = 0u; level < kTileBits; ++level) {
    uint random = seed ^ (marked >> 2u * level + 2u) * 0x9E3779B9u;
    random ^= random >> 15;
    random *= 0x2C1B3C6Du;
    const uint digit = permuteDigit(morton >> 2u * level & 3u, random);
    series = divideByQ(series);
    const uint first = (digit & 1u) != 0u ? series : 0u;
    const uint second = (digit & 2u) != 0u ? series : 0u;
    shift ^= uvec2(first ^ second << 1, first ^ second ^ second << 1);  // t is t at 0, 1 + (t + 1) at 1
  }
  return shift;
}

#endif
