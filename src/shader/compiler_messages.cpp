// SPDX-License-Identifier: Apache-2.0
#include "shader/compiler_messages.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <set>
#include <utility>

#include "base/typographic.h"
#include "spirv/glsl_declaration.h"
#include "spirv/source_text.h"

namespace quintet::shader {
namespace {

constexpr std::string_view kCompilerId = "GLSL";

// Consumes "error: ", "warning: " or "note: " at the start of `rest`.
bool takeSeverity(std::string_view& rest, Severity& severity) {
  for (const Severity candidate : {Severity::error, Severity::warning, Severity::note}) {
    const std::string_view name = severityName(candidate);
    if (rest.starts_with(name) && rest.substr(name.size(), 2) == ": ") {
      severity = candidate;
      rest.remove_prefix(name.size() + 2);
      return true;
    }
  }
  return false;
}

// Consumes "12: " at the start of `rest`.
bool takeLine(std::string_view& rest, int& line) {
  const auto [end, failed] = std::from_chars(rest.data(), rest.data() + rest.size(), line);
  const auto used = static_cast<std::size_t>(end - rest.data());
  if (failed != std::errc{} || line < 0 || rest.substr(used, 2) != ": ") return false;
  rest.remove_prefix(used + 2);
  return true;
}

// Parses the part after the file name: ":12: error: text" or ": error: text".
bool parseAfterName(std::string_view rest, Diagnostic& diagnostic) {
  if (!rest.starts_with(':')) return false;
  rest.remove_prefix(1);
  if (rest.starts_with(' ')) {
    rest.remove_prefix(1);
  } else if (!takeLine(rest, diagnostic.line)) {
    return false;
  }
  if (!takeSeverity(rest, diagnostic.severity)) return false;
  diagnostic.text = rest;
  return true;
}

bool parseMessage(std::string_view message, const std::vector<const SourceFile*>& files, Diagnostic& diagnostic) {
  for (const SourceFile* file : files) {
    if (!message.starts_with(file->name)) continue;
    diagnostic.file = file->name;
    if (parseAfterName(message.substr(file->name.size()), diagnostic)) return true;
  }
  // A name that the source sets with #line "name".
  for (std::size_t colon = message.find(':'); colon != message.npos; colon = message.find(':', colon + 1)) {
    diagnostic.file = message.substr(0, colon);
    if (parseAfterName(message.substr(colon), diagnostic)) return true;
  }
  diagnostic.file.clear();
  diagnostic.line = 0;
  if (takeSeverity(message, diagnostic.severity)) {
    diagnostic.text = message;
    return true;
  }
  return false;
}

// "compilation terminated" adds nothing, and the version that shaderc reports as overridden is set by us.
bool isNoise(const Diagnostic& d) {
  return d.text == "'' : compilation terminated" || d.text.ends_with("while in source code it is (460, none)");
}

// Returns the line without the comment at its end, which can have any characters.
std::string_view codeOf(std::string_view line) { return line.substr(0, line.find("//")); }

// Returns `line`, or the last #define before it, if its code has the byte; else 0.
int lineWithByte(std::string_view source, int line, char byte) {
  int found = 0;
  for (int i = 1; i <= line; ++i) {
    const std::size_t end = std::min(source.find('\n'), source.size());
    const std::string_view code = codeOf(source.substr(0, end));
    if ((i == line || code.starts_with("#define")) && code.find(byte) != code.npos) found = i;
    source.remove_prefix(std::min(end + 1, source.size()));
  }
  return found;
}

// The compiler reports only one byte of a character that GLSL does not have, and for a macro the line of its use.
// Restores the character and its location.
void restoreCharacter(Diagnostic& d, std::string_view source) {
  constexpr std::string_view kEnd = "' : unexpected token";
  if (d.line <= 0 || d.text.size() != kEnd.size() + 2 || !d.text.ends_with(kEnd) || (d.text[1] & 0x80) == 0) return;
  const int number = lineWithByte(source, d.line, d.text[1]);
  if (number == 0) return;
  const std::string_view line = codeOf(spirv::lineOf(source, number));
  const std::string_view quote = findTypographicQuote(line);
  std::size_t at = quote.find(d.text[1]) != quote.npos ? line.find(quote) : line.find(d.text[1]);
  while (at > 0 && (line[at] & 0xC0) == 0x80) --at;
  std::size_t length = 1;
  while (at + length < line.size() && (line[at + length] & 0xC0) == 0x80) ++length;
  const std::string_view character = line.substr(at, length);
  d.text = "'" + std::string(character) + std::string(kEnd);
  if (!findTypographicQuote(character).empty()) d.text += "; " + typographicQuoteHint(character);
  d.line = number;
  d.column = static_cast<int>(at) + 1;
}

// Adds a hint to the error for #include “file”.
void explainInclude(Diagnostic& d, std::string_view source) {
  if (!d.text.starts_with("'#include'")) return;
  const std::string_view line = codeOf(spirv::lineOf(source, d.line));
  const std::string_view quote = findTypographicQuote(line);
  if (quote.empty()) return;
  d.text += "; " + typographicQuoteHint(quote);
  d.column = static_cast<int>(quote.data() - line.data()) + 1;
}

}  // namespace

int columnOfToken(std::string_view text, int line, std::string_view message) {
  const std::size_t open = message.find('\'');
  const std::size_t close = message.find('\'', open == message.npos ? open : open + 1);
  if (close == message.npos || close == open + 1 || line <= 0) return 0;
  const std::string_view token = message.substr(open + 1, close - open - 1);

  text = spirv::lineOf(text, line);
  const std::size_t at = spirv::findToken(text, token);
  const bool unique = at != text.npos && spirv::findToken(text, token, at + 1) == text.npos;
  return unique ? static_cast<int>(at) + 1 : 0;
}

std::vector<Diagnostic> parseMessages(std::string_view messages, const IncludeResolver& files) {
  std::vector<const SourceFile*> known = files.files();
  std::ranges::sort(known, std::greater{}, [](const SourceFile* f) { return f->name.size(); });  // longest first
  std::vector<Diagnostic> diagnostics;
  while (!messages.empty()) {
    const std::size_t end = std::min(messages.find('\n'), messages.size());
    const std::string_view message = messages.substr(0, end);
    messages.remove_prefix(std::min(end + 1, messages.size()));
    if (message.empty()) continue;

    Diagnostic diagnostic;
    diagnostic.id = kCompilerId;
    if (parseMessage(message, known, diagnostic)) {
      diagnostic.column = columnOfToken(files.textOf(diagnostic.file), diagnostic.line, diagnostic.text);
      restoreCharacter(diagnostic, files.textOf(diagnostic.file));
      explainInclude(diagnostic, files.textOf(diagnostic.file));
      if (!isNoise(diagnostic)) diagnostics.push_back(std::move(diagnostic));
    } else if (diagnostics.empty()) {
      diagnostic.file = files.root().name;
      diagnostic.text = message;
      diagnostics.push_back(std::move(diagnostic));
    } else {
      // "Possible extensions include:" continues with "test.rgen: GL_EXT_ray_tracing".
      const std::string prefix = files.root().name + ": ";
      diagnostics.back().text.append(" ").append(message.starts_with(prefix) ? message.substr(prefix.size()) : message);
    }
  }
  return diagnostics;
}

void dropFollowUpErrors(std::vector<Diagnostic>& diagnostics) {
  const auto isMissingInclude = [](const Diagnostic& d) { return d.text.starts_with("'#include'"); };
  if (std::ranges::any_of(diagnostics, isMissingInclude))
    std::erase_if(diagnostics,
                  [&](const Diagnostic& d) { return d.severity == Severity::error && !isMissingInclude(d); });
  std::set<std::pair<std::string, int>> seen;
  std::erase_if(diagnostics, [&](const Diagnostic& d) {
    return d.severity == Severity::error && d.line > 0 && !seen.emplace(d.file, d.line).second;
  });
}

void explainOutgoingPayload(std::vector<Diagnostic>& diagnostics, Stage stage, const IncludeResolver& files) {
  for (Diagnostic& d : diagnostics) {
    if (d.text.find("RayPayloadKHR Storage Class is limited") == d.text.npos) continue;
    d.id = "Q103";
    d.text = "rayPayloadEXT in the " + std::string(stageName(stage)) +
             " shader, which cannot trace rays; declare the payload of the incoming ray as rayPayloadInEXT";
    for (const SourceFile* file : files.files()) {
      const auto found = spirv::findWord(file->text, "rayPayloadEXT");
      if (!found) continue;
      d.file = found->file.empty() ? file->name : found->file;
      d.line = found->line;
      d.column = found->column;
      break;
    }
  }
}

}  // namespace quintet::shader
