#include "render/adaptive_batch.h"

#include <algorithm>
#include <limits>

namespace quintet::render {

AdaptiveBatch nextAdaptiveBatch(const Region& region, const SampleCounts& counts,
                                const std::vector<std::uint32_t>& limits) {
  AdaptiveBatch next;
  next.counts = counts.cellBatches;
  if (next.counts.empty()) next.counts.assign(limits.size(), static_cast<std::uint32_t>(counts.batches()));
  next.batch = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t c = 0; c < limits.size(); ++c)
    if (next.counts[c] < limits[c]) next.batch = std::min(next.batch, next.counts[c]);
  const std::uint32_t columns = tileColumns(region.width);
  for (std::uint32_t t = 0; t < limits.size() / 2; ++t) {
    shared::FilmTile tile{t % columns * shared::kTileSize, t / columns * shared::kTileSize, {}};
    for (std::uint32_t c = 0; c < 2; ++c) {
      tile.drawn[c] = next.counts[2 * t + c] == next.batch && next.batch < limits[2 * t + c] ? 1 : 0;
      next.counts[2 * t + c] += tile.drawn[c];
    }
    if (tile.drawn[0] + tile.drawn[1] > 0) next.tiles.push_back(tile);
  }
  return next;
}

}  // namespace quintet::render
