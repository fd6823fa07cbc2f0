// SPDX-License-Identifier: Apache-2.0
#include "base/diagnostic.h"

#include <algorithm>
#include <charconv>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/plural.h"

namespace quintet {
namespace {

std::string firstError(const std::vector<Diagnostic>& diagnostics) {
  const auto found = std::ranges::find(diagnostics, Severity::error, &Diagnostic::severity);
  return found == diagnostics.end() ? "the program does not compile" : found->format();
}

}  // namespace

std::string Diagnostic::format() const {
  std::string result = locationText(file, line, column);
  if (!file.empty()) result += ": ";
  result.append(severityName(severity)).append(": ").append(text);
  if (!id.empty()) result.append(" [").append(id).append("]");
  return result;
}

ProgramError::ProgramError(std::vector<Diagnostic> diagnostics)
    : Error(firstError(diagnostics)), diagnostics_(std::move(diagnostics)) {}

std::string_view severityName(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

std::string locationText(const std::string& file, int line, int column) {
  std::string result = file;
  if (!file.empty() && line > 0) {
    result += ":" + std::to_string(line);
    if (column > 0) result += ":" + std::to_string(column);
  }
  return result;
}

bool hasErrors(const std::vector<Diagnostic>& diagnostics) {
  return std::ranges::find(diagnostics, Severity::error, &Diagnostic::severity) != diagnostics.end();
}

std::string countText(const std::vector<Diagnostic>& diagnostics) {
  const auto count = [&](Severity severity) {
    return std::ranges::count(diagnostics, severity, &Diagnostic::severity);
  };
  const auto errors = count(Severity::error), warnings = count(Severity::warning);
  std::string text;
  if (errors > 0) text = counted(errors, "error");
  if (warnings > 0) text += (text.empty() ? "" : ", ") + counted(warnings, "warning");
  return text;
}

void addUnique(std::vector<Diagnostic>& diagnostics, Diagnostic diagnostic) {
  const auto fields = [](const Diagnostic& d) { return std::tie(d.severity, d.file, d.line, d.column, d.id, d.text); };
  const auto equal = [&](const Diagnostic& d) { return fields(d) == fields(diagnostic); };
  if (std::ranges::none_of(diagnostics, equal)) diagnostics.push_back(std::move(diagnostic));
}

Diagnostic asDiagnostic(const FileError& error) {
  Diagnostic d{Severity::error, error.file().string(), 0, 0, "FILE", error.problem()};
  constexpr std::string_view kLine = "line ";
  const std::string& location = error.location();
  if (location.starts_with(kLine)) {
    const char* end = location.data() + location.size();
    const auto [stop, failed] = std::from_chars(location.data() + kLine.size(), end, d.line);
    if (failed == std::errc{} && stop == end) return d;
    if (failed != std::errc{}) d.line = 0;
  }
  if (!location.empty()) d.text = location + ": " + d.text;
  return d;
}

}  // namespace quintet
