// SPDX-License-Identifier: Apache-2.0
#include "base/temporary_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "base/hash.h"

namespace quintet {
namespace {

namespace fs = std::filesystem;

// Writers try the numbers in ascending order, so files of killed processes are found without reading the folder. The
// name contains a hash, because the name of the target may be too long for a suffix.
fs::path nameOf(const fs::path& target, unsigned number) {
  const std::string hash = Hasher().add(target.filename().string()).finish().hex().substr(0, 16);
  return (target.has_parent_path() ? target.parent_path() : fs::path(".")) /
         (".quintet-" + hash + "-" + std::to_string(number) + ".tmp");
}

// Returns whether `path` still names the open file. Another process can replace it between open and lock.
bool stillNames(int fd, const fs::path& path) {
  struct stat open {
  }, named{};
  return ::fstat(fd, &open) == 0 && ::lstat(path.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

bool lock(int fd) { return ::flock(fd, LOCK_EX | LOCK_NB) == 0; }

// Returns true if the file does not exist afterwards; false if it is being written, is not a regular file or is
// unknown.
bool removeLeftover(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return errno == ENOENT;
  struct stat info {};
  const bool abandoned = ::fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && lock(fd) && stillNames(fd, path);
  const bool removed = abandoned && ::unlink(path.c_str()) == 0;
  ::close(fd);
  return removed;
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& target) : target_(target) {
  for (unsigned number = 0; fd_ < 0; ++number) {
    path_ = nameOf(target, number);
    removeLeftover(path_);
    fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd_ < 0 && errno == EEXIST) continue;
    if (fd_ < 0) throw std::system_error(errno, std::generic_category());
    // Another process that removes leftovers may have locked or removed the file before this one locked it. On file
    // systems without locks, removeLeftover() cannot lock a file and therefore keeps all of them.
    const bool taken = !lock(fd_) && errno == EWOULDBLOCK;
    if (taken || !stillNames(fd_, path_)) ::close(std::exchange(fd_, -1));
  }
  removeLeftovers(target);
}

TemporaryFile::~TemporaryFile() {
  if (!renamed_) ::unlink(path_.c_str());
  ::close(fd_);
}

int TemporaryFile::flush() {
  if (::fsync(fd_) != 0 && errno != EINVAL && errno != ENOTSUP) return errno;
  // NFS reports a lost write when a descriptor is closed. Closing a copy keeps this descriptor open and locked.
  const int copy = ::dup(fd_);
  return copy < 0 || ::close(copy) == 0 ? 0 : errno;
}

int TemporaryFile::renameToTarget() {
  if (::rename(path_.c_str(), target_.c_str()) != 0) return errno;
  renamed_ = true;
  return 0;
}

void TemporaryFile::removeLeftovers(const fs::path& target) {
  constexpr unsigned kGap = 4;  // unused numbers between used ones: their writers have finished
  struct stat info {};
  for (unsigned number = 0, missing = 0; missing < kGap; ++number) {
    const fs::path path = nameOf(target, number);
    if (::lstat(path.c_str(), &info) == 0)
      removeLeftover(path);
    else
      ++missing;
  }
}

}  // namespace quintet
