// The file that is written in place of another one until it is whole: beside it, hidden, with a name that follows from
// the other's. Its process holds a lock on it (flock), which ends with the process: so one that a killed process has left
// is told from one that is being written, and the next writer of the same file removes it.
#ifndef QUINTET_BASE_TEMPORARY_FILE_H
#define QUINTET_BASE_TEMPORARY_FILE_H

#include <filesystem>

namespace quintet {

class TemporaryFile {
 public:
  // Empty, open for writing. Throws std::system_error.
  explicit TemporaryFile(const std::filesystem::path& target);
  // Closes it, and removes it unless it was renamed.
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return fd_; }
  // Each 0 or the error's code. flush(): all is on the disk, or it is known what is lost.
  int flush();
  int renameToTarget();

  // Removes what killed processes have left beside `target`, and nothing that somebody is writing.
  static void removeLeftovers(const std::filesystem::path& target);

 private:
  std::filesystem::path target_, path_;
  int fd_ = -1;
  bool renamed_ = false;
};

}  // namespace quintet
#endif
