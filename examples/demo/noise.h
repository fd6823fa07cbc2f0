// SPDX-License-Identifier: Apache-2.0
// Deterministic noise for textures, terrain and scattered objects.
#ifndef QUINTET_DEMO_NOISE_H
#define QUINTET_DEMO_NOISE_H

#include <cstdint>

#include "base/math.h"

namespace quintet::demo {

// Hash in [0,1) (PCG; Jarzynski & Olano 2020, "Hash Functions for GPU Rendering").
float hash01(std::uint32_t x, std::uint32_t y = 0, std::uint32_t z = 0, std::uint32_t seed = 0);

// A sequence of hashes.
class Random {
 public:
  explicit Random(std::uint32_t seed) : seed_(seed) {}
  float operator()() { return hash01(count_++, 0, 0, seed_); }
  float operator()(float low, float high) { return low + (high - low) * (*this)(); }

 private:
  std::uint32_t seed_;
  std::uint32_t count_ = 0;
};

// Gradient noise (Perlin 2002) in about [-1,1], 0 at lattice points. `period` is the number of lattice cells per
// repetition along each axis; 0 disables repetition.
float noise(vec3 p, std::uint32_t seed = 0, glm::ivec3 period = {0, 0, 0});

// Sum of octaves of noise in about [-1,1]. Each octave has twice the frequency and half the amplitude of the one
// before.
float fbm(vec3 p, int octaves, std::uint32_t seed = 0, glm::ivec3 period = {0, 0, 0});

}  // namespace quintet::demo
#endif
