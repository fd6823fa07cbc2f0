// SPDX-License-Identifier: Apache-2.0
#include "child.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

namespace quintet::oracle {
namespace {

// Returns the environment of this process with some variables replaced.
std::vector<std::string> environmentWith(const Variables& changes) {
  std::vector<std::string> result;
  for (char** entry = ::environ; *entry; ++entry) {
    const std::string text = *entry;
    const bool changed = std::ranges::any_of(changes, [&](const auto& c) { return text.starts_with(c.first + "="); });
    if (!changed) result.push_back(text);
  }
  for (const auto& [name, value] : changes)
    if (value) result.push_back(name + "=" + *value);
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

}  // namespace

ChildEnd runInChild(const std::string& test, const Variables& environment) {
  std::vector<std::string> arguments = {"quintet_oracle_tests", "--gtest_also_run_disabled_tests",
                                        "--gtest_filter=" + test};
  std::vector<std::string> variables = environmentWith(environment);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, "/proc/self/exe", &actions, nullptr, pointers(arguments).data(),
                                  pointers(variables).data());
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error("cannot start a child process");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
  }
  if (!WIFEXITED(status)) return ChildEnd::crashed;
  return WEXITSTATUS(status) == 0 ? ChildEnd::passed : ChildEnd::failed;
}

}  // namespace quintet::oracle
