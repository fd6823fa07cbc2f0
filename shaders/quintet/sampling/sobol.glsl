// SPDX-License-Identifier: Apache-2.0
// Owen-scrambled Sobol points, padded (B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020,
// https://jcgt.org/published/0009/04/01/), with errors that are blue noise over the image (blue_shift.glsl).
// A draw is one call of next1D or next2D. Draw d of a pixel uses the first two Sobol dimensions, shifted by the digits
// of the pixel. In each pixel, every prefix of 2^k samples is a (0,k,2)-net (1D: the first dimension). The numbers can
// be multiplied like independent numbers, for these reasons:
//  * Draws: a nested uniform scramble (Owen 1995) shuffles the order of the samples, and the Morton indices of the
//    pixels are permuted. Each d has separate seeds, so equal sample indices give different points.
//  * Coordinates: x and y of a point are scrambled with two more seeds. An Owen-scrambled point is uniform in the
//    square, so the estimate of each pixel is unbiased for any net.
//  * Pixels: pixels of different tiles have different seeds. Pixels of one tile are *not* independent, because their
//    errors must cancel. Use kIndependentPixels if the samples of a pixel decide on those of its neighbors.
// Seeds are 32-bit hashes. For one d, all tiles (or pixels) have distinct seeds; for two d, equal seeds are improbable.
#ifndef QUINTET_SAMPLING_SOBOL_GLSL
#define QUINTET_SAMPLING_SOBOL_GLSL
#ifdef QUINTET_SAMPLING_PCG_GLSL
#error "include either quintet/sampling/sobol.glsl or quintet/sampling/pcg.glsl"
#endif

#include "../shared/frame.h"
#include "blue_shift.glsl"
#include "sampler.glsl"

struct Sampler {
  uint index;      // of the sample in its pixel, with its bits reversed
  uint pixel;      // seed of the pixel
  uint tile;       // seed of its tile
  uint morton;     // Morton index of the pixel in the tile, with its bits reversed
  uint ownBits;    // mask of the bits of `index` that are shuffled per pixel; the others are shuffled per tile
  uint dimension;  // draws so far
};

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

// The pixels of a tile must use the same aligned ranges of 2^k indices. Therefore they share the shuffle of the nodes
// on the path to `plannedSamples` in the tree of these ranges. All nodes below are shuffled per pixel; otherwise
// products of draws would have more noise in some tiles than in others. With 0 planned samples, every count 2^k is as
// good as a planned count.
Sampler makeSampler(uvec2 pixel, uint sampleIndex, uint seed, uint plannedSamples) {
  const uint own = pixelSeed(pixel, seed);
  const uint tile = pixelSeed(pixel >> kTileBits, hash(seed));
  const int node = findMSB(sampleIndex ^ plannedSamples);  // -1: none
  const uint ownBits = (1u << max(node, 0)) - 1u;
  return Sampler(bitfieldReverse(sampleIndex), own, plannedSamples == kIndependentPixels ? own : tile,
                 reversedMortonInTile(pixel), bitfieldReverse(ownBits), 0u);
}

// Independent pixels.
Sampler makeSampler(uvec2 pixel, uint sampleIndex, uint seed) {
  return makeSampler(pixel, sampleIndex, seed, kIndependentPixels);
}

uint drawSeed(uint seed, uint dimension) { return hash(seed + 0x9E3779B9u * dimension); }

// Digits of the sample's point before the scramble, with the first digit in bit 0. The first dimension is the reversed
// index. Nested uniform scrambles shuffle the index.
uvec2 drawDigits(Sampler s, uint seed) {
  const uint ofTile = permuteUpwards(s.index, seed);
  const uint ofPixel = permuteUpwards(s.index, hash(seed ^ s.pixel));
  const uint index = bitfieldReverse((ofTile & ~s.ownBits) | (ofPixel & s.ownBits));
  // The halves of the seed are exchanged, because few of its low bits decide on the highest digits of both scrambles.
  return uvec2(index, sobolSecondReversed(index)) ^ blueShift(s.morton, seed << 16 | seed >> 16);
}

uint nextBits(inout Sampler s) { return hash(drawSeed(s.pixel, s.dimension++) ^ hash(bitfieldReverse(s.index))); }

void skipDraw(inout Sampler s) { s.dimension++; }

float next1D(inout Sampler s) {
  const uint seed = drawSeed(s.tile, s.dimension++);
  return unitFloat(bitfieldReverse(permuteUpwards(drawDigits(s, seed).x, hash(seed ^ 0x2C1B3C6Du))));
}

vec2 next2D(inout Sampler s) {
  const uint seed = drawSeed(s.tile, s.dimension++);
  const uvec2 digits = drawDigits(s, seed);
  const uint x = permuteUpwards(digits.x, hash(seed ^ 0x2C1B3C6Du));
  const uint y = permuteUpwards(digits.y, hash(seed ^ 0x297A2D39u));
  return vec2(unitFloat(bitfieldReverse(x)), unitFloat(bitfieldReverse(y)));
}

#endif
