// SPDX-License-Identifier: Apache-2.0
// Reports files that are written in place, replaced by a rename, removed or recreated.
#include "shader/file_watcher.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "temp_folder.h"

namespace quintet::shader {
namespace {

namespace fs = std::filesystem;
using Paths = std::vector<fs::path>;

constexpr double kLong = 10.0;  // seconds to wait for expected changes
constexpr double kShort = 0.3;  // seconds without changes

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

class FileWatching : public ::testing::Test {
 protected:
  FileWatching() {
    write(file_, "one");
    watcher_.watch({file_});
  }
  test::TempFolder folder_;
  const fs::path file_ = folder_ / "main.rgen";
  FileWatcher watcher_;
};

TEST_F(FileWatching, ReportsAFileWrittenInPlace) {
  EXPECT_FALSE(watcher_.pending());
  write(file_, "two");
  EXPECT_TRUE(watcher_.pending());
  EXPECT_EQ(watcher_.wait(kLong), Paths{file_});
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

// Editors write a new file and rename it over the old one, so the inode changes each time.
TEST_F(FileWatching, ReportsAFileReplacedByARename) {
  for (int i = 0; i < 3; ++i) {
    write(folder_ / "main.rgen~", "new");
    fs::rename(folder_ / "main.rgen~", file_);
    EXPECT_EQ(watcher_.wait(kLong), Paths{file_}) << i;
  }
}

// Other editors move the old file away and write a new one.
TEST_F(FileWatching, ReportsAFileMovedAwayAndRecreated) {
  fs::rename(file_, folder_ / "main.rgen.bak");
  write(file_, "new");
  EXPECT_EQ(watcher_.wait(kLong), Paths{file_});
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

TEST_F(FileWatching, IgnoresOtherFilesOfTheFolder) {
  write(folder_ / "out.png", "image");
  write(folder_ / ".main.rgen.swp", "swap");
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

TEST_F(FileWatching, ReportsFilesThatAppearLater) {
  const fs::path later = folder_ / "later.glsl", deep = folder_ / "sub" / "deep.glsl";
  watcher_.watch({file_, later, deep});
  write(later, "now");
  EXPECT_EQ(watcher_.wait(kLong), Paths{later});
  fs::create_directory(folder_ / "sub");
  write(deep, "now");
  EXPECT_EQ(watcher_.wait(kLong), Paths{deep});
  write(deep, "again");
  EXPECT_EQ(watcher_.wait(kLong), Paths{deep});
}

TEST_F(FileWatching, ReportsFilesOfAFolder) {
  const fs::path folder = folder_.path();
  watcher_.watch({}, {folder}, [](const fs::path& name) { return name.extension() == ".glsl"; });
  write(folder / "new.glsl", "x");
  EXPECT_EQ(watcher_.wait(kLong), Paths{folder / "new.glsl"});
  write(folder / "out.png", "x");
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

TEST_F(FileWatching, ReportsSeveralFilesAtOnce) {
  const fs::path other = folder_ / "a.glsl";
  watcher_.watch({file_, other});
  write(file_, "x");
  write(other, "y");
  EXPECT_EQ(watcher_.wait(kLong), (Paths{other, file_}));
}

TEST_F(FileWatching, ReportsARemovedFile) {
  fs::remove(file_);
  EXPECT_EQ(watcher_.wait(kLong), Paths{file_});
}

TEST_F(FileWatching, ReportsLinksAndTheirTargets) {
  const fs::path real = folder_ / "real.glsl", link = folder_ / "link.glsl";
  write(real, "x");
  fs::create_symlink(real, link);
  watcher_.watch({link});
  write(real, "y");
  EXPECT_EQ(watcher_.wait(kLong), Paths{link});
  fs::remove(link);
  fs::create_symlink(file_, link);
  EXPECT_EQ(watcher_.wait(kLong), Paths{link});
}

TEST_F(FileWatching, ReturnsRelativePathsAsGiven) {
  const fs::path relative = fs::relative(file_, fs::current_path());
  watcher_.watch({relative});
  write(file_, "x");
  EXPECT_EQ(watcher_.wait(kLong), Paths{relative});
}

TEST_F(FileWatching, IgnoresFilesThatAreNoLongerWatched) {
  watcher_.watch({folder_ / "other.glsl"});
  write(file_, "x");
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
  watcher_.watch({});
  write(folder_ / "other.glsl", "x");
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

// A change between two calls is returned by the next wait().
TEST_F(FileWatching, KeepsChangesBetweenTwoWatches) {
  write(file_, "x");
  watcher_.watch({file_, folder_ / "more.glsl"});
  EXPECT_EQ(watcher_.wait(kLong), Paths{file_});
}

TEST_F(FileWatching, WakesUpFromWaiting) {
  std::thread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    write(file_, "x");
  });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(watcher_.wait(10.0 * kLong), Paths{file_});
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), kLong);
  writer.join();
}

}  // namespace
}  // namespace quintet::shader
