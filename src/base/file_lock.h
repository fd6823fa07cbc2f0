// SPDX-License-Identifier: Apache-2.0
// An advisory lock for a file that one process at a time may use (flock). The lock is on a hidden file beside it, because
// the file itself may not exist yet and is replaced by renaming. The system releases the lock when the process ends,
// however it ends.
#ifndef QUINTET_BASE_FILE_LOCK_H
#define QUINTET_BASE_FILE_LOCK_H

#include <filesystem>

namespace quintet {

class FileLock {
 public:
  // Throws FileError that names `file` and the process that holds the lock, if it is known. On a file system without
  // locks, nothing is locked.
  explicit FileLock(const std::filesystem::path& file);
  // Releases the lock and removes its file.
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::filesystem::path path_;
  int fd_ = -1;
};

}  // namespace quintet
#endif
