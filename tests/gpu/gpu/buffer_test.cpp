// SPDX-License-Identifier: Apache-2.0
#include "gpu/uploader.h"

#include <algorithm>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gpu/commands.h"
#include "gpu/error.h"
#include "harness.h"

namespace quintet::gpu {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<std::uint32_t> counting(std::size_t count, std::uint32_t first = 0) {
  std::vector<std::uint32_t> result(count);
  std::iota(result.begin(), result.end(), first);
  return result;
}

TEST(GpuBuffer, RoundTripsInEveryMemory) {
  for (const Memory memory : {Memory::device, Memory::upload, Memory::readback}) {
    Buffer buffer(test::testContext(), {.size = 4000, .memory = memory, .name = "round trip"});
    EXPECT_EQ(buffer.mapped() != nullptr, memory != Memory::device);
    EXPECT_EQ(buffer.size(), 4000u);
    const std::vector<std::uint32_t> data = counting(1000);
    buffer.uploadAs(std::span<const std::uint32_t>(data));
    EXPECT_EQ(buffer.downloadAs<std::uint32_t>(1000), data);
  }
}

TEST(GpuBuffer, RoundTripsMoreThanAStagingStep) {
  const std::vector<std::uint32_t> data = counting(70 * test::kMiB / 4 + 5);
  const Buffer buffer = makeBufferOf(test::testContext(), data, 0, "large");
  EXPECT_TRUE(buffer.downloadAs<std::uint32_t>(data.size()) == data);
}

TEST(GpuBuffer, CopiesToAndFromAnOffset) {
  Buffer buffer = makeBufferOf(test::testContext(), counting(100), 0, "offsets");
  const std::vector<std::uint32_t> patch = counting(3, 7000);
  buffer.upload(std::as_bytes(std::span(patch)), 40);
  std::vector<std::uint32_t> part(5);
  buffer.download(std::as_writable_bytes(std::span(part)), 36);
  EXPECT_THAT(part, testing::ElementsAre(9, 7000, 7001, 7002, 13));
}

TEST(GpuBuffer, CanBeEmptyOrMoved) {
  const Buffer none;
  EXPECT_FALSE(none);
  const Buffer empty = makeBuffer(test::testContext(), {}, 0, "empty");
  EXPECT_TRUE(empty);
  EXPECT_EQ(empty.size(), 4u);
  Buffer first = makeBufferOf(test::testContext(), counting(10), 0, "first");
  const VkDeviceAddress address = first.address();
  Buffer second = std::move(first);
  EXPECT_FALSE(first);  // NOLINT: a moved-from buffer is empty
  EXPECT_EQ(second.address(), address);
  second = makeBufferOf(test::testContext(), counting(10, 5), 0, "other");
  EXPECT_EQ(second.downloadAs<std::uint32_t>(10), counting(10, 5));
}

TEST(GpuBuffer, HasAnAlignedAddress) {
  Context& context = test::testContext();
  std::vector<Buffer> buffers;
  for (int i = 0; i < 20; ++i) {
    buffers.emplace_back(context, BufferOptions{.size = 20, .name = "plain"});
    EXPECT_NE(buffers.back().address(), 0u);
    EXPECT_EQ(buffers.back().address() % 16, 0u);
    buffers.emplace_back(context, BufferOptions{.size = 20, .alignment = 4096, .name = "aligned"});
    EXPECT_EQ(buffers.back().address() % 4096, 0u);
    buffers.emplace_back(
        context, BufferOptions{.size = 20, .usage = VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR, .name = "table"});
    EXPECT_EQ(buffers.back().address() % context.info().limits.baseAlignment, 0u);
  }
}

TEST(GpuBuffer, RejectsTooLargeSizes) {
  Context& context = test::testContext();
  EXPECT_THAT([&] { const Buffer b(context, {.size = VkDeviceSize{1} << 50, .name = "film"}); },
              ThrowsMessage<MemoryError>(
                  AllOf(HasSubstr("buffer 'film' of 1073741824.0 MiB"), HasSubstr("the device's memory of"))));
  for (const Memory memory : {Memory::device, Memory::upload, Memory::readback}) {
    EXPECT_THROW(Buffer(context, {.size = ~VkDeviceSize{0}, .memory = memory, .name = "all"}), MemoryError);
    EXPECT_THROW(Buffer(context, {.size = context.info().maxBufferBytes + 1, .memory = memory, .name = "limit"}),
                 MemoryError);
  }
  const Buffer after = makeBufferOf(context, counting(10), 0, "after");  // the context still works
  EXPECT_EQ(after.downloadAs<std::uint32_t>(10), counting(10));
}

TEST(GpuBuffer, RejectsMoreThanTheTotalMemory) {
  Context& context = test::testContext();
  if (!context.info().software) return;  // drivers of GPUs report this error themselves
  std::vector<Buffer> buffers;
  const VkDeviceSize size = context.info().maxBufferBytes;
  const std::size_t enough = context.info().memoryBytes / size + 2;
  EXPECT_THAT(
      [&] {
        for (std::size_t i = 0; i < enough; ++i)
          buffers.emplace_back(context, BufferOptions{.size = size, .name = "piece"});
      },
      ThrowsMessage<MemoryError>(AllOf(HasSubstr("MiB for buffer 'piece'"), HasSubstr("MiB are free"))));
}

TEST(GpuUploader, FillsManyBuffersThroughASmallRing) {
  Context& context = test::testContext();
  std::vector<Buffer> buffers;
  {
    Uploader uploader(context, 2 * test::kMiB);
    for (std::uint32_t i = 0; i < 40; ++i) {
      buffers.emplace_back(context, BufferOptions{.size = 300'004, .name = "one of many"});
      const std::vector<std::uint32_t> data = counting(75'001, i);
      uploader.upload(buffers.back(), std::as_bytes(std::span(data)));
    }
  }
  for (std::uint32_t i = 0; i < 40; ++i)
    EXPECT_TRUE(buffers[i].downloadAs<std::uint32_t>(75'001) == counting(75'001, i));
}

TEST(GpuUploader, SplitsUploadsThatAreLargerThanTheRing) {
  Context& context = test::testContext();
  const std::vector<std::uint32_t> data = counting(9 * test::kMiB / 4 + 1);
  const Buffer buffer(context, {.size = data.size() * 4 + 400, .name = "larger"});
  Uploader uploader(context, 2 * test::kMiB);
  uploader.upload(buffer, std::as_bytes(std::span(data)), 400);
  uploader.flush();
  std::vector<std::uint32_t> result(data.size());
  buffer.download(std::as_writable_bytes(std::span(result)), 400);
  EXPECT_TRUE(result == data);
}

TEST(GpuUploader, KeepsTheOrderOfOverlappingUploads) {
  Context& context = test::testContext();
  const Buffer buffer(context, {.size = 400, .name = "overwritten"});
  Uploader uploader(context);
  for (std::uint32_t i = 0; i < 10; ++i) {
    const std::vector<std::uint32_t> data = counting(100, i);
    uploader.upload(buffer, std::as_bytes(std::span(data)));
  }
  const std::uint32_t patch = 77;
  uploader.upload(buffer, std::as_bytes(std::span(&patch, 1)), 4);
  uploader.flush();
  std::vector<std::uint32_t> expected = counting(100, 9);
  expected[1] = 77;
  EXPECT_EQ(buffer.downloadAs<std::uint32_t>(100), expected);
}

// Uploads in descending order, with gaps and overlaps: the last upload wins.
TEST(GpuUploader, KeepsTheOrderForAnyOrderOfOffsets) {
  Context& context = test::testContext();
  const Buffer buffer(context, {.size = 4 * 1000, .name = "patchwork"});
  std::vector<std::uint32_t> expected(1000);
  Uploader uploader(context, 0);
  const auto write = [&](std::uint32_t begin, std::uint32_t count, std::uint32_t value) {
    const std::vector<std::uint32_t> data(count, value);
    uploader.upload(buffer, std::as_bytes(std::span(data)), VkDeviceSize{4} * begin);
    std::fill_n(expected.begin() + begin, count, value);
  };
  write(0, 1000, 1);
  for (std::uint32_t i = 0; i < 50; ++i) write(980 - 20 * i, 15, 100 + i);
  for (std::uint32_t i = 0; i < 50; ++i) write((i * 37) % 900, 100, 200 + i);
  uploader.flush();
  EXPECT_EQ(buffer.downloadAs<std::uint32_t>(1000), expected);
}

// During stack unwinding, destinations can be destroyed before the uploader.
TEST(GpuUploader, DiscardsCopiesDuringStackUnwinding) {
  Context& context = test::testContext();
  const Buffer kept = makeBufferOf(context, std::vector<std::uint32_t>(100, 5), 0, "kept");
  EXPECT_THROW(
      {
        Uploader uploader(context);
        const std::vector<std::uint32_t> data = counting(100, 1);
        uploader.upload(kept, std::as_bytes(std::span(data)));
        const Buffer gone(context, {.size = 400, .name = "gone"});
        uploader.upload(gone, std::as_bytes(std::span(data)));
        throw std::runtime_error("no memory");
      },
      std::runtime_error);
  EXPECT_EQ(kept.downloadAs<std::uint32_t>(100), std::vector<std::uint32_t>(100, 5));
}

TEST(GpuUploader, FlushesWithoutUploads) {
  Uploader uploader(test::testContext());
  uploader.upload(makeBuffer(test::testContext(), {}, 0, "empty"), {});
  uploader.flush();
  uploader.flush();
}

}  // namespace
}  // namespace quintet::gpu
