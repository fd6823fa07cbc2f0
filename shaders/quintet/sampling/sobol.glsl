// Owen-scrambled Sobol points, padded: B. Burley, "Practical Hash-based Owen Scrambling", JCGT 10(4), 2020,
// https://jcgt.org/published/0009/04/01/. Each demand d of a pixel takes the first two Sobol dimensions
// (each prefix of 2^k samples is a (0,k,2)-net; 1D: the first dimension). Why the numbers may be multiplied as if
// they were independent:
//  * pixels, demands: the order of the samples is shuffled by a nested uniform scramble with a seed of
//    its own, a hash of (pixel, d), so equal sample indices meet different points of the net;
//  * coordinates: x and y of a point are scrambled with two further seeds. An Owen-scrambled point is uniform in
//    the square, so each estimate is unbiased whatever the net does.
// Seeds are 32-bit hashes: for one d distinct over all pixels, between two d equal only by chance.
#ifndef QUINTET_SAMPLING_SOBOL_GLSL
#define QUINTET_SAMPLING_SOBOL_GLSL

#include "sampler.glsl"

struct Sampler {
  uint index;      // of the sample in its pixel
  uint seed;       // of the pixel
  uint dimension;  // demands so far
};

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

// The second Sobol dimension with its bits reversed. Its generator matrix is Pascal's triangle modulo 2, and
// C(k,j) is odd iff the bits of j are among those of k (Lucas), so bit j is the parity of the
// index bits k with j ⊆ k: a sum over supersets, one step for each of the five bits of a position.
uint sobolSecondReversed(uint index) {
  index ^= (index & 0xAAAAAAAAu) >> 1;
  index ^= (index & 0xCCCCCCCCu) >> 2;
  index ^= (index & 0xF0F0F0F0u) >> 4;
  index ^= (index & 0xFF00FF00u) >> 8;
  index ^= index >> 16;
  return index;
}

Sampler makeSampler(uvec2 pixel, uint sampleIndex, uint seed) { return Sampler(sampleIndex, pixelSeed(pixel, seed), 0u); }

uint nextSeed(inout Sampler s) { return hash(s.seed + 0x9E3779B9u * s.dimension++); }

// The sample's place in the demand's own order: a nested uniform scramble (Owen 1995) of the index.
uint shuffledIndex(Sampler s, uint seed) { return bitfieldReverse(permuteUpwards(bitfieldReverse(s.index), seed)); }

uint nextBits(inout Sampler s) { return hash(nextSeed(s) ^ hash(s.index)); }

float next1D(inout Sampler s) {
  const uint seed = nextSeed(s);
  // The first dimension is the reversed index: two reversals cancel.
  return unitFloat(bitfieldReverse(permuteUpwards(shuffledIndex(s, seed), hash(seed ^ 0x2C1B3C6Du))));
}

vec2 next2D(inout Sampler s) {
  const uint seed = nextSeed(s);
  const uint index = shuffledIndex(s, seed);
  const uint x = permuteUpwards(index, hash(seed ^ 0x2C1B3C6Du));
  const uint y = permuteUpwards(sobolSecondReversed(index), hash(seed ^ 0x297A2D39u));
  return vec2(unitFloat(bitfieldReverse(x)), unitFloat(bitfieldReverse(y)));
}

#endif
