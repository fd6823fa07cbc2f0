// SPDX-License-Identifier: Apache-2.0
// The renderers of a job, one per device, and the film that they make together. There are two kinds of teams: one device, whose
// renderer does everything, and several devices. These share each batch by their measured speed. Their films are joined exactly
// in host memory, so that the bytes are those of one device of the same kind. A device that is lost leaves the team: the others
// render again what its film held.
#ifndef QUINTET_JOB_DEVICE_TEAM_H
#define QUINTET_JOB_DEVICE_TEAM_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "job/result.h"
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

  virtual ~DeviceTeam() = default;
  DeviceTeam(const DeviceTeam&) = delete;
  DeviceTeam& operator=(const DeviceTeam&) = delete;

  // All devices, lost ones included.
  const std::vector<TeamMember>& members() const { return members_; }
  bool isShared() const { return members_.size() > 1; }
  // For what all members have in common, such as settings and the linked program. Its film is that of the team only if there is
  // one device.
  render::Renderer& first() const { return *members_.front().renderer; }
  const render::Region& region() const { return first().film().region(); }

  // For work that is not on the film of the team: the indices of the devices that are not lost; and that one was lost.
  virtual std::vector<std::size_t> active() const = 0;  // throws DeviceLostError if there is none
  virtual void drop(std::size_t index, const std::string& reason) = 0;
  // Changes renderers or scenes: calls apply(member) for each device that is not lost, for several devices side by side. Throws
  // what it throws, and DeviceLostError if no device is left.
  virtual void change(const std::function<void(TeamMember&)>& apply) = 0;

  virtual const render::SampleCounts& counts() const = 0;
  // The number of uniform batches that take about `seconds`; 1 for one device and while the speed is unknown.
  virtual std::uint64_t batchesWithin(double seconds) const = 0;
  virtual std::uint64_t roundBatches() const = 0;  // of the last renderSamples() or renderCells()

  // Render the next batches of all pixels with this number of samples (one device: at most kBatchSamples); or batches of cells as
  // Renderer::renderCells() does, with several devices as many as take about `seconds`. Return false if `progress` canceled
  // them: one device then has the samples before them, several devices have lost all samples. Throw DeviceLostError if no
  // device is left.
  virtual bool renderSamples(std::uint64_t count, const render::BatchProgress& progress) = 0;
  virtual bool renderCells(const std::vector<std::uint32_t>& limits, double seconds,
                           const render::BatchProgress& progress) = 0;

  // Brings the film of all devices to the host; nothing to do for one device.
  virtual void join() = 0;
  // These read the film or its counters, and wait for the devices. Several devices join their films first.
  virtual std::shared_ptr<FilmView> view() = 0;  // of the film at any time, valid as long as the team
  virtual render::ErrorEstimate estimateError() = 0;
  virtual render::RayCount rays() = 0;
  virtual std::vector<render::NotFinitePixels> notFinitePixels() = 0;
  virtual std::uint64_t skippedTraces() = 0;
  virtual void finish() = 0;  // waits for launches in flight

  // Replaces the film by one that holds whole batches; the next samples follow it.
  virtual void restoreFilm(render::FilmState state) = 0;
  virtual void startAt(std::uint64_t batch) = 0;
  virtual void restart() = 0;  // discards all samples

  // Descriptions of the devices that were lost since the last call.
  virtual std::vector<std::string> takeWarnings() = 0;

 protected:
  explicit DeviceTeam(std::vector<TeamMember> members) : members_(std::move(members)) {}

  std::vector<TeamMember> members_;
};

std::unique_ptr<DeviceTeam> teamOfOne(TeamMember member);

// The planes of a film of the program, without samples.
std::vector<render::FilmPlane> emptyPlanes(const program::Program& program);

}  // namespace quintet::job
#endif
