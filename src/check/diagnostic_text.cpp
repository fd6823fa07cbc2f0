// SPDX-License-Identifier: Apache-2.0
#include "check/diagnostic_text.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/parse.h"
#include "base/wrap.h"
#include "check/catalog.h"
#include "shader/library.h"
#include "spirv/source_text.h"

namespace quintet::check {
namespace {

constexpr std::size_t kMaxLineBytes = 200;  // shown of a source line
constexpr std::size_t kMaxRelated = 4;      // shown of a diagnostic
constexpr std::string_view kMargin = "      ";

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
std::string excerpt(int line, int column, const std::string& text, bool color) {
  const std::string_view source = spirv::lineOf(text, line).substr(0, kMaxLineBytes);
  if (source.find_first_not_of(" \t\r") == source.npos) return {};
  std::string shown, pad;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const char c = source[i];
    if (c == '\r' && i + 1 == source.size()) continue;
    shown += c == '\t' ? '\t' : withoutControl(c);
    const bool continues = (static_cast<unsigned char>(c) & 0xC0) == 0x80;  // UTF-8 continuation byte
    if (column > 0 && i + 1 < static_cast<std::size_t>(column) && !continues) pad += c == '\t' ? '\t' : ' ';
  }
  std::string result = fmt::format("{:5} | {}\n", line, shown);
  if (column > 0 && static_cast<std::size_t>(column) <= source.size())
    result += fmt::format("{}| {}{}^{}\n", kMargin, pad, color ? "\x1b[1;32m" : "", color ? "\x1b[0m" : "");
  return result;
}

std::string colored(std::string_view text, std::string_view sequence, bool color) {
  return color && !text.empty() ? fmt::format("{}{}\x1b[0m", sequence, text) : std::string(text);
}

// "file:line:column: error: text [id]"
std::string headline(const Diagnostic& d, std::string_view severity, bool color) {
  std::string location = withoutControls(locationText(d.file, d.line, d.column));
  if (!location.empty()) location += ": ";
  const std::string id = d.id.empty() ? "" : fmt::format(" [{}]", d.id);
  return colored(location, "\x1b[1m", color) + colored(fmt::format("{}: ", severity), severityColor(d.severity), color) +
         withoutControls(d.text + id);
}

// Appends a line after a margin; on a terminal it breaks between words, and further lines are indented.
void addLine(std::string& text, const std::string& line, const TextOptions& options, std::string_view margin = {},
             std::size_t indent = 2) {
  text.append(margin).append(options.width ? wrapped(line, *options.width, indent, margin.size()) : line) += "\n";
}

void addExcerpt(std::string& text, const std::string& file, int line, int column, const SourceLookup& sources,
                bool color) {
  if (line <= 0) return;
  if (const std::optional<std::string> source = sources(file)) text += excerpt(line, column, *source, color);
}

void addRelated(std::string& text, const RelatedLocation& r, const SourceLookup& sources, const TextOptions& options) {
  const Diagnostic note{Severity::note, r.file, r.line, r.column, "", r.text};
  addLine(text, headline(note, severityName(note.severity), options.color), options);
  addExcerpt(text, r.file, r.line, r.column, sources, options.color);
}

// "      = why: …" and "      = fix: …"
void addReason(std::string& text, const DiagnosticInfo& info, const TextOptions& options) {
  for (const auto& [label, sentence] : {std::pair{"why", info.why}, {"fix", info.fix}})
    addLine(text, fmt::format("= {}: {}", colored(label, "\x1b[1m", options.color), sentence), options, kMargin,
            kMargin.size() + 7);
}

// The page without its Markdown title, which repeats the catalog.
void addPage(std::string& text, std::string_view id, const TextOptions& options) {
  text += "\n";
  for (const std::string& line : splitText(explanation(id), '\n'))
    text += (line.starts_with('#') ? colored(line, "\x1b[1m", options.color) : line) + "\n";
  while (text.ends_with("\n\n")) text.pop_back();
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

std::string diagnosticsText(std::vector<Diagnostic> diagnostics, const SourceLookup& sources,
                            const TextOptions& options) {
  std::ranges::stable_sort(diagnostics, std::ranges::greater{}, &Diagnostic::severity);
  std::string text;
  std::set<std::string> explained;
  const std::size_t shown = std::min(diagnostics.size(), kMaxShownDiagnostics);
  for (std::size_t i = 0; i < shown; ++i) {
    const Diagnostic& d = diagnostics[i];
    addLine(text, headline(d, severityName(d.severity), options.color), options);
    addExcerpt(text, d.file, d.line, d.column, sources, options.color);
    for (std::size_t k = 0; k < std::min(d.related.size(), kMaxRelated); ++k)
      addRelated(text, d.related[k], sources, options);
    const DiagnosticInfo* info = findDiagnostic(d.id);
    if (info && explained.insert(d.id).second) addReason(text, *info, options);
  }
  if (diagnostics.size() > shown) text += fmt::format("... and {} more\n", diagnostics.size() - shown);
  if (options.explain)
    for (const std::string& id : explained) addPage(text, id, options);
  return text;
}

std::string suppressedText(const std::vector<SuppressedDiagnostic>& suppressed, const TextOptions& options) {
  std::string text;
  for (const SuppressedDiagnostic& s : suppressed) {
    const Diagnostic& d = s.diagnostic;
    std::string line = headline(d, fmt::format("suppressed {}", severityName(d.severity)), options.color);
    line += fmt::format(", allowed in line {}", s.comment.line);
    if (!s.reason.empty()) line += ": " + withoutControls(s.reason);
    addLine(text, line, options);
  }
  return text;
}

namespace {

using Json = nlohmann::ordered_json;

Json toJson(const Diagnostic& d) {
  Json entry{{"severity", severityName(d.severity)},
             {"file", d.file},
             {"line", d.line},
             {"column", d.column},
             {"id", d.id},
             {"text", d.text}};
  for (const RelatedLocation& r : d.related)
    entry["related"].push_back({{"file", r.file}, {"line", r.line}, {"column", r.column}, {"text", r.text}});
  if (const DiagnosticInfo* info = findDiagnostic(d.id)) {
    entry["why"] = info->why;
    entry["fix"] = info->fix;
  }
  return entry;
}

}  // namespace

std::string diagnosticsJson(const std::vector<Diagnostic>& diagnostics,
                            const std::vector<SuppressedDiagnostic>& suppressed) {
  Json array = Json::array();
  for (const Diagnostic& d : diagnostics) array.push_back(toJson(d));
  for (const SuppressedDiagnostic& s : suppressed) {
    Json entry = toJson(s.diagnostic);
    entry["suppressed"] = {{"file", s.comment.file}, {"line", s.comment.line}, {"reason", s.reason}};
    array.push_back(std::move(entry));
  }
  return array.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace quintet::check
