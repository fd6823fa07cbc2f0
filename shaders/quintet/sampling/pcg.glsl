// SPDX-License-Identifier: Apache-2.0
// Independent random numbers, for `naive` and for tests. The generator is counter-based: a number is a bijective mix of
// the 128 bits of (pixel, sample, dimension, seed). Two streams therefore never overlap, for any number of samples.
// Mixer: pcg4d of M. Jarzynski & M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020,
// https://jcgt.org/published/0009/03/02/ (after M. O'Neill's PCG, 2014).
#ifndef QUINTET_SAMPLING_PCG_GLSL
#define QUINTET_SAMPLING_PCG_GLSL
#ifdef QUINTET_SAMPLING_SOBOL_GLSL
#error "include either quintet/sampling/sobol.glsl or quintet/sampling/pcg.glsl"
#endif

#include "sampler.glsl"

struct Sampler {
  uint pixel;      // x | y << 16
  uint index;      // of the sample
  uint dimension;  // of the next number
  uint seed;
};

// A linear congruential step on each word, two rounds of products between the words, one fold of the high bits.
uvec4 pcg4d(uvec4 v) {
  v = v * 1664525u + 1013904223u;
  for (int i = 0; i < 2; ++i) {
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    if (i == 0) v ^= v >> 16;
  }
  return v;
}

Sampler makeSampler(uvec2 pixel, uint sampleIndex, uint seed) {
  return Sampler(pixel.x | pixel.y << 16, sampleIndex, 0u, seed);
}

// Same interface as sobol.glsl. Here pixels are always independent.
Sampler makeSampler(uvec2 pixel, uint sampleIndex, uint seed, uint plannedSamples) {
  return makeSampler(pixel, sampleIndex, seed);
}

uvec4 nextWords(inout Sampler s) { return pcg4d(uvec4(s.pixel, s.index, s.dimension++, s.seed)); }

uint nextBits(inout Sampler s) { return nextWords(s).x; }
void skipDraw(inout Sampler s) { s.dimension++; }
float next1D(inout Sampler s) { return unitFloat(nextWords(s).x); }
vec2 next2D(inout Sampler s) {
  const uvec4 words = nextWords(s);
  return vec2(unitFloat(words.x), unitFloat(words.y));
}

#endif
