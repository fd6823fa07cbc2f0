// SPDX-License-Identifier: Apache-2.0
// Counts the pixels of an output that are not finite, and finds the first of them. A compute shader with one invocation
// per pixel.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/passes/fixed_sum.glsl>
#include <quintet/passes/not_finite.glsl>
#include <quintet/passes/pass_index.glsl>

layout(local_size_x = kPassGroupSize) in;
layout(push_constant, scalar) uniform FilmCheckBlock { FilmCheck pass; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ValueArray { uvec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer FixedSumArray { FixedSum at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MarkArray { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer NotFiniteReference { NotFinite value; };

void main() {
  const uint i = passIndex();
  if (i >= pass.count) return;
  bool bad = false;
  if (pass.mark != 0u)
    bad = (MarkArray(pass.values).at[i] & pass.mark) != 0u;
  else if (pass.sums == 0u)
    bad = hasInfOrNan(ValueArray(pass.values).at[i]);
  else
    for (uint c = 0u; c < 4u; ++c) bad = bad || isNotFinite(FixedSumArray(pass.values).at[4u * i + c]);
  if (!bad) return;
  NotFiniteReference result = NotFiniteReference(pass.result);
  atomicAdd(result.value.count, 1u);
  atomicMin(result.value.first, i);
}
