// SPDX-License-Identifier: Apache-2.0
#include "cli/companion.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <vector>

#include "base/error.h"
#include "base/parse.h"

namespace quintet::cli {
namespace {

namespace fs = std::filesystem;

bool isExecutable(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0;
}

}  // namespace

fs::path findCompanion(const std::string& name) {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  if (!error && isExecutable(self.parent_path() / name)) return self.parent_path() / name;
  const char* path = std::getenv("PATH");
  for (const std::string& folder : splitText(path ? path : "", ':'))
    if (!folder.empty() && isExecutable(fs::path(folder) / name)) return fs::path(folder) / name;
  return {};
}

void startCompanion(const fs::path& program, std::span<const std::string> arguments) {
  std::string name = program.string();
  std::vector<std::string> texts(arguments.begin(), arguments.end());
  std::vector<char*> pointers{name.data()};
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  ::execv(name.c_str(), pointers.data());
  throw FileError(program.string(), "", std::string("cannot start it: ") + std::strerror(errno));
}

}  // namespace quintet::cli
