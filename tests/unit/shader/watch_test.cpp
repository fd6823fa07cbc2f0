// Files that change on disk are told: written in place, replaced by a rename, removed, brought back.
#include "shader/watch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "temp_folder.h"

namespace quintet::shader {
namespace {

namespace fs = std::filesystem;
using Paths = std::vector<fs::path>;

constexpr double kLong = 10.0;  // for what must happen
constexpr double kShort = 0.3;  // for what must not

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

class ShaderWatch : public ::testing::Test {
 protected:
  ShaderWatch() {
    write(file_, "one");
    watcher_.watch({file_});
  }
  test::TempFolder folder_;
  const fs::path file_ = folder_ / "main.rgen";
  FileWatcher watcher_;
};

TEST_F(ShaderWatch, WrittenInPlace) {
  EXPECT_FALSE(watcher_.pending());
  write(file_, "two");
  EXPECT_TRUE(watcher_.pending());
  EXPECT_EQ(watcher_.wait(kLong), Paths{file_});
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

// What editors do: a new file beside it, renamed over it; again and again, though the inode changes.
TEST_F(ShaderWatch, ReplacedByARename) {
  for (int i = 0; i < 3; ++i) {
    write(folder_ / "main.rgen~", "new");
    fs::rename(folder_ / "main.rgen~", file_);
    EXPECT_EQ(watcher_.wait(kLong), Paths{file_}) << i;
  }
}

// Others move the old file away and write a new one.
TEST_F(ShaderWatch, MovedAwayAndWrittenAnew) {
  fs::rename(file_, folder_ / "main.rgen.bak");
  write(file_, "new");
  EXPECT_EQ(watcher_.wait(kLong), Paths{file_});
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

TEST_F(ShaderWatch, OtherFilesOfTheFolderDoNotMatter) {
  write(folder_ / "out.png", "picture");
  write(folder_ / ".main.rgen.swp", "swap");
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

TEST_F(ShaderWatch, FilesThatComeLater) {
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

TEST_F(ShaderWatch, FilesOfAFolder) {
  const fs::path folder = folder_.path();
  watcher_.watch({}, {folder}, [](const fs::path& name) { return name.extension() == ".glsl"; });
  write(folder / "new.glsl", "x");
  EXPECT_EQ(watcher_.wait(kLong), Paths{folder / "new.glsl"});
  write(folder / "out.png", "x");
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

TEST_F(ShaderWatch, SeveralAtOnce) {
  const fs::path other = folder_ / "a.glsl";
  watcher_.watch({file_, other});
  write(file_, "x");
  write(other, "y");
  EXPECT_EQ(watcher_.wait(kLong), (Paths{other, file_}));
}

TEST_F(ShaderWatch, RemovedIsTold) {
  fs::remove(file_);
  EXPECT_EQ(watcher_.wait(kLong), Paths{file_});
}

TEST_F(ShaderWatch, LinksAndTheirTargets) {
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

TEST_F(ShaderWatch, RelativeNamesStayAsGiven) {
  const fs::path relative = fs::relative(file_, fs::current_path());
  watcher_.watch({relative});
  write(file_, "x");
  EXPECT_EQ(watcher_.wait(kLong), Paths{relative});
}

TEST_F(ShaderWatch, WhatIsNoLongerWatchedIsNotTold) {
  watcher_.watch({folder_ / "other.glsl"});
  write(file_, "x");
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
  watcher_.watch({});
  write(folder_ / "other.glsl", "x");
  EXPECT_EQ(watcher_.wait(kShort), Paths{});
}

// What was saved while somebody was busy is told at the next wait.
TEST_F(ShaderWatch, NothingIsLostBetweenTwoWatches) {
  write(file_, "x");
  watcher_.watch({file_, folder_ / "more.glsl"});
  EXPECT_EQ(watcher_.wait(kLong), Paths{file_});
}

TEST_F(ShaderWatch, WakesUpWhileWaiting) {
  std::thread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    write(file_, "x");
  });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(watcher_.wait(kLong), Paths{file_});
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  writer.join();
}

}  // namespace
}  // namespace quintet::shader
