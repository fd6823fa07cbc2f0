// SPDX-License-Identifier: Apache-2.0
#include "cli/supervisor.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/diagnostic.h"
#include "base/error.h"
#include "base/plural.h"
#include "base/temporary_file.h"
#include "check/diagnostic_text.h"
#include "cli/console.h"
#include "cli/failure.h"
#include "cli/signals.h"
#include "cli/work.h"
#include "job/source_watcher.h"
#include "output/report.h"

namespace quintet::cli {
namespace {

volatile pid_t child = 0;                // for the signal handler
volatile std::sig_atomic_t stopped = 0;  // a signal has arrived
bool restarted = false;

void forward(int signal, siginfo_t* info, void* /*context*/) {
  const int savedErrno = errno;
  stopped = 1;
  // The terminal sends its signals to both processes.
  if (child > 0 && info->si_code != SI_KERNEL) ::kill(child, signal);
  errno = savedErrno;
}

// `handled`: forward, or the default. Signals that are ignored stay so.
void setSignalActions(bool handled) {
  struct sigaction action {};
  if (handled) {
    action.sa_sigaction = forward;
    action.sa_flags = SA_SIGINFO;
  }
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction inherited {};
    if (sigaction(signal, nullptr, &inherited) == 0 && inherited.sa_handler == SIG_IGN) continue;
    sigaction(signal, &action, nullptr);
  }
}

bool isCrash(int signal) {
  constexpr std::array kCrashes{SIGSEGV, SIGABRT, SIGBUS, SIGILL, SIGFPE, SIGTRAP, SIGSYS};
  return std::ranges::find(kCrashes, signal) != kCrashes.end();
}

// Joins JSON arrays, each in one line.
std::string joinedArrays(const std::vector<std::string>& arrays) {
  std::string elements;
  for (const std::string& array : arrays) {
    const std::size_t begin = array.find('[') + 1, end = array.rfind(']');
    if (end == array.npos || begin >= end) continue;
    elements += (elements.empty() ? "" : ",") + array.substr(begin, end - begin);
  }
  return "[" + elements + "]\n";
}

void reportCrash(int signal, std::span<const std::string> arguments) {
  const std::string program(workProgram()), stage(workStage());
  const char* description = ::strsignal(signal);
  const std::string text =
      fmt::format("crash in the driver or in Quintet{}{} (signal {}, {}); see docs/debugging.md, \"Crashes\"",
                  stage.empty() ? "" : " while ", stage, signal, description ? description : "unknown");
  const SceneProgress scenes = sceneProgress();
  const std::string object = scenes.unfinished ? scenes.name : program;
  const std::string message = object.empty() ? text : fmt::format("{}: {}", object, text);
  if (!workFile().empty()) TemporaryFile::removeLeftovers(workFile());
  const FailureJson json = failureJson(arguments);
  if (json == FailureJson::object) {
    printFailureJson(output::errorJson(message, nullptr, kCrashed, scenes.unfinished ? scenes.name : ""));
  } else if (json == FailureJson::diagnostics) {
    std::vector<std::string> arrays = workResults();
    arrays.push_back(check::diagnosticsJson({{Severity::error, program, 0, 0, "CRASH", text}}));
    printFailureJson(joinedArrays(arrays));
    clearWorkResults();
  }
  printFailure(message, kCrashed);
}

// Ends as the child ended, without a crash.
int relay(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  if (signal == SIGKILL) return printFailure("the process was killed, possibly because memory ran out", 128 + signal);
  std::signal(signal, SIG_DFL);
  ::raise(signal);
  return 128 + signal;
}

// Of a command with several scenes: whether the child has ended before the scene that it was rendering, for a reason that
// does not end the command. A launch that hangs ends the child with a status.
bool continuesWithNextScene(int status) {
  if (stopped || !sceneProgress().unfinished) return false;
  return WIFSIGNALED(status) ? isCrash(WTERMSIG(status)) || WTERMSIG(status) == SIGKILL : WEXITSTATUS(status) < 128;
}

// Returns the child's process id; 0 in the child, negative if no process can be created.
pid_t startChild() {
  sigset_t signals, before;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  ::sigprocmask(SIG_BLOCK, &signals, &before);
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  if (process == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(kRuntimeError);  // the parent was killed before
    setSupervisor(parent);
  }
  child = process;
  setSignalActions(process > 0);
  ::sigprocmask(SIG_SETMASK, &before, nullptr);
  return process;
}

// Returns the status of waitpid(); nullopt if it is unknown, such as after a parent that ignores SIGCHLD.
std::optional<int> waitForEnd(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return {};
  child = 0;
  return status;
}

// After a crash: waits until one of the files that the child watched is saved. Returns false if there are none, or if a
// signal has arrived.
bool waitForSave() {
  job::WatchList list = watchedFiles();
  if (list.files.empty() && list.folders.empty()) return false;
  try {
    job::SourceWatcher watcher;
    watcher.watch(std::move(list));
    printMessage(fmt::format("watching {}; press Ctrl-C to stop", counted(watcher.watched().files.size(), "file")));
    while (!stopped && watcher.wait(kSignalSeconds).empty()) {
    }
    if (!stopped) printMessage(fmt::format("{} saved", watcher.changedNames()));
  } catch (const Error& error) {  // the system's limit of watches
    printFailure(error.what(), kRuntimeError);
    return false;
  }
  return !stopped;
}

}  // namespace

std::optional<int> supervise(std::span<const std::string> arguments) {
  const char* isolation = std::getenv("QUINTET_ISOLATION");
  if (isolation && std::string_view(isolation) == "off") return {};
  if (!shareWork()) return {};
  while (true) {
    const pid_t process = startChild();
    if (process <= 0) return {};
    const std::optional<int> ended = waitForEnd(process);
    if (!ended) return kRuntimeError;
    const int status = *ended;
    const bool crashed = WIFSIGNALED(status) && isCrash(WTERMSIG(status));
    if (crashed) reportCrash(WTERMSIG(status), arguments);
    if (continuesWithNextScene(status)) {
      if (WIFSIGNALED(status) && !crashed) relay(status);  // prints that it was killed
      continue;
    }
    // With --watch, a lost device ends the child as a crash does.
    if (!crashed && !(WIFEXITED(status) && WEXITSTATUS(status) == kCrashed)) return relay(status);
    if (stopped || !waitForSave()) return kCrashed;
    restarted = true;
  }
}

bool restartedAfterCrash() { return restarted; }

}  // namespace quintet::cli
