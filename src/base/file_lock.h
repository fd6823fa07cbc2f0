// SPDX-License-Identifier: Apache-2.0
// An advisory lock for a file that one process at a time may use (flock). The lock is on a hidden file beside it, because
// the file itself may not exist yet and is replaced by renaming. The system releases the lock when the process ends,
// however it ends.
#ifndef QUINTET_BASE_FILE_LOCK_H
#define QUINTET_BASE_FILE_LOCK_H

#include <filesystem>
#include <functional>
#include <string>

namespace quintet {

class FileLock {
 public:
  using Note = std::function<void(const std::string& text)>;

  // Throws FileError that names `file` and the process that holds the lock, if it is known. A process that was killed holds
  // it until the system has ended all of its threads and the driver's. So the constructor waits up to `seconds` for the lock;
  // it calls `note` once before it waits. On a file system without locks, nothing is locked.
  explicit FileLock(const std::filesystem::path& file, double seconds = 0, const Note& note = {});
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
