// SPDX-License-Identifier: Apache-2.0
// Integer mixers: every output bit depends on every input bit. Bijective where they map 32 bits to 32.
#ifndef QUINTET_SAMPLING_HASH_GLSL
#define QUINTET_SAMPLING_HASH_GLSL

// Two rounds of xor-shift and multiply; structure and constants from C. Wellons, "Prospecting for Hash
// Functions" (2018, https://nullprogram.com/blog/2018/07/31/), in the variant of lowest measured bias (0.107).
uint hash(uint x) {
  x ^= x >> 16;
  x *= 0x21F0AAADu;
  x ^= x >> 15;
  x *= 0xD35A2D97u;
  x ^= x >> 15;
  return x;
}

// One value from two. For a fixed `b`, a bijection of `a`, and vice versa.
uint hashCombine(uint a, uint b) { return hash(a ^ hash(b + 0x9E3779B9u)); }

// The upper 24 bits as a number in [0,1): exact, and never rounded up to 1.
float unitFloat(uint bits) { return float(bits >> 8) * (1.0 / 16777216.0); }

#endif
