// SPDX-License-Identifier: Apache-2.0
// Diagnostics as text, "file:line:column: error: text [id]" with source lines and carets, and as JSON. sarif.h writes
// them for editors and CI.
#ifndef QUINTET_CHECK_DIAGNOSTIC_TEXT_H
#define QUINTET_CHECK_DIAGNOSTIC_TEXT_H

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "check/suppression.h"
#include "program/description/program.h"

namespace quintet::check {

inline constexpr std::size_t kMaxShownDiagnostics = 20;  // in a text; further ones are only counted

// Returns the text of a file by its name in diagnostics; nullopt if unknown.
using SourceLookup = std::function<std::optional<std::string>(const std::string& file)>;

// Searches the files of the program, the shader library and the disk. `program` must outlive the result.
SourceLookup sourcesOf(const program::Program& program);
// Searches the shader library and the disk.
SourceLookup sourcesOnDisk();

struct TextOptions {
  bool color = false;    // ANSI escape sequences
  bool explain = false;  // with the whole page of each id (docs/diagnostics)
  std::optional<std::size_t> width{};  // of the terminal: lines except those of sources break between words
};

// Returns lines that end with a line break: errors in their order, then warnings, then notes. Related locations follow
// their diagnostic as notes. The first diagnostic of an id also has the reason and the fix from the catalog. Control
// characters of the diagnostics and sources are replaced by '?'.
std::string diagnosticsText(std::vector<Diagnostic> diagnostics, const SourceLookup& sources,
                            const TextOptions& options = {});

// Returns a line for each: "file:line:column: suppressed warning: text [id], allowed in line 7: reason".
std::string suppressedText(const std::vector<SuppressedDiagnostic>& suppressed, const TextOptions& options = {});

// Returns one line with an array of {severity, file, line, column, id, text, related, why, fix}. Unknown lines and
// columns are 0; `related` exists if there are related locations, {file, line, column, text}; `why` and `fix` exist for
// ids of the catalog. Suppressed diagnostics come last and have `suppressed`, {file, line, reason}.
std::string diagnosticsJson(const std::vector<Diagnostic>& diagnostics,
                            const std::vector<SuppressedDiagnostic>& suppressed = {});

}  // namespace quintet::check
#endif
