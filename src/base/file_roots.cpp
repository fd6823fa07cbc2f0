// SPDX-License-Identifier: Apache-2.0
#include "base/file_roots.h"

#include <stdlib.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "base/parse.h"

namespace quintet {
namespace {

constexpr const char* kRootsVariable = "QUINTET_INCLUDE_ROOTS";

bool isHidden(const std::filesystem::path& part) { return part.native().starts_with('.'); }

}  // namespace

FileRoots FileRoots::fromEnvironment() {
  FileRoots roots;
  const char* value = std::getenv(kRootsVariable);
  for (const std::string& folder : splitText(value ? value : "", ':')) {
    std::error_code error;
    if (!folder.empty()) roots.folders_.push_back(std::filesystem::weakly_canonical(folder, error));
  }
  return roots;
}

bool FileRoots::allows(const std::filesystem::path& file) const {
  if (!limited()) return true;
  std::error_code error;
  const std::filesystem::path path = std::filesystem::weakly_canonical(std::filesystem::absolute(file, error), error);
  if (error) return false;
  return std::ranges::any_of(folders_, [&](const std::filesystem::path& folder) {
    const auto [end, below] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
    return end == folder.end() && std::none_of(below, path.end(), isHidden);
  });
}

void addFileRoot(const std::filesystem::path& folder) {
  const char* value = std::getenv(kRootsVariable);
  const std::string before = value ? value : "";
  ::setenv(kRootsVariable, (before.empty() ? folder.string() : before + ":" + folder.string()).c_str(), 1);
}

}  // namespace quintet
