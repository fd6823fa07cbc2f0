// The catalogue of what the link can report: one row per id, and the page of docs/diagnostics that explains it.
// The check (check.h) and the instrumented run take severity and words from here; `quintet explain` prints the page.
#ifndef QUINTET_PROGRAM_DIAGNOSTIC_CATALOG_H
#define QUINTET_PROGRAM_DIAGNOSTIC_CATALOG_H

#include <span>
#include <string_view>

#include "shader/compiler.h"

namespace quintet::program {

struct DiagnosticInfo {
  std::string_view id;  // "Q101"
  shader::Severity severity = shader::Severity::error;
  std::string_view title;  // what is wrong, without names: a few words, no full stop
  std::string_view why;    // why it matters: one sentence
  std::string_view mend;   // how to mend it: one sentence
};

// Sorted by id, no id twice.
std::span<const DiagnosticInfo> allDiagnostics();

// Null for an id that does not exist. Upper or lower case: "q101" is found, too.
const DiagnosticInfo* findDiagnostic(std::string_view id);

// The page docs/diagnostics/ID.md (Markdown), embedded in the binary; empty if there is none.
std::string_view explanation(std::string_view id);

}  // namespace quintet::program
#endif
