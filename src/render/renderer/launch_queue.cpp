// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/launch_queue.h"

#include <algorithm>
#include <cassert>

#include <quintet/device.h>

#include <fmt/format.h>

#include "base/plural.h"

namespace quintet::render {

LaunchQueue::LaunchQueue(gpu::Context& context, const RenderSettings& settings, RenderStatistics& statistics)
    : context_(context),
      statistics_(statistics),
      timeoutSeconds_(settings.timeoutSeconds),
      maxInFlight_(settings.launchesInFlight),
      profile_(settings.profile),
      sizes_(context.info().software, static_cast<double>(context.info().limits.maxLaunchInvocations),
             settings.launchSeconds),
      timers_{gpu::Timer(context, 4), gpu::Timer(context, 4)} {
  assert(maxInFlight_ >= 1 && maxInFlight_ <= kMaxLaunchesInFlight);
}

void LaunchQueue::compile(const Record& trace) {
  const Stopwatch clock;
  context_.wait(context_.submit(trace));
  compileSeconds_ = clock.seconds();
}

void LaunchQueue::submit(const Launch& launch) {
  while (inFlight_.size() >= maxInFlight_) finishOldest();
  gpu::Timer& timer = timers_[count_++ % kMaxLaunchesInFlight];
  const Stopwatch sinceRecording;
  const std::uint64_t value = context_.submit([&](gpu::Commands& commands) {
    timer.reset(commands);
    timer.mark(commands, 0);
    if (launch.before) launch.before(commands);
    timer.mark(commands, 1);
    launch.trace(commands);
    timer.mark(commands, 2);
    if (launch.after) launch.after(commands);
    timer.mark(commands, 3);
  });
  inFlight_.push_back({value, sinceRecording, &timer, count_, launch.rows, launch.samples, launch.pixelSamples});
  // The first launch measures the rate for the others.
  if (maxInFlight_ == 1 || statistics_.firstLaunchSeconds == 0) finish();
}

void LaunchQueue::finish() {
  while (!inFlight_.empty()) finishOldest();
}

void LaunchQueue::finishOldest() {
  const InFlight launch = inFlight_.front();
  inFlight_.pop_front();
  try {
    context_.wait(launch.value, timeoutSeconds_);
  } catch (const TimeoutError& error) {
    const double pixels = launch.pixelSamples / launch.samples;
    throw TimeoutError(error.seconds(), fmt::format("launch {} ({}, {} each)", launch.number,
                                                    counted(static_cast<std::uint64_t>(pixels), "pixel"),
                                                    counted(launch.samples, "sample")));
  }
  const double wall = launch.sinceRecording.seconds();
  if (statistics_.firstLaunchSeconds == 0) statistics_.firstLaunchSeconds = compileSeconds_ + wall;
  const double device = launch.timer->seconds(1, 2);
  if (profile_) recordTiming(launch, wall);
  statistics_.deviceSeconds += device;
  sizes_.add(launch.pixelSamples, device > 0 ? device : wall);
}

void LaunchQueue::recordTiming(const InFlight& launch, double wallSeconds) {
  const gpu::Timer& timer = *launch.timer;
  const double idle = timings_.empty() ? 0.0 : std::max(0.0, timer.stamp(0) - lastStamp_);
  timings_.push_back(
      {launch.rows, launch.samples, timer.seconds(0, 1), timer.seconds(1, 2), timer.seconds(2, 3), idle, wallSeconds});
  lastStamp_ = timer.stamp(3);
}

}  // namespace quintet::render
