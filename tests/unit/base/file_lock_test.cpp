// SPDX-License-Identifier: Apache-2.0
// Locks between processes: exclusive, released by the end of the process, and independent of the locked file.
#include "base/file_lock.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>

#include "base/error.h"
#include "base/file.h"
#include "temp_folder.h"

namespace quintet {
namespace {

using quintet::test::TempFolder;
using testing::HasSubstr;

std::string errorFor(const std::filesystem::path& file) {
  try {
    const FileLock lock(file);
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

TEST(FileLockTest, IsExclusiveAndNamesTheOwner) {
  const TempFolder folder;
  {
    const FileLock lock(folder / "a");
    EXPECT_THAT(errorFor(folder / "a"), testing::AllOf(HasSubstr((folder / "a").string() + ": is in use by process " +
                                                                 std::to_string(getpid()) + " on ")));
    EXPECT_EQ(errorFor(folder / "b"), "");
  }
  EXPECT_EQ(errorFor(folder / "a"), "");
  EXPECT_EQ(folder.entryCount(), 0u);
}

TEST(FileLockTest, StaysWhenTheFileIsReplaced) {
  const TempFolder folder;
  const FileLock lock(folder / "a");
  writeFile(folder / "a", "first");
  writeFile(folder / "a", "second");
  EXPECT_NE(errorFor(folder / "a"), "");
}

TEST(FileLockTest, IsTheSameForAllNamesOfAFile) {
  const TempFolder folder;
  writeFile(folder / "a", "");
  std::filesystem::create_symlink("a", folder / "link");
  const FileLock lock(folder / "a");
  EXPECT_NE(errorFor(folder / "link"), "");
  EXPECT_NE(errorFor(folder / "x" / ".." / "a"), "");
}

TEST(FileLockTest, EndsWithTheProcess) {
  const TempFolder folder;
  const pid_t owner = fork();
  if (owner == 0) {
    const FileLock lock(folder / "a");
    _exit(0);  // as if killed: no destructor runs
  }
  ASSERT_EQ(waitpid(owner, nullptr, 0), owner);
  EXPECT_EQ(folder.entryCount(), 1u);
  EXPECT_EQ(errorFor(folder / "a"), "");
  EXPECT_EQ(folder.entryCount(), 0u);
}

}  // namespace
}  // namespace quintet
