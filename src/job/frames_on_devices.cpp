// SPDX-License-Identifier: Apache-2.0
// The frames of an animation on several devices: each renders whole frames, from a common list. Their results reach the
// observer in the order of the frames, from the thread of the job. If a device is lost, another one renders its frame.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include <quintet/device.h>

#include "job/render_job.h"

namespace quintet::job {
namespace {

constexpr auto kFramePollInterval = std::chrono::milliseconds(50);
// Finished frames that wait for an earlier one, per device; they are in host memory.
constexpr std::size_t kWaitingFrames = 2;

}  // namespace

RenderJob::RenderJob(const RenderJob& job, const TeamMember& member)
    : clock_(job.clock_),
      engine_(job.engine_),
      job_(job.job_),
      scene_(std::make_shared<PreparedScene>(*job.scene_)),
      diagnostics_(job.diagnostics_),
      team_(teamOfOne(member)),
      provenance_(job.provenance_),
      linkedSeconds_(job.linkedSeconds_) {
  std::vector<std::shared_ptr<render::DeviceScene>> scenes = std::exchange(scene_->onFurther, {});
  scenes.push_back(scene_->onDevice);
  scene_->onDevice = *std::ranges::find(scenes, member.scene, &std::shared_ptr<render::DeviceScene>::get);
  scene_->devices.resize(1);
}

// A thread per device, each with a job of its own.
class RenderJob::FrameCrew {
 public:
  // `devices`: indices of members of the team.
  FrameCrew(const RenderJob& job, std::vector<std::size_t> devices, const RenderLimits& limits, Observer& observer)
      : job_(job), limits_(limits), observer_(observer), devices_(std::move(devices)), running_(devices_.size()) {}

  // Renders the frames that are not rendered yet. Calls deliver(frame, result) for each in their order until it returns false.
  // Returns false if the observer abandons the frames. Losses are in losses() afterward; then frames can be missing.
  template <class Deliver>
  bool run(std::set<std::uint32_t> frames, const Deliver& deliver) {
    open_ = std::move(frames);
    std::vector<std::uint32_t> order(open_.begin(), open_.end());
    std::vector<std::jthread> threads;
    try {
      for (const std::size_t device : devices_) threads.emplace_back([this, device] { work(device); });
      for (const std::uint32_t frame : order) {
        std::optional<RenderResult> result = wait(frame);
        if (!result || !deliver(frame, std::move(*result))) break;
      }
    } catch (...) {
      stop(StopRequest::abandon);
      throw;  // after the threads have ended
    }
    stop(StopRequest::abandon);
    threads.clear();
    if (failure_) std::rethrow_exception(failure_);
    return !abandoned_;
  }
  const std::vector<std::pair<std::size_t, std::string>>& losses() const { return losses_; }

 private:
  // Takes the reports of a thread.
  class FrameObserver : public Observer {
   public:
    FrameObserver(FrameCrew& crew, std::uint32_t frame) : crew_(crew), frame_(frame) {}
    void warning(const std::string& text) override { crew_.observer_.warning(text); }
    void progress(const Progress& state) override {
      const std::lock_guard lock(crew_.mutex_);
      crew_.progress_[frame_] = state;
    }
    StopRequest stopRequested() override { return crew_.stop_; }

   private:
    FrameCrew& crew_;
    const std::uint32_t frame_;
  };

  void stop(StopRequest request) {
    const std::lock_guard lock(mutex_);
    stop_ = request;
    changed_.notify_all();
  }

  // Waits for a frame. Returns nothing if it will not come.
  std::optional<RenderResult> wait(std::uint32_t frame) {
    std::unique_lock lock(mutex_);
    next_ = frame;
    changed_.notify_all();
    while (true) {
      changed_.wait_for(lock, kFramePollInterval, [&] { return done_.contains(frame) || running_ == 0; });
      if (const auto found = done_.find(frame); found != done_.end()) {
        RenderResult result = std::move(found->second);
        done_.erase(found);
        progress_.erase(frame);
        return result;
      }
      if (running_ == 0) return std::nullopt;
      const std::optional<Progress> state = progress_.contains(frame) ? std::optional(progress_[frame]) : std::nullopt;
      lock.unlock();
      if (state) observer_.progress(*state);
      const StopRequest request = observer_.stopRequested();
      if (request == StopRequest::abandon) abandoned_ = true;
      if (request != StopRequest::none) stop(request);
      lock.lock();
    }
  }

  std::optional<std::uint32_t> take() {
    std::unique_lock lock(mutex_);
    const auto mayStart = [&] {
      if (stop_ != StopRequest::none) return true;
      return !open_.empty() && (done_.size() < kWaitingFrames * devices_.size() || *open_.begin() == next_);
    };
    changed_.wait(lock, [&] { return mayStart() || (open_.empty() && atWork_ == 0) || failure_; });
    if (stop_ != StopRequest::none || failure_ || open_.empty()) return std::nullopt;
    const std::uint32_t frame = *open_.begin();
    open_.erase(open_.begin());
    ++atWork_;
    return frame;
  }

  void work(std::size_t device) noexcept {
    std::optional<std::uint32_t> frame;
    try {
      RenderJob job(job_, job_.team_->members()[device]);
      while ((frame = take())) {
        FrameObserver observer(*this, *frame);
        RenderResult result = job.renderAnimationFrame(*frame, limits_, observer);
        if (!result.abandoned) result.film = viewOf(result.film->state(), result.provenance.transparent);
        const std::lock_guard lock(mutex_);
        --atWork_;
        if (result.abandoned) break;
        done_[*frame] = std::move(result);
        changed_.notify_all();
      }
    } catch (const TimeoutError&) {  // the program may never end, so the other devices cannot help
      fail();
    } catch (const DeviceLostError& error) {
      const std::lock_guard lock(mutex_);
      losses_.emplace_back(device, error.what());
      if (frame) {
        open_.insert(*frame);
        --atWork_;
      }
    } catch (...) {
      fail();
    }
    const std::lock_guard lock(mutex_);
    --running_;
    changed_.notify_all();
  }

  void fail() {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
    stop_ = StopRequest::abandon;
  }

  const RenderJob& job_;
  const RenderLimits& limits_;
  Observer& observer_;
  const std::vector<std::size_t> devices_;
  std::atomic<StopRequest> stop_{StopRequest::none};
  bool abandoned_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  // With the lock.
  std::set<std::uint32_t> open_;
  std::map<std::uint32_t, RenderResult> done_;
  std::map<std::uint32_t, Progress> progress_;
  std::uint32_t next_ = 0;  // frame that run() waits for
  std::size_t atWork_ = 0, running_;
  std::exception_ptr failure_;
  std::vector<std::pair<std::size_t, std::string>> losses_;
};

// A checkpoint holds one frame, so with checkpoints all devices share each frame.
bool RenderJob::givesFramesToDevices() const {
  const FrameRequest& frames = job_.request.frames;
  return team_->isShared() && frames.every && frames.lastFrame() > frames.firstFrame() && !checkpoint_;
}

RenderResult RenderJob::runFramesOnDevices(const RenderLimits& limits, Observer& observer) {
  const FrameRequest& frames = job_.request.frames;
  std::set<std::uint32_t> open;
  for (std::uint32_t frame = frames.firstFrame(); frame <= frames.lastFrame(); ++frame) open.insert(frame);
  const Stopwatch clock;
  FrameSequence sequence;
  bool proceed = true, complete = true;
  while (complete && proceed && !open.empty()) {
    FrameCrew crew(*this, team_->active(), limits, observer);
    complete = crew.run(open, [&](std::uint32_t frame, RenderResult result) {
      open.erase(frame);
      return proceed = addToSequence(sequence, frame, std::move(result), clock.seconds(), observer);
    });
    for (const auto& [index, reason] : crew.losses()) team_->drop(index, reason);
    reportLosses(observer);
  }
  if (!complete) {
    RenderResult useless;
    useless.abandoned = true;
    return useless;
  }
  // The scenes and renderers show what the last frames of the devices left.
  frame_ = frames.lastFrame();
  showFrame();
  team_->restart();
  return endSequence(std::move(sequence));
}

}  // namespace quintet::job
