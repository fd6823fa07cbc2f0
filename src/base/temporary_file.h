// SPDX-License-Identifier: Apache-2.0
// A hidden temporary file beside the target file that it replaces once it is complete. Its name is derived from the
// target's. The writing process holds a lock on it (flock), which ends with the process. A file without a lock was left
// by a killed process, and the next writer of the same target removes it.
#ifndef QUINTET_BASE_TEMPORARY_FILE_H
#define QUINTET_BASE_TEMPORARY_FILE_H

#include <filesystem>

namespace quintet {

class TemporaryFile {
 public:
  // Creates an empty file that is open for writing. Throws std::system_error.
  explicit TemporaryFile(const std::filesystem::path& target);
  // Closes the file and removes it unless it was renamed.
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return fd_; }
  const std::filesystem::path& path() const { return path_; }  // for other programs that write the file
  // Both return 0 or the error code. After flush() all data is on the disk, or the error has been reported.
  int flush();
  int renameToTarget();

  // Removes the files of killed processes beside `target`, but not those of running writers.
  static void removeLeftovers(const std::filesystem::path& target);

 private:
  std::filesystem::path target_, path_;
  int fd_ = -1;
  bool renamed_ = false;
};

}  // namespace quintet
#endif
