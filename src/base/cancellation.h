// SPDX-License-Identifier: Apache-2.0
// Cancellation of long work without a loop that its caller sees, such as reading a scene. The thread that starts the work asks
// whether to cancel. Loops on all cores (parallelFor) then end between two calls of their body, and other steps where they call
// throwIfCanceled(), with CanceledError.
#ifndef QUINTET_BASE_CANCELLATION_H
#define QUINTET_BASE_CANCELLATION_H

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <thread>
#include <utility>

namespace quintet {

class Cancellation {
 public:
  // `isCanceled` is called from this thread only, at most every kAskSeconds. Empty: never canceled.
  explicit Cancellation(std::function<bool()> isCanceled) : isCanceled_(std::move(isCanceled)) {}
  Cancellation(const Cancellation&) = delete;
  Cancellation& operator=(const Cancellation&) = delete;

  bool requested();  // from any thread

  // The work of this thread belongs to a cancellation, or to none (null), as long as the scope exists.
  class Scope {
   public:
    explicit Scope(Cancellation* cancellation) : outer_(std::exchange(current_, cancellation)) {}
    ~Scope() { current_ = outer_; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Cancellation* outer_;
  };
  static Cancellation* current() { return current_; }  // of this thread; null if there is none

  static constexpr double kAskSeconds = 0.02;

 private:
  static thread_local Cancellation* current_;
  std::function<bool()> isCanceled_;
  const std::thread::id owner_ = std::this_thread::get_id();
  std::atomic<bool> requested_{false};
  std::chrono::steady_clock::time_point asked_{};
};

// Throws CanceledError if the work of this thread is canceled.
void throwIfCanceled();

// Waits for the result of a thread that has the same cancellation as this one.
template <class T>
T getUnlessCanceled(std::future<T>& result) {
  // A canceled thread ends with an exception, which get() throws.
  if (Cancellation* cancellation = Cancellation::current())
    while (result.wait_for(std::chrono::milliseconds(20)) == std::future_status::timeout &&
           !cancellation->requested()) {
    }
  return result.get();
}

}  // namespace quintet
#endif
