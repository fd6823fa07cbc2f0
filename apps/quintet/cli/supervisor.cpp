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

#include <fmt/format.h>

#include "base/diagnostic.h"
#include "base/file.h"
#include "base/temporary_file.h"
#include "base/text.h"
#include "check/diagnostic_text.h"
#include "cli/failure.h"
#include "cli/signals.h"
#include "cli/work.h"
#include "output/report.h"

namespace quintet::cli {
namespace {

volatile pid_t child = 0;  // for the signal handler

void forward(int signal, siginfo_t* info, void* /*context*/) {
  const int savedErrno = errno;
  // The terminal sends its signals to both processes.
  if (child > 0 && info->si_code != SI_KERNEL) ::kill(child, signal);
  errno = savedErrno;
}

void forwardSignals() {
  struct sigaction action {};
  action.sa_sigaction = forward;
  action.sa_flags = SA_SIGINFO;
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

int reportCrash(int signal, std::span<const std::string> arguments) {
  const std::string program(workProgram()), stage(workStage());
  const char* description = ::strsignal(signal);
  const std::string text =
      fmt::format("crash in the driver or in Quintet{}{} (signal {}, {}); see docs/debugging.md, \"Crashes\"",
                  stage.empty() ? "" : " while ", stage, signal, description ? description : "unknown");
  const std::string message = program.empty() ? text : fmt::format("{}: {}", program, text);
  if (!workFile().empty()) TemporaryFile::removeLeftovers(workFile());
  if (wantsJson(arguments)) {
    try {
      const bool diagnostics = arguments.front() == "check";
      writeFile("-", diagnostics ? check::diagnosticsJson({{Severity::error, program, 0, 0, "CRASH", text}})
                                 : output::errorJson(message, nullptr, kCrashed));
    } catch (const Error&) {  // the reader has ended
    }
  }
  return printFailure(message, kCrashed);
}

// Ends as the child ended.
int relay(int status, std::span<const std::string> arguments) {
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  if (isCrash(signal)) return reportCrash(signal, arguments);
  if (signal == SIGKILL) return printFailure("the process was killed, possibly because memory ran out", 128 + signal);
  std::signal(signal, SIG_DFL);
  ::raise(signal);
  return 128 + signal;
}

}  // namespace

std::optional<int> supervise(std::span<const std::string> arguments) {
  const char* isolation = std::getenv("QUINTET_ISOLATION");
  if (isolation && std::string_view(isolation) == "off") return {};
  if (!shareWork()) return {};
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
  if (process > 0) {
    child = process;
    forwardSignals();
  }
  ::sigprocmask(SIG_SETMASK, &before, nullptr);
  if (process <= 0) return {};
  int status = 0;
  while (::waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return kRuntimeError;
  child = 0;
  return relay(status, arguments);
}

}  // namespace quintet::cli
