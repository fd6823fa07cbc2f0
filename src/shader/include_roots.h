// SPDX-License-Identifier: Apache-2.0
// The folders outside of which a program reads no files by #include or as the default of an image parameter: those of the
// environment variable QUINTET_INCLUDE_ROOTS, separated by ':'. The lab sets it, because a page must not reach other files.
// Unset or empty means no limit. The shader library, QUINTET_SHADER_PATH and include folders of the compiler do not count.
#ifndef QUINTET_SHADER_INCLUDE_ROOTS_H
#define QUINTET_SHADER_INCLUDE_ROOTS_H

#include <filesystem>
#include <string>
#include <vector>

namespace quintet::shader {

class IncludeRoots {
 public:
  static IncludeRoots fromEnvironment();

  // Symbolic links count as the files that they name.
  bool allows(const std::filesystem::path& file) const;
  bool limited() const { return !folders_.empty(); }

 private:
  std::vector<std::filesystem::path> folders_;  // without symbolic links
};

// Allows files of one more folder in this process and its children, and limits them to such folders if that was the first
// one. Not while other threads read the environment.
void addIncludeRoot(const std::filesystem::path& folder);

}  // namespace quintet::shader
#endif
