// SPDX-License-Identifier: Apache-2.0
#include "lab/unsaved_program.h"

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxName = 128;  // characters

// Of the folders of a process.
std::string prefixOf(pid_t process) { return fmt::format("quintet-lab-{}-", process); }

// Only this user can read the folder.
fs::path createFolder() {
  std::string name = (fs::temp_directory_path() / (prefixOf(::getpid()) + "XXXXXX")).string();
  if (!mkdtemp(name.data())) throw FileError(name, std::generic_category().message(errno));
  return name;
}

}  // namespace

bool isUnsavedName(std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
  };
  return !name.empty() && name.size() <= kMaxName && name.front() != '.' && std::ranges::all_of(name, allowed);
}

UnsavedProgram::UnsavedProgram(const std::vector<std::pair<std::string, std::string>>& files)
    : folder_(createFolder()) {
  try {
    for (const auto& [name, text] : files) writeFile(folder_ / name, text);
  } catch (...) {
    std::error_code error;
    fs::remove_all(folder_, error);
    throw;
  }
}

UnsavedProgram::~UnsavedProgram() {
  std::error_code error;
  fs::remove_all(folder_, error);
}

void removeUnsavedPrograms(pid_t process) {
  std::error_code error;
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::temp_directory_path(error), error))
    if (entry.path().filename().string().starts_with(prefixOf(process))) folders.push_back(entry.path());
  for (const fs::path& folder : folders) fs::remove_all(folder, error);
}

}  // namespace quintet::lab
