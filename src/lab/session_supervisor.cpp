// SPDX-License-Identifier: Apache-2.0
#include "lab/session_supervisor.h"

#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json.h"
#include "base/text.h"
#include "job/observer.h"
#include "lab/page_message.h"
#include "lab/session_events.h"

namespace quintet::lab {
namespace {

using Json = nlohmann::json;

std::string endText(const WorkerEnd& end) {
  if (end.signal != 0) {
    const char* name = ::strsignal(end.signal);
    return fmt::format("the driver or Quintet crashed (signal {}, {})", end.signal, name ? name : "unknown");
  }
  return fmt::format("the driver or Quintet failed (exit status {})", end.status);
}

}  // namespace

SessionSupervisor::Actions SessionSupervisor::started(double now, bool hold, const std::string& state,
                                                      const std::string& message) {
  Actions actions;
  actions.start = true;
  actions.hold = hold;
  actions.toPage.push_back(workerJson(state, message, restarts_));
  if (!open_.empty()) actions.toWorker.push_back(resumed(keepParameters_));
  keepParameters_ = true;
  state_ = State::running;
  ended_.clear();
  exceeded_ = false;
  compiling_ = false;
  lastAlive_ = now;
  return actions;
}

SessionSupervisor::Actions SessionSupervisor::connected(double now) {
  lastPage_ = now;
  return started(now, false, "started", "");
}

SessionSupervisor::Actions SessionSupervisor::pageSent(double now, std::string_view message) {
  lastPage_ = now;
  const std::string command = commandName(message).value_or("");
  const bool restart = command == "restart";
  const bool start = state_ == State::ended && command != "received";
  Actions actions;
  if (start || restart) {
    if (restart) ++restarts_;
    actions = started(now, false, "started", "");
    actions.end = restart && !start;
  }
  if (command == "open") {
    open_ = message;
    shown_.clear();
    if (start) actions.toWorker.clear();  // the command replaces what it would resume
  }
  if (!restart && state_ == State::running) actions.toWorker.emplace_back(message);
  return actions;
}

void SessionSupervisor::workerSent(double now, std::string_view message) {
  lastAlive_ = now;
  // Events are written by this program: the name comes first.
  compiling_ = message.starts_with(R"({"event":"stage")") && message.find(job::kCompilingStage) != message.npos;
  if (message.starts_with(R"({"event":"progress")")) lastPage_ = now;  // the page waits for a video
  if (message.starts_with(R"({"event":"state")")) shown_ = message;
}

// The last `open`, with what the user has changed since.
std::string SessionSupervisor::resumed(bool keepParameters) const {
  Json open = findJson(open_).value_or(Json::object());
  const Json state = findJson(shown_).value_or(nullptr);
  open.erase("id");
  if (state.is_object()) {
    for (const char* key : {"program", "width", "height", "output", "exposure", "tonemap", "frame", "camera"})
      if (state.contains(key)) open[key] = state[key];
    if (!state.value("frames", false)) open["samples"] = state.value("samples", 64u);
    open["parameters"] = state.value("parameters", Json::object());
  }
  if (!keepParameters) open.erase("parameters");
  return open.dump(-1, ' ', false, Json::error_handler_t::replace);
}

SessionSupervisor::Actions SessionSupervisor::workerEnded(double now, const WorkerEnd& end) {
  if (state_ == State::ended) return {};  // it was idle
  ++restarts_;
  const bool hung = end.hung.has_value() || !ended_.empty();
  const bool killed = end.signal == 9 && !hung;  // not by the program that it ran
  const std::string message = !ended_.empty() ? ended_ : end.hung.value_or(endText(end));
  keepParameters_ = killed;
  const bool again = lastCrash_ && now - *lastCrash_ < kCrashSeconds;
  lastCrash_ = now;
  if (exceeded_ && again) {  // also without a program: the limit is too low
    state_ = State::ended;
    Actions actions;
    actions.toPage.push_back(workerJson("hung", message, restarts_));
    return actions;
  }
  const bool hold = !open_.empty() && (hung || again);
  Actions actions = started(now, hold, hold ? "waiting" : "started",
                            hold ? "the program runs again as soon as one of its files is saved" : "");
  actions.toPage.insert(actions.toPage.begin(), workerJson(hung ? "hung" : "crashed", message, restarts_));
  return actions;
}

SessionSupervisor::Actions SessionSupervisor::workerMissing(const std::string& message) {
  state_ = State::ended;
  Actions actions;
  actions.toPage.push_back(workerJson("crashed", message, restarts_));
  return actions;
}

SessionSupervisor::Actions SessionSupervisor::tick(double now) {
  Actions actions;
  if (state_ != State::running) return actions;
  if (now - lastPage_ > limits_.idleSeconds) {
    state_ = State::ended;
    actions.end = true;
    actions.toPage.push_back(
        workerJson("idle", "the session was not used for some time; it continues with the next command", restarts_));
  } else if (now - lastAlive_ > stuckLimit() && ended_.empty()) {
    ended_ =
        fmt::format("the driver did not answer within {:g} s; it possibly compiles an endless shader", stuckLimit());
    actions.end = true;  // workerEnded() follows
  }
  return actions;
}

SessionSupervisor::Actions SessionSupervisor::workerExceeded(std::uint64_t limit, std::string_view hint) {
  Actions actions;
  if (state_ != State::running || !ended_.empty()) return actions;
  exceeded_ = true;
  ended_ = fmt::format("the program, its scene or the compiler needs more than {} of memory, the limit{}",
                       bytesText(limit), hint);
  actions.end = true;  // workerEnded() follows
  return actions;
}

}  // namespace quintet::lab
