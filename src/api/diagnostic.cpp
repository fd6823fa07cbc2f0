#include <algorithm>

#include "api/impl.h"

namespace quintet {
namespace {

shader::Severity toInternal(Diagnostic::Severity severity) {
  return severity == Diagnostic::Severity::error     ? shader::Severity::error
         : severity == Diagnostic::Severity::warning ? shader::Severity::warning
                                                     : shader::Severity::note;
}

std::string firstError(const std::vector<Diagnostic>& diagnostics) {
  const auto found = std::ranges::find(diagnostics, Diagnostic::Severity::error, &Diagnostic::severity);
  return found == diagnostics.end() ? "the program does not compile" : found->format();
}

}  // namespace

std::string Diagnostic::format() const {
  return shader::Diagnostic{toInternal(severity), file, line, column, id, text}.format();
}

ProgramError::ProgramError(std::vector<Diagnostic> diagnostics)
    : Error(firstError(diagnostics)), diagnostics_(std::move(diagnostics)) {}

Diagnostic api::toPublic(const shader::Diagnostic& d) {
  const auto severity = d.severity == shader::Severity::error     ? Diagnostic::Severity::error
                        : d.severity == shader::Severity::warning ? Diagnostic::Severity::warning
                                                                  : Diagnostic::Severity::note;
  return {severity, d.file, d.line, d.column, d.id, d.text};
}

}  // namespace quintet
