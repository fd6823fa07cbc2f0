// SPDX-License-Identifier: Apache-2.0
// Adaptive sampling: how many batches each cell of a film gets, and which cells the next batch renders.
#ifndef QUINTET_RENDER_FILM_ADAPTIVE_PLAN_H
#define QUINTET_RENDER_FILM_ADAPTIVE_PLAN_H

#include <cstdint>
#include <vector>

#include "quintet/shared/frame.h"
#include "render/film/film_error.h"
#include "render/film/film_state.h"

namespace quintet::render {

struct CellGoal {
  double error = 0;    // for ErrorEstimate::reaches; 0 means no target: use all of `batches`
  double batches = 0;  // largest mean number of batches per pixel; 0 means no limit
};

// Returns the number of batches that each cell should have in the end, at least as many as it has. Of all allocations
// that reach a mean square error, the cheapest is proportional to the standard deviation (Neyman 1934).
//
// The spread of a cell is estimated from the other cell of its tile, whose pixels are sampled independently. The number
// of a cell's samples then does not depend on their values, which would bias the mean (Kirk & Arvo 1991, "Unbiased
// Sampling Techniques for Image Synthesis"). The same holds for the factor that all even cells share, their part of the
// batches or of the error, and ε: they are computed from the odd cells, and vice versa. Only a tile without a second
// cell (one pixel at an edge) uses its own samples. In later decisions a dependence remains through the numbers of
// earlier ones. docs/design/path-tracer.md, "How many samples".
std::vector<std::uint32_t> planCells(const ErrorEstimate& estimate, const CellGoal& goal);

struct AdaptiveBatch {
  std::uint32_t batch = 0;  // index of the batch, the same for all cells that are rendered
  // Tiles with at least one rendered cell. Empty if all cells have reached their limits.
  std::vector<shared::FilmTile> tiles;
  std::vector<std::uint32_t> counts;  // SampleCounts::cellBatches after this batch
};

// Selects the cells with the fewest batches among those that have fewer batches than `limits` demands.
AdaptiveBatch nextAdaptiveBatch(const Region& region, const SampleCounts& counts,
                                const std::vector<std::uint32_t>& limits);

}  // namespace quintet::render
#endif
