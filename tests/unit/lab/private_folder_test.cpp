// SPDX-License-Identifier: Apache-2.0
#include "lab/private_folder.h"

#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <gmock/gmock.h>

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

// The id of a process that has ended.
pid_t endedProcess() {
  const pid_t process = ::fork();
  if (process == 0) ::_exit(0);
  ::waitpid(process, nullptr, 0);
  return process;
}

fs::path folderOf(pid_t process) {
  const fs::path folder = fs::temp_directory_path() / ("quintet-lab-" + std::to_string(process) + "-test");
  fs::create_directories(folder / "program");
  return folder;
}

TEST(PrivateFolder, ExistsAsLongAsTheObject) {
  std::optional<PrivateFolder> folder(std::in_place, ::getpid());
  const fs::path path = folder->path();
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
  folder.reset();
  EXPECT_FALSE(fs::exists(path));
}

TEST(PrivateFolder, RemovesThoseOfProcessesThatHaveEnded) {
  const PrivateFolder own(::getpid());
  const fs::path ended = folderOf(endedProcess()), other = folderOf(endedProcess());
  fs::remove_all(folderOf(::getppid()));
  const fs::path running = folderOf(::getppid());
  removePrivateFolders(std::stoi(ended.filename().string().substr(12)));
  EXPECT_FALSE(fs::exists(ended));
  EXPECT_TRUE(fs::exists(other));
  removeAbandonedFolders();
  EXPECT_FALSE(fs::exists(other));
  EXPECT_TRUE(fs::exists(running));
  EXPECT_TRUE(fs::exists(own.path()));
  fs::remove_all(running);
}

}  // namespace
}  // namespace quintet::lab
