// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/cancellation.h"

namespace quintet {
namespace {

thread_local bool insideLoop = false;

// Threads take indices from a shared counter until it reaches the count or a call has thrown.
class Loop {
 public:
  Loop(std::size_t count, const std::function<void(std::size_t)>& body) : count_(count), body_(body) {}

  void work() noexcept {
    const bool outer = std::exchange(insideLoop, true);
    const Cancellation::Scope scope(cancellation_);
    try {
      for (std::size_t i; !failed_ && (i = next_.fetch_add(1)) < count_;) {
        throwIfCanceled();
        body_(i);
      }
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      failed_ = true;
    }
    insideLoop = outer;
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::size_t count_;
  const std::function<void(std::size_t)>& body_;
  Cancellation* const cancellation_ = Cancellation::current();
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

unsigned hardwareThreads() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0) return static_cast<unsigned>(std::max(1, CPU_COUNT(&set)));
  return std::max(1u, std::thread::hardware_concurrency());
}

void parallelFor(std::size_t count, const std::function<void(std::size_t)>& body) {
  throwIfCanceled();
  if (count == 1) return body(0);  // a loop inside the body can then use all cores
  Loop loop(count, body);
  std::vector<std::jthread> helpers;
  // A nested loop stays on its thread, because the outer loop already uses the other cores.
  if (count > 1 && !insideLoop) {
    const std::size_t wanted = std::min<std::size_t>(count, hardwareThreads()) - 1;
    helpers.reserve(wanted);
    try {
      while (helpers.size() < wanted) helpers.emplace_back([&loop] { loop.work(); });
    } catch (const std::system_error&) {
      // The system has no more threads. The started ones and this thread do the work.
    }
  }
  loop.work();
  helpers.clear();  // joins
  loop.rethrow();
}

void parallelCopy(std::byte* to, std::span<const std::byte> from) {
  constexpr std::size_t kPart = std::size_t{4} << 20;
  parallelFor((from.size() + kPart - 1) / kPart, [&](std::size_t part) {
    const std::size_t first = part * kPart;
    std::memcpy(to + first, from.data() + first, std::min(kPart, from.size() - first));
  });
}

}  // namespace quintet
