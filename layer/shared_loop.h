// SPDX-License-Identifier: Apache-2.0
// A parallel loop that threads can join while it runs. The check runs on threads of low priority; a thread of the application that
// waits for it takes part, with its own priority, so that other load does not make it wait longer.
#ifndef QUINTET_LAYER_SHARED_LOOP_H
#define QUINTET_LAYER_SHARED_LOOP_H

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>

namespace quintet::layer {

class SharedLoop {
 public:
  // Calls body(i) once for each i in [0, count), on all cores and on the threads that join, and returns after the last call.
  // `started` is called once the loop can be joined. Rethrows the first exception of a call. Loops of other threads run one after the other.
  void run(std::size_t count, const std::function<void(std::size_t)>& body, const std::function<void()>& started);
  // Takes part in the loop that runs, if there is one, until no call is left to start.
  void join();

 private:
  void work();

  std::mutex running_;  // of run()
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void(std::size_t)>* body_ = nullptr;  // null if no loop runs
  std::size_t next_ = 0, count_ = 0;
  std::size_t atWork_ = 0;  // calls of the body
  std::exception_ptr failure_;
};

}  // namespace quintet::layer
#endif
