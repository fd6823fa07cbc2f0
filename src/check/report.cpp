// SPDX-License-Identifier: Apache-2.0
#include "check/report.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "check/catalog.h"

namespace quintet::check {

RelatedLocation relatedTo(const SourceLocation& location, std::string text) {
  return {location.file, location.line, location.column, std::move(text)};
}

void Report::add(std::string_view id, const SourceLocation& location, std::string text,
                 std::vector<RelatedLocation> related) {
  const DiagnosticInfo* info = findDiagnostic(id);
  const Severity severity = info ? info->severity : Severity::error;
  std::erase_if(related, [&](const RelatedLocation& r) {
    return r.line <= 0 || (r.file == location.file && r.line == location.line);
  });
  addUnique(diagnostics_, {severity, location.file, location.line, location.column, std::string(id), std::move(text),
                           std::move(related)});
}

void Report::addOncePerLine(std::string_view id, const SourceLocation& location, std::string text) {
  const auto sameLine = [&](const Diagnostic& d) {
    return d.id == id && d.file == location.file && d.line == location.line;
  };
  if (std::ranges::none_of(diagnostics_, sameLine)) add(id, location, std::move(text));
}

bool Report::hasAny(std::span<const std::string_view> ids) const {
  return std::ranges::any_of(
      diagnostics_, [&](const Diagnostic& d) { return std::ranges::find(ids, std::string_view(d.id)) != ids.end(); });
}

std::vector<Diagnostic> Report::take() {
  std::ranges::stable_sort(diagnostics_, {}, [](const Diagnostic& d) { return std::tie(d.id, d.file, d.line); });
  return std::move(diagnostics_);
}

}  // namespace quintet::check
