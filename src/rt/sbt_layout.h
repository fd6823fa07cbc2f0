// SPDX-License-Identifier: Apache-2.0
// The layout of the shader binding table as a pure function. Vulkan 1.3, chapter "Shader Binding Table": record = base
// + stride · index, with handles of `handleSize` bytes at multiples of `handleAlignment` and regions at multiples of
// `baseAlignment`.
#ifndef QUINTET_RT_SBT_LAYOUT_H
#define QUINTET_RT_SBT_LAYOUT_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gpu/device_info.h"

namespace quintet::rt {

// One record: a shader group of the pipeline and the bytes of shaderRecordEXT.
struct SbtRecord {
  std::uint32_t group = 0;  // index in the pipeline; kUnusedGroup gives a record of zeros
  std::vector<std::byte> data;
  static constexpr std::uint32_t kUnusedGroup = ~0u;
};

struct SbtContents {
  SbtRecord rayGeneration;
  std::vector<SbtRecord> miss;
  std::vector<SbtRecord> hit;  // [instance offset + geometry · stride + ray type]
  std::vector<SbtRecord> callable;
};

struct SbtRegion {
  std::uint64_t offset = 0;  // bytes from the start of the table, a multiple of baseAlignment
  std::uint64_t stride = 0;  // bytes between records, a multiple of handleAlignment
  std::uint64_t size = 0;    // bytes; equal to `stride` for ray generation
};

struct SbtLayout {
  SbtRegion rayGeneration, miss, hit, callable;
  std::uint64_t size = 0;  // bytes of the whole table
};

// Throws UsageError if the data of a record exceeds maxRecordStride.
SbtLayout layoutSbt(const SbtContents& contents, const gpu::RayTracingLimits& limits);

// Returns the bytes of the table. `handles` are the handles of all groups of the pipeline, handleSize bytes each.
std::vector<std::byte> fillSbt(const SbtContents& contents, const SbtLayout& layout, std::span<const std::byte> handles,
                               const gpu::RayTracingLimits& limits);

}  // namespace quintet::rt
#endif
