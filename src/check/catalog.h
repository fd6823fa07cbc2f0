// SPDX-License-Identifier: Apache-2.0
// The catalog of diagnostics: one row per id, and the page of docs/diagnostics that explains it. The check (check.h)
// and instrumented runs take severities and texts from here; `quintet explain` prints the page.
#ifndef QUINTET_CHECK_CATALOG_H
#define QUINTET_CHECK_CATALOG_H

#include <span>
#include <string_view>

#include "base/diagnostic.h"

namespace quintet::check {

struct DiagnosticInfo {
  std::string_view id;  // "Q101"
  Severity severity = Severity::error;
  // Source file that reports it, without extension: a rule below src/check/rules ("across_stages/payload_types"), or a
  // front end, the checks of modules or the instrumented run below src ("program/lecture/split").
  std::string_view rule;
  std::string_view title;  // what is wrong, without names: a few words, no period
  std::string_view why;    // why it matters: one sentence
  std::string_view fix;    // how to fix it: one sentence
  // Words that users search for and that the title does not have, separated by spaces: synonyms, symptoms, identifiers.
  std::string_view keywords = {};
  bool ofScene = false;  // can also depend on the scene of the check
};

// Returns all rows, sorted by id.
std::span<const DiagnosticInfo> allDiagnostics();

// Finds a row by id, ignoring case; null if unknown.
const DiagnosticInfo* findDiagnostic(std::string_view id);

// Returns the page docs/diagnostics/ID.md (Markdown), which is embedded in the binary; empty if unknown.
std::string_view explanation(std::string_view id);

}  // namespace quintet::check
#endif
