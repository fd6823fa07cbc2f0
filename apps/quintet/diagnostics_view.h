// Diagnostics as people and editors read them: "file:line:column: error: text [id]" with the source line and a
// caret, or JSON.
#ifndef QUINTET_APP_DIAGNOSTICS_VIEW_H
#define QUINTET_APP_DIAGNOSTICS_VIEW_H

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "program/program.h"
#include "shader/compiler.h"

namespace quintet::app {

inline constexpr std::size_t kMaxDiagnostics = 20;  // shown; the rest is counted

// Finds the text of a file by the name that diagnostics call it; nothing: not known.
using SourceLookup = std::function<std::optional<std::string>(const std::string& file)>;

// The program's own files, the built-in library, the disk. `program` outlives the result.
SourceLookup sourcesOf(const program::Program& program);
SourceLookup sourcesOnDisk();

// Ends with a line break. Errors come first, in their order, then warnings, then notes.
std::string diagnosticsText(std::vector<shader::Diagnostic> diagnostics, const SourceLookup& sources, bool color);

// An array of {severity, file, line, column, id, text, why, mend}, all of them; one line. Ids of the catalogue have
// `why` and `mend`; an unknown line or column is 0.
std::string diagnosticsJson(const std::vector<shader::Diagnostic>& diagnostics);

// A file that is wrong, as a diagnostic: "line 7" of the place becomes its line.
shader::Diagnostic asDiagnostic(const FileError& error);

bool hasErrors(const std::vector<shader::Diagnostic>& diagnostics);

// "2 errors, 1 warning"; empty if there is neither.
std::string countText(const std::vector<shader::Diagnostic>& diagnostics);

}  // namespace quintet::app
#endif
