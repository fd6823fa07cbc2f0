// Owen-scrambled Sobol points, padded (B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020,
// https://jcgt.org/published/0009/04/01/), with errors that are blue noise over the image (blue_shift.glsl).
// Each demand d of a pixel takes the first two Sobol dimensions, shifted by the pixel's own digits: of each pixel,
// every prefix of 2^k samples is a (0,k,2)-net (1D: the first dimension). Why the numbers may be multiplied as if
// they were independent:
//  * demands: the order of the samples is shuffled by a nested uniform scramble (Owen 1995) and the places of the
//    pixels are permuted, for each d with seeds of its own, so equal sample indices meet different points;
//  * coordinates: x and y of a point are scrambled with two further seeds. An Owen-scrambled point is uniform in
//    the square, so each pixel's estimate is unbiased whatever the nets do;
//  * pixels: those of different tiles have seeds of their own. Those of one tile are *not* independent: their errors
//    are meant to cancel. Where that must not be (a pixel's samples decide about its neighbour's): kIndependentPixels.
// Seeds are 32-bit hashes: for one d distinct over all tiles (or pixels), between two d equal only by chance.
#ifndef QUINTET_SAMPLING_SOBOL_GLSL
#define QUINTET_SAMPLING_SOBOL_GLSL

#include "../shared/frame.h"
#include "blue_shift.glsl"
#include "sampler.glsl"

struct Sampler {
  uint index;      // of the sample in its pixel
  uint pixel;      // seed of the pixel
  uint tile;       // seed of its tile
  uint place;      // of the pixel in the tile
  uint ownBits;    // those bits of the index whose order is shuffled for the pixel alone
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

// Pixels share the shuffle of what they need to take the same aligned ranges of 2^k indices: the nodes of the tree of
// ranges that lie on the way to `plannedSamples`. Everything below is shuffled for each pixel alone, or products
// of demands would be noisier in some tiles than in others. With 0 planned, counts 2^k are as good as planned ones.
Sampler makeSampler(uvec2 pixel, uint sampleIndex, uint seed, uint plannedSamples) {
  const uint own = pixelSeed(pixel, seed);
  const uint tile = pixelSeed(pixel >> kTileBits, hash(seed));
  const int node = findMSB(sampleIndex ^ plannedSamples);  // -1: none
  const uint ownBits = (1u << max(node, 0)) - 1u;
  return Sampler(sampleIndex, own, plannedSamples == kIndependentPixels ? own : tile, placeInTile(pixel), ownBits, 0u);
}

// Independent pixels.
Sampler makeSampler(uvec2 pixel, uint sampleIndex, uint seed) {
  return makeSampler(pixel, sampleIndex, seed, kIndependentPixels);
}

uint demandSeed(uint seed, uint dimension) { return hash(seed + 0x9E3779B9u * dimension); }

// A nested uniform scramble of the index.
uint shuffled(uint index, uint seed) { return bitfieldReverse(permuteUpwards(bitfieldReverse(index), seed)); }

// Digits of the sample's point before the scramble, the first in bit 0. The first dimension is the reversed index.
uvec2 demandDigits(Sampler s, uint seed) {
  const uint ofTile = shuffled(s.index, seed);
  const uint ofPixel = shuffled(s.index, hash(seed ^ s.pixel));
  const uint index = (ofTile & ~s.ownBits) | (ofPixel & s.ownBits);
  return uvec2(index, sobolSecondReversed(index)) ^ blueShift(s.place, seed);
}

uint nextBits(inout Sampler s) { return hash(demandSeed(s.pixel, s.dimension++) ^ hash(s.index)); }

float next1D(inout Sampler s) {
  const uint seed = demandSeed(s.tile, s.dimension++);
  return unitFloat(bitfieldReverse(permuteUpwards(demandDigits(s, seed).x, hash(seed ^ 0x2C1B3C6Du))));
}

vec2 next2D(inout Sampler s) {
  const uint seed = demandSeed(s.tile, s.dimension++);
  const uvec2 digits = demandDigits(s, seed);
  const uint x = permuteUpwards(digits.x, hash(seed ^ 0x2C1B3C6Du));
  const uint y = permuteUpwards(digits.y, hash(seed ^ 0x297A2D39u));
  return vec2(unitFloat(bitfieldReverse(x)), unitFloat(bitfieldReverse(y)));
}

#endif
