// SPDX-License-Identifier: Apache-2.0
// The account of device memory: purposes, peaks, and when memory is freed. Each test has its own context.
#include "gpu/memory.h"

#include <gtest/gtest.h>

#include "gpu/image.h"
#include "gpu/uploader.h"
#include "harness.h"

namespace quintet::gpu {
namespace {

class GpuMemory : public testing::Test {
 protected:
  std::uint64_t now() const { return context.memory().now; }
  std::uint64_t atPeak(Purpose purpose) const { return context.memory().atPeak[static_cast<std::size_t>(purpose)]; }
  Context context{{.device = test::testContext().info().name}};
};

TEST_F(GpuMemory, FreesLargeBuffers) {
  const std::uint64_t before = now();
  {
    const Buffer buffer(context, {.size = 20 * test::kMiB, .name = "film", .purpose = Purpose::film});
    EXPECT_GE(now(), before + 20 * test::kMiB);
    EXPECT_LT(now(), before + 21 * test::kMiB);
  }
  EXPECT_EQ(now(), before);
  EXPECT_GE(context.memory().peak, before + 20 * test::kMiB);
  EXPECT_GE(atPeak(Purpose::film), 20 * test::kMiB);
  EXPECT_EQ(atPeak(Purpose::staging), 0u);
}

TEST_F(GpuMemory, SharesBlocksBetweenSmallBuffers) {
  std::vector<Buffer> buffers;
  for (int i = 0; i < 1000; ++i) buffers.emplace_back(context, BufferOptions{.size = 1000, .name = "small"});
  EXPECT_LE(context.allocator().account().blockCount(), 2u);
  EXPECT_LE(now(), 8 * test::kMiB);
}

TEST_F(GpuMemory, FreesTheRingOfAnUploader) {
  const Buffer buffer(context, {.size = 24 * test::kMiB, .name = "geometry", .purpose = Purpose::geometry});
  const Image image(context, {.width = 1024, .height = 1024, .name = "image"});
  const std::uint64_t before = now();
  {
    Uploader uploader(context, 16 * test::kMiB);
    uploader.upload(buffer, std::vector<std::byte>(24 * test::kMiB));
    uploader.upload(image, std::vector<std::byte>(4 * test::kMiB));
  }
  EXPECT_EQ(now(), before);
  EXPECT_GE(context.memory().peak, before + 16 * test::kMiB);
  EXPECT_GE(atPeak(Purpose::staging), 16 * test::kMiB);
  EXPECT_GE(atPeak(Purpose::geometry), 24 * test::kMiB);
  EXPECT_GE(atPeak(Purpose::textures), 4 * test::kMiB);
}

TEST_F(GpuMemory, LimitsStagingOfBlockingCopies) {
  Buffer buffer(context, {.size = 64 * test::kMiB, .name = "large"});
  const std::uint64_t before = now();
  std::vector<std::uint32_t> data(buffer.size() / 4);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::uint32_t>(i);
  buffer.uploadAs(std::span<const std::uint32_t>(data));
  EXPECT_TRUE(buffer.downloadAs<std::uint32_t>(data.size()) == data);
  EXPECT_LE(context.memory().peak, before + 9 * test::kMiB);
  EXPECT_EQ(now(), before);
}

// The peak is always the sum of all purposes and of the free space in blocks.
TEST_F(GpuMemory, AddsUpToThePeak) {
  for (const std::uint64_t size : {3 * test::kMiB, 100 * test::kMiB / 1000, 7 * test::kMiB}) {
    const Buffer a(context, {.size = size, .name = "a", .purpose = Purpose::scratch});
    const Buffer b(context, {.size = size / 2, .memory = Memory::upload, .name = "b", .purpose = Purpose::staging});
    std::uint64_t sum = 0;
    const DeviceMemory memory = context.memory();
    for (const std::uint64_t part : memory.atPeak) sum += part;
    EXPECT_LE(sum, memory.peak);
    EXPECT_EQ(sum + memory.unusedAtPeak(), memory.peak);
  }
  EXPECT_GE(atPeak(Purpose::scratch), 7 * test::kMiB);
  EXPECT_GE(atPeak(Purpose::staging), 7 * test::kMiB / 2);
}

}  // namespace
}  // namespace quintet::gpu
