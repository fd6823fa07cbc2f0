// SPDX-License-Identifier: Apache-2.0
// The pixel of an invocation, in every ray tracing stage.
#ifndef QUINTET_LAUNCH_PIXEL_GLSL
#define QUINTET_LAUNCH_PIXEL_GLSL

#include "frame.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TileArray { FilmTile at[]; };

// The tile that this invocation belongs to, if the launch covers tiles. Its rows are those of the tiles, one tile after another.
FilmTile launchTile() { return TileArray(launch.tiles).at[(gl_LaunchIDEXT.y + launch.offset.y) / kTileSize]; }

// The pixel of a column in this invocation's row of the launch.
uvec2 launchPixelIn(uint column) {
  const uvec2 position = uvec2(column, gl_LaunchIDEXT.y) + launch.offset;
  if (launch.tiles == 0ul) return position;
  const FilmTile tile = launchTile();
  return frame.filmOffset + uvec2(tile.x + position.x, tile.y + position.y % kTileSize);
}

// The index of a pixel of this invocation's row in the arrays of the outputs (Frame::outputs).
uint outputIndex(uvec2 pixel) {
  const uvec2 film = pixel - frame.filmOffset;
  return launch.tiles == 0ul ? film.y * frame.filmWidth + film.x
                             : (gl_LaunchIDEXT.y + launch.offset.y) * kTileSize + film.x % kTileSize;
}

// The pixel of this invocation.
uvec2 launchPixel() { return launchPixelIn(gl_LaunchIDEXT.x); }

// For programs with adaptive = true: true if this pixel is sampled in this batch. If false, write nothing.
bool launchActive(uvec2 pixel) {
  if (launch.tiles == 0ul) return true;
  const uvec2 film = pixel - frame.filmOffset;
  if (film.x >= frame.filmWidth || film.y >= frame.filmHeight) return false;
  const uint cell = (film.x + film.y) & 1u;
  return launchTile().drawn[cell] != 0u;
}

#endif
