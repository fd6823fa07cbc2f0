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
  void wait(const Task& task);
  bool isDone(const Task& task);
  void waitForAll();

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Task>> tasks_;
  std::size_t open_ = 0;  // tasks that are not done
  bool stop_ = false;
  std::thread thread_;  // starts with the first task
};

}  // namespace quintet::layer
#endif
