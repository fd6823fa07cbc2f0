#include "diagnostics_view.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "program/diagnostic_catalog.h"
#include "shader/embedded_library.h"
#include "values.h"

namespace quintet::app {
namespace {

using shader::Diagnostic;
using shader::Severity;

constexpr std::size_t kMaxLineBytes = 200;  // of a source line

std::string_view severityName(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

std::string_view severityColor(Severity severity) {
  return severity == Severity::error ? "\x1b[1;31m" : severity == Severity::warning ? "\x1b[1;35m" : "\x1b[1;36m";
}

// Names in memory are written in brackets: "<quintet/hit.glsl>".
std::string withoutBrackets(const std::string& file) {
  return file.size() > 2 && file.front() == '<' && file.back() == '>' ? file.substr(1, file.size() - 2) : file;
}

std::optional<std::string> inLibrary(const std::string& path) {
  const auto library = embeddedShaderLibrary();
  const auto found = std::ranges::find(library, std::string_view(path), &EmbeddedFile::path);
  return found == library.end() ? std::nullopt : std::optional(std::string(found->data));
}

std::optional<std::string> onDisk(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  try {
    return readTextFile(path);
  } catch (const FileError&) {
    return std::nullopt;
  }
}

std::optional<std::string> lineOf(const std::string& text, int line) {
  std::size_t begin = 0;
  for (int i = 1; i < line; ++i) {
    begin = text.find('\n', begin);
    if (begin == std::string::npos) return std::nullopt;
    ++begin;
  }
  return text.substr(begin, std::min(text.find('\n', begin), text.size()) - begin);
}

// The source line and, below it, the caret: tabs stay tabs, so that both are aligned on every terminal.
std::string excerpt(const Diagnostic& d, const std::string& text, bool color) {
  std::optional<std::string> source = lineOf(text, d.line);
  if (!source || source->find_first_not_of(" \t\r") == std::string::npos) return {};
  if (source->size() > kMaxLineBytes) source->resize(kMaxLineBytes);
  std::string shown, pad;
  for (std::size_t i = 0; i < source->size(); ++i) {
    const char c = (*source)[i];
    if (c == '\r' && i + 1 == source->size()) continue;
    shown += c == '\t' ? '\t' : plain(std::string_view(&c, 1))[0];
    const bool continues = (static_cast<unsigned char>(c) & 0xC0) == 0x80;  // within a UTF-8 character
    if (d.column > 0 && i + 1 < static_cast<std::size_t>(d.column) && !continues) pad += c == '\t' ? '\t' : ' ';
  }
  std::string result = fmt::format("{:5} | {}\n", d.line, shown);
  if (d.column > 0 && static_cast<std::size_t>(d.column) <= source->size())
    result += fmt::format("      | {}{}^{}\n", pad, color ? "\x1b[1;32m" : "", color ? "\x1b[0m" : "");
  return result;
}

std::string headline(const Diagnostic& d, bool color) {
  if (!color) return plain(d.format()) + "\n";
  Diagnostic bare = d;
  bare.id.clear();
  const std::string text = plain(bare.format());
  const std::string severity = fmt::format("{}: ", severityName(d.severity));
  const std::size_t at = d.file.empty() ? 0 : text.find(severity, std::min(plain(d.file).size(), text.size()));
  if (at == std::string::npos) return plain(d.format()) + "\n";
  const std::string id = d.id.empty() ? "" : fmt::format(" [{}]", plain(d.id));
  return fmt::format("\x1b[1m{}\x1b[0m{}{}\x1b[0m{}{}\n", text.substr(0, at), severityColor(d.severity), severity,
                     text.substr(at + severity.size()), id);
}

std::string plural(std::size_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

SourceLookup sourcesOf(const program::Program& program) {
  return [&program](const std::string& file) -> std::optional<std::string> {
    for (const auto& [path, text] : program.files)
      if (program.path(path) == file) return text;
    return sourcesOnDisk()(file);
  };
}

SourceLookup sourcesOnDisk() {
  return [](const std::string& file) {
    const std::optional<std::string> text = inLibrary(withoutBrackets(file));
    return text ? text : onDisk(file);
  };
}

std::string diagnosticsText(std::vector<Diagnostic> diagnostics, const SourceLookup& sources, bool color) {
  std::ranges::stable_sort(diagnostics, std::ranges::greater{}, &Diagnostic::severity);
  std::string text;
  for (std::size_t i = 0; i < std::min(diagnostics.size(), kMaxDiagnostics); ++i) {
    const Diagnostic& d = diagnostics[i];
    text += headline(d, color);
    if (d.line <= 0) continue;
    if (const std::optional<std::string> source = sources(d.file)) text += excerpt(d, *source, color);
  }
  if (diagnostics.size() > kMaxDiagnostics)
    text += fmt::format("... and {} more\n", diagnostics.size() - kMaxDiagnostics);
  return text;
}

std::string diagnosticsJson(const std::vector<Diagnostic>& diagnostics) {
  using Json = nlohmann::ordered_json;
  Json array = Json::array();
  for (const Diagnostic& d : diagnostics) {
    Json entry{{"severity", severityName(d.severity)},
               {"file", d.file},
               {"line", d.line},
               {"column", d.column},
               {"id", d.id},
               {"text", d.text}};
    if (const program::DiagnosticInfo* info = program::findDiagnostic(d.id)) {
      entry["why"] = info->why;
      entry["mend"] = info->mend;
    }
    array.push_back(entry);
  }
  return array.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Diagnostic asDiagnostic(const FileError& error) {
  Diagnostic d{Severity::error, error.file().string(), 0, 0, "FILE", error.problem()};
  constexpr std::string_view kLine = "line ";
  const std::string& place = error.place();
  if (place.starts_with(kLine)) {
    const auto [end, failed] = std::from_chars(place.data() + kLine.size(), place.data() + place.size(), d.line);
    if (failed == std::errc{} && end == place.data() + place.size()) return d;
    if (failed != std::errc{}) d.line = 0;
  }
  if (!place.empty()) d.text = place + ": " + d.text;
  return d;
}

bool hasErrors(const std::vector<Diagnostic>& diagnostics) {
  return std::ranges::any_of(diagnostics, [](const Diagnostic& d) { return d.severity == Severity::error; });
}

std::string countText(const std::vector<Diagnostic>& diagnostics) {
  const auto count = [&](Severity severity) {
    return static_cast<std::size_t>(std::ranges::count(diagnostics, severity, &Diagnostic::severity));
  };
  const std::size_t errors = count(Severity::error), warnings = count(Severity::warning);
  std::string text;
  if (errors > 0) text = plural(errors, "error");
  if (warnings > 0) text += (text.empty() ? "" : ", ") + plural(warnings, "warning");
  return text;
}

}  // namespace quintet::app
