// SPDX-License-Identifier: Apache-2.0
#include "lab/worker_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"

extern char** environ;  // NOLINT: POSIX

namespace quintet::lab {
namespace {

// For lavapipe, the driver of CPUs: it compiles shaders without the optimizations of LLVM, in less than half of the time, and
// they compute the same values in up to 1.5 times the time. Other drivers ignore the variable. A value of the user counts.
constexpr const char* kCompilerVariable = "GALLIVM_PERF";
constexpr const char* kFastCompiler = "GALLIVM_PERF=nopt";

}  // namespace

WorkerProcess startWorkerProcess(const std::filesystem::path& executable) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw Error(fmt::format("cannot start a worker: {}", std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], kWorkerSocket);
  // The sockets of other sessions would stay open in this worker.
  ::posix_spawn_file_actions_addclosefrom_np(&actions, kWorkerSocket + 1);
  std::string name = executable.string(), option = kWorkerOption;
  std::array<char*, 3> arguments{name.data(), option.data(), nullptr};
  std::string fastCompiler = kFastCompiler;
  std::vector<char*> environment;
  for (char** variable = environ; *variable; ++variable) environment.push_back(*variable);
  if (!std::getenv(kCompilerVariable)) environment.push_back(fastCompiler.data());
  environment.push_back(nullptr);
  WorkerProcess worker{.socket = ends[0]};
  const int failed =
      ::posix_spawn(&worker.process, name.c_str(), &actions, nullptr, arguments.data(), environment.data());
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (failed != 0) {
    ::close(ends[0]);
    throw Error(fmt::format("{}: cannot start a worker: {}", name, std::strerror(failed)));
  }
  return worker;
}

std::optional<WorkerEnd> takeWorkerEnd(pid_t process) {
  int status = 0;
  const pid_t ended = ::waitpid(process, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return {};
  WorkerEnd end;
  if (ended < 0) return end;  // it was waited for
  if (WIFSIGNALED(status))
    end.signal = WTERMSIG(status);
  else
    end.status = WEXITSTATUS(status);
  return end;
}

}  // namespace quintet::lab
