// SPDX-License-Identifier: Apache-2.0
// The work of several devices: every row of every batch is given out once, to devices of any speed, and again if a device is
// lost.
#include "job/work_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace quintet::job {
namespace {

constexpr render::Region kQueuedRegion{0, 0, 64, 100};

std::vector<std::shared_ptr<const WorkBatch>> batches(std::uint32_t count) {
  std::vector<std::shared_ptr<const WorkBatch>> result;
  for (std::uint32_t b = 0; b < count; ++b)
    result.push_back(std::make_shared<WorkBatch>(WorkBatch::ofRows(kQueuedRegion, {4 * b, 4 * b + 4})));
  return result;
}

// How often each row of each batch was given out.
class Tally {
 public:
  void add(const WorkPiece& piece, int times = 1) {
    ASSERT_LE(piece.first + piece.count, piece.batch->units);
    for (std::uint32_t row = piece.first; row < piece.first + piece.count; ++row)
      rows_[{piece.batch->samples.begin, row}] += times;
  }
  void expectOnce(std::size_t count) const {
    EXPECT_EQ(rows_.size(), count);
    for (const auto& [row, times] : rows_) ASSERT_EQ(times, 1) << row.first << ' ' << row.second;
  }

 private:
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> rows_;
};

// Simulates devices of these speeds, in pixel samples per second. Returns the seconds until all are idle.
double simulate(WorkQueue& queue, const std::vector<double>& speeds, Tally& tally) {
  double total = 0;
  for (const double speed : speeds) total += speed;
  const double fastest = *std::max_element(speeds.begin(), speeds.end());
  std::vector<double> idleAt(speeds.size(), 0.0);
  std::vector<bool> working(speeds.size(), true);
  while (std::find(working.begin(), working.end(), true) != working.end()) {
    std::size_t next = speeds.size();
    for (std::size_t i = 0; i < speeds.size(); ++i)
      if (working[i] && (next == speeds.size() || idleAt[i] < idleAt[next])) next = i;
    const std::optional<WorkPiece> piece = queue.take(speeds[next], total, speeds[next] == fastest);
    working[next] = piece.has_value();
    if (!piece) continue;
    tally.add(*piece);
    idleAt[next] += piece->pixelSamples() / speeds[next];
  }
  return *std::max_element(idleAt.begin(), idleAt.end());
}

TEST(WorkQueue, GivesOutEachRowOnce) {
  for (const std::vector<double>& speeds :
       {std::vector<double>{1e6}, {1e6, 1e6}, {1e6, 2e6, 3e6, 4e6}, {1e9, 1e5}, {1e2, 1e2, 1e2}}) {
    WorkQueue queue(batches(7), {});
    Tally tally;
    simulate(queue, speeds, tally);
    EXPECT_TRUE(queue.empty());
    tally.expectOnce(700);
  }
}

// On NVIDIA, what a ray hits can depend on the other pixels of its group (docs/design/quirks.md).
TEST(WorkQueue, CutsAtMultiplesOfRows) {
  WorkQueue queue(batches(9), {});
  for (const double speed : {0.0, 3e5, 1e6, 2.1e6, 7e5}) {
    for (int i = 0; i < 5; ++i) {
      const std::optional<WorkPiece> piece = queue.take(speed, 5e6, true);
      ASSERT_TRUE(piece);
      EXPECT_EQ(piece->first % render::kLaunchRows, 0u);
      EXPECT_TRUE(piece->count % render::kLaunchRows == 0 || piece->first + piece->count == piece->batch->units);
    }
  }
}

// Equal devices work for about the same time; a slow one does not delay the others.
TEST(WorkQueue, FinishesTogether) {
  const double work = 64.0 * 100 * 4 * 256;
  for (const std::vector<double>& speeds : {std::vector<double>{1e6, 1e6, 1e6, 1e6}, {1e6, 5e5}, {1e6, 1e6, 1e4}}) {
    double total = 0;
    for (const double speed : speeds) total += speed;
    WorkQueue queue(batches(256), {});
    Tally tally;
    const double seconds = simulate(queue, speeds, tally);
    EXPECT_LT(seconds, 1.02 * work / total) << speeds.size();
    tally.expectOnce(25600);
  }
}

TEST(WorkQueue, DoesNotWaitForAVerySlowDevice) {
  WorkQueue queue(batches(2), {});
  EXPECT_FALSE(queue.take(10.0, 1e6 + 10.0, false)) << "its smallest piece takes minutes, the rest 0.05 s";
  EXPECT_TRUE(queue.take(1e6, 1e6 + 10.0, true));
}

TEST(WorkQueue, GivesTheSmallestPieceToADeviceOfUnknownSpeed) {
  WorkQueue queue(batches(2), {});
  EXPECT_EQ(queue.take(0.0, 0.0, true)->count, WorkQueue::kMinRows);
  EXPECT_GT(queue.take(1e6, 1e6, true)->count, WorkQueue::kMinRows);
}

TEST(WorkQueue, RepeatsWhatALostDeviceHad) {
  WorkQueue queue(batches(3), {});
  Tally tally;
  std::vector<WorkPiece> lost;
  for (int i = 0; i < 4; ++i) {
    lost.push_back(*queue.take(1e6, 2e6, true));
    tally.add(lost.back());
  }
  for (const WorkPiece& piece : lost) tally.add(piece, -1);
  queue.giveBack(lost);
  EXPECT_FALSE(queue.empty());
  simulate(queue, {1e6}, tally);
  tally.expectOnce(300);
}

TEST(WorkQueue, CutsTiles) {
  std::vector<shared::FilmTile> tiles(37);
  for (shared::FilmTile& tile : tiles) tile.drawn[0] = tile.drawn[1] = 1;
  const auto batch = std::make_shared<WorkBatch>(WorkBatch::ofTiles(tiles));
  EXPECT_EQ(batch->units, 37u);
  EXPECT_DOUBLE_EQ(batch->unitSamples, 32 * 32 * 4);
  WorkQueue queue({batch}, {});
  Tally tally;
  simulate(queue, {1e5, 3e5}, tally);
  tally.expectOnce(37);
}

TEST(SpeedMeter, IgnoresTheFirstPieceAndFollowsTheLatest) {
  SpeedMeter meter;
  EXPECT_EQ(meter.value(), 0.0);
  meter.add(1000, 10.0);
  EXPECT_EQ(meter.value(), 0.0) << "the driver compiles in the first launch";
  meter.add(1000, 1.0);
  EXPECT_DOUBLE_EQ(meter.value(), 1000.0);
  for (int i = 0; i < 20; ++i) meter.add(500, 1.0);
  EXPECT_NEAR(meter.value(), 500.0, 5.0);
}

}  // namespace
}  // namespace quintet::job
