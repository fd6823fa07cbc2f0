// SPDX-License-Identifier: Apache-2.0
#include "lab/private_folder.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parse.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "quintet-lab-";

// "quintet-lab-123-abc" → 123.
std::optional<pid_t> ownerOf(const std::string& name) {
  if (!name.starts_with(kPrefix)) return {};
  const std::size_t end = name.find('-', kPrefix.size());
  if (end == name.npos) return {};
  return parseNumber<pid_t>(name.substr(kPrefix.size(), end - kPrefix.size()));
}

bool isOwn(const fs::path& folder) {
  struct stat status {};
  return ::lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == ::getuid();
}

void removeFolders(const std::function<bool(pid_t)>& ofProcess) {
  std::error_code error;
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::temp_directory_path(error), error)) {
    const std::optional<pid_t> owner = ownerOf(entry.path().filename().string());
    if (owner && ofProcess(*owner) && isOwn(entry.path())) folders.push_back(entry.path());
  }
  for (const fs::path& folder : folders) fs::remove_all(folder, error);
}

}  // namespace

PrivateFolder::PrivateFolder(pid_t process) {
  std::string name = (fs::temp_directory_path() / fmt::format("{}{}-XXXXXX", kPrefix, process)).string();
  if (!mkdtemp(name.data())) throw FileError(name, std::generic_category().message(errno));
  path_ = fs::canonical(name);
}

PrivateFolder::~PrivateFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

void removePrivateFolders(pid_t process) {
  removeFolders([&](pid_t owner) { return owner == process; });
}

void removeAbandonedFolders() {
  removeFolders([](pid_t owner) { return owner > 0 && ::kill(owner, 0) != 0 && errno == ESRCH; });
}

}  // namespace quintet::lab
