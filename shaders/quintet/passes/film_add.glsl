// SPDX-License-Identifier: Apache-2.0
// total += value, squares += value² / samples. A compute shader with one invocation per value of the batch; see
// src/render/film/film.h.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/passes/batch_pixel.glsl>
#include <quintet/passes/fixed_sum.glsl>
#include <quintet/passes/pass_index.glsl>

layout(local_size_x = kPassGroupSize) in;
layout(push_constant, scalar) uniform FilmAddBlock { FilmAdd pass; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PixelArray { vec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer FixedSumArray { FixedSum at[]; };

void add(Address sums, uint index, float value) {
  FixedSumArray(sums).at[index] = addFixed(FixedSumArray(sums).at[index], fixedFromFloat(value));
}

void main() {
  const uint i = passIndex();
  uint pixel;
  if (!findBatchPixel(pass.batch, i, pixel)) return;
  const vec4 value = PixelArray(pass.values).at[i];
  if (value == vec4(0.0)) return;
  for (uint c = 0u; c < 4u; ++c) {
    add(pass.total, 4u * pixel + c, value[c]);
    if (pass.squares == 0ul) continue;
    // A clamped square would understate the variance: mark it as not finite.
    const float square = value[c] * value[c] * pass.batch.inverseSamples;
    add(pass.squares, 4u * pixel + c, square < kFixedLimit ? square : uintBitsToFloat(0x7F800000u));
  }
}
