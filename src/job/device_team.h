// SPDX-License-Identifier: Apache-2.0
// The renderers of a job, one per device, and the film that they make together. With one device it only forwards to its
// renderer. Several devices share each batch by their measured speed; their films are joined exactly in host memory, so that the
// bytes are those of one device of the same kind. A device that is lost leaves the team: the others render again what its
// film held.
#ifndef QUINTET_JOB_DEVICE_TEAM_H
#define QUINTET_JOB_DEVICE_TEAM_H

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/stopwatch.h"
#include "job/result.h"
#include "job/work_queue.h"
#include "render/renderer/renderer.h"

namespace quintet::job {

// A renderer with the scene that it renders, both on one device.
struct TeamMember {
  render::DeviceScene* scene = nullptr;
  std::shared_ptr<render::Renderer> renderer;
};

class DeviceTeam {
 public:
  // Several devices render batches for about this time before the job decides how to continue.
  static constexpr double kRoundSeconds = 2.0;

  // At least one member; all have the same program, settings and scene. Programs that accumulate and jobs that print have one.
  explicit DeviceTeam(std::vector<TeamMember> members);
  ~DeviceTeam();
  DeviceTeam(const DeviceTeam&) = delete;
  DeviceTeam& operator=(const DeviceTeam&) = delete;

  // For what all members have in common, such as settings and the linked program. Its film is that of the team only if there is
  // one device.
  render::Renderer& first() const { return *members_.front().member.renderer; }
  bool isShared() const { return members_.size() > 1; }    // several devices, lost ones included
  std::vector<const render::DeviceScene*> scenes() const;  // of all devices, lost ones included
  // For work that is not on the film of the team: a device that is not lost, with its index; and that it was lost.
  std::vector<std::pair<std::size_t, TeamMember>> members();  // throws DeviceLostError if there is none
  void drop(std::size_t index, const std::string& reason) { markLost(members_.at(index), reason); }
  std::uint64_t roundBatches() const { return roundBatches_; }  // of the last renderSamples() or renderCells()
  // Changes renderers or scenes: calls apply(member) for each device that is not lost, for several devices side by side. Throws
  // what it throws, and DeviceLostError if no device is left.
  void change(const std::function<void(TeamMember&)>& apply);

  const render::Region& region() const { return first().film().region(); }
  const render::SampleCounts& counts() const;
  // The number of uniform batches that take about `seconds`; 1 for one device and while the speed is unknown.
  std::uint64_t batchesWithin(double seconds) const;

  // Render the next batches of all pixels with this number of samples (one device: at most kBatchSamples); or batches of cells as
  // Renderer::renderCells() does, with several devices as many as take about `seconds`. Return false if `progress` canceled
  // them: one device then has the samples before them, several devices have lost all samples. Throw DeviceLostError if no
  // device is left.
  bool renderSamples(std::uint64_t count, const render::BatchProgress& progress);
  bool renderCells(const std::vector<std::uint32_t>& limits, double seconds, const render::BatchProgress& progress);

  // Brings the film of all devices to the host; nothing to do for one device.
  void join();
  // These read the film or its counters, and wait for the devices. Several devices join their films first.
  render::ErrorEstimate estimateError();
  render::FilmState saveFilm();
  std::shared_ptr<FilmView> view();  // of the film at any time, valid as long as the team
  render::RayCount rays();
  std::vector<render::NotFinitePixels> notFinitePixels();
  std::uint64_t skippedTraces();
  double deviceSeconds() const;  // sum of RenderStatistics::deviceSeconds
  void finish();                 // waits for launches in flight

  // Replaces the film by one that holds whole batches; the next samples follow it.
  void restoreFilm(render::FilmState state);
  void startAt(std::uint64_t batch);
  void restart();  // discards all samples

  // Descriptions of the devices that were lost since the last call.
  std::vector<std::string> takeWarnings();

 private:
  struct Worker {
    TeamMember member;
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
  void discard();                                            // all samples in host memory
  void markLost(Worker& worker, const std::string& reason);  // its work goes to redo_
  std::vector<Worker*> workers();  // that are not lost; throws DeviceLostError if there is none
  double speed() const;            // of all devices; 0 if unknown

  std::vector<Worker> members_;
  // With several devices: what they have joined so far, the counts of all samples, and the work that a lost device leaves.
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

}  // namespace quintet::job
#endif
