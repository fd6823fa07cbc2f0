// SPDX-License-Identifier: Apache-2.0
#include "job/shared_devices.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "base/plural.h"
#include "gpu/error.h"
#include "render/film/adaptive_plan.h"
#include "render/film/film_error.h"
#include "render/tone_map/tone_map.h"

namespace quintet::job {
namespace {

constexpr auto kProgressInterval = std::chrono::milliseconds(50);
// The films are joined at least this often, so that a loss costs little, but for at most a fiftieth of the time.
constexpr double kJoinSeconds = 60.0;
constexpr double kJoinShare = 50.0;

}  // namespace

// The film of several devices, joined when it is read.
class SharedDevices::JoinedView : public FilmView {
 public:
  explicit JoinedView(SharedDevices& team) : team_(team), planes_(emptyPlanes(team.first().program())) {}

  const std::vector<render::FilmPlane>& planes() const override { return planes_; }
  bool stores(std::size_t output) const override { return team_.first().film().stores(output); }
  render::SampleCounts counts() const override { return team_.counts(); }
  io::Image image(std::size_t output) const override {
    io::Image image = render::planeImage(film(), output);
    if (planes_[output].kind == program::OutputKind::display)
      render::decodeDisplay(image, team_.first().settings().transparent);
    return image;
  }
  render::FilmPlane plane(std::size_t output) const override { return film().planes.at(output); }
  io::Image variance() const override { return render::varianceImage(film()); }
  render::FilmState state() const override { return film(); }

 private:
  const render::FilmState& film() const { return team_.joined(); }

  SharedDevices& team_;
  std::vector<render::FilmPlane> planes_;
};

// One thread per device takes pieces of the queue until none is left for it.
class SharedDevices::Crew {
 public:
  Crew(std::vector<Worker*> workers, WorkQueue& queue) : workers_(std::move(workers)), queue_(queue) {}

  // Returns false if `progress`, which is called by this thread, has canceled the work. Rethrows what a thread has thrown; a
  // loss is no failure.
  bool run(const std::function<bool(double pixelSamples)>& progress) {
    std::vector<std::jthread> threads;
    running_ = workers_.size();
    try {
      for (Worker* worker : workers_) threads.emplace_back([this, worker] { work(*worker); });
      watch(progress);
    } catch (...) {
      canceled_ = true;
      throw;  // after the threads have ended
    }
    threads.clear();
    if (failure_) std::rethrow_exception(failure_);
    return !canceled_;
  }
  double done() const { return done_; }  // pixel samples
  const std::vector<std::pair<Worker*, std::string>>& losses() const { return losses_; }

 private:
  void watch(const std::function<bool(double pixelSamples)>& progress) {
    std::unique_lock lock(mutex_);
    while (running_ > 0) {
      changed_.wait_for(lock, kProgressInterval, [this] { return running_ == 0; });
      const double done = done_;
      if (!progress) continue;
      lock.unlock();
      if (!progress(done)) canceled_ = true;
      lock.lock();
    }
  }

  void work(Worker& worker) noexcept {
    try {
      while (!canceled_) {
        const std::optional<WorkPiece> piece = nextPiece(worker);
        if (!piece || !render(worker, *piece)) break;
      }
    } catch (const TimeoutError&) {  // the program may never end, so the other devices cannot help
      fail();
    } catch (const DeviceLostError& error) {
      const std::lock_guard lock(mutex_);
      losses_.emplace_back(&worker, error.what());
      worker.lost = true;
      for (const WorkPiece& piece : worker.uncollected) done_ -= piece.pixelSamples();
      queue_.giveBack(worker.uncollected);
      worker.uncollected.clear();
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
    canceled_ = true;
  }

  std::optional<WorkPiece> nextPiece(Worker& worker) {
    const std::lock_guard lock(mutex_);
    double total = 0;
    bool isFastest = true;
    for (const Worker* other : workers_) {
      if (other->lost) continue;
      total += other->speed.value();
      isFastest = isFastest && other->speed.value() <= worker.speed.value();
    }
    std::optional<WorkPiece> piece = queue_.take(worker.speed.value(), total, isFastest);
    if (piece) worker.uncollected.push_back(*piece);
    return piece;
  }

  bool render(Worker& worker, const WorkPiece& piece) {
    render::Renderer& renderer = *worker.member->renderer;
    const Stopwatch clock;
    const render::Renderer::Part part{piece.batch->samples, piece.batch->tiles, piece.first, piece.count};
    if (!renderer.renderPart(part, [this](double /*fraction*/) { return !canceled_; })) return false;
    renderer.finish();
    const std::lock_guard lock(mutex_);
    worker.speed.add(piece.pixelSamples(), clock.seconds());
    done_ += piece.pixelSamples();
    return true;
  }

  const std::vector<Worker*> workers_;
  WorkQueue& queue_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<bool> canceled_{false};
  // With the lock.
  std::size_t running_ = 0;
  double done_ = 0;
  std::exception_ptr failure_;
  std::vector<std::pair<Worker*, std::string>> losses_;
};

SharedDevices::SharedDevices(std::vector<TeamMember> members) : DeviceTeam(std::move(members)) {
  for (TeamMember& member : members_) {
    std::string name =
        fmt::format("device {} of {} ({})", workers_.size() + 1, members_.size(), member.scene->context().info().name);
    workers_.push_back({&member, std::move(name), false, {}, {}});
  }
}

std::vector<std::size_t> SharedDevices::active() const {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < workers_.size(); ++i)
    if (!workers_[i].lost) indices.push_back(i);
  if (indices.empty())
    throw DeviceLostError(fmt::format("all {} devices were lost; the last one: {}", workers_.size(), lastLoss_));
  return indices;
}

std::vector<SharedDevices::Worker*> SharedDevices::activeWorkers() {
  std::vector<Worker*> workers;
  for (const std::size_t index : active()) workers.push_back(&workers_[index]);
  return workers;
}

void SharedDevices::markLost(Worker& worker, const std::string& reason) {
  worker.lost = true;
  redo_.insert(redo_.end(), worker.uncollected.begin(), worker.uncollected.end());
  worker.uncollected.clear();
  lastLoss_ = reason;
  const auto left =
      static_cast<std::size_t>(std::ranges::count_if(workers_, [](const Worker& other) { return !other.lost; }));
  if (left > 0)
    warnings_.push_back(fmt::format("{} was lost: {}; its samples are rendered again on {}", worker.name, reason,
                                    counted(left, "other device")));
}

std::vector<std::string> SharedDevices::takeWarnings() { return std::exchange(warnings_, {}); }

void SharedDevices::change(const std::function<void(TeamMember&)>& apply) {
  const std::vector<Worker*> changed = activeWorkers();
  std::vector<std::future<void>> changes;
  for (Worker* worker : changed)
    changes.push_back(std::async(std::launch::async, [&apply, worker] { apply(*worker->member); }));
  std::exception_ptr failure;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    try {
      changes[i].get();
    } catch (const TimeoutError&) {
      failure = std::current_exception();
    } catch (const DeviceLostError& error) {
      markLost(*changed[i], error.what());
    } catch (...) {
      failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
  static_cast<void>(active());  // throws if none is left
}

double SharedDevices::speed() const {
  double sum = 0;
  for (const Worker& worker : workers_) sum += worker.lost ? 0.0 : worker.speed.value();
  return sum;
}

std::uint64_t SharedDevices::batchesWithin(double seconds) const {
  const double batch = static_cast<double>(region().width) * region().height * render::kBatchSamples;
  return static_cast<std::uint64_t>(std::clamp(speed() * seconds / batch, 1.0, 1e6));
}

bool SharedDevices::perform(WorkQueue& queue, const render::BatchProgress& progress, double total) {
  double done = 0;
  while (!queue.empty()) {
    Crew crew(activeWorkers(), queue);
    std::function<bool(double)> report;
    if (progress) report = [&](double now) { return progress(std::clamp((done + now) / total, 0.0, 1.0)); };
    const bool complete = crew.run(report);
    for (const auto& [worker, reason] : crew.losses()) markLost(*worker, reason);
    if (!complete) return false;
    done += crew.done();
  }
  return true;
}

bool SharedDevices::renderRound(std::vector<std::shared_ptr<const WorkBatch>> batches, render::SampleCounts after,
                                const render::BatchProgress& progress) {
  double total = 0;
  for (const auto& batch : batches) total += batch->unitSamples * batch->units;
  if (stale_) restart();
  joinedAll_ = false;
  roundBatches_ = batches.size();
  WorkQueue queue(std::move(batches), std::exchange(redo_, {}));
  bool complete = false;
  try {
    complete = perform(queue, progress, total);
  } catch (...) {
    discard();
    throw;
  }
  if (!complete) {
    discard();
    return false;
  }
  counts_ = std::move(after);
  if (sinceJoin_.seconds() > std::max(kJoinSeconds, kJoinShare * joinSeconds_)) join();
  return true;
}

bool SharedDevices::renderSamples(std::uint64_t count, const render::BatchProgress& progress) {
  const auto begin = static_cast<std::uint32_t>(nextBatch_ * render::kBatchSamples);
  const render::SampleRange samples{begin, begin + static_cast<std::uint32_t>(count)};
  std::vector<std::shared_ptr<const WorkBatch>> batches;
  for (std::uint32_t first = begin; first < samples.end; first += render::kBatchSamples)
    batches.push_back(std::make_shared<WorkBatch>(
        WorkBatch::ofRows(region(), {first, std::min(first + render::kBatchSamples, samples.end)})));
  render::SampleCounts after = counts_;
  after.add(samples);
  const std::uint64_t next = nextBatch_ + batches.size();
  if (!renderRound(std::move(batches), std::move(after), progress)) return false;
  nextBatch_ = next;
  return true;
}

bool SharedDevices::renderCells(const std::vector<std::uint32_t>& limits, double seconds,
                                const render::BatchProgress& progress) {
  std::vector<std::shared_ptr<const WorkBatch>> batches;
  render::SampleCounts after = counts_;
  double work = 0;
  do {
    render::AdaptiveBatches next = render::nextAdaptiveBatches(region(), after, limits, first().needsOneBatch());
    if (next.tiles.empty()) break;
    auto batch = std::make_shared<WorkBatch>(WorkBatch::ofTiles(std::move(next.tiles)));
    work += batch->unitSamples * batch->units;
    batches.push_back(std::move(batch));
    after.cellBatches = std::move(next.counts);
  } while (work < speed() * seconds);
  assert(!batches.empty());
  return renderRound(std::move(batches), std::move(after), progress);
}

void SharedDevices::join() {
  if (joinedAll_ && joined_) return;
  if (stale_) restart();
  const Stopwatch clock;
  while (!joinedAll_ || !joined_) {
    if (!redo_.empty()) {
      WorkQueue queue({}, std::exchange(redo_, {}));
      perform(queue, {}, 0);
    }
    std::vector<std::pair<Worker*, std::future<render::FilmState>>> films;
    for (Worker* worker : activeWorkers())
      if (!worker->uncollected.empty() || (!joined_ && films.empty()))
        films.emplace_back(worker,
                           std::async(std::launch::async, [worker] { return worker->member->renderer->takeFilm(); }));
    for (auto& [worker, film] : films) {
      try {
        render::FilmState state = film.get();
        if (joined_)
          render::addFilm(*joined_, state);
        else
          joined_ = std::make_shared<render::FilmState>(std::move(state));
        worker->uncollected.clear();
      } catch (const TimeoutError&) {
        throw;
      } catch (const DeviceLostError& error) {
        markLost(*worker, error.what());
      }
    }
    joinedAll_ = redo_.empty();
  }
  joined_->counts = counts_;
  sinceJoin_ = Stopwatch();
  joinSeconds_ = clock.seconds();
}

const render::FilmState& SharedDevices::joined() {
  join();
  return *joined_;
}

render::ErrorEstimate SharedDevices::estimateError() { return render::estimateError(joined()); }

std::shared_ptr<FilmView> SharedDevices::view() { return std::make_shared<JoinedView>(*this); }

render::RayCount SharedDevices::rays() {
  if (joined_ && joinedAll_) return render::countRays(joined_->statistics, region());
  std::mutex mutex;
  render::RayCount sum;
  if (joined_) sum = render::countRays(joined_->statistics, region());
  change([&](TeamMember& member) {
    const render::RayCount rays = member.renderer->rays();
    const std::lock_guard lock(mutex);
    sum.rays += rays.rays;
    sum.droppedSamples += rays.droppedSamples;
  });
  return sum;
}

std::vector<render::NotFinitePixels> SharedDevices::notFinitePixels() { return render::findNotFinite(joined()); }

std::uint64_t SharedDevices::skippedTraces() {
  std::atomic<std::uint64_t> sum{0};
  change([&](TeamMember& member) { sum += member.renderer->skippedTraces(); });
  return sum;
}

void SharedDevices::restoreFilm(render::FilmState state) {
  restart();
  counts_ = state.counts;
  nextBatch_ =
      counts_.ranges.empty() ? 0 : (counts_.ranges.back().end + render::kBatchSamples - 1) / render::kBatchSamples;
  joined_ = std::make_shared<render::FilmState>(std::move(state));
}

void SharedDevices::discard() {
  joined_.reset();
  counts_ = {};
  nextBatch_ = 0;
  redo_.clear();
  joinedAll_ = stale_ = true;
  for (Worker& worker : workers_) worker.uncollected.clear();
}

void SharedDevices::restart() {
  discard();
  change([](TeamMember& member) { member.renderer->restart(); });
  stale_ = false;
  sinceJoin_ = Stopwatch();
}

std::unique_ptr<DeviceTeam> makeTeam(std::vector<TeamMember> members) {
  assert(!members.empty());
  if (members.size() == 1) return teamOfOne(std::move(members.front()));
  return std::make_unique<SharedDevices>(std::move(members));
}

}  // namespace quintet::job
