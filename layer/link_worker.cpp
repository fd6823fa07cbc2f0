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

void LinkWorker::wait(const Task& task) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return task.done; });
}

bool LinkWorker::isDone(const Task& task) {
  const std::scoped_lock lock(mutex_);
  return task.done;
}

void LinkWorker::waitForAll() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return open_ == 0; });
}

void LinkWorker::work() {
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), kNice);
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return stop_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    const std::shared_ptr<Task> task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task->run();
    lock.lock();
    task->done = true;
    task->run = nullptr;
    --open_;
    changed_.notify_all();
  }
}

}  // namespace quintet::layer
