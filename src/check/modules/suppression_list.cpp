// SPDX-License-Identifier: Apache-2.0
#include "check/modules/suppression_list.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parse.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "check/catalog.h"

namespace quintet::check {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr const char* kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

// True if `path` is `end`, or ends with it after a separator.
bool endsWithPath(std::string_view path, std::string_view end) {
  return path.ends_with(end) && (path.size() == end.size() || path[path.size() - end.size() - 1] == '/');
}

}  // namespace

SuppressionList SuppressionList::parse(const std::filesystem::path& file, std::string_view text) {
  SuppressionList list;
  int number = 0;
  for (const std::string& whole : splitText(text, '\n')) {
    ++number;
    const auto fail = [&](const std::string& problem) {
      throw FileError(file, fmt::format("line {}", number), problem);
    };
    const std::size_t comment = std::min(whole.find('#'), whole.size());
    std::string_view rest = trimmed(std::string_view(whole).substr(0, comment));
    if (rest.empty()) continue;
    Entry entry;
    entry.location = {file.string(), number, 1};
    if (comment < whole.size()) entry.reason = trimmed(std::string_view(whole).substr(comment + 1));
    const std::size_t blank = std::min(rest.find_first_of(" \t"), rest.size());
    entry.id = rest.substr(0, blank);
    if (!findDiagnostic(entry.id)) {
      std::vector<std::string> ids;
      for (const DiagnosticInfo& known : allDiagnostics()) ids.emplace_back(known.id);
      fail(fmt::format("unknown diagnostic '{}'{}; write an id such as Q104, and optionally a file",
                       printable(entry.id), suggestion(entry.id, ids)));
    }
    entry.id = findDiagnostic(entry.id)->id;
    rest = trimmed(rest.substr(blank));
    const std::size_t colon = rest.rfind(':');
    if (colon != rest.npos && colon + 1 < rest.size()) {
      const char* end = rest.data() + rest.size();
      const auto [stop, failed] = std::from_chars(rest.data() + colon + 1, end, entry.line);
      if (failed == std::errc{} && stop == end)
        rest = rest.substr(0, colon);
      else
        entry.line = 0;
    }
    entry.file = rest;
    list.entries_.push_back(std::move(entry));
  }
  return list;
}

const SuppressionList::Entry* SuppressionList::find(const Diagnostic& d) const {
  const auto found = std::ranges::find_if(entries_, [&](const Entry& entry) {
    return entry.id == d.id && (entry.file.empty() || endsWithPath(d.file, entry.file)) &&
           (entry.line == 0 || entry.line == d.line);
  });
  return found == entries_.end() ? nullptr : &*found;
}

bool SuppressionList::accepts(const Diagnostic& diagnostic) const { return find(diagnostic) != nullptr; }

std::vector<SuppressedDiagnostic> SuppressionList::apply(std::vector<Diagnostic>& diagnostics) const {
  std::vector<SuppressedDiagnostic> result;
  std::vector<Diagnostic> kept;
  for (Diagnostic& d : diagnostics) {
    if (const Entry* entry = find(d))
      result.push_back({std::move(d), entry->location, entry->reason, false});
    else
      kept.push_back(std::move(d));
  }
  diagnostics = std::move(kept);
  return result;
}

}  // namespace quintet::check
