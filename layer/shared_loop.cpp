// SPDX-License-Identifier: Apache-2.0
#include "shared_loop.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace quintet::layer {

void SharedLoop::run(std::size_t count, const std::function<void(std::size_t)>& body,
                     const std::function<void()>& started) {
  std::unique_lock alone(running_, std::try_to_lock);
  if (!alone) {
    join();  // the other loop can be one of low priority
    alone.lock();
  }
  {
    const std::scoped_lock lock(mutex_);
    body_ = &body;
    next_ = 0, count_ = count;
    failure_ = nullptr;
  }
  started();
  parallelFor(std::min<std::size_t>(count, hardwareThreads()), [&](std::size_t) { work(); });
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return atWork_ == 0; });
  body_ = nullptr;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void SharedLoop::join() { work(); }

void SharedLoop::work() {
  std::unique_lock lock(mutex_);
  while (body_ && next_ < count_) {
    const std::size_t i = next_++;
    const auto& body = *body_;
    ++atWork_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      body(i);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && !failure_) failure_ = failure, next_ = count_;
    if (--atWork_ == 0) changed_.notify_all();
  }
}

}  // namespace quintet::layer
