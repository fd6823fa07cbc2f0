// SPDX-License-Identifier: Apache-2.0
#include "process.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <utility>

extern char** environ;

namespace quintet::test {
namespace {

struct Pipe {
  int read = -1;
  int write = -1;
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("cannot create a pipe");
    read = ends[0];
    write = ends[1];
  }
  ~Pipe() {
    if (read >= 0) ::close(read);
    if (write >= 0) ::close(write);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void closeWrite() {
    ::close(write);
    write = -1;
  }
};

// Reads both streams to their ends, in the order in which data arrives.
void readBoth(int out, std::string& outText, int err, std::string& errText) {
  std::array<pollfd, 2> waiting{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  const std::array<std::string*, 2> texts{&outText, &errText};
  std::array<char, 65536> buffer{};
  while (waiting[0].fd >= 0 || waiting[1].fd >= 0) {
    if (::poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR) throw std::runtime_error("poll failed");
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if (waiting[i].fd < 0 || waiting[i].revents == 0) continue;
      const ssize_t got = ::read(waiting[i].fd, buffer.data(), buffer.size());
      if (got > 0) {
        texts[i]->append(buffer.data(), static_cast<std::size_t>(got));
      } else {
        waiting[i].fd = -1;
      }
    }
  }
}

constexpr std::chrono::seconds kSilence{120};  // without output, after which a test gives up

std::vector<std::string> environmentWith(const std::vector<std::pair<std::string, std::string>>& added) {
  std::vector<std::string> result;
  for (char** entry = environ; *entry; ++entry) result.emplace_back(*entry);
  for (const auto& [name, value] : added) {
    std::erase_if(result, [&name = name](const std::string& e) { return e.starts_with(name + "="); });
    result.push_back(name + "=" + value);
  }
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

// tests/mutation/run tests one with a bug.
std::string testedBinary() {
  const char* changed = std::getenv("QUINTET_TESTED_BINARY");
  return changed ? changed : QUINTET_BINARY;
}

// posix_spawn cannot change the working directory portably. A shell does it and then executes the binary.
std::vector<std::string> commandOf(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                                   const std::string& shell) {
  const std::string change = folder.empty() ? "" : "cd \"$0\" && ";
  const std::string more = shell.empty() ? "" : shell + " && ";
  std::vector<std::string> command{"/bin/sh", "-c", change + more + "exec \"$@\"",
                                   folder.empty() ? "sh" : folder.string(), testedBinary()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

// With the default actions for signals: tests that run in the background of a shell inherit SIGINT as ignored.
pid_t spawn(std::vector<std::string> command, std::vector<std::string> environment,
            posix_spawn_file_actions_t& actions) {
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t signals;
  sigemptyset(&signals);
  ::posix_spawnattr_setsigmask(&attributes, &signals);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&signals, signal);
  ::posix_spawnattr_setsigdefault(&attributes, &signals);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  pid_t process = -1;
  const int code =
      ::posix_spawn(&process, "/bin/sh", &actions, &attributes, pointers(command).data(), pointers(environment).data());
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (code != 0) throw std::runtime_error("cannot start a process");
  return process;
}

int waitStatus(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0)
    if (errno != EINTR) throw std::runtime_error("waitpid failed");
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

}  // namespace

RunResult run(const std::vector<std::string>& arguments, const RunOptions& options) {
  Pipe out;
  Pipe err;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  if (options.out.empty()) {
    ::posix_spawn_file_actions_adddup2(&actions, out.write, STDOUT_FILENO);
  } else {
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, options.out.c_str(), O_WRONLY | O_CREAT, 0644);
  }
  ::posix_spawn_file_actions_adddup2(&actions, err.write, STDERR_FILENO);
  const pid_t process =
      spawn(commandOf(arguments, options.folder, options.shell), environmentWith(options.environment), actions);
  out.closeWrite();
  err.closeWrite();
  RunResult result;
  readBoth(out.read, result.out, err.read, result.err);
  result.status = waitStatus(process);
  return result;
}

LiveRun::~LiveRun() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    waitStatus(process_);
  }
  ::close(output_);
}

bool LiveRun::readSome() {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(std::min(Clock::now() + kSilence, deadline_) -
                                                                          Clock::now());
  pollfd waiting{output_, POLLIN, 0};
  const int ready = left.count() > 0 ? ::poll(&waiting, 1, static_cast<int>(left.count())) : 0;
  if (ready < 0 && errno == EINTR) return true;
  if (ready <= 0) return false;
  std::array<char, 4096> buffer{};
  const ssize_t got = ::read(output_, buffer.data(), buffer.size());
  if (got < 0 && errno == EINTR) return true;
  closed_ = got <= 0;  // EIO: no process has the terminal open
  if (closed_) return false;
  text_.append(buffer.data(), static_cast<std::size_t>(got));
  return true;
}

bool LiveRun::waitFor(const std::string& text) {
  while (text_.find(text) == std::string::npos)
    if (!readSome()) return false;
  return true;
}

bool LiveRun::waitForNext(const std::string& text) {
  std::size_t found = text_.find(text, seen_);
  for (; found == std::string::npos; found = text_.find(text, seen_))
    if (!readSome()) return false;
  seen_ = found + text.size();
  return true;
}

void LiveRun::signal(int number) { ::kill(process_, number); }

void LiveRun::kill() {
  ::kill(process_, SIGKILL);
  waitStatus(std::exchange(process_, -1));
}

RunResult LiveRun::finish() {
  while (readSome()) {
  }
  if (!closed_) ::kill(process_, SIGKILL);  // it does not end
  const int status = waitStatus(process_);
  process_ = -1;
  return {status, "", text_};
}

TerminalRun::TerminalRun(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                         unsigned short columns, const Environment& environment) {
  int child = -1;
  winsize size{};
  size.ws_col = columns;
  size.ws_row = 24;
  if (::openpty(&output_, &child, nullptr, nullptr, &size) != 0) throw std::runtime_error("cannot open a terminal");
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, child, STDERR_FILENO);
  ::posix_spawn_file_actions_addclose(&actions, child);
  ::posix_spawn_file_actions_addclose(&actions, output_);
  Environment all{{"TERM", "xterm"}};
  all.insert(all.end(), environment.begin(), environment.end());
  process_ = spawn(commandOf(arguments, folder, ""), environmentWith(all), actions);
  ::close(child);
}

PipeRun::PipeRun(const std::vector<std::string>& arguments, const RunOptions& options, std::chrono::seconds limit) {
  deadline_ = Clock::now() + limit;
  Pipe err;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  const std::filesystem::path out = options.out.empty() ? "/dev/null" : options.out;
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  ::posix_spawn_file_actions_adddup2(&actions, err.write, STDERR_FILENO);
  process_ = spawn(commandOf(arguments, options.folder, options.shell), environmentWith(options.environment), actions);
  output_ = std::exchange(err.read, -1);
}

}  // namespace quintet::test
