// SPDX-License-Identifier: Apache-2.0
// A program that a page sends instead of a name (the key `files` of `open`): its files in a private temporary folder. The
// folder is removed with the object, and by the server if the process of the worker has ended before.
#ifndef QUINTET_LAB_UNSAVED_PROGRAM_H
#define QUINTET_LAB_UNSAVED_PROGRAM_H

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace quintet::lab {

// A name in a folder: letters, digits, '_', '-' and '.', 1 to 128 of them, without a leading '.'.
bool isUnsavedName(std::string_view name);

class UnsavedProgram {
 public:
  // `parent`: a private folder. `files`: pairs of name and text. Throws FileError.
  UnsavedProgram(const std::filesystem::path& parent, const std::vector<std::pair<std::string, std::string>>& files);
  ~UnsavedProgram();
  UnsavedProgram(const UnsavedProgram&) = delete;
  UnsavedProgram& operator=(const UnsavedProgram&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace quintet::lab
#endif
