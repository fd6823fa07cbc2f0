// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/shutter.h"

namespace quintet::render {
namespace {

std::uint32_t reverseBits(std::uint32_t x) {
  x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
  x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
  x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
  x = (x & 0x00FF00FFu) << 8 | (x >> 8 & 0x00FF00FFu);
  return x << 16 | x >> 16;
}

// hash() of quintet/sampling/hash.glsl.
std::uint32_t hashOf(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x21F0AAADu;
  x ^= x >> 15;
  x *= 0xD35A2D97u;
  x ^= x >> 15;
  return x;
}

}  // namespace

double sampleTime(const ShutterInterval& shutter, std::uint32_t sample, std::uint32_t seed) {
  const std::uint32_t fraction = reverseBits(sample) + hashOf(seed + 0x9E3779B9u);  // of 2^32, wraps around
  return shutter.open + (shutter.close - shutter.open) * (fraction * 0x1p-32);
}

}  // namespace quintet::render
