// SPDX-License-Identifier: Apache-2.0
// The limit on the memory that a file requests.
#include "base/memory_budget.h"

#include <gmock/gmock.h>

#include <cstdint>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "base/file.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(MemoryBudget, ThrowsAboveItsLimit) {
  MemoryBudget budget("scene.glb", std::size_t{3} << 30);
  budget.take(std::size_t{2} << 30);
  budget.take(std::size_t{1} << 30);
  try {
    budget.take(1);
    FAIL();
  } catch (const MemoryError& error) {
    EXPECT_THAT(error.what(), AllOf(StartsWith("scene.glb: "), HasSubstr("3.0 GiB")));
    EXPECT_EQ(error.remedy(), Remedy::raiseMemoryLimit);
  }
  EXPECT_THROW(MemoryBudget("x", 10).take(~std::size_t{0}), MemoryError);
}

TEST(MemoryBudget, GetsBackWhatIsTemporary) {
  MemoryBudget budget("a.png", 10);
  {
    const TemporaryMemory temporary(budget, 8);
    EXPECT_THROW(budget.take(3), MemoryError);
    EXPECT_THROW(TemporaryMemory(budget, 3), MemoryError);
    budget.take(2);
  }
  EXPECT_NO_THROW(budget.take(8));
  EXPECT_THROW(budget.take(1), MemoryError);
}

TEST(MemoryBudget, ReportsFailedAllocations) {
  EXPECT_EQ(withMemoryErrors("scene.glb", [] { return 3; }), 3);
  EXPECT_THROW(withMemoryErrors("scene.glb", []() -> int { throw std::bad_alloc(); }), MemoryError);
  EXPECT_THROW(withMemoryErrors("scene.glb", []() -> int { throw std::length_error(""); }), MemoryError);
}

// The files have no pages on the disk, and /dev/zero has no end.
TEST(MemoryBudget, LimitsTheSizeOfFiles) {
  const TempFolder folder;
  writeFile(folder / "a", std::string_view("12345678"));
  MemoryBudget enough("a", 16), tooSmall("a", 4), endless("/dev/zero", std::size_t{1} << 20);
  EXPECT_EQ(readFile(folder / "a", enough).size(), 8u);
  EXPECT_THROW(readFile(folder / "a", tooSmall), MemoryError);
  EXPECT_THROW(readTextFile(folder / "a", tooSmall), MemoryError);
  EXPECT_THROW(readLargeFile(folder / "a", tooSmall), MemoryError);
  EXPECT_THROW(readFile("/dev/zero", endless), MemoryError);

  std::error_code unsupported;
  std::filesystem::resize_file(folder / "a", std::uintmax_t{1} << 43, unsupported);
  if (unsupported) GTEST_SKIP() << "the file system has no files of 8 TiB";
  try {
    readFile(folder / "a");
    FAIL();
  } catch (const MemoryError& error) {
    EXPECT_EQ(error.remedy(), Remedy::none) << "the caller cannot change the limit";
  }
}

}  // namespace
}  // namespace quintet::test
