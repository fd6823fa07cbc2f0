// SPDX-License-Identifier: Apache-2.0
#include "output/file_names.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "base/error.h"

namespace quintet::output {
namespace {

constexpr std::uint32_t kFrameDigits = 4;
constexpr std::uint32_t kMaxDigits = 9;

struct FramePattern {
  std::size_t begin = 0;  // of "%04d" or "####"
  std::size_t end = 0;
  std::uint32_t digits = 0;
};

bool isDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::optional<FramePattern> findPattern(const std::string& name, std::size_t from) {
  for (std::size_t at = name.find_first_of("%#", from); at != name.npos; at = name.find_first_of("%#", at + 1)) {
    FramePattern pattern{at, at + 1, 0};
    if (name[at] == '#') {
      pattern.end = std::min(name.find_first_not_of('#', at), name.size());
      pattern.digits = std::min(static_cast<std::uint32_t>(pattern.end - at), kMaxDigits);
      return pattern;
    }
    while (pattern.end < name.size() && isDigit(name[pattern.end]))
      pattern.digits =
          std::min(pattern.digits * 10 + static_cast<std::uint32_t>(name[pattern.end++] - '0'), kMaxDigits);
    if (pattern.end >= name.size() || name[pattern.end] != 'd') continue;
    ++pattern.end;
    return pattern;
  }
  return std::nullopt;
}

}  // namespace

bool hasFramePattern(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  const std::optional<FramePattern> pattern = findPattern(name, 0);
  if (pattern && findPattern(name, pattern->end))
    throw UsageError(fmt::format("{}: the name contains more than one pattern for the frame number", file.string()));
  return pattern.has_value();
}

std::filesystem::path fileName(const std::filesystem::path& file, const std::string& output,
                               std::optional<std::uint64_t> frame) {
  std::string name = file.filename().string();
  std::optional<FramePattern> pattern = frame ? findPattern(name, 0) : std::nullopt;
  if (frame && !pattern) {
    const std::size_t at = file.stem().string().size();
    name.insert(at, fmt::format(".%0{}d", kFrameDigits));
    pattern = findPattern(name, at);
  }
  if (pattern)
    name.replace(pattern->begin, pattern->end - pattern->begin, fmt::format("{:0{}}", *frame, pattern->digits));
  if (!output.empty()) {
    // Before the frame number and its separator, so that numbers stay last.
    std::size_t at = pattern ? pattern->begin : file.stem().string().size();
    if (at > 0 && pattern && (name[at - 1] == '.' || name[at - 1] == '_' || name[at - 1] == '-')) --at;
    const char separator = pattern && at < pattern->begin ? name[at] : '.';
    name.insert(at, at == 0 ? output + "." : separator + output);
  }
  return file.parent_path() / name;
}

std::filesystem::path defaultImage(const std::string& program) {
  const std::string name = std::filesystem::path(program).filename().string();
  const std::string stem = name.substr(0, name.find('.'));
  return (stem.empty() ? "out" : stem) + ".png";
}

}  // namespace quintet::output
