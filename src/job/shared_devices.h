// SPDX-License-Identifier: Apache-2.0
// A team of several devices (device_team.h).
#ifndef QUINTET_JOB_SHARED_DEVICES_H
#define QUINTET_JOB_SHARED_DEVICES_H

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/stopwatch.h"
#include "job/device_team.h"
#include "job/work_queue.h"

namespace quintet::job {

class SharedDevices : public DeviceTeam {
 public:
  explicit SharedDevices(std::vector<TeamMember> members);

  std::vector<std::size_t> active() const override;
  void drop(std::size_t index, const std::string& reason) override { markLost(workers_.at(index), reason); }
  void change(const std::function<void(TeamMember&)>& apply) override;
  const render::SampleCounts& counts() const override { return counts_; }
  std::uint64_t batchesWithin(double seconds) const override;
  std::uint64_t roundBatches() const override { return roundBatches_; }
  bool renderSamples(std::uint64_t count, const render::BatchProgress& progress) override;
  bool renderCells(const std::vector<std::uint32_t>& limits, double seconds,
                   const render::BatchProgress& progress) override;
  void join() override;
  std::shared_ptr<FilmView> view() override;
  render::ErrorEstimate estimateError() override;
  render::RayCount rays() override;
  std::vector<render::NotFinitePixels> notFinitePixels() override;
  std::uint64_t skippedTraces() override;
  void finish() override {}  // the devices finish each piece
  void restoreFilm(render::FilmState state) override;
  void startAt(std::uint64_t batch) override { nextBatch_ = batch; }
  void restart() override;
  std::vector<std::string> takeWarnings() override;

 private:
  struct Worker {
    TeamMember* member = nullptr;
    std::string name;  // for messages
    bool lost = false;
    SpeedMeter speed;                    // pixel samples per second
    std::vector<WorkPiece> uncollected;  // in its film
  };
  class Crew;  // the threads that work on a queue
  class JoinedView;

  // Return false if `progress` canceled them.
  bool perform(WorkQueue& queue, const render::BatchProgress& progress, double total);  // `total`: pixel samples
  bool renderRound(std::vector<std::shared_ptr<const WorkBatch>> batches, render::SampleCounts after,
                   const render::BatchProgress& progress);
  const render::FilmState& joined();
  void discard();                                            // all samples in host memory
  void markLost(Worker& worker, const std::string& reason);  // its work goes to redo_
  std::vector<Worker*> activeWorkers();                      // throws DeviceLostError if there is none
  double speed() const;                                      // of all devices; 0 if unknown

  std::vector<Worker> workers_;  // one per member
  // What the devices have joined so far, the counts of all samples, and the work that a lost device leaves.
  std::shared_ptr<render::FilmState> joined_;
  render::SampleCounts counts_;
  std::uint64_t nextBatch_ = 0;
  std::uint64_t roundBatches_ = 1;
  std::deque<WorkPiece> redo_;
  bool joinedAll_ = true;  // no device has samples of its own
  bool stale_ = false;     // the devices have samples that were discarded
  Stopwatch sinceJoin_;
  double joinSeconds_ = 0;  // of the last one
  std::string lastLoss_;
  std::vector<std::string> warnings_;
};

// At least one member; all have the same program, settings and scene. Programs that accumulate and jobs that print have one.
std::unique_ptr<DeviceTeam> makeTeam(std::vector<TeamMember> members);

}  // namespace quintet::job
#endif
