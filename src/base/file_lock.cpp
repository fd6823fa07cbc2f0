// SPDX-License-Identifier: Apache-2.0
#include "base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/stopwatch.h"
#include "base/text.h"

namespace quintet {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPollInterval{50};

// The same for all names of one file. The name contains a hash, because the file's name may be too long for a suffix.
fs::path lockPath(const fs::path& file) {
  std::error_code failed;
  fs::path target = fs::weakly_canonical(fs::absolute(file, failed), failed);
  if (failed || target.empty()) target = file;
  const std::string hash = Hasher().add(target.filename().string()).finish().hex().substr(0, 16);
  return (target.has_parent_path() ? target.parent_path() : fs::path(".")) / (".quintet-" + hash + ".lock");
}

// Returns whether `path` still names the open file: the previous owner removes it.
bool stillNames(int fd, const fs::path& path) {
  struct stat open {
  }, named{};
  return ::fstat(fd, &open) == 0 && ::lstat(path.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

// "process 123 on host", as the owner wrote it; "another process" if that is unknown.
std::string ownerOf(int fd) {
  char text[300];
  const ssize_t size = ::pread(fd, text, sizeof text, 0);
  return size > 0 ? printable({text, static_cast<std::size_t>(size)}) : "another process";
}

void writeOwner(int fd) {
  char host[256] = {};
  std::string text = "process " + std::to_string(::getpid());
  if (::gethostname(host, sizeof host - 1) == 0 && *host) text += std::string(" on ") + host;
  // Only for messages, so a failure does not matter.
  if (::ftruncate(fd, 0) == 0) [[maybe_unused]]
    const ssize_t written = ::pwrite(fd, text.data(), text.size(), 0);
}

}  // namespace

FileLock::FileLock(const fs::path& file, double seconds, const Note& note) : path_(lockPath(file)) {
  const Stopwatch clock;
  bool noted = false;
  while (fd_ < 0) {
    fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd_ < 0) throw FileError(file, "cannot be locked: " + std::generic_category().message(errno));
    if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EINTR) {
        ::close(std::exchange(fd_, -1));
        continue;
      }
      if (errno != EWOULDBLOCK) return;  // a file system without locks
      const std::string owner = ownerOf(fd_);
      ::close(std::exchange(fd_, -1));
      if (clock.seconds() >= seconds)
        throw FileError(file, "is in use by " + owner + "; wait until it ends, or choose a different file");
      if (!std::exchange(noted, true) && note)
        note(fmt::format("{}: is in use by {}; waiting up to {:g} s for its end", file.string(), owner, seconds));
      std::this_thread::sleep_for(kPollInterval);
      continue;
    }
    if (!stillNames(fd_, path_)) ::close(std::exchange(fd_, -1));
  }
  writeOwner(fd_);
}

FileLock::~FileLock() {
  ::unlink(path_.c_str());  // before the lock is released, so that no other process has locked this file
  ::close(fd_);
}

}  // namespace quintet
