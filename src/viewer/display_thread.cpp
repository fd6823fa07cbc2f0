// SPDX-License-Identifier: Apache-2.0
#include "viewer/display_thread.h"

#include <exception>
#include <utility>

namespace quintet::viewer {

DisplayThread::DisplayThread(std::function<void()> onDisplay)
    : onDisplay_(std::move(onDisplay)), thread_([this] { run(); }) {}

DisplayThread::~DisplayThread() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void DisplayThread::request(DisplayRequest request) {
  if (!request.image) return;
  {
    const std::lock_guard lock(mutex_);
    next_ = std::move(request);
  }
  changed_.notify_one();
}

std::shared_ptr<const Display> DisplayThread::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

std::string DisplayThread::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

void DisplayThread::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return stop_ || next_; });
    if (stop_) return;
    const DisplayRequest request = std::move(*std::exchange(next_, std::nullopt));
    lock.unlock();
    std::shared_ptr<const Display> display;
    std::string error;
    try {
      display = std::make_shared<const Display>(makeDisplay(*request.image, request.reference.get(), request.settings));
    } catch (const std::exception& failure) {
      error = failure.what();
    }
    lock.lock();
    if (display) latest_ = std::move(display);
    error_ = std::move(error);
    lock.unlock();
    onDisplay_();
    lock.lock();
  }
}

}  // namespace quintet::viewer
