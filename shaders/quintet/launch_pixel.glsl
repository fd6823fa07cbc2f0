// SPDX-License-Identifier: Apache-2.0
// The pixel of an invocation, in every ray tracing stage.
#ifndef QUINTET_LAUNCH_PIXEL_GLSL
#define QUINTET_LAUNCH_PIXEL_GLSL

#include "frame.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TileArray { FilmTile at[]; };

// Extracts bits 0, 2, 4, … into adjacent bits.
uint evenBits(uint x) {
  x &= 0x55555555u;
  x = (x | x >> 1) & 0x33333333u;
  x = (x | x >> 2) & 0x0F0F0F0Fu;
  return (x | x >> 4) & 0x00FF00FFu;
}

// The pixel of a column in this invocation's row of the launch. If the launch covers tiles, each row is one tile, with its pixels in
// Morton order.
uvec2 launchPixelIn(uint column) {
  if (launch.tiles == 0ul) return uvec2(column, gl_LaunchIDEXT.y) + launch.offset;
  const FilmTile tile = TileArray(launch.tiles).at[gl_LaunchIDEXT.y + launch.offset.y];
  return frame.filmOffset + uvec2(tile.x, tile.y) + uvec2(evenBits(column), evenBits(column >> 1));
}

// The pixel of this invocation.
uvec2 launchPixel() { return launchPixelIn(gl_LaunchIDEXT.x); }

// For programs with adaptive = true: true if this pixel is sampled in this batch. If false, write nothing.
bool launchActive(uvec2 pixel) {
  if (launch.tiles == 0ul) return true;
  const uvec2 film = pixel - frame.filmOffset;
  if (film.x >= frame.filmWidth || film.y >= frame.filmHeight) return false;
  const uint cell = (film.x + film.y) & 1u;
  return TileArray(launch.tiles).at[gl_LaunchIDEXT.y + launch.offset.y].drawn[cell] != 0u;
}

#endif
