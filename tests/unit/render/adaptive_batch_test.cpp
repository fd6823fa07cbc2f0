// Which cells the next batch of adaptive sampling draws: of those below their limits, those with the fewest batches.
#include "render/adaptive_batch.h"

#include <gtest/gtest.h>

namespace quintet::render {
namespace {

const Region kRegion{7, 3, shared::kTileSize + 5, 2 * shared::kTileSize};  // 2 x 2 tiles, 8 cells

TEST(AdaptiveBatchTest, BeginsWithWhatAllPixelsHave) {
  SampleCounts counts;
  counts.ranges = {{0, 2 * kBatchSamples}};
  const AdaptiveBatch next = nextAdaptiveBatch(kRegion, counts, {2, 2, 5, 2, 2, 2, 3, 9});
  EXPECT_EQ(next.batch, 2u);
  EXPECT_EQ(next.counts, (std::vector<std::uint32_t>{2, 2, 3, 2, 2, 2, 3, 3}));
  ASSERT_EQ(next.tiles.size(), 2u);
  EXPECT_EQ(next.tiles[0].x, shared::kTileSize);
  EXPECT_EQ(next.tiles[0].y, 0u);
  EXPECT_EQ(next.tiles[0].drawn[0], 1u);
  EXPECT_EQ(next.tiles[0].drawn[1], 0u);
  EXPECT_EQ(next.tiles[1].x, shared::kTileSize);
  EXPECT_EQ(next.tiles[1].y, shared::kTileSize);
  EXPECT_EQ(next.tiles[1].drawn[0], 1u);
  EXPECT_EQ(next.tiles[1].drawn[1], 1u);
}

TEST(AdaptiveBatchTest, CellsThatAreBehindComeFirst) {
  SampleCounts counts;
  counts.ranges = {{0, 2 * kBatchSamples}};
  counts.cellBatches = {4, 3, 2, 6, 5, 3, 3, 2};
  const AdaptiveBatch next = nextAdaptiveBatch(kRegion, counts, {9, 9, 2, 9, 9, 9, 9, 2});  // those with 2 have enough
  EXPECT_EQ(next.batch, 3u);
  EXPECT_EQ(next.counts, (std::vector<std::uint32_t>{4, 4, 2, 6, 5, 4, 4, 2}));
  EXPECT_EQ(next.tiles.size(), 3u);
}

TEST(AdaptiveBatchTest, NothingIsLeft) {
  SampleCounts counts;
  counts.cellBatches = std::vector<std::uint32_t>(8, 4);
  EXPECT_TRUE(nextAdaptiveBatch(kRegion, counts, std::vector<std::uint32_t>(8, 4)).tiles.empty());
}

}  // namespace
}  // namespace quintet::render
