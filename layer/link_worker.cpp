// SPDX-License-Identifier: Apache-2.0
#include "link_worker.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <utility>

namespace quintet::layer {
namespace {

constexpr int kNice = 15;  // the threads of parallelFor inherit it

}  // namespace

LinkWorker::~LinkWorker() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

std::shared_ptr<LinkWorker::Task> LinkWorker::add(std::function<void()> run) {
  auto task = std::make_shared<Task>(Task{std::move(run), false});
  const std::scoped_lock lock(mutex_);
  tasks_.push_back(task);
  ++open_;
  if (!thread_.joinable()) thread_ = std::thread([this] { work(); });
  changed_.notify_all();
  return task;
}

std::shared_ptr<LinkWorker::Task> LinkWorker::runNow(std::function<void()> function) {
  auto task = std::make_shared<Task>(Task{std::move(function), false});
  std::unique_lock lock(mutex_);
  ++open_;
  run(task, lock);
  return task;
}

void LinkWorker::wait(const std::shared_ptr<Task>& task) {
  {
    std::unique_lock lock(mutex_);
    if (std::erase(tasks_, task) > 0) return run(task, lock);
  }
  waitUntil([&] { return task->done; });
}

void LinkWorker::run(const std::shared_ptr<Task>& task, std::unique_lock<std::mutex>& lock) {
  lock.unlock();
  task->run();
  lock.lock();
  task->done = true;
  task->run = nullptr;
  --open_;
  changed_.notify_all();
}

// `done` is called with the lock.
void LinkWorker::waitUntil(const std::function<bool()>& done) {
  std::unique_lock lock(mutex_);
  while (!done()) {
    const std::size_t known = loops_;
    lock.unlock();
    loop_.join();
    lock.lock();
    changed_.wait(lock, [&] { return done() || loops_ != known; });
  }
}

void LinkWorker::loop(std::size_t count, const std::function<void(std::size_t)>& body) {
  loop_.run(count, body, [this] {
    const std::scoped_lock lock(mutex_);
    ++loops_;
    changed_.notify_all();
  });
}

bool LinkWorker::isDone(const Task& task) {
  const std::scoped_lock lock(mutex_);
  return task.done;
}

void LinkWorker::waitForAll() {
  waitUntil([&] { return open_ == 0; });
}

void LinkWorker::work() {
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), kNice);
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return stop_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    const std::shared_ptr<Task> task = std::move(tasks_.front());
    tasks_.pop_front();
    run(task, lock);
  }
}

}  // namespace quintet::layer
