// SPDX-License-Identifier: Apache-2.0
// The folders outside of which no file is read that a program or a scene names: by #include, as the default of an image parameter,
// or as a part of a scene. They are those of the environment variable QUINTET_INCLUDE_ROOTS, separated by ':'. The lab sets it,
// because a page must not reach other files. An entry can also be a file. Files and folders below them whose names begin with a dot
// are not read: a project can be a home folder, with keys and passwords. Unset or empty means no limit. Files that the user names,
// the shader library, QUINTET_SHADER_PATH and include folders of the compiler do not count.
#ifndef QUINTET_BASE_FILE_ROOTS_H
#define QUINTET_BASE_FILE_ROOTS_H

#include <filesystem>
#include <string>
#include <vector>

namespace quintet {

// End of the message about a file that is not read, after its name.
inline constexpr const char* kOutsideOfRoots = "is outside of the project (QUINTET_INCLUDE_ROOTS)";

class FileRoots {
 public:
  static FileRoots fromEnvironment();

  // Symbolic links count as the files that they name.
  bool allows(const std::filesystem::path& file) const;
  bool limited() const { return !folders_.empty(); }
  const std::vector<std::filesystem::path>& folders() const { return folders_; }

 private:
  std::vector<std::filesystem::path> folders_;  // without symbolic links
};

// Allows a file, or the files of one more folder, in this process and its children, and limits them to such folders if that was the first
// one. Not while other threads read the environment.
void addFileRoot(const std::filesystem::path& folder);

}  // namespace quintet
#endif
