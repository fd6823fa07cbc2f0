// SPDX-License-Identifier: Apache-2.0
// Collects the diagnostics of the rules. Severities come from the catalog.
#ifndef QUINTET_CHECK_REPORT_H
#define QUINTET_CHECK_REPORT_H

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"

namespace quintet::check {

// A second location of a diagnostic. `text` says what is there: "received here".
RelatedLocation relatedTo(const SourceLocation& location, std::string text);

class Report {
 public:
  // Adds a diagnostic. Equal diagnostics are kept once, since stages can share source text. Related locations without a
  // line, and those in the same line, are dropped.
  void add(std::string_view id, const SourceLocation& location, std::string text,
           std::vector<RelatedLocation> related = {});
  // As add(), but keeps only the first diagnostic of an id per line, for rules that find several instructions there.
  void addOncePerLine(std::string_view id, const SourceLocation& location, std::string text);

  bool hasAny(std::span<const std::string_view> ids) const;
  std::vector<Diagnostic> take();  // sorted by id, file and line

 private:
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace quintet::check
#endif
