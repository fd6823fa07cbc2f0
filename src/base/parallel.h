// SPDX-License-Identifier: Apache-2.0
// Data-parallel loops on the cores of the host.
#ifndef QUINTET_BASE_PARALLEL_H
#define QUINTET_BASE_PARALLEL_H

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace quintet {

// Number of threads that parallelFor uses: the cores that this process may run on, at least 1.
unsigned hardwareThreads();

// Calls body(i) once for each i in [0, count), in any order, on all cores, and returns after the last call. The first
// exception that a call throws is rethrown; the remaining calls are skipped. A loop inside a body runs on the thread of
// that body, unless the outer loop has only one iteration.
void parallelFor(std::size_t count, const std::function<void(std::size_t)>& body);

// Calls body(first, last) for consecutive ranges of [0, count) of at most `grain` indices, on all cores.
template <class Body>
void parallelRanges(std::size_t count, const Body& body, std::size_t grain = 65536) {
  parallelFor((count + grain - 1) / grain, [&](std::size_t i) { body(i * grain, std::min(count, (i + 1) * grain)); });
}

// Tasks that add further tasks, such as the nodes of a tree. Any thread can take the one that was added last.
template <class Task>
class TaskList {
  static_assert(std::is_nothrow_move_constructible_v<Task>, "take() must not lose a task");

 public:
  explicit TaskList(std::vector<Task> tasks) : tasks_(std::move(tasks)) {}

  void add(Task task) {
    const std::scoped_lock lock(mutex_);
    tasks_.push_back(std::move(task));
    changed_.notify_one();
  }
  // Waits for a task. Returns nothing if none is left and no thread is at work that could add one, or after stop().
  std::optional<Task> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return stopped_ || !tasks_.empty() || atWork_ == 0; });
    if (stopped_ || tasks_.empty()) return std::nullopt;
    ++atWork_;
    Task task = std::move(tasks_.back());
    tasks_.pop_back();
    return task;
  }
  void done() {  // the thread has done the task that it took
    const std::scoped_lock lock(mutex_);
    if (--atWork_ == 0 && tasks_.empty()) changed_.notify_all();
  }
  void stop() {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Task> tasks_;
  std::size_t atWork_ = 0;  // threads that took a task and are not done
  bool stopped_ = false;
};

// Calls body(task, list) for each task, in any order, on all cores, and returns after the last call. A body can add
// tasks with list.add(). Exceptions and nested loops are as in parallelFor.
template <class Task, class Body>
void parallelTasks(std::vector<Task> tasks, const Body& body) {
  TaskList<Task> list(std::move(tasks));
  parallelFor(hardwareThreads(), [&](std::size_t) {
    while (std::optional<Task> task = list.take()) {
      try {
        body(*task, list);
      } catch (...) {
        list.stop();
        throw;
      }
      list.done();
    }
  });
}

// memcpy on all cores. Most of its time is spent in page faults, which the first write to each new page causes.
void parallelCopy(std::byte* to, std::span<const std::byte> from);

}  // namespace quintet
#endif
