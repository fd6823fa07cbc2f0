// SPDX-License-Identifier: Apache-2.0
#include "check/diagnostic_text.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "check/catalog.h"
#include "shader/library.h"
#include "spirv/source_text.h"

namespace quintet::check {
namespace {

constexpr std::size_t kMaxLineBytes = 200;  // shown of a source line

char withoutControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c; }

std::string withoutControls(std::string text) {
  std::ranges::transform(text, text.begin(), withoutControl);
  return text;
}

std::string_view severityColor(Severity severity) {
  return severity == Severity::error ? "\x1b[1;31m" : severity == Severity::warning ? "\x1b[1;35m" : "\x1b[1;36m";
}

// Files in memory have names in brackets: "<quintet/hit.glsl>".
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

// Returns the source line and a line with the caret. Tabs are kept, so both are aligned on all terminals.
std::string excerpt(const Diagnostic& d, const std::string& text, bool color) {
  const std::string_view source = spirv::lineOf(text, d.line).substr(0, kMaxLineBytes);
  if (source.find_first_not_of(" \t\r") == source.npos) return {};
  std::string shown, pad;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const char c = source[i];
    if (c == '\r' && i + 1 == source.size()) continue;
    shown += c == '\t' ? '\t' : withoutControl(c);
    const bool continues = (static_cast<unsigned char>(c) & 0xC0) == 0x80;  // UTF-8 continuation byte
    if (d.column > 0 && i + 1 < static_cast<std::size_t>(d.column) && !continues) pad += c == '\t' ? '\t' : ' ';
  }
  std::string result = fmt::format("{:5} | {}\n", d.line, shown);
  if (d.column > 0 && static_cast<std::size_t>(d.column) <= source.size())
    result += fmt::format("      | {}{}^{}\n", pad, color ? "\x1b[1;32m" : "", color ? "\x1b[0m" : "");
  return result;
}

std::string headline(const Diagnostic& d, bool color) {
  if (!color) return withoutControls(d.format()) + "\n";
  Diagnostic bare = d;
  bare.id.clear();
  const std::string text = withoutControls(bare.format());
  const std::string severity = fmt::format("{}: ", severityName(d.severity));
  const std::size_t at =
      d.file.empty() ? 0 : text.find(severity, std::min(withoutControls(d.file).size(), text.size()));
  if (at == std::string::npos) return withoutControls(d.format()) + "\n";
  const std::string id = d.id.empty() ? "" : fmt::format(" [{}]", withoutControls(d.id));
  return fmt::format("\x1b[1m{}\x1b[0m{}{}\x1b[0m{}{}\n", text.substr(0, at), severityColor(d.severity), severity,
                     text.substr(at + severity.size()), id);
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
  for (std::size_t i = 0; i < std::min(diagnostics.size(), kMaxShownDiagnostics); ++i) {
    const Diagnostic& d = diagnostics[i];
    text += headline(d, color);
    if (d.line <= 0) continue;
    if (const std::optional<std::string> source = sources(d.file)) text += excerpt(d, *source, color);
  }
  if (diagnostics.size() > kMaxShownDiagnostics)
    text += fmt::format("... and {} more\n", diagnostics.size() - kMaxShownDiagnostics);
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
    if (const DiagnosticInfo* info = findDiagnostic(d.id)) {
      entry["why"] = info->why;
      entry["fix"] = info->fix;
    }
    array.push_back(entry);
  }
  return array.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace quintet::check
