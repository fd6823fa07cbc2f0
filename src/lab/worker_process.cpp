// SPDX-License-Identifier: Apache-2.0
#include "lab/worker_process.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "lab/sandbox.h"

extern char** environ;  // NOLINT: POSIX

namespace quintet::lab {
namespace {

// For lavapipe, the driver of CPUs: it compiles shaders without the optimizations of LLVM, in less than half of the time, and
// they compute the same values in up to 1.5 times the time. Other drivers ignore the variable. A value of the user counts.
constexpr const char* kCompilerVariable = "GALLIVM_PERF";
constexpr const char* kFastCompiler = "GALLIVM_PERF=nopt";

// What the new process does. Other threads of this one can hold locks, so it uses nothing but system calls.
struct Start {
  const char* file;
  char* const* arguments;
  char* const* environment;
  int socket;
  const char *userMap, *groupMap;  // null: no namespaces
};
[[noreturn]] void becomeWorker(const Start& start) {
  constexpr int kCannotStart = 127;
  if (start.userMap && !mapUser(start.userMap, start.groupMap)) ::_exit(kCannotStart);
  const int null = ::open("/dev/null", O_RDONLY);
  if (::dup2(null, STDIN_FILENO) < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) ::_exit(kCannotStart);
  // dup2() of a descriptor to itself would keep it closed for the new program.
  if (start.socket == kWorkerSocket ? ::fcntl(kWorkerSocket, F_SETFD, 0) != 0 : ::dup2(start.socket, kWorkerSocket) < 0)
    ::_exit(kCannotStart);
  // The sockets of other sessions would stay open in this worker.
  ::close_range(kWorkerSocket + 1, ~0u, 0);
  ::execve(start.file, start.arguments, start.environment);
  ::_exit(kCannotStart);
}

}  // namespace

WorkerProcess startWorkerProcess(const std::filesystem::path& executable, bool contained) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw Error(fmt::format("cannot start a worker: {}", std::strerror(errno)));
  std::string name = executable.string(), option = kWorkerOption;
  std::array<char*, 3> arguments{name.data(), option.data(), nullptr};
  std::string fastCompiler = kFastCompiler;
  std::vector<char*> environment;
  for (char** variable = environ; *variable; ++variable) environment.push_back(*variable);
  if (!std::getenv(kCompilerVariable)) environment.push_back(fastCompiler.data());
  environment.push_back(nullptr);
  const std::string users = userMap(), groups = groupMap();
  const bool own = contained && sandboxSupport().namespaces;
  const Start start{name.c_str(),
                    arguments.data(),
                    environment.data(),
                    ends[1],
                    own ? users.c_str() : nullptr,
                    own ? groups.c_str() : nullptr};
  // As fork(), which has no namespaces.
  const auto process = static_cast<pid_t>(::syscall(SYS_clone, (own ? namespaceFlags() : 0) | SIGCHLD, 0, 0, 0, 0));
  if (process == 0) becomeWorker(start);
  const int failed = errno;
  ::close(ends[1]);
  if (process < 0) {
    ::close(ends[0]);
    throw Error(fmt::format("{}: cannot start a worker: {}", name, std::strerror(failed)));
  }
  return {process, ends[0]};
}

void endBySignals() {
  struct sigaction action {};
  action.sa_handler = [](int signal) { ::_exit(kSignalStatus + signal); };
  action.sa_flags = SA_ONSTACK;
  ::sigemptyset(&action.sa_mask);
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTERM, SIGXCPU})
    ::sigaction(signal, &action, nullptr);
}

std::uint64_t workerMemory(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/statm", process));
  std::uint64_t size = 0, resident = 0;
  file >> size >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::optional<WorkerEnd> takeWorkerEnd(pid_t process) {
  int status = 0;
  const pid_t ended = ::waitpid(process, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return {};
  WorkerEnd end;
  if (ended < 0) return end;  // it was waited for
  if (WIFSIGNALED(status))
    end.signal = WTERMSIG(status);
  else if (WEXITSTATUS(status) > kSignalStatus)
    end.signal = WEXITSTATUS(status) - kSignalStatus;
  else
    end.status = WEXITSTATUS(status);
  return end;
}

}  // namespace quintet::lab
