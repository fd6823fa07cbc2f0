// SPDX-License-Identifier: Apache-2.0
// The checkpoint of a long render: a film file that is replaced as rendering proceeds, and from which it resumes. One
// process at a time uses it.
#ifndef QUINTET_JOB_CHECKPOINT_H
#define QUINTET_JOB_CHECKPOINT_H

#include <cstdint>
#include <optional>

#include "base/file_lock.h"
#include "base/stopwatch.h"
#include "job/film_store.h"
#include "job/observer.h"
#include "job/request.h"
#include "job/result.h"
#include "job/sampling_schedule.h"

namespace quintet::job {

// The film to resume from; empty if it does not exist or the request starts over. `expected`: provenance and arrays of this
// render. Only reads the file, without a lock. Throws FileError if the file belongs to a different render, is damaged, or
// would be lost; MemoryError if it requests more than `maxMemory` (render::readFilm).
std::optional<StoredFilm> loadCheckpoint(const CheckpointRequest& request, const Provenance& expected,
                                         const render::FilmState& empty, const StartPoint& start,
                                         const RenderLimits& limits, Observer& observer, std::size_t maxMemory = 0);

class Checkpoint {
 public:
  // Locks the file until the destruction. Throws FileError if another process uses it for more than
  // CheckpointRequest::waitSeconds.
  Checkpoint(CheckpointRequest request, Observer& observer);

  // Like loadCheckpoint(). Also removes temporary files that an interrupted save() left behind.
  std::optional<StoredFilm> load(const Provenance& expected, const render::FilmState& empty, const StartPoint& start,
                                 const RenderLimits& limits, Observer& observer, std::size_t maxMemory = 0);

  bool isDue() const { return clock_.seconds() - lastSave_ >= request_.seconds; }
  // Replaces the file. A failure to write is a warning, once: the previous checkpoint is still there.
  void save(const RenderResult& result, Observer& observer);
  // Like save(), unless the file already holds all samples.
  void saveIfChanged(const RenderResult& result, Observer& observer);
  void remove(Observer& observer);

  // The file stays when the outputs are written: it was requested, or the render is incomplete.
  bool mustStay(const RenderResult& result) const { return request_.keep || result.interrupted || result.targetMissed; }
  std::uint64_t savedSamples() const { return savedSamples_; }  // per pixel, in the file
  const CheckpointRequest& request() const { return request_; }

 private:
  const CheckpointRequest request_;
  const FileLock lock_;
  const Stopwatch clock_;
  double lastSave_ = 0;  // on clock_
  std::uint64_t savedSamples_ = 0;
  render::SampleCounts savedCounts_;
  bool warned_ = false;
};

// Where a render continues after restoring this film, whose `file` is named in notes: that it resumes, and if device or
// target error have changed.
StartPoint resumePoint(const StoredFilm& film, const Provenance& current, const std::filesystem::path& file,
                       const StartPoint& start, Observer& observer);

}  // namespace quintet::job
#endif
