// SPDX-License-Identifier: Apache-2.0
// Checks pipelines on a thread of its own with low priority, so that their creation does not wait. Results are delivered
// inside of Vulkan calls of the application.
#ifndef QUINTET_LAYER_LINK_WORKER_H
#define QUINTET_LAYER_LINK_WORKER_H

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "shared_loop.h"

namespace quintet::layer {

class LinkWorker {
 public:
  LinkWorker() = default;
  ~LinkWorker();  // finishes all tasks
  LinkWorker(const LinkWorker&) = delete;

  struct Task {
    std::function<void()> run;  // must not throw
    bool done = false;
  };
  std::shared_ptr<Task> add(std::function<void()> run);
  std::shared_ptr<Task> runNow(std::function<void()> run);  // on the calling thread
  // Runs a task that was not started on the calling thread, with its priority.
  void wait(const std::shared_ptr<Task>& task);
  bool isDone(const Task& task);
  // For tasks: a parallel loop in which threads that wait take part.
  void loop(std::size_t count, const std::function<void(std::size_t)>& body);
  void waitForAll();

 private:
  void work();
  void run(const std::shared_ptr<Task>& task, std::unique_lock<std::mutex>& lock);
  void waitUntil(const std::function<bool()>& done);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Task>> tasks_;
  std::size_t open_ = 0;  // tasks that are not done
  bool stop_ = false;
  SharedLoop loop_;
  std::size_t loops_ = 0;  // that were started
  std::thread thread_;     // starts with the first task
};

}  // namespace quintet::layer
#endif
