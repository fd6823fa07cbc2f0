// SPDX-License-Identifier: Apache-2.0
#include "job/print_log.h"

#include <span>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"

namespace quintet::job {
namespace {

constexpr std::uint32_t kPrintLogWords = 1u << 20;  // 4 MiB: more than 100,000 prints in a batch

}  // namespace

render::Region printedPixels(const PrintRequest& request, const render::Region& rendered) {
  if (request.all) return rendered;
  const render::Region& p = request.pixels;
  if (p.width == 0) return {rendered.x + rendered.width / 2, rendered.y + rendered.height / 2, 1, 1};
  const auto isInside = [](std::uint64_t begin, std::uint64_t size, std::uint64_t from, std::uint64_t length) {
    return begin >= from && begin + size <= from + length;
  };
  if (isInside(p.x, p.width, rendered.x, rendered.width) && isInside(p.y, p.height, rendered.y, rendered.height))
    return p;
  throw UsageError(
      fmt::format("the pixels {},{},{},{} to print are outside the rendered part of the image, {},{},{},{}", p.x, p.y,
                  p.width, p.height, rendered.x, rendered.y, rendered.width, rendered.height));
}

Printed printedLines(const render::LogContents& log, const program::PrintTable& table, const PrintNumbers& numbers,
                     std::uint64_t limit) {
  Printed result;
  result.omitted = result.notStored = log.dropped;
  for (const render::LogRecord& record : log.records) {
    const std::span<const std::uint32_t> words = log.wordsOf(record);
    if (record.kind != shared::kLogPrint || words.empty() || words[0] >= table.size()) continue;
    const program::PrintSite& site = table[words[0]];
    if (words.size() != 1 + site.format.wordCount()) continue;  // not of this call
    if (result.lines.size() >= limit) {
      ++result.omitted;
      continue;
    }
    std::string text = site.format.text(words.subspan(1));
    while (text.ends_with('\n')) text.pop_back();
    const std::optional<std::uint32_t> index = record.sampleIndex;
    result.lines.push_back({record.pixel, numbers.accumulates ? index : numbers.frame,
                            numbers.accumulates ? std::nullopt : index, site.location, site.stage, std::move(text)});
  }
  return result;
}

PrintLog::PrintLog(gpu::Context& context, const PrintRequest& request, const render::Region& rendered,
                   program::PrintTable table)
    : log_(context, printedPixels(request, rendered), kPrintLogWords),
      table_(std::move(table)),
      limit_(request.limit),
      remaining_(request.limit) {}

void PrintLog::flush(Observer& observer, const PrintNumbers& numbers) {
  const Printed printed = printedLines(log_.take(), table_, numbers, remaining_);
  if (printed.lines.empty() && printed.omitted == 0) return;
  remaining_ -= printed.lines.size();
  observer.printed(printed);
}

void PrintLog::restart() {
  log_.take();
  remaining_ = limit_;
}

}  // namespace quintet::job
