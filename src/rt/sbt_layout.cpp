// SPDX-License-Identifier: Apache-2.0
#include "rt/sbt_layout.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include <fmt/format.h>

#include "base/error.h"
#include "base/math.h"
#include "base/plural.h"

namespace quintet::rt {
namespace {

// Returns the smallest stride for the largest record of a table; 0 for an empty table.
std::uint64_t strideOf(std::span<const SbtRecord> records, const char* table, const gpu::RayTracingLimits& limits) {
  if (records.empty()) return 0;
  std::uint64_t largest = 0;
  for (const SbtRecord& record : records) largest = std::max<std::uint64_t>(largest, record.data.size());
  const std::uint64_t stride = alignUp(limits.handleSize + largest, limits.handleAlignment);
  if (stride > limits.maxRecordStride)
    throw UsageError(fmt::format("a {} record with {} of data needs {} bytes with its handle; the device supports {}",
                                 table, counted(largest, "byte"), stride, limits.maxRecordStride));
  return stride;
}

// Appends a table to the layout.
SbtRegion append(SbtLayout& layout, std::uint64_t stride, std::size_t count, const gpu::RayTracingLimits& limits) {
  if (count == 0) return {};
  const SbtRegion region{alignUp(layout.size, limits.baseAlignment), stride, stride * count};
  layout.size = region.offset + region.size;
  return region;
}

void fill(std::vector<std::byte>& table, const SbtRegion& region, std::span<const SbtRecord> records,
          std::span<const std::byte> handles, std::size_t handleSize) {
  for (std::size_t k = 0; k < records.size(); ++k) {
    const SbtRecord& record = records[k];
    std::byte* to = table.data() + region.offset + k * region.stride;
    if (record.group != SbtRecord::kUnusedGroup) {
      assert((record.group + std::size_t{1}) * handleSize <= handles.size());
      std::memcpy(to, handles.data() + record.group * handleSize, handleSize);
    }
    if (!record.data.empty()) std::memcpy(to + handleSize, record.data.data(), record.data.size());
  }
}

}  // namespace

SbtLayout layoutSbt(const SbtContents& contents, const gpu::RayTracingLimits& limits) {
  SbtLayout layout;
  const std::span rayGeneration(&contents.rayGeneration, 1);
  // The size of this region must equal its stride, and the next region starts at a multiple of baseAlignment.
  const std::uint64_t stride = strideOf(rayGeneration, "ray generation", limits);
  layout.rayGeneration = append(layout, alignUp(stride, limits.baseAlignment), 1, limits);
  layout.miss = append(layout, strideOf(contents.miss, "miss", limits), contents.miss.size(), limits);
  layout.hit = append(layout, strideOf(contents.hit, "hit", limits), contents.hit.size(), limits);
  layout.callable = append(layout, strideOf(contents.callable, "callable", limits), contents.callable.size(), limits);
  return layout;
}

std::vector<std::byte> fillSbt(const SbtContents& contents, const SbtLayout& layout, std::span<const std::byte> handles,
                               const gpu::RayTracingLimits& limits) {
  std::vector<std::byte> table(layout.size);
  fill(table, layout.rayGeneration, std::span(&contents.rayGeneration, 1), handles, limits.handleSize);
  fill(table, layout.miss, contents.miss, handles, limits.handleSize);
  fill(table, layout.hit, contents.hit, handles, limits.handleSize);
  fill(table, layout.callable, contents.callable, handles, limits.handleSize);
  return table;
}

}  // namespace quintet::rt
