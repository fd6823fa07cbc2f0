// SPDX-License-Identifier: Apache-2.0
// Helpers for the diagnostics of the public API.
#ifndef QUINTET_BASE_DIAGNOSTIC_H
#define QUINTET_BASE_DIAGNOSTIC_H

#include <string>
#include <string_view>
#include <vector>

#include <quintet/diagnostic.h>

namespace quintet {

// A location in a source file under the name that the user knows. 0 means unknown.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;
};

std::string_view severityName(Severity severity);  // "error", "warning", "note"

// Returns "file:line:column"; unknown parts are left out.
std::string locationText(const std::string& file, int line, int column);

bool hasErrors(const std::vector<Diagnostic>& diagnostics);

// Returns "2 errors, 1 warning"; empty without errors and warnings. Notes do not count.
std::string countText(const std::vector<Diagnostic>& diagnostics);

// Appends a diagnostic unless the list has an equal one; related locations do not count. Stages that share source text report the same problems.
void addUnique(std::vector<Diagnostic>& diagnostics, Diagnostic diagnostic);

// Returns a diagnostic with the id "FILE". The location "line 7" becomes its line.
Diagnostic asDiagnostic(const FileError& error);

}  // namespace quintet
#endif
