// SPDX-License-Identifier: Apache-2.0
// mean = total / samples, in single precision, for display. A compute shader with one invocation per pixel.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/passes/fixed_sum.glsl>
#include <quintet/passes/pass_index.glsl>

layout(local_size_x = kPassGroupSize) in;
layout(push_constant, scalar) uniform FilmMeanBlock { FilmMean pass; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer FixedSumArray { FixedSum at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MeanArray { vec4 at[]; };

void main() {
  const uint i = passIndex();
  if (i >= pass.count) return;
  vec4 mean;
  for (uint c = 0u; c < 4u; ++c) mean[c] = floatFromFixed(FixedSumArray(pass.total).at[4u * i + c]) * pass.inverseSamples;
  MeanArray(pass.mean).at[i] = mean;
}
