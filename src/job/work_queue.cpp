// SPDX-License-Identifier: Apache-2.0
#include "job/work_queue.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace quintet::job {
namespace {

// A device takes this share of what would be its part of the rest.
constexpr double kShare = 0.5;
// Pieces of less time cost too much between launches.
constexpr double kMinPieceSeconds = 0.004;
// Older pieces count half after about this time.
constexpr double kSpeedSeconds = 1.0;

}  // namespace

WorkBatch WorkBatch::ofRows(const render::Region& region, render::SampleRange samples) {
  return {samples, {}, region.height, static_cast<double>(region.width) * (samples.end - samples.begin)};
}

WorkBatch WorkBatch::ofTiles(std::vector<shared::FilmTile> tiles) {
  double cells = 0;
  for (const shared::FilmTile& tile : tiles) cells += tile.drawn[0] + tile.drawn[1];
  const double pixels = 0.5 * shared::kTileSize * shared::kTileSize * cells;
  const auto count = static_cast<std::uint32_t>(tiles.size());
  return {{}, std::move(tiles), count, pixels * render::kBatchSamples / std::max(1u, count)};
}

void SpeedMeter::add(double pixelSamples, double seconds) {
  if (!std::exchange(warm_, true)) return;
  if (seconds_ > kSpeedSeconds) {
    samples_ *= 0.5;
    seconds_ *= 0.5;
  }
  samples_ += pixelSamples;
  seconds_ += seconds;
  speed_ = seconds_ > 0 ? samples_ / seconds_ : 0;
}

WorkQueue::WorkQueue(std::vector<std::shared_ptr<const WorkBatch>> batches, std::deque<WorkPiece> redo)
    : batches_(std::move(batches)), redo_(std::move(redo)) {
  for (const auto& batch : batches_) remaining_ += batch->unitSamples * batch->units;
  for (const WorkPiece& piece : redo_) remaining_ += piece.pixelSamples();
}

std::optional<WorkPiece> WorkQueue::take(double speed, double total, bool isFastest) {
  const std::lock_guard lock(mutex_);
  if (!redo_.empty() && (isFastest || isWorthwhile(redo_.front().pixelSamples(), speed, total))) {
    WorkPiece piece = std::move(redo_.front());
    redo_.pop_front();
    remaining_ -= piece.pixelSamples();
    return piece;
  }
  return cut(speed, total, isFastest);
}

// Whether the device finishes so many pixel samples before the others finish all of the rest.
bool WorkQueue::isWorthwhile(double pixelSamples, double speed, double total) const {
  const double others = total - speed;
  return speed > 0 && (!(others > 0) || pixelSamples / speed <= remaining_ / others);
}

std::optional<WorkPiece> WorkQueue::cut(double speed, double total, bool isFastest) {
  if (batch_ == batches_.size()) return std::nullopt;
  const WorkBatch& batch = *batches_[batch_];
  const std::uint32_t left = batch.units - unit_;
  const std::uint32_t least = batch.tiles.empty() ? kMinRows : kMinTiles;
  std::uint32_t count = least;
  if (speed > 0) {
    if (!isFastest && !isWorthwhile(batch.unitSamples * std::min(least, left), speed, total)) return std::nullopt;
    const double samples = std::max(kShare * remaining_ * speed / std::max(total, speed), kMinPieceSeconds * speed);
    count = std::max(least, static_cast<std::uint32_t>(std::min<double>(left, std::ceil(samples / batch.unitSamples))));
  }
  count = (count + least - 1) / least * least;
  // A rest of a few rows would be a launch of its own.
  if (left < count + least) count = left;
  WorkPiece piece{batches_[batch_], unit_, count};
  remaining_ -= piece.pixelSamples();
  unit_ += count;
  if (unit_ == batch.units) {
    ++batch_;
    unit_ = 0;
  }
  return piece;
}

void WorkQueue::giveBack(const std::vector<WorkPiece>& pieces) {
  const std::lock_guard lock(mutex_);
  for (const WorkPiece& piece : pieces) {
    redo_.push_back(piece);
    remaining_ += piece.pixelSamples();
  }
}

bool WorkQueue::empty() const {
  const std::lock_guard lock(mutex_);
  return redo_.empty() && batch_ == batches_.size();
}

}  // namespace quintet::job
