// SPDX-License-Identifier: Apache-2.0
#include "output/video/ffmpeg.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parse.h"
#include "base/text.h"

extern char** environ;

namespace quintet::output {
namespace {

// A file without a name for the messages of the process.
int makeMessageFile() {
  const int fd = ::memfd_create("quintet-ffmpeg", MFD_CLOEXEC);
  if (fd < 0) throw Error(fmt::format("cannot start ffmpeg: {}", std::generic_category().message(errno)));
  return fd;
}

struct SpawnSettings {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  SpawnSettings() {
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawnattr_init(&attributes);
  }
  ~SpawnSettings() {
    ::posix_spawn_file_actions_destroy(&files);
    ::posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

}  // namespace

std::filesystem::path findProgram(const std::string& name) {
  const char* const path = std::getenv("PATH");
  for (const std::string& folder : splitText(path ? path : "", ':')) {
    const std::filesystem::path file = std::filesystem::path(folder.empty() ? "." : folder) / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

FfmpegProcess::FfmpegProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments)
    : messages_(makeMessageFile()) {
  std::array<int, 2> sockets{};
  // Unlike a pipe, a socket can be written without a signal when its reader has ended.
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) {
    ::close(messages_);
    throw Error(fmt::format("cannot start ffmpeg: {}", std::generic_category().message(errno)));
  }
  input_ = sockets[0];
  SpawnSettings spawn;
  ::posix_spawn_file_actions_adddup2(&spawn.files, sockets[1], STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&spawn.files, messages_, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&spawn.files, messages_, STDERR_FILENO);
  sigset_t none, standard;
  ::sigemptyset(&none);
  ::sigemptyset(&standard);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) ::sigaddset(&standard, signal);
  ::posix_spawnattr_setsigmask(&spawn.attributes, &none);
  ::posix_spawnattr_setsigdefault(&spawn.attributes, &standard);
  ::posix_spawnattr_setpgroup(&spawn.attributes, 0);
  ::posix_spawnattr_setflags(&spawn.attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const int failed = ::posix_spawn(&pid_, program.c_str(), &spawn.files, &spawn.attributes, pointers.data(), environ);
  ::close(sockets[1]);
  if (failed == 0) return;
  ::close(input_);
  ::close(messages_);
  throw Error(fmt::format("cannot start {}: {}", program.string(), std::generic_category().message(failed)));
}

FfmpegProcess::~FfmpegProcess() {
  closeInput();  // it ends then, too, where signals to other processes are not allowed
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  ::close(messages_);
}

void FfmpegProcess::closeInput() {
  if (input_ >= 0) ::close(std::exchange(input_, -1));
}

bool FfmpegProcess::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

std::string FfmpegProcess::finish() {
  closeInput();
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  const std::string message = lastMessage();
  const std::string end =
      WIFEXITED(status) ? fmt::format("status {}", WEXITSTATUS(status)) : fmt::format("signal {}", WTERMSIG(status));
  return message.empty() ? fmt::format("ffmpeg ended with {}", end) : fmt::format("ffmpeg failed: {}", message);
}

std::string FfmpegProcess::lastMessage() const {
  constexpr off_t kTail = 4096;
  const off_t size = ::lseek(messages_, 0, SEEK_END);
  std::string text(static_cast<std::size_t>(std::min(std::max<off_t>(size, 0), kTail)), '\0');
  const ssize_t count = ::pread(messages_, text.data(), text.size(), size - static_cast<off_t>(text.size()));
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return printable(text.substr(text.find_last_of("\n\r") + 1));  // npos + 1 is 0
}

}  // namespace quintet::output
