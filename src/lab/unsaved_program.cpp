// SPDX-License-Identifier: Apache-2.0
#include "lab/unsaved_program.h"

#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>

#include "base/error.h"
#include "base/file.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxName = 128;  // characters

fs::path createSubfolder(const fs::path& parent) {
  std::string name = (parent / "program-XXXXXX").string();
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

UnsavedProgram::UnsavedProgram(const fs::path& parent, const std::vector<std::pair<std::string, std::string>>& files)
    : folder_(createSubfolder(parent)) {
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

}  // namespace quintet::lab
