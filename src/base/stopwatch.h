// SPDX-License-Identifier: Apache-2.0
// Wall-clock time since construction and since the last lap.
#ifndef QUINTET_BASE_STOPWATCH_H
#define QUINTET_BASE_STOPWATCH_H

#include <chrono>
#include <utility>

namespace quintet {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  // Returns the seconds since the last lap (since construction for the first) and starts a new lap.
  double lap() {
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(lapStart_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), lapStart_ = start_;
};

}  // namespace quintet
#endif
