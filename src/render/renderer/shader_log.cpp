// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/shader_log.h"

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

namespace quintet::render {
namespace {

constexpr std::size_t kRecordWords = shared::kLogRecordWords;
static_assert(sizeof(shared::LogRecord) == kRecordWords * sizeof(std::uint32_t));

}  // namespace

LogContents parseLog(const shared::LogHeader& header, std::vector<std::uint32_t> words) {
  LogContents contents;
  contents.dropped = header.dropped;
  contents.words = std::move(words);
  const std::size_t end = std::min<std::size_t>(contents.words.size(), header.used);
  for (std::size_t at = 0; at + kRecordWords <= end;) {
    const std::uint32_t* const record = &contents.words[at];  // a shared::LogRecord
    const std::size_t wordCount = record[1];
    at += kRecordWords;
    if (record[0] == shared::kLogEnd || wordCount > end - at) break;
    contents.records.push_back({record[0], {record[2], record[3]}, record[4], at, wordCount});
    at += wordCount;
  }
  // An invocation appends its records in the order of its calls, so a stable sort keeps this order.
  std::ranges::stable_sort(contents.records, {}, [](const LogRecord& record) {
    return std::tuple(record.pixel.y, record.pixel.x, record.sampleIndex);
  });
  return contents;
}

ShaderLog::ShaderLog(gpu::Context& context, const Region& pixels, std::uint32_t capacity)
    : empty_{.capacity = capacity,
             .used = 0,
             .dropped = 0,
             .state = 0,
             .firstPixel = {pixels.x, pixels.y},
             .endPixel = {pixels.x + pixels.width, pixels.y + pixels.height}},
      buffer_(context, {.size = sizeof(shared::LogHeader) + std::uint64_t{capacity} * sizeof(std::uint32_t),
                        .name = "shader log"}) {
  buffer_.uploadAs(std::span<const shared::LogHeader>(&empty_, 1));
}

LogContents ShaderLog::take() {
  const shared::LogHeader header = buffer_.downloadAs<shared::LogHeader>(1).front();
  std::vector<std::uint32_t> words(std::min(header.used, header.capacity));
  if (!words.empty()) buffer_.download(std::as_writable_bytes(std::span(words)), sizeof(shared::LogHeader));
  if (header.used > 0 || header.dropped > 0) buffer_.uploadAs(std::span<const shared::LogHeader>(&empty_, 1));
  return parseLog(header, std::move(words));
}

}  // namespace quintet::render
