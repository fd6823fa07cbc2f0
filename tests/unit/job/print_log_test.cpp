// SPDX-License-Identifier: Apache-2.0
// Records of the shader log become lines, up to a limit.
#include "job/print_log.h"

#include <gtest/gtest.h>

namespace quintet::job {
namespace {

const program::PrintTable& table() {
  static const spirv::PrintArgument integer{spirv::PrintArgument::Kind::integer, true, 32, 1, "int"};
  static const program::PrintTable sites{
      {{"p/a.rchit", 12, 3}, "a.rchit", spirv::PrintFormat("i = %d\n", {integer})},
      {{"p/common.glsl", 4, 0}, "b.rmiss", spirv::PrintFormat("missed", {})},
  };
  return sites;
}

// Records with one sample each of pixels 0, 1, …, as (kind, words).
render::LogContents logOf(const std::vector<std::pair<std::uint32_t, std::vector<std::uint32_t>>>& records) {
  render::LogContents log;
  for (const auto& [kind, words] : records) {
    const auto x = static_cast<std::uint32_t>(log.records.size());
    log.records.push_back({kind, {x, 5}, 7, log.words.size(), words.size()});
    log.words.insert(log.words.end(), words.begin(), words.end());
  }
  return log;
}

TEST(PrintLog, RecordsBecomeLines) {
  const Printed printed =
      printedLines(logOf({{shared::kLogPrint, {0, 42}}, {shared::kLogPrint, {1}}}), table(), {}, 10);
  ASSERT_EQ(printed.lines.size(), 2u);
  EXPECT_EQ(printed.omitted, 0u);
  const PrintedLine& line = printed.lines[0];
  EXPECT_EQ(line.text, "i = 42");
  EXPECT_EQ(line.pixel, uvec2(0, 5));
  EXPECT_EQ(line.sample, 7u);
  EXPECT_FALSE(line.frame);
  EXPECT_EQ(line.stage, "a.rchit");
  EXPECT_EQ(line.location.file, "p/a.rchit");
  EXPECT_EQ(line.location.line, 12);
  EXPECT_EQ(printed.lines[1].text, "missed");
  EXPECT_EQ(printed.lines[1].pixel, uvec2(1, 5));
}

TEST(PrintLog, LinesBeyondTheLimitAreCounted) {
  render::LogContents log = logOf({{shared::kLogPrint, {1}}, {shared::kLogPrint, {1}}, {shared::kLogPrint, {1}}});
  log.dropped = 5;
  const Printed printed = printedLines(log, table(), {}, 1);
  EXPECT_EQ(printed.lines.size(), 1u);
  EXPECT_EQ(printed.omitted, 7u);
  EXPECT_EQ(printed.notStored, 5u);
}

TEST(PrintLog, OtherRecordsAreNoLines) {
  const std::uint32_t unknownSite = 2;
  const Printed printed = printedLines(logOf({{shared::kLogPrint + 1, {0, 1}},
                                              {shared::kLogPrint, {unknownSite}},
                                              {shared::kLogPrint, {}},
                                              {shared::kLogPrint, {0}},
                                              {shared::kLogPrint, {1, 4}}}),
                                       table(), {}, 10);  // the last two have too few and too many words
  EXPECT_TRUE(printed.lines.empty());
  EXPECT_EQ(printed.omitted, 0u);
}

TEST(PrintLog, IndicesAreFramesOfAProgramThatAccumulates) {
  const render::LogContents log = logOf({{shared::kLogPrint, {1}}});
  const PrintedLine accumulated = printedLines(log, table(), {.accumulates = true, .frame = {}}, 10).lines.at(0);
  EXPECT_EQ(accumulated.frame, 7u);
  EXPECT_FALSE(accumulated.sample);
  const PrintedLine animated = printedLines(log, table(), {.accumulates = false, .frame = 3}, 10).lines.at(0);
  EXPECT_EQ(animated.frame, 3u);
  EXPECT_EQ(animated.sample, 7u);
}

}  // namespace
}  // namespace quintet::job
