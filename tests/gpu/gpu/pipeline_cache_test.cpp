// SPDX-License-Identifier: Apache-2.0
#include "gpu/pipeline_cache.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/file.h"
#include "gpu/compute.h"
#include "harness.h"

namespace quintet::gpu {
namespace {

namespace fs = std::filesystem;

class GpuPipelineCache : public testing::Test {
 protected:
  GpuPipelineCache() : folder(fs::temp_directory_path() / ("quintet_cache_" + std::to_string(::getpid()))) {
    fs::remove_all(folder);
  }
  ~GpuPipelineCache() override { fs::remove_all(folder); }

  // Creates a pipeline with the cache.
  void use() {
    PipelineCache cache(test::testContext(), folder);
    const ComputePipeline pipeline(test::testContext(), test::testSet(),
                                   test::compileCompute("#version 460\nlayout(local_size_x = 64) in; void main() {}"),
                                   cache.handle(), "empty");
  }
  fs::path onlyFile() const {
    fs::path file;
    for (const auto& entry : fs::directory_iterator(folder)) {
      EXPECT_TRUE(file.empty()) << "more than one file";
      file = entry.path();
    }
    return file;
  }

  fs::path folder;
};

TEST_F(GpuPipelineCache, WritesOneFilePerDevice) {
  use();
  ASSERT_FALSE(onlyFile().empty());
  const auto time = fs::last_write_time(onlyFile());
  use();
  EXPECT_EQ(fs::last_write_time(onlyFile()), time) << "an unchanged cache is not written";
}

TEST_F(GpuPipelineCache, IgnoresCorruptFiles) {
  use();
  const fs::path file = onlyFile();
  const std::vector<std::byte> good = readFile(file);
  std::vector<std::vector<std::byte>> broken = {{}, {good.begin(), good.begin() + 10}, {good.begin(), good.end() - 1}};
  for (const std::size_t position : {std::size_t{0}, std::size_t{12}, std::size_t{30}, good.size() - 1}) {
    broken.push_back(good);
    broken.back()[position] ^= std::byte{0x40};
  }
  broken.emplace_back(100'000, std::byte{0xFF});
  for (const std::vector<std::byte>& bytes : broken) {
    writeFile(file, std::span<const std::byte>(bytes));
    use();
    EXPECT_NE(readFile(file), bytes) << "the corrupt file must be replaced";
    const auto time = fs::last_write_time(file);
    use();
    EXPECT_EQ(fs::last_write_time(file), time) << "the new file must be valid";
  }
}

TEST_F(GpuPipelineCache, WorksWithoutAFolder) {
  folder.clear();
  use();
  PipelineCache cache(test::testContext(), {});
  cache.save();
  EXPECT_NE(cache.handle(), VkPipelineCache{VK_NULL_HANDLE});
}

TEST_F(GpuPipelineCache, WorksIfNoFileCanBeWritten) {
  writeFile(folder, std::string_view("a file instead of a folder"));
  use();
  EXPECT_TRUE(fs::is_regular_file(folder));
}

}  // namespace
}  // namespace quintet::gpu
