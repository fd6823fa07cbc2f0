// SPDX-License-Identifier: Apache-2.0
// total += batch, squares += batch² / samples. A compute shader with one invocation per pixel; see
// src/render/film/film.h.
#extension GL_EXT_scalar_block_layout : require
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
  if (i >= pass.count) return;
  const vec4 batch = PixelArray(pass.batch).at[i];
  if (batch == vec4(0.0)) return;  // also pixels that adaptive sampling skips
  for (uint c = 0u; c < 4u; ++c) {
    add(pass.total, 4u * i + c, batch[c]);
    if (pass.squares == 0ul) continue;
    // A clamped square would understate the variance: mark it as not finite.
    const float square = batch[c] * batch[c] * pass.inverseSamples;
    add(pass.squares, 4u * i + c, square < kFixedLimit ? square : uintBitsToFloat(0x7F800000u));
  }
}
