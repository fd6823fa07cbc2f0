// SPDX-License-Identifier: Apache-2.0
#include "check/modules/table_check.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "check/report.h"

namespace quintet::check {
namespace {

class TableRule {
 public:
  TableRule(std::span<const TableGroup> groups, const TableLimits& limits) : groups_(groups), limits_(limits) {
    for (std::size_t i = 0; i < groups.size(); ++i) byHandle_[groups[i].handle].push_back(i);
  }

  TableFindings take() {
    findings_.diagnostics = report_.take();
    return std::move(findings_);
  }

  void check(TableKind kind, const TableRegion& region) {
    kind_ = kind;
    if (region.bytes == 0 || region.address == 0) {
      if (kind == TableKind::rayGeneration)
        add("Q663", "the ray generation region is empty, so the trace runs no shader");
      return;
    }
    if (!checkRegion(region)) {
      findings_.complete = false;
      return;
    }
    if (region.data.size() < region.bytes) findings_.complete = false;
    // With a stride of 0, any index selects the same record.
    if (region.stride == 0 && kind != TableKind::rayGeneration) findings_.complete = false;
    const std::uint64_t stride = kind == TableKind::rayGeneration || region.stride == 0 ? region.bytes : region.stride;
    const std::uint64_t all = std::min<std::uint64_t>(region.data.size(), region.bytes) / stride;
    const std::size_t count = std::min<std::size_t>(all, kMaxTableRecords);
    if (count < all) findings_.complete = false;
    reports_ = 0;
    // Large tables have gaps, which no ray reaches and nothing writes.
    mayHaveGaps_ = count > kMaxTableWithoutGaps;
    for (std::size_t i = 0; i < count; ++i) checkRecord(i, region.data.data() + i * stride, stride);
  }

 private:
  void add(std::string_view id, std::string text) { report_.add(id, {}, std::move(text)); }
  void addRecord(std::string_view id, std::string text) {
    constexpr int kMaxReports = 16;  // for one region
    if (!mayHaveGaps_ && ++reports_ <= kMaxReports) add(id, std::move(text));
  }
  std::string name() const { return std::string(tableName(kind_)); }

  // Returns false if the records cannot be read. VUID-vkCmdTraceRaysKHR-pRayGenShaderBindingTable-03680 and others.
  bool checkRegion(const TableRegion& region) {
    bool valid = true;
    const auto fail = [&](std::string text) {
      add("Q664", fmt::format("{} region: {}", name(), text));
      valid = false;
    };
    if (limits_.baseAlignment != 0 && region.address % limits_.baseAlignment != 0)
      fail(fmt::format("the address is not a multiple of shaderGroupBaseAlignment ({})", limits_.baseAlignment));
    if (kind_ == TableKind::rayGeneration) {
      if (region.stride != region.bytes)
        fail(fmt::format("its stride is {} and its size {}, but they must be equal", region.stride, region.bytes));
    } else if (limits_.handleAlignment != 0 && region.stride % limits_.handleAlignment != 0) {
      fail(fmt::format("the stride {} is not a multiple of shaderGroupHandleAlignment ({})", region.stride,
                       limits_.handleAlignment));
    } else if (region.stride > limits_.maxStride) {
      fail(fmt::format("the stride {} is above maxShaderGroupStride ({})", region.stride, limits_.maxStride));
    }
    const std::uint64_t record = kind_ == TableKind::rayGeneration ? region.bytes : region.stride;
    if (record != 0 && record < limits_.handleBytes)
      fail(fmt::format("its records have {} bytes, but a handle has {}", record, limits_.handleBytes));
    if (region.available && region.bytes > *region.available) {
      add("Q665", fmt::format("the {} region has {} bytes, but its buffer ends after {}", name(), region.bytes,
                              *region.available));
      valid = false;
    }
    return valid;
  }

  void checkRecord(std::size_t index, const std::byte* data, std::uint64_t stride) {
    const std::vector<std::byte> handle(data, data + std::min<std::uint64_t>(limits_.handleBytes, stride));
    auto& records = findings_.records[static_cast<std::size_t>(kind_)];
    records.emplace_back();
    if (std::ranges::all_of(handle, [](std::byte b) { return b == std::byte{}; })) {
      if (kind_ == TableKind::rayGeneration)
        add("Q663", "the ray generation record is null, so the trace runs no shader");
      return;
    }
    const auto found = byHandle_.find(handle);
    if (found == byHandle_.end()) {
      addRecord("Q661", fmt::format("{} record {} has a handle that is not one of the bound pipeline", name(), index));
      return;
    }
    const auto fits = [&](std::size_t group) { return groups_[group].kind == kind_; };
    const auto group = std::ranges::find_if(found->second, fits);
    if (group == found->second.end()) {
      const TableGroup& other = groups_[found->second.front()];
      addRecord("Q662", fmt::format("{} record {} has the handle of {}, which is for the {} region", name(), index,
                                    other.name, tableName(other.kind)));
      return;
    }
    records.back() = *group;
    const std::uint64_t needed = limits_.handleBytes + groups_[*group].recordBytes;
    if (groups_[*group].recordBytes > 0 && stride < needed)
      addRecord(
          "Q666",
          fmt::format("{} record {} has {} bytes, but {} needs {}: a handle of {} and a shader record block of {}",
                      name(), index, stride, groups_[*group].name, needed, limits_.handleBytes,
                      groups_[*group].recordBytes));
  }

  std::span<const TableGroup> groups_;
  const TableLimits& limits_;
  std::map<std::vector<std::byte>, std::vector<std::size_t>> byHandle_;
  TableKind kind_ = TableKind::rayGeneration;
  int reports_ = 0;
  bool mayHaveGaps_ = false;
  Report report_;
  TableFindings findings_;
};

}  // namespace

std::string_view tableName(TableKind kind) {
  constexpr std::array<std::string_view, kTableKinds> kNames{"ray generation", "miss", "hit", "callable"};
  return kNames[static_cast<std::size_t>(kind)];
}

TableFindings checkTable(const std::array<TableRegion, kTableKinds>& regions, std::span<const TableGroup> groups,
                         const TableLimits& limits) {
  TableRule rule(groups, limits);
  for (std::size_t i = 0; i < kTableKinds; ++i) rule.check(static_cast<TableKind>(i), regions[i]);
  return rule.take();
}

}  // namespace quintet::check
