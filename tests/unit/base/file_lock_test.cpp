// SPDX-License-Identifier: Apache-2.0
// Locks between processes: exclusive, released by the end of the process, and independent of the locked file.
#include "base/file_lock.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <vector>

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

// A process that was killed takes a moment to end. Here it ends when the wait begins.
TEST(FileLockTest, WaitsForTheOwner) {
  const TempFolder folder;
  int ready[2], end[2];
  ASSERT_EQ(::pipe(ready), 0);
  ASSERT_EQ(::pipe(end), 0);
  const pid_t owner = fork();
  char byte = 'x';
  if (owner == 0) {
    const FileLock lock(folder / "a");
    _exit(::write(ready[1], &byte, 1) == 1 && ::read(end[0], &byte, 1) == 1 ? 0 : 1);
  }
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  std::vector<std::string> notes;
  EXPECT_THROW(FileLock(folder / "a", 0.1, [&](const std::string& text) { notes.push_back(text); }), FileError);
  EXPECT_EQ(notes.size(), 1u);
  const FileLock lock(folder / "a", 60, [&](const std::string& text) {
    notes.push_back(text);
    EXPECT_EQ(::write(end[1], &byte, 1), 1);
  });
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_THAT(notes[1], testing::AllOf(HasSubstr("a: is in use by process " + std::to_string(owner)),
                                       HasSubstr("waiting up to 60 s")));
  ASSERT_EQ(waitpid(owner, nullptr, 0), owner);
  for (const int file : {ready[0], ready[1], end[0], end[1]}) ::close(file);
}

}  // namespace
}  // namespace quintet
