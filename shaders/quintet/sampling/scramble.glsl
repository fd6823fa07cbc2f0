// SPDX-License-Identifier: Apache-2.0
// Nested uniform scrambles (A. Owen, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", 1995) by hashing.
#ifndef QUINTET_SAMPLING_SCRAMBLE_GLSL
#define QUINTET_SAMPLING_SCRAMBLE_GLSL

// A permutation in which each bit is flipped depending on the bits *below* it: S. Laine & T. Karras,
// "Stratified Sampling for Stochastic Transparency" (2011), with N. Vegdahl's steps and constants
// ("Building a Better LK Hash", 2021, https://psychopath.io/post/2021_01_30_building_a_better_lk_hash).
uint permuteUpwards(uint x, uint seed) {
  x ^= x * 0x3D20ADEAu;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526C56u;
  x ^= x * 0x53A22864u;
  return x;
}

#endif
