// SPDX-License-Identifier: Apache-2.0
// The common interface of the two samplers: `struct Sampler` with
//   Sampler makeSampler(uvec2 pixel, uint sampleIndex, uint seed)                       pixels are independent
//   Sampler makeSampler(uvec2 pixel, uint sampleIndex, uint seed, uint plannedSamples)  their errors are blue noise;
//                                                                         frame.plannedSamples
//   float next1D(inout Sampler)   vec2 next2D(inout Sampler)   in [0,1)
//   uint nextBits(inout Sampler)  32 independent bits, e.g. a ray's seed
//   void skipDraw(inout Sampler)  instead of a draw that is not needed: later draws have the same numbers as after it
// A program includes either sobol.glsl (converges faster) or pcg.glsl (independent numbers), not both.
#ifndef QUINTET_SAMPLING_SAMPLER_GLSL
#define QUINTET_SAMPLING_SAMPLER_GLSL

#include "hash.glsl"

// For each seed a bijection on pixels up to 65536 x 65536: no two pixels of an image share a value.
uint pixelSeed(uvec2 pixel, uint seed) { return hashCombine(hash(pixel.x | pixel.y << 16), seed); }

#endif
