// SPDX-License-Identifier: Apache-2.0
// Diagnostics as text, "file:line:column: error: text [id]" with the source line and a caret, and as JSON.
#ifndef QUINTET_CHECK_DIAGNOSTIC_TEXT_H
#define QUINTET_CHECK_DIAGNOSTIC_TEXT_H

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "program/description/program.h"

namespace quintet::check {

inline constexpr std::size_t kMaxShownDiagnostics = 20;  // in a text; further ones are only counted

// Returns the text of a file by its name in diagnostics; nullopt if unknown.
using SourceLookup = std::function<std::optional<std::string>(const std::string& file)>;

// Searches the files of the program, the shader library and the disk. `program` must outlive the result.
SourceLookup sourcesOf(const program::Program& program);
// Searches the shader library and the disk.
SourceLookup sourcesOnDisk();

// Returns lines that end with a line break: errors in their order, then warnings, then notes. `color` adds ANSI escape
// sequences; control characters of the diagnostics and sources are replaced by '?'.
std::string diagnosticsText(std::vector<Diagnostic> diagnostics, const SourceLookup& sources, bool color);

// Returns one line with an array of {severity, file, line, column, id, text, why, fix}. Unknown lines and columns are
// 0; `why` and `fix` exist for ids of the catalog.
std::string diagnosticsJson(const std::vector<Diagnostic>& diagnostics);

}  // namespace quintet::check
#endif
