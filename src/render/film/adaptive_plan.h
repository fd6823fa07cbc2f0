// SPDX-License-Identifier: Apache-2.0
// Adaptive sampling: how many batches each cell of a film gets, and in which order.
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

struct AdaptiveBatches {
  // Tiles with at least one sampled cell, sorted by their batch. Empty if all cells have reached their limits.
  std::vector<shared::FilmTile> tiles;
  std::vector<std::uint32_t> counts;  // SampleCounts::cellBatches after these batches
};

// Selects batches of the cells that have fewer than `limits` demands, those with the lowest indices first, for as many tiles as
// the film has. The last cells with many batches then do not run alone, which would use a small part of a GPU. `one`: only
// batches with the same index.
AdaptiveBatches nextAdaptiveBatches(const Region& region, const SampleCounts& counts,
                                    const std::vector<std::uint32_t>& limits, bool one = false);

}  // namespace quintet::render
#endif
