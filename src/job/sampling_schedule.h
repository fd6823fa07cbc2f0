// SPDX-License-Identifier: Apache-2.0
// Decides which batches are rendered next and when rendering stops: number of samples, target error, adaptive sampling.
#ifndef QUINTET_JOB_SAMPLING_SCHEDULE_H
#define QUINTET_JOB_SAMPLING_SCHEDULE_H

#include <cstdint>
#include <optional>
#include <vector>

#include "job/device_team.h"
#include "job/request.h"
#include "render/film/adaptive_plan.h"
#include "render/film/film_error.h"
#include "render/film/film_file.h"

namespace quintet::job {

// Where a render begins: at its first sample, at the first batch of a part, or where an earlier session stopped.
struct StartPoint {
  std::uint64_t begin = 0;          // first sample of the render or part
  std::uint64_t done = 0;           // next sample
  double seconds = 0;               // wall clock spent so far
  double batchSeconds = 0;          // of it, in the last batch
  std::vector<std::uint32_t> plan;  // of adaptive sampling: SamplingSchedule::plan() at that time; may be empty
};

class SamplingSchedule {
 public:
  SamplingSchedule(DeviceTeam& team, const RenderLimits& limits, const StartPoint& start);

  // Chooses the next batch, or for several devices as many as take about `seconds`, but none beyond the next decision. False: a limit
  // is reached, except the time limit, which is not checked here.
  bool next(double seconds = DeviceTeam::kRoundSeconds);
  ReachedLimit reached() const { return reached_; }  // after next() returned false
  // Renders the chosen batches. False: `progress` abandoned them.
  bool render(const render::BatchProgress& progress);

  double samples() const { return samples_; }            // per pixel, on average, of this render or part
  std::uint64_t nextSample() const { return done_; }     // of all pixels
  double batchSamples() const { return batchSamples_; }  // that the chosen batches add; 0 if adaptive
  std::optional<std::uint64_t> sampleLimit() const;      // of samples()
  const std::optional<render::ErrorEstimate>& estimate() const { return estimate_; }  // the latest one
  // expectedSamples() by the latest estimate; unset without target error.
  std::optional<double> targetSamples() const;
  // Batches per cell that adaptive sampling has decided on. Film and plan determine how the render continues.
  const std::vector<std::uint32_t>& plan() const { return plan_; }
  void estimateError();  // waits for the device

 private:
  // Estimates the error. Returns true if it decides that rendering stops.
  bool stopsAtError();
  bool nextUniformBatches();
  bool nextAdaptiveBatches();
  std::uint64_t batchesToDecision() const;  // uniform ones

  DeviceTeam& team_;
  const RenderLimits limits_;
  const StartPoint start_;
  std::uint64_t done_;       // next sample of all pixels
  std::uint64_t count_ = 0;  // samples of the chosen batches; 0: adaptive batches
  double seconds_ = 0;       // of next()
  std::vector<std::uint32_t> plan_;
  double samples_ = 0;
  double batchSamples_ = 0;
  ReachedLimit reached_ = ReachedLimit::samples;
  std::optional<render::ErrorEstimate> estimate_;
  double estimatedAt_ = 0;  // samples per pixel of estimate_
};

// Samples per pixel after which the target error will probably be reached: the error falls with the square root of their
// number. `samples`: of the estimate. Unset if the error is unknown.
std::optional<double> expectedSamples(const render::ErrorEstimate& estimate, double target, double samples);

// Some cell has fewer batches than planned.
bool hasRemainingBatches(const std::vector<std::uint32_t>& plan, const render::SampleCounts& counts);

// The next plan of adaptive sampling after the previous one was carried out: batches per cell. Empty: rendering stops.
std::vector<std::uint32_t> planNextBatches(const render::Region& region, const render::SampleCounts& counts,
                                           const render::ErrorEstimate& estimate, const RenderLimits& limits);

// An adaptive render with these limits would not add samples to this film. `plan`: render::FilmFile::plan.
bool isComplete(const render::FilmState& film, const std::vector<std::uint32_t>& plan,
                const render::ErrorEstimate& estimate, const RenderLimits& limits);

// The target error is the only limit, and the error can never be known, because sums exceed the film's range.
bool targetUnreachable(const render::ErrorEstimate& estimate, const RenderLimits& limits);

// The target error is checked after this number of batches. The numbers are fixed, so that the same request stops after
// the same samples whether or not it was interrupted: 4 to 15, then eight per doubling.
bool isErrorCheckpoint(std::uint64_t batches);

}  // namespace quintet::job
#endif
