// SPDX-License-Identifier: Apache-2.0
// total = frame, and marks the pixels that are not finite: the next frame can overwrite them. A compute shader with one
// invocation per pixel; see src/render/film/film.h.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/passes/not_finite.glsl>
#include <quintet/passes/pass_index.glsl>
#include <quintet/shared/film.h>

layout(local_size_x = kPassGroupSize) in;
layout(push_constant, scalar) uniform FilmFrameBlock { FilmFrame pass; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ValueArray { uvec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MarkArray { uint at[]; };

void main() {
  const uint i = passIndex();
  if (i >= pass.count) return;
  const uvec4 value = ValueArray(pass.batch).at[i];
  ValueArray(pass.total).at[i] = value;
  // Atomic, because the passes of several outputs run at the same time.
  if (hasInfOrNan(value)) atomicOr(MarkArray(pass.marks).at[i], pass.mark);
}
