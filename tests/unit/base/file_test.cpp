// SPDX-License-Identifier: Apache-2.0
#include "base/file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <thread>

#include "base/error.h"
#include "base/temporary_file.h"
#include "temp_folder.h"

namespace quintet {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;
using testing::HasSubstr;

std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const FileError& error) {
    return error.what();
  }
  return "no FileError";
}

// Sets an environment variable until the end of the scope.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    value ? setenv(name, value, 1) : unsetenv(name);
  }
  ~Variable() { old_ ? setenv(name_, old_->c_str(), 1) : unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> old_;
};

// Replaces standard input until the end of the scope.
class StandardInput {
 public:
  explicit StandardInput(int descriptor) : old_(dup(STDIN_FILENO)) { dup2(descriptor, STDIN_FILENO); }
  ~StandardInput() {
    dup2(old_, STDIN_FILENO);
    close(old_);
  }
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

 private:
  int old_;
};

// Writes the text into a new pipe from another thread, and calls body(path of the pipe, descriptor).
template <class Body>
void withPipe(const std::string& text, const Body& body) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  std::thread writer([&] {
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t more = write(ends[1], text.data() + done, text.size() - done);
      if (more <= 0) break;
      done += static_cast<std::size_t>(more);
    }
    close(ends[1]);
  });
  body(fs::path("/proc/self/fd/" + std::to_string(ends[0])), ends[0]);
  writer.join();
  close(ends[0]);
}

TEST(FileTest, ReadsPipesAsOftenAsFiles) {
  const std::string large = std::string(300'000, 'x') + "end";  // more than a pipe holds
  withPipe(large, [&](const fs::path& path, int) {
    EXPECT_EQ(readTextFile(path), large);
    EXPECT_EQ(readTextFile(path), large);
    EXPECT_EQ(readFile(path).size(), large.size());
  });
  withPipe("second", [&](const fs::path& path, int) { EXPECT_EQ(readTextFile(path), "second"); });
  withPipe("", [&](const fs::path& path, int) { EXPECT_EQ(readTextFile(path), ""); });
}

TEST(FileTest, ReadsStandardInput) {
  withPipe("from a pipe", [&](const fs::path&, int descriptor) {
    const StandardInput input(descriptor);
    EXPECT_EQ(readTextFile("-"), "from a pipe");
    EXPECT_EQ(readTextFile("-"), "from a pipe");
    EXPECT_EQ(readTextFile("/dev/stdin"), "from a pipe");
  });
  const TempFolder folder;
  writeFile(folder.path() / "a", "from a file");
  const int file = open((folder.path() / "a").c_str(), O_RDONLY);
  {
    const StandardInput input(file);
    EXPECT_EQ(readTextFile("-"), "from a file");
    EXPECT_EQ(readTextFile("-"), "from a file");
  }
  close(file);
  const int directory = open(folder.path().c_str(), O_RDONLY | O_DIRECTORY);
  {
    const StandardInput input(directory);
    EXPECT_EQ(messageOf([] { readFile("-"); }), "standard input: cannot be read: Is a directory");
  }
  close(directory);
}

TEST(FileErrorTest, ContainsFileLocationAndProblem) {
  const FileError error("scene.gltf", "/nodes/3", "no such mesh");
  EXPECT_STREQ(error.what(), "scene.gltf: /nodes/3: no such mesh");
  EXPECT_EQ(error.file(), "scene.gltf");
  EXPECT_EQ(error.location(), "/nodes/3");
  EXPECT_EQ(error.problem(), "no such mesh");
  EXPECT_STREQ(FileError("a.png", "is empty").what(), "a.png: is empty");
}

TEST(ReadFileTest, ReturnsWrittenBytes) {
  const TempFolder folder;
  const std::string text("a\0b\n\xff", 5);
  writeFile(folder / "a", text);
  EXPECT_EQ(readTextFile(folder / "a"), text);
  const auto bytes = readFile(folder / "a");
  ASSERT_EQ(bytes.size(), 5u);
  EXPECT_EQ(bytes[4], std::byte{0xff});
}

TEST(ReadFileTest, ReadsEmptyFilesAndFilesWithoutSize) {
  const TempFolder folder;
  writeFile(folder / "empty", "");
  EXPECT_TRUE(readFile(folder / "empty").empty());
  EXPECT_THAT(readTextFile("/proc/self/status"), HasSubstr("Pid:"));
}

TEST(ReadFileTest, ReportsMissingFilesAndFolders) {
  const TempFolder folder;
  EXPECT_THAT(messageOf([&] { readFile(folder / "none"); }), HasSubstr("none: cannot be read: No such file"));
  EXPECT_THAT(messageOf([&] { readFile(folder.path()); }), HasSubstr("Is a directory"));
}

TEST(WriteFileTest, ReplacesAFileWithoutTemporaryFiles) {
  const TempFolder folder;
  writeFile(folder / "a", "old");
  writeFile(folder / "a", "new");
  EXPECT_EQ(readTextFile(folder / "a"), "new");
  EXPECT_EQ(folder.entryCount(), 1u);
}

TEST(WriteFileTest, AppliesUmaskToNewFilesAndKeepsPermissionsOfExistingOnes) {
  const TempFolder folder;
  const mode_t before = umask(027);
  writeFile(folder / "a", "1");
  umask(before);
  struct stat info {};
  ASSERT_EQ(stat((folder / "a").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
  ASSERT_EQ(chmod((folder / "a").c_str(), 0604), 0);
  writeFile(folder / "a", "2");
  ASSERT_EQ(stat((folder / "a").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0604u);
}

TEST(WriteFileTest, WritesThroughSymbolicLinks) {
  const TempFolder folder;
  fs::create_directory(folder / "sub");
  writeFile(folder / "sub/target", "old");
  fs::create_symlink("sub/target", folder / "link");
  writeFile(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(readTextFile(folder / "sub/target"), "new");

  fs::create_symlink("sub/later", folder / "dangling");
  writeFile(folder / "dangling", "made");
  EXPECT_EQ(readTextFile(folder / "sub/later"), "made");

  fs::create_symlink("loop", folder / "loop");
  EXPECT_THAT(messageOf([&] { writeFile(folder / "loop", "x"); }), HasSubstr("symbolic links"));
}

TEST(WriteFileTest, ReportsMissingFolders) {
  const TempFolder folder;
  const std::string message = messageOf([&] { writeFile(folder / "none/a.png", "x"); });
  EXPECT_THAT(message, HasSubstr("a.png: cannot be written: the folder "));
  EXPECT_THAT(message, HasSubstr("none does not exist"));
  EXPECT_EQ(message, messageOf([&] { checkWritable(folder / "none/a.png"); }));
}

TEST(WriteFileTest, RejectsFoldersAndEmptyNames) {
  const TempFolder folder;
  EXPECT_THAT(messageOf([&] { writeFile(folder.path(), "x"); }), HasSubstr("Is a directory"));
  EXPECT_THAT(messageOf([&] { writeFile(folder / "new/", "x"); }), HasSubstr("Is a directory"));
  EXPECT_THAT(messageOf([&] { writeFile("", "x"); }), HasSubstr("empty"));
  writeFile(folder / "file", "x");
  EXPECT_THAT(messageOf([&] { writeFile(folder / "file/a", "x"); }), HasSubstr("Not a directory"));
}

TEST(WriteFileTest, ReportsFullDevices) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  EXPECT_THAT(messageOf([] { writeFile("/dev/full", "x"); }), HasSubstr("/dev/full: cannot be written: No space left"));
  writeFile("/dev/null", "x");
}

// A limit on the file size makes the write fail halfway, like a full disk.
TEST(WriteFileTest, KeepsTheOldFileOnFailure) {
  const TempFolder folder;
  writeFile(folder / "a", "old");
  EXPECT_EXIT(
      {
        signal(SIGXFSZ, SIG_IGN);
        struct rlimit limit {};
        limit.rlim_cur = limit.rlim_max = 1000;
        setrlimit(RLIMIT_FSIZE, &limit);
        const std::string message = messageOf([&] { writeFile(folder / "a", std::string(100000, 'x')); });
        std::_Exit(message.find("File too large") != std::string::npos ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
  EXPECT_EQ(readTextFile(folder / "a"), "old");
  EXPECT_EQ(folder.entryCount(), 1u);
}

// SIGXFSZ kills the process halfway through the write.
void writeAndDie(const fs::path& file) {
  signal(SIGXFSZ, SIG_DFL);
  struct rlimit limit {};
  setrlimit(RLIMIT_CORE, &limit);
  limit.rlim_cur = limit.rlim_max = 1000;
  setrlimit(RLIMIT_FSIZE, &limit);
  writeFile(file, std::string(100000, 'x'));
}
void leaveLeftover(const fs::path& file) { EXPECT_EXIT(writeAndDie(file), testing::KilledBySignal(SIGXFSZ), ""); }

std::vector<std::string> hiddenFiles(const TempFolder& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder.path()))
    if (entry.path().filename().string().starts_with('.')) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  return names;
}

TEST(WriteFileTest, RemovesTemporaryFilesOfKilledWriters) {
  const TempFolder folder;
  writeFile(folder / "a", "old");
  leaveLeftover(folder / "a");
  EXPECT_EQ(readTextFile(folder / "a"), "old");
  ASSERT_EQ(hiddenFiles(folder).size(), 1u);
  const std::string left = hiddenFiles(folder)[0];
  EXPECT_EQ(fs::file_size(folder / left), 1000u);
  // Temporary files of a different target, or with a different kind of name, stay.
  leaveLeftover(folder / "b");
  writeFile(folder / ".quintet-mine.tmp", "mine");
  ASSERT_EQ(hiddenFiles(folder).size(), 3u);
  writeFile(folder / "a", "new");
  EXPECT_EQ(readTextFile(folder / "a"), "new");
  EXPECT_THAT(hiddenFiles(folder), testing::AllOf(testing::SizeIs(2), testing::Not(testing::Contains(left)),
                                                  testing::Contains(".quintet-mine.tmp")));
  removeLeftovers(folder / "b");
  EXPECT_EQ(hiddenFiles(folder), std::vector<std::string>{".quintet-mine.tmp"});
}

TEST(WriteFileTest, RemovesSeveralLeftoversAndFollowsLinks) {
  const TempFolder folder;
  const auto leaveTwo = [&] {
    leaveLeftover(folder / "a");
    const std::string first = hiddenFiles(folder).at(0), second = first.substr(0, first.size() - 5) + "1.tmp";
    ASSERT_TRUE(first.ends_with("-0.tmp")) << first;
    fs::copy_file(folder / first, folder / second);
  };
  leaveTwo();
  writeFile(folder / "a", "new");
  EXPECT_EQ(folder.entryCount(), 1u);
  leaveTwo();
  fs::create_symlink("a", folder / "link");
  removeLeftovers(folder / "link");
  EXPECT_EQ(folder.entryCount(), 2u);
}

// A slow writer and a fast writer of the same file do not disturb each other.
TEST(WriteFileTest, KeepsTemporaryFilesThatAreBeingWritten) {
  const TempFolder folder;
  std::optional<TemporaryFile> slow(std::in_place, folder / "a");
  ASSERT_EQ(hiddenFiles(folder).size(), 1u);
  const std::string name = hiddenFiles(folder)[0];
  removeLeftovers(folder / "a");
  writeFile(folder / "a", "fast");
  EXPECT_EQ(hiddenFiles(folder), std::vector<std::string>{name});
  ASSERT_EQ(write(slow->descriptor(), "slow", 4), 4);
  EXPECT_EQ(slow->flush(), 0);
  removeLeftovers(folder / "a");  // the lock holds until the file is renamed
  EXPECT_EQ(slow->renameToTarget(), 0);
  slow.reset();
  EXPECT_EQ(readTextFile(folder / "a"), "slow");
  EXPECT_EQ(folder.entryCount(), 1u);
}

// A symbolic link with the temporary file's name must not redirect the write to another file.
TEST(WriteFileTest, IgnoresLinksWithTheTemporaryFilesName) {
  const TempFolder folder;
  leaveLeftover(folder / "a");
  const std::string name = hiddenFiles(folder).at(0);
  fs::remove(folder / name);
  writeFile(folder / "other", "other");
  fs::create_symlink("other", folder / name);
  writeFile(folder / "a", "new");
  EXPECT_EQ(readTextFile(folder / "a"), "new");
  EXPECT_EQ(readTextFile(folder / "other"), "other");
  EXPECT_TRUE(fs::is_symlink(folder / name));
  EXPECT_EQ(folder.entryCount(), 3u);
}

TEST(WriteFileTest, ConcurrentWritersLeaveOneCompleteFile) {
  const TempFolder folder;
  std::vector<std::jthread> writers;
  for (int i = 0; i < 4; ++i)
    writers.emplace_back([&, i] {
      for (int k = 0; k < 50; ++k) writeFile(folder / "a", std::string(20000, static_cast<char>('a' + i)));
    });
  writers.clear();
  const std::string text = readTextFile(folder / "a");
  EXPECT_EQ(text, std::string(20000, text.at(0)));
  EXPECT_EQ(folder.entryCount(), 1u);
}

TEST(WriteFileTest, RejectsReadOnlyFilesAndFolders) {
  if (geteuid() == 0) GTEST_SKIP() << "root can write everywhere";
  const TempFolder folder;
  writeFile(folder / "a", "old");
  chmod((folder / "a").c_str(), 0444);
  EXPECT_THAT(messageOf([&] { writeFile(folder / "a", "x"); }), HasSubstr("Permission denied"));
  chmod(folder.path().c_str(), 0555);
  EXPECT_THAT(messageOf([&] { checkWritable(folder / "b"); }), HasSubstr("Permission denied"));
}

TEST(WriteFileTest, WritesToPipes) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const std::string large(1 << 20, 'x');  // more than a pipe holds
  std::string received;
  std::jthread reader([&] {
    char buffer[4096];
    for (ssize_t got; (got = read(ends[0], buffer, sizeof buffer)) > 0;)
      received.append(buffer, static_cast<std::size_t>(got));
  });
  writeFile("/dev/fd/" + std::to_string(ends[1]), large);
  close(ends[1]);
  reader.join();
  close(ends[0]);
  EXPECT_EQ(received, large);
}

TEST(WriteFileTest, WritesToStandardOutputForADash) {
  testing::internal::CaptureStdout();
  writeFile("-", "to stdout");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "to stdout");
  checkWritable("-");
}

TEST(CheckWritableTest, TouchesNothing) {
  const TempFolder folder;
  writeFile(folder / "a", "old");
  checkWritable(folder / "a");
  checkWritable(folder / "new");
  EXPECT_EQ(readTextFile(folder / "a"), "old");
  EXPECT_EQ(folder.entryCount(), 1u);
}

// Also for root, who has the permission to write everywhere.
TEST(CheckWritableTest, RejectsFoldersThatTakeNoFiles) {
  if (!fs::is_directory("/proc/self")) GTEST_SKIP() << "no /proc";
  EXPECT_THROW(checkWritable("/proc/x.png"), FileError);
}

TEST(FoldersTest, ReadsTheCacheFolderFromTheEnvironment) {
  const Variable own("QUINTET_CACHE_DIR", nullptr);
  const Variable home("HOME", "/home/x");
  {
    const Variable xdg("XDG_CACHE_HOME", "/xdg");
    EXPECT_EQ(cacheFolder(), "/xdg/quintet");
    const Variable override("QUINTET_CACHE_DIR", "/own");
    EXPECT_EQ(cacheFolder(), "/own");
  }
  {
    const Variable relative("XDG_CACHE_HOME", "not/absolute");
    EXPECT_EQ(cacheFolder(), "/home/x/.cache/quintet");
  }
  const Variable none("XDG_CACHE_HOME", nullptr);
  const Variable homeless("HOME", nullptr);
  EXPECT_EQ(cacheFolder(), "");
}

TEST(FoldersTest, FindsTheExecutableFolder) { EXPECT_TRUE(fs::is_directory(executableFolder())); }

}  // namespace
}  // namespace quintet
