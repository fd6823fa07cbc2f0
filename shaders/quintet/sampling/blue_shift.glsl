// SPDX-License-Identifier: Apache-2.0
// Digital shifts that distribute one net over the pixels of a tile. The errors of neighboring pixels then cancel in the
// mean, and the remaining error is blue noise. The hierarchical order of the pixels is that of A. Ahmed & P. Wonka,
// "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels", ACM TOG 39(6),
// 2020. Unlike their method, this one does not need the number of samples in advance, and permutes by a binary scramble.
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

#include "scramble.glsl"

const uint kTileBits = 6u;  // tiles of 64 x 64 pixels

// Moves the bits of a 16-bit number to the even bit positions.
uint spreadBits(uint x) {
  x = (x | x << 8) & 0x00FF00FFu;
  x = (x | x << 4) & 0x0F0F0F0Fu;
  x = (x | x << 2) & 0x33333333u;
  return (x | x << 1) & 0x55555555u;
}

// Morton index of the pixel in its tile, with its bits reversed: the bit that distinguishes the halves of the tile is bit 0.
uint reversedMortonInTile(uvec2 pixel) {
  const uint mask = (1u << kTileBits) - 1u;
  return bitfieldReverse(spreadBits(pixel.x & mask) | spreadBits(pixel.y & mask) << 1) >> 32u - 2u * kTileBits;
}

// The base-4 digits c_i of a pixel: its Morton index, in which each bit is flipped or not, depending on the bits above it.
// Digit c_i has the bits 2i and 2i + 1.
uint permutedMorton(uint reversedMorton, uint seed) {
  return bitfieldReverse(permuteUpwards(reversedMorton, seed)) >> 32u - 2u * kTileBits;
}

// Shifts of x and y, first digit in bit 0: the first 32 Taylor coefficients of c_0/q + … + c_5/q⁶ at t = 0 and at t = 1.
// The common numerator is c_0 q⁵ + … + c_5, and 1/q⁶ = q²/q⁸ = q² (1 + t⁸)/(1 + t²⁴), because squares of sums are sums
// of squares.
uvec2 blueShift(uint reversedMorton, uint seed) {
  const uint digits = permutedMorton(reversedMorton, seed);
  // Both numerators in one word, 16 bits each. q is the same polynomial in t and in t - 1, and c = bit 0 + bit 1 + (bit 1) (t - 1).
  uint p = digits | (digits ^ digits >> 1 & 0x555u) << 16;
  // Pairs: c_2i q + c_2i+1. Then all three: (c_0 q + c_1) q⁴ + (c_2 q + c_3) q² + (c_4 q + c_5), q⁴ = t⁸ + t⁴ + 1.
  const uint even = p & 0x33333333u;
  p = p >> 2 & 0x33333333u ^ even ^ even << 1 ^ even << 2;
  const uint first = p & 0x000F000Fu;
  const uint second = p & 0x00F000F0u;
  p = p >> 8 & 0x000F000Fu ^ second ^ second >> 2 ^ second >> 4 ^ first ^ first << 4 ^ first << 8;
  p ^= p << 2 ^ p << 4;  // times q²
  uvec2 shift = uvec2(p & 0xFFFFu, p >> 16);
  shift ^= shift << 8;
  return shift ^ shift << 24;
}

#endif
