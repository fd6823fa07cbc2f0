// SPDX-License-Identifier: Apache-2.0
// Decides what happens with the worker of a session: when it starts, whether it starts again after its end, and with
// which commands. Pure decisions on given times; page_session.h carries them out.
#ifndef QUINTET_LAB_SESSION_SUPERVISOR_H
#define QUINTET_LAB_SESSION_SUPERVISOR_H

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quintet::lab {

inline constexpr double kCrashSeconds = 10;  // a second crash within this time would repeat forever
inline constexpr double kStuckSeconds = 60;  // beyond the time limit of a launch: loading can take long
// After job::kCompilingStage, the driver has as much time as a launch, but at least this much: a busy machine compiles slowly.
inline constexpr double kCompileSeconds = 10;

// How a worker ended.
struct WorkerEnd {
  int signal = 0;                   // that ended it; 0 if it has exited
  int status = 0;                   // exit status
  std::optional<std::string> hung;  // Control::hung
};

class SessionSupervisor {
 public:
  struct Limits {
    double timeout = 30;       // seconds that a launch may take
    double idleSeconds = 600;  // without a command of the page, after which the worker ends
  };
  explicit SessionSupervisor(const Limits& limits) : limits_(limits) {}

  // What to send to the page and to the worker, and whether to start it first.
  struct Actions {
    bool start = false;                 // a new worker
    bool end = false;                   // the worker that runs
    std::vector<std::string> toPage;    // JSON
    std::vector<std::string> toWorker;  // JSON of the page, after `hold`
    bool hold = false;                  // Control::hold before the first of them
  };

  Actions connected(double now);
  Actions pageSent(double now, std::string_view message);
  void workerSent(double now, std::string_view message);  // FrameKind::text
  void workerAlive(double now) {
    lastAlive_ = now;
    compiling_ = false;
  }
  Actions workerEnded(double now, const WorkerEnd& end);
  // It uses more memory than it may. `hint`: the end of the message, which names what raises the limit.
  Actions workerExceeded(std::uint64_t limit, std::string_view hint);
  // The system could not start a worker. The next command of the page tries again.
  Actions workerMissing(const std::string& message);
  // Call it about once per second.
  Actions tick(double now);

 private:
  enum class State { running, ended };

  double stuckLimit() const {
    return compiling_ ? std::max(limits_.timeout, kCompileSeconds) : limits_.timeout + kStuckSeconds;
  }
  Actions started(double now, bool hold, const std::string& state, const std::string& message);
  std::string resumed(bool keepParameters) const;

  const Limits limits_;
  State state_ = State::ended;
  unsigned restarts_ = 0;
  bool exceeded_ = false;       // that is workerExceeded()
  std::string ended_;           // why this object has ended the worker; empty if it has not
  bool compiling_ = false;      // the last message was job::kCompilingStage
  bool keepParameters_ = true;  // for the next worker
  double lastPage_ = 0, lastAlive_ = 0;
  std::optional<double> lastCrash_;
  std::string open_;   // last command `open` of the page; empty before the first
  std::string shown_;  // last event `state` since it
};

}  // namespace quintet::lab
#endif
