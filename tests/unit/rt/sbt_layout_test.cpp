// SPDX-License-Identifier: Apache-2.0
// The layout of the shader binding table: examples, and the rules of the specification for random tables.
#include "rt/sbt_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>
#include <utility>

#include "base/error.h"

namespace quintet::rt {
namespace {

gpu::RayTracingLimits limits(std::uint32_t handleSize, std::uint32_t handleAlignment, std::uint32_t baseAlignment,
                             std::uint32_t maxRecordStride = 4096) {
  gpu::RayTracingLimits result;
  result.handleSize = handleSize;
  result.handleAlignment = handleAlignment;
  result.baseAlignment = baseAlignment;
  result.maxRecordStride = maxRecordStride;
  return result;
}

SbtRecord record(std::uint32_t group, std::size_t dataBytes = 0, std::uint8_t fill = 0xDD) {
  return {group, std::vector<std::byte>(dataBytes, std::byte{fill})};
}

// Returns handles of `size` bytes; all bytes of handle g are g + 1.
std::vector<std::byte> handles(std::size_t groups, std::size_t size) {
  std::vector<std::byte> result;
  for (std::size_t g = 0; g < groups; ++g) result.insert(result.end(), size, static_cast<std::byte>(g + 1));
  return result;
}

void expectRegion(const SbtRegion& region, std::uint64_t offset, std::uint64_t stride, std::uint64_t size) {
  EXPECT_EQ(region.offset, offset);
  EXPECT_EQ(region.stride, stride);
  EXPECT_EQ(region.size, size);
}

TEST(SbtLayout, PacksRecordsWithoutData) {
  const SbtContents contents{record(0), {record(1), record(2)}, {record(3), record(4), record(5)}, {}};
  const SbtLayout layout = layoutSbt(contents, limits(32, 32, 64));
  expectRegion(layout.rayGeneration, 0, 64, 64);
  expectRegion(layout.miss, 64, 32, 64);
  expectRegion(layout.hit, 128, 32, 96);
  expectRegion(layout.callable, 0, 0, 0);
  EXPECT_EQ(layout.size, 224u);
}

TEST(SbtLayout, SupportsHandleAlignmentsAboveTheHandleSize) {
  const SbtContents contents{record(0), {record(1)}, {record(2), record(3)}, {record(4)}};
  const SbtLayout layout = layoutSbt(contents, limits(16, 64, 64));
  expectRegion(layout.rayGeneration, 0, 64, 64);
  expectRegion(layout.miss, 64, 64, 64);
  expectRegion(layout.hit, 128, 64, 128);
  expectRegion(layout.callable, 256, 64, 64);
}

TEST(SbtLayout, DerivesTheStrideFromTheLargestRecord) {
  const SbtContents contents{record(0, 40), {record(1, 4)}, {record(2), record(3, 33), record(4, 8)}, {}};
  const SbtLayout layout = layoutSbt(contents, limits(32, 32, 64));
  expectRegion(layout.rayGeneration, 0, 128, 128);  // 32 + 40 = 72 → 96 → 128; the size equals the stride
  expectRegion(layout.miss, 128, 64, 64);           // 32 + 4 = 36 → 64
  expectRegion(layout.hit, 192, 96, 288);           // 32 + 33 = 65 → 96
}

TEST(SbtLayout, SupportsTablesWithOnlyRayGeneration) {
  const SbtLayout layout = layoutSbt({record(0), {}, {}, {}}, limits(32, 32, 64));
  EXPECT_EQ(layout.size, 64u);
  EXPECT_EQ(layout.miss.size + layout.hit.size + layout.callable.size, 0u);
}

TEST(SbtLayout, RejectsTooLargeRecords) {
  const gpu::RayTracingLimits small = limits(32, 32, 64, 96);
  EXPECT_NO_THROW(layoutSbt({record(0), {}, {record(1, 64)}, {}}, small));
  EXPECT_THROW(layoutSbt({record(0), {}, {record(1, 65)}, {}}, small), UsageError);
  EXPECT_THROW(layoutSbt({record(0), {record(1, 65)}, {}, {}}, small), UsageError);
  EXPECT_THROW(layoutSbt({record(0), {}, {}, {record(1, 65)}}, small), UsageError);
  EXPECT_THROW(layoutSbt({record(0, 65), {}, {}, {}}, small), UsageError);
  try {
    layoutSbt({record(0), {}, {record(1, 65)}, {}}, small);
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("hit record with 65 bytes"), std::string::npos) << error.what();
  }
}

TEST(SbtFill, WritesHandlesDataAndUnusedRecords) {
  const gpu::RayTracingLimits device = limits(16, 32, 64);
  const SbtContents contents{
      record(2), {record(0)}, {record(1, 20), record(SbtRecord::kUnusedGroup), record(2, 4)}, {}};
  const SbtLayout layout = layoutSbt(contents, device);
  const std::vector<std::byte> table = fillSbt(contents, layout, handles(3, 16), device);
  ASSERT_EQ(table.size(), layout.size);
  const auto at = [&](std::uint64_t byte) { return std::to_integer<int>(table[byte]); };
  EXPECT_EQ(at(0), 3);
  EXPECT_EQ(at(15), 3);
  EXPECT_EQ(at(16), 0);
  EXPECT_EQ(at(layout.miss.offset), 1);
  const std::uint64_t hit = layout.hit.offset;
  ASSERT_EQ(layout.hit.stride, 64u);
  EXPECT_EQ(at(hit), 2);
  EXPECT_EQ(at(hit + 16), 0xDD);
  EXPECT_EQ(at(hit + 35), 0xDD);
  EXPECT_EQ(at(hit + 36), 0);
  for (std::uint64_t k = 0; k < 64; ++k) EXPECT_EQ(at(hit + 64 + k), 0) << k;
  EXPECT_EQ(at(hit + 128), 3);
  EXPECT_EQ(at(hit + 128 + 16), 0xDD);
  EXPECT_EQ(at(hit + 128 + 20), 0);
}

// The address in traces: record = base + stride · (instance offset + geometry · ray types + ray type).
TEST(SbtFill, StoresRecordsByGeometryAndRayType) {
  constexpr std::uint32_t kRayTypes = 2;
  const std::uint32_t geometries[] = {3, 1, 4};  // of each instance
  const gpu::RayTracingLimits device = limits(32, 32, 64);
  SbtContents contents{record(0), {}, {}, {}};
  for (std::uint32_t instance = 0; instance < 3; ++instance)
    for (std::uint32_t g = 0; g < geometries[instance]; ++g)
      for (std::uint32_t type = 0; type < kRayTypes; ++type) {
        SbtRecord r = record(type);
        r.data = {static_cast<std::byte>(instance), static_cast<std::byte>(g), static_cast<std::byte>(type)};
        contents.hit.push_back(r);
      }
  const SbtLayout layout = layoutSbt(contents, device);
  const std::vector<std::byte> table = fillSbt(contents, layout, handles(2, 32), device);
  std::uint32_t offset = 0;
  for (std::uint32_t instance = 0; instance < 3; ++instance) {
    for (std::uint32_t g = 0; g < geometries[instance]; ++g)
      for (std::uint32_t type = 0; type < kRayTypes; ++type) {
        const std::byte* r = table.data() + layout.hit.offset + layout.hit.stride * (offset + g * kRayTypes + type);
        EXPECT_EQ(r[0], static_cast<std::byte>(type + 1));
        EXPECT_EQ(r[32], static_cast<std::byte>(instance));
        EXPECT_EQ(r[33], static_cast<std::byte>(g));
        EXPECT_EQ(r[34], static_cast<std::byte>(type));
      }
    offset += geometries[instance] * kRayTypes;
  }
}

TEST(SbtLayout, FollowsTheSpecificationForRandomTables) {
  std::mt19937 random(1);
  const auto table = [&](std::size_t maxCount) {
    std::vector<SbtRecord> records(random() % (maxCount + 1));
    for (SbtRecord& r : records)
      r = record(random() % 8, random() % 3 ? 0 : random() % 200, static_cast<std::uint8_t>(1 + random() % 200));
    return records;
  };
  const gpu::RayTracingLimits devices[] = {limits(32, 32, 64), limits(16, 64, 64), limits(32, 8, 256),
                                           limits(8, 16, 16), limits(64, 64, 64)};
  for (int round = 0; round < 500; ++round) {
    const gpu::RayTracingLimits& device = devices[random() % std::size(devices)];
    const SbtContents contents{record(random() % 8, random() % 100), table(4), table(20), table(5)};
    const SbtLayout layout = layoutSbt(contents, device);
    const std::vector<std::byte> bytes = fillSbt(contents, layout, handles(8, device.handleSize), device);
    ASSERT_EQ(bytes.size(), layout.size);
    EXPECT_EQ(layout.rayGeneration.size, layout.rayGeneration.stride);
    std::uint64_t end = 0;
    const std::pair<const SbtRegion*, std::vector<SbtRecord>> tables[] = {
        {&layout.rayGeneration, {contents.rayGeneration}},
        {&layout.miss, contents.miss},
        {&layout.hit, contents.hit},
        {&layout.callable, contents.callable}};
    for (const auto& [region, records] : tables) {
      EXPECT_EQ(region->size, region->stride * records.size());
      if (records.empty()) continue;
      EXPECT_EQ(region->offset % device.baseAlignment, 0u);
      EXPECT_EQ(region->stride % device.handleAlignment, 0u);
      EXPECT_LE(region->stride, device.maxRecordStride);
      EXPECT_GE(region->offset, end) << "tables overlap";
      end = region->offset + region->size;
      for (std::size_t k = 0; k < records.size(); ++k) {
        const std::byte* at = bytes.data() + region->offset + k * region->stride;
        EXPECT_GE(region->stride, device.handleSize + records[k].data.size());
        EXPECT_EQ(at[device.handleSize - 1], static_cast<std::byte>(records[k].group + 1));
        EXPECT_TRUE(std::equal(records[k].data.begin(), records[k].data.end(), at + device.handleSize));
      }
    }
    EXPECT_EQ(layout.size, end);
  }
}

}  // namespace
}  // namespace quintet::rt
