// SPDX-License-Identifier: Apache-2.0
// The words of a shader log become records in an order that does not depend on the device.
#include "render/renderer/shader_log.h"

#include <gtest/gtest.h>

namespace quintet::render {
namespace {

using Words = std::vector<std::uint32_t>;

LogContents parse(const Words& words, std::uint32_t dropped = 0) {
  const auto size = static_cast<std::uint32_t>(words.size());
  return parseLog({.capacity = size, .used = size, .dropped = dropped, .state = 0, .firstPixel = {}, .endPixel = {}},
                  words);
}

void append(Words& words, uvec2 pixel, std::uint32_t sample, const Words& data) {
  words.insert(words.end(), {7u, static_cast<std::uint32_t>(data.size()), pixel.x, pixel.y, sample});
  words.insert(words.end(), data.begin(), data.end());
}

TEST(ShaderLog, SortsByPixelThenSampleThenCall) {
  Words words;
  append(words, {5, 1}, 0, {10});
  append(words, {9, 0}, 1, {20, 21});
  append(words, {9, 0}, 0, {});
  append(words, {9, 0}, 1, {22});
  append(words, {0, 1}, 3, {30});
  const LogContents log = parse(words);
  ASSERT_EQ(log.records.size(), 5u);
  std::vector<Words> data;
  for (const LogRecord& record : log.records) {
    EXPECT_EQ(record.kind, 7u);
    data.emplace_back(log.wordsOf(record).begin(), log.wordsOf(record).end());
  }
  EXPECT_EQ(data, (std::vector<Words>{{}, {20, 21}, {22}, {30}, {10}}));
  EXPECT_EQ(log.records[1].pixel, uvec2(9, 0));
  EXPECT_EQ(log.records[1].sampleIndex, 1u);
  EXPECT_EQ(log.dropped, 0u);
}

TEST(ShaderLog, StopsAtTheEndMark) {
  Words words;
  append(words, {0, 0}, 0, {1});
  const std::size_t end = words.size();
  append(words, {1, 0}, 0, {2});
  words[end] = shared::kLogEnd;
  const LogContents log = parse(words, 1);
  EXPECT_EQ(log.records.size(), 1u);
  EXPECT_EQ(log.dropped, 1u);
}

TEST(ShaderLog, StopsAtAnIncompleteRecord) {
  Words words;
  append(words, {0, 0}, 0, {1});
  append(words, {1, 0}, 0, {2, 3});
  for (const std::size_t removed : {1u, 3u, 7u}) {
    const Words part(words.begin(), words.end() - static_cast<std::ptrdiff_t>(removed));
    EXPECT_EQ(parse(part).records.size(), 1u) << removed;
  }
}

}  // namespace
}  // namespace quintet::render
