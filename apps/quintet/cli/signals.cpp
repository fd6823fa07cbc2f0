// SPDX-License-Identifier: Apache-2.0
#include "cli/signals.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <initializer_list>

namespace quintet::cli {
namespace {

// The only variables that signal handlers access.
volatile std::sig_atomic_t graceful = 0;
volatile std::sig_atomic_t writing = 0;
volatile std::sig_atomic_t received = 0;     // the first signal's number
volatile std::sig_atomic_t pendingExit = 0;  // end the process when the file is written
volatile std::sig_atomic_t supervisor = 0;   // its process id, 0 if there is none
volatile std::sig_atomic_t counts[2][2];     // of SIGINT and SIGTERM: from the supervisor, from elsewhere

[[noreturn]] void exitNow(int status) {
  static constexpr char kMessage[] = "\nquintet: interrupted\n";
  const int skip = ::isatty(STDERR_FILENO) ? 0 : 1;  // the line break ends the progress bar
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kMessage + skip, sizeof kMessage - 1 - skip);
  ::_exit(status);
}

// A signal to the process group comes twice. Returns false for the second one.
bool isNew(int signal, const siginfo_t& info) {
  const bool forwarded = supervisor != 0 && info.si_code == SI_USER && info.si_pid == supervisor;
  volatile std::sig_atomic_t* count = counts[signal == SIGINT ? 0 : 1];
  const int fromSupervisor = count[0], fromElsewhere = count[1];
  const int now = (forwarded ? fromSupervisor : fromElsewhere) + 1;
  count[forwarded ? 0 : 1] = now;
  return now > std::max(fromSupervisor, fromElsewhere);
}

void handle(int signal, siginfo_t* info, void* /*context*/) {
  if (!isNew(signal, *info)) return;
  const int savedErrno = errno;
  const bool first = received == 0;
  if (first) received = signal;
  if (!(graceful && first)) {
    if (!writing) exitNow(128 + signal);
    pendingExit = 1;
  }
  errno = savedErrno;
}

}  // namespace

void installSignalHandlers() {
  struct sigaction action {};
  action.sa_sigaction = handle;
  action.sa_flags = SA_RESTART | SA_SIGINFO;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction inherited {};
    // Ignored by the parent (nohup, a background job of a shell): it stays ignored.
    if (sigaction(signal, nullptr, &inherited) == 0 && inherited.sa_handler == SIG_IGN) continue;
    sigaction(signal, &action, nullptr);
  }
}

void setSupervisor(pid_t process) { supervisor = process; }

GracefulStop::GracefulStop() { graceful = 1; }
GracefulStop::~GracefulStop() { graceful = 0; }
bool GracefulStop::requested() const { return received != 0; }
int GracefulStop::exitStatus() const { return received ? 128 + received : 0; }

ProtectedWrite::ProtectedWrite() { writing = 1; }
ProtectedWrite::~ProtectedWrite() {
  writing = 0;
  if (pendingExit) exitNow(128 + received);
}

}  // namespace quintet::cli
