// SPDX-License-Identifier: Apache-2.0
// The temporary folder of a worker, which only this user can read: programs that are not saved, and files that the page
// downloads. It is removed with the object; by the server if the worker has ended before; and by the next server if that was
// killed, too.
#ifndef QUINTET_LAB_PRIVATE_FOLDER_H
#define QUINTET_LAB_PRIVATE_FOLDER_H

#include <sys/types.h>

#include <filesystem>

namespace quintet::lab {

class PrivateFolder {
 public:
  // `process`: that the folder belongs to, as other processes see it. Throws FileError.
  explicit PrivateFolder(pid_t process);
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }  // without symbolic links

 private:
  std::filesystem::path path_;
};

// Removes the folders of a process that has ended.
void removePrivateFolders(pid_t process);

// Removes the folders of all processes of this user that no longer exist.
void removeAbandonedFolders();

}  // namespace quintet::lab
#endif
