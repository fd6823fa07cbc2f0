// total += batch, one invocation per pixel. Compute main; see src/render/film.h for why the order matters.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/shared/frame.h>

layout(local_size_x = kFilmAddGroupSize) in;
layout(push_constant, scalar) uniform FilmAddBlock { FilmAdd pass; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PixelArray { vec4 at[]; };

void main() {
  const uint i = gl_GlobalInvocationID.y * (kFilmAddColumns * kFilmAddGroupSize) + gl_GlobalInvocationID.x;
  if (i < pass.count) PixelArray(pass.total).at[i] += PixelArray(pass.batch).at[i];
}
