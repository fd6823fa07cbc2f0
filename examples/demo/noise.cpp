// SPDX-License-Identifier: Apache-2.0
#include "demo/noise.h"

namespace quintet::demo {
namespace {

std::uint32_t pcg(std::uint32_t v) {
  const std::uint32_t state = v * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t seed) {
  return pcg(x + pcg(y + pcg(z + pcg(seed))));
}

// The dot product of `offset` with one of the twelve edge directions of a cube.
float gradient(std::uint32_t h, vec3 offset) {
  const std::uint32_t k = h % 12u;
  const float a = k < 8u ? offset.x : offset.y;
  const float b = k < 4u ? offset.y : offset.z;
  return ((h & 16u) != 0 ? -a : a) + ((h & 32u) != 0 ? -b : b);
}

int wrap(int i, int period) { return period > 0 ? ((i % period) + period) % period : i; }

}  // namespace

float hash01(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t seed) {
  return static_cast<float>(hash(x, y, z, seed) >> 8) * 0x1p-24f;
}

float noise(vec3 p, std::uint32_t seed, glm::ivec3 period) {
  const vec3 cell = glm::floor(p);
  const vec3 f = p - cell;
  const vec3 s = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
  const glm::ivec3 i(cell);
  std::uint32_t x[2], y[2], z[2];  // lattice coordinates of the two sides of the cell
  for (int k = 0; k < 2; ++k) {
    x[k] = static_cast<std::uint32_t>(wrap(i.x + k, period.x));
    y[k] = static_cast<std::uint32_t>(wrap(i.y + k, period.y));
    z[k] = static_cast<std::uint32_t>(wrap(i.z + k, period.z));
  }
  const std::uint32_t start = pcg(seed);
  float corner[8];
  for (unsigned c = 0; c < 8; c += 2) {  // hash(x, y, z, seed) with common terms computed once
    const unsigned dy = (c >> 1) & 1u, dz = c >> 2;
    const std::uint32_t row = pcg(y[dy] + pcg(z[dz] + start));
    const vec3 offset = f - vec3(0.0f, static_cast<float>(dy), static_cast<float>(dz));
    corner[c] = gradient(pcg(x[0] + row), offset);
    corner[c + 1] = gradient(pcg(x[1] + row), offset - vec3(1, 0, 0));
  }
  const float near = glm::mix(glm::mix(corner[0], corner[1], s.x), glm::mix(corner[2], corner[3], s.x), s.y);
  const float far = glm::mix(glm::mix(corner[4], corner[5], s.x), glm::mix(corner[6], corner[7], s.x), s.y);
  return glm::mix(near, far, s.z);
}

float fbm(vec3 p, int octaves, std::uint32_t seed, glm::ivec3 period) {
  float sum = 0.0f, weight = 0.5f;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * noise(p, seed + static_cast<std::uint32_t>(i), period);
    p *= 2.0f;
    period *= 2;
    weight *= 0.5f;
  }
  return sum;
}

}  // namespace quintet::demo
