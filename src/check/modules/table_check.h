// SPDX-License-Identifier: Apache-2.0
// The check of a shader binding table as its bytes were when a trace read them: regions, handles, and the size of records.
// Plain data, without a device; the Vulkan layer fills it in.
#ifndef QUINTET_CHECK_MODULES_TABLE_CHECK_H
#define QUINTET_CHECK_MODULES_TABLE_CHECK_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"

namespace quintet::check {

enum class TableKind { rayGeneration, miss, hit, callable };
inline constexpr std::size_t kTableKinds = 4;
std::string_view tableName(TableKind kind);  // "ray generation", "miss", "hit", "callable"

// VkPhysicalDeviceRayTracingPipelinePropertiesKHR
struct TableLimits {
  std::uint32_t handleBytes = 32;
  std::uint32_t handleAlignment = 32;
  std::uint32_t baseAlignment = 64;
  std::uint32_t maxStride = 4096;
};

// VkStridedDeviceAddressRegionKHR, and what was there.
struct TableRegion {
  std::uint64_t address = 0;
  std::uint64_t stride = 0;
  std::uint64_t bytes = 0;
  std::optional<std::uint64_t> available;  // bytes from the address to the end of its buffer; nullopt if unknown
  std::vector<std::byte> data;             // empty if it could not be read
};

// A shader group of the bound pipeline.
struct TableGroup {
  TableKind kind = TableKind::rayGeneration;
  std::string name;  // for messages
  std::vector<std::byte> handle;
  std::uint64_t recordBytes = 0;  // of the shader record blocks of its shaders; 0 if they have none
};

struct TableFindings {
  std::vector<Diagnostic> diagnostics;  // Q661 to Q666, without a location
  // By kind: the group of each record; nullopt for null records and unknown handles.
  std::array<std::vector<std::optional<std::size_t>>, kTableKinds> records;
  bool complete = true;  // all regions could be read
};

inline constexpr std::size_t kMaxTableRecords = std::size_t{1} << 20;  // further records are not checked
inline constexpr std::size_t kMaxTableWithoutGaps = 4096;              // records of larger ones may be unwritten

TableFindings checkTable(const std::array<TableRegion, kTableKinds>& regions, std::span<const TableGroup> groups,
                         const TableLimits& limits);

}  // namespace quintet::check
#endif
