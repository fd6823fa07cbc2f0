// SPDX-License-Identifier: Apache-2.0
// The check of shader binding tables by their bytes.
#include "check/modules/table_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "check/modules/stack_check.h"

namespace quintet::check {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::byte> handle(int value) { return std::vector<std::byte>(32, std::byte(value)); }

struct Table {
  std::vector<TableGroup> groups{{TableKind::rayGeneration, "group 0", handle(1), 0},
                                 {TableKind::miss, "group 1", handle(2), 0},
                                 {TableKind::hit, "group 2", handle(3), 0}};
  std::array<TableRegion, kTableKinds> regions;
  Table() {
    for (std::size_t i = 0; i < 3; ++i) regions[i] = {64 * (i + 1), 32, 32, 64, groups[i].handle};
  }
  std::vector<std::string> check() const {
    std::vector<std::string> ids;
    for (const Diagnostic& d : checkTable(regions, groups, {}).diagnostics) ids.push_back(d.id);
    return ids;
  }
};

TEST(TableCheck, AcceptsAnIntactTable) {
  const Table table;
  EXPECT_THAT(table.check(), IsEmpty());
  const TableFindings found = checkTable(table.regions, table.groups, {});
  EXPECT_EQ(found.records[2].at(0), std::size_t{2});
  EXPECT_TRUE(found.complete);
}

// Any index selects the only record, so the number of records says nothing.
TEST(TableCheck, DoesNotCountTheRecordsOfARegionWithoutStride) {
  Table table;
  table.regions[1].stride = 0;
  EXPECT_THAT(table.check(), IsEmpty());
  EXPECT_FALSE(checkTable(table.regions, table.groups, {}).complete);
}

TEST(TableCheck, ReportsHandles) {
  Table table;
  table.regions[2].data = handle(9);
  EXPECT_THAT(table.check(), ElementsAre("Q661"));
  table.regions[2].data = handle(2);
  EXPECT_THAT(table.check(), ElementsAre("Q662"));
  table.regions[2].data = handle(0);  // null: no shader runs
  EXPECT_THAT(table.check(), IsEmpty());
  table.regions[0].data = handle(0);
  EXPECT_THAT(table.check(), ElementsAre("Q663"));
  table.regions[0] = {};
  EXPECT_THAT(table.check(), ElementsAre("Q663"));
}

// Records of a large table can be gaps. Reports of a region are limited.
TEST(TableCheck, AcceptsGapsOfLargeTables) {
  const auto filled = [](std::size_t count, int group) {
    Table table;
    TableRegion& region = table.regions[2];
    region.data.clear();
    for (std::size_t i = 0; i < count; ++i)
      for (const std::byte b : handle(group)) region.data.push_back(b);
    region.bytes = region.data.size();
    region.available = region.bytes;
    return table.check();
  };
  EXPECT_THAT(filled(kMaxTableWithoutGaps, 9), testing::SizeIs(16));
  EXPECT_THAT(filled(kMaxTableWithoutGaps + 1, 9), IsEmpty());
  EXPECT_THAT(filled(kMaxTableWithoutGaps + 1, 2), IsEmpty());  // memory that was a table of a different pipeline
}

TEST(TableCheck, ReportsRegions) {
  Table table;
  table.regions[1].address += 32;
  EXPECT_THAT(table.check(), ElementsAre("Q664"));
  table = {};
  table.regions[1].stride = 48;
  EXPECT_THAT(table.check(), ElementsAre("Q664"));
  table = {};
  table.regions[0].stride = 64;
  EXPECT_THAT(table.check(), ElementsAre("Q664"));
  table = {};
  table.regions[2].bytes = 96;
  EXPECT_THAT(table.check(), ElementsAre("Q665"));
  table = {};
  table.groups[2].recordBytes = 4;
  EXPECT_THAT(table.check(), ElementsAre("Q666"));
}

TEST(StackCheck, AddsTheShadersOfTheChain) {
  const std::vector<StackFrame> chain{{"a.rgen", 100}, {"a.rchit", 50}};
  EXPECT_FALSE(checkStackSize(150, chain));
  ASSERT_TRUE(checkStackSize(149, chain));
  EXPECT_EQ(checkStackSize(149, chain)->id, "Q667");
}

}  // namespace
}  // namespace quintet::check
