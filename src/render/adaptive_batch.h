// The next batch of adaptive sampling: which cells of a film are drawn, as tiles for the device.
#ifndef QUINTET_RENDER_ADAPTIVE_BATCH_H
#define QUINTET_RENDER_ADAPTIVE_BATCH_H

#include <cstdint>
#include <vector>

#include "quintet/shared/frame.h"
#include "render/film_state.h"

namespace quintet::render {

struct AdaptiveBatch {
  std::uint32_t batch = 0;              // its number, the same for all cells that are drawn
  std::vector<shared::FilmTile> tiles;  // those with a cell that is drawn; none: no cell is below its limit
  std::vector<std::uint32_t> counts;    // SampleCounts::cellBatches after it
};

// Of the cells that have fewer batches than `limits` says, those that have the fewest.
AdaptiveBatch nextAdaptiveBatch(const Region& region, const SampleCounts& counts,
                                const std::vector<std::uint32_t>& limits);

}  // namespace quintet::render
#endif
