// SPDX-License-Identifier: Apache-2.0
// The pixel of the film that a value of a batch belongs to.
#ifndef QUINTET_PASSES_BATCH_PIXEL_GLSL
#define QUINTET_PASSES_BATCH_PIXEL_GLSL
#include <quintet/shared/film.h>

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer FilmTileArray { FilmTile at[]; };

// Returns false if the value has no pixel: it is beyond the batch or the film, or its cell is not sampled in this batch.
bool findBatchPixel(FilmBatch batch, uint value, out uint pixel) {
  pixel = value;
  if (value >= batch.count) return false;
  if (batch.tiles == 0ul) return true;
  const FilmTile tile = FilmTileArray(batch.tiles).at[value / (kTileSize * kTileSize)];
  const uint x = tile.x + value % kTileSize, y = tile.y + value / kTileSize % kTileSize;
  pixel = y * batch.width + x;
  return x < batch.width && y < batch.height && tile.drawn[(x + y) & 1u] != 0u;
}

#endif
