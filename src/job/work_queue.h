// SPDX-License-Identifier: Apache-2.0
// The work of several devices: batches, and how they are cut into pieces for devices of different speeds. Without Vulkan.
#ifndef QUINTET_JOB_WORK_QUEUE_H
#define QUINTET_JOB_WORK_QUEUE_H

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "render/film/film_state.h"

namespace quintet::job {

// One batch of all pixels of a film, or batches of tiles (render::AdaptiveBatches).
struct WorkBatch {
  render::SampleRange samples;          // of rows
  std::vector<shared::FilmTile> tiles;  // empty: all rows
  std::uint32_t units = 0;              // rows of the film, or tiles
  double unitSamples = 0;               // pixel samples per unit, on average

  static WorkBatch ofRows(const render::Region& region, render::SampleRange samples);
  static WorkBatch ofTiles(std::vector<shared::FilmTile> tiles);
};

// Units [first, first + count) of a batch.
struct WorkPiece {
  std::shared_ptr<const WorkBatch> batch;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  double pixelSamples() const { return batch->unitSamples * count; }
};

// The speed of a device, as its latest pieces show it.
class SpeedMeter {
 public:
  void add(double pixelSamples, double seconds);
  double value() const { return speed_; }  // pixel samples per second; 0 if unknown

 private:
  bool warm_ = false;  // the first piece includes what the driver does at the first launch, and is not counted
  double samples_ = 0, seconds_ = 0, speed_ = 0;
};

// Thread-safe. Pieces get smaller toward the end, so that all devices finish at about the same time.
class WorkQueue {
 public:
  // `redo`: pieces that come first.
  WorkQueue(std::vector<std::shared_ptr<const WorkBatch>> batches, std::deque<WorkPiece> redo);

  // Returns the next piece for a device of this speed; 0 means unknown, and gives the smallest piece. `total`: speed of all
  // devices together. Returns nothing if no work is left, or if the other devices finish the rest before this device
  // finishes its smallest piece; the fastest device (`isFastest`) always gets a piece.
  std::optional<WorkPiece> take(double speed, double total, bool isFastest);
  void giveBack(const std::vector<WorkPiece>& pieces);  // of a lost device

  bool empty() const;

  // Pieces have multiples of so many rows, except the last one of a batch. Launches of fewer rows waste the device.
  static constexpr std::uint32_t kMinRows = render::kLaunchRows;
  static constexpr std::uint32_t kMinTiles = 1;

 private:
  bool isWorthwhile(double pixelSamples, double speed, double total) const;
  std::optional<WorkPiece> cut(double speed, double total, bool isFastest);

  mutable std::mutex mutex_;
  const std::vector<std::shared_ptr<const WorkBatch>> batches_;
  std::deque<WorkPiece> redo_;
  std::size_t batch_ = 0;   // of the next piece
  std::uint32_t unit_ = 0;  // in that batch
  double remaining_ = 0;
};

}  // namespace quintet::job
#endif
