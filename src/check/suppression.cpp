// SPDX-License-Identifier: Apache-2.0
#include "check/suppression.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "base/suggestion.h"
#include "base/text.h"
#include "check/catalog.h"
#include "check/sources.h"

namespace quintet::check {
namespace {

constexpr std::string_view kPrefix = "quintet:", kVerb = "allow";
constexpr std::string_view kForm = "quintet: allow Q604 reason";

// Removes the first word, which a blank or a comma ends, from the text and returns it.
std::string_view takeWord(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_of(" \t,"), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  while (!text.empty() && (text.front() == ',' || text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  return word;
}

bool isId(std::string_view word) {
  return word.size() == 4 && (word[0] == 'Q' || word[0] == 'q') &&
         std::ranges::all_of(word.substr(1), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// The comment of a line that starts with kPrefix.
struct Comment {
  std::size_t begin = 0;    // offset of the comment in the line
  std::string_view text{};  // after kPrefix, without the end of the comment
};

std::optional<Comment> findComment(std::string_view line, bool toml) {
  for (std::size_t at = line.find(kPrefix); at != line.npos; at = line.find(kPrefix, at + 1)) {
    const std::string_view before = trimmed(line.substr(0, at));
    const bool block = !toml && before.ends_with("/*");
    if (!(toml ? before.ends_with('#') : block || before.ends_with("//"))) continue;
    const std::size_t size = toml ? 1 : 2;
    std::string_view text = line.substr(at + kPrefix.size());
    if (block) text = text.substr(0, text.find("*/"));
    return Comment{static_cast<std::size_t>(before.data() - line.data()) + before.size() - size, trimmed(text)};
  }
  return {};
}

std::string problemOf(const std::string& id) {
  const DiagnosticInfo* info = findDiagnostic(id);
  if (info == nullptr) {
    std::vector<std::string> ids;
    for (const DiagnosticInfo& known : allDiagnostics()) ids.emplace_back(known.id);
    return fmt::format("unknown diagnostic '{}'{}", printable(id), suggestion(id, ids));
  }
  return info->severity == Severity::error ? fmt::format("{} is an error, and errors cannot be suppressed", info->id)
                                           : std::string();
}

// Reads the text after kPrefix. Returns nullopt for a comment that only happens to start like a suppression.
std::optional<Suppression> parse(std::string_view text) {
  Suppression result;
  const std::string_view verb = takeWord(text);
  std::string_view rest = text;
  if (verb != kVerb) {
    if (!isId(takeWord(rest))) return {};
    result.problem = fmt::format("unknown word '{}'; write '{}'", printable(verb), kForm);
    return result;
  }
  while (!rest.empty() &&
         (result.ids.empty() || isId(rest.substr(0, std::min(rest.find_first_of(" \t,:"), rest.size()))))) {
    std::string id(takeWord(rest));
    if (id.ends_with(':')) id.pop_back();
    if (isId(id)) id[0] = 'Q';
    if (result.problem.empty()) result.problem = problemOf(id);
    result.ids.push_back(std::move(id));
  }
  if (result.ids.empty()) result.problem = fmt::format("the id of a diagnostic is missing; write '{}'", kForm);
  result.reason = std::string(trimmed(rest));
  return result;
}

// Only a run gives Q001 to Q009, only some devices give Q901 and later, and a check with a scene finds more: it can use
// the suppression.
bool canStayUnused(std::string_view id, bool hasScene) {
  return id < "Q010" || id.starts_with("Q9") || (!hasScene && findDiagnostic(id)->ofScene);
}

bool isSource(const std::string& name) {
  constexpr std::string_view kExtensions[] = {".glsl", ".rgen", ".rmiss", ".rchit", ".rahit", ".rint", ".rcall"};
  return std::ranges::any_of(kExtensions, [&](std::string_view extension) { return name.ends_with(extension); });
}

}  // namespace

std::vector<Suppression> findSuppressions(const std::string& file, std::string_view text) {
  std::vector<Suppression> result;
  if (text.find(kPrefix) == text.npos) return result;
  const bool toml = file.ends_with(".toml");
  std::vector<std::size_t> waiting;  // comments alone in their line, whose line of code follows
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    const std::string_view code = trimmed(line);
    const bool onlyComment = code.empty() || code.starts_with(toml ? "#" : "//") ||
                             (!toml && code.starts_with("/*") && code.find("*/") == code.size() - 2);
    if (!onlyComment) {
      for (const std::size_t index : waiting) result[index].line = number;
      waiting.clear();
    }
    const std::optional<Comment> comment = findComment(line, toml);
    std::optional<Suppression> found = comment ? parse(comment->text) : std::nullopt;
    if (!found) continue;
    found->location = {file, number, static_cast<int>(comment->begin) + 1};
    found->line = number;
    if (onlyComment) waiting.push_back(result.size());
    result.push_back(std::move(*found));
  }
  return result;
}

Suppressions::Suppressions(const program::Program& program) {
  for (const auto& [name, text] : program.files) {
    const bool generated = name.starts_with(program.descriptionFile + ".");  // parts of a lecture-form file
    if (name == program.descriptionFile || (isSource(name) && !generated)) add(program.path(name), text);
  }
}

Suppressions::Suppressions(const std::map<std::string, std::string>& texts) {
  for (const auto& [file, text] : texts) add(file, text);
}

void Suppressions::add(const std::string& file, std::string_view text) {
  std::vector<Known>& list = files_[file];
  for (Suppression& suppression : findSuppressions(file, text)) {
    const std::size_t count = suppression.ids.size();
    list.push_back({std::move(suppression), std::vector<bool>(count)});
  }
}

std::vector<Suppressions::Known>& Suppressions::inFile(const std::string& file) {
  if (!files_.contains(file)) add(file, sourcesOnDisk()(file).value_or(""));
  return files_[file];
}

std::vector<SuppressedDiagnostic> Suppressions::apply(std::vector<Diagnostic>& diagnostics) {
  std::vector<SuppressedDiagnostic> result;
  const auto accepts = [&](Diagnostic& d) {
    if (d.severity == Severity::error || d.line <= 0 || !d.id.starts_with('Q')) return false;
    for (Known& known : inFile(d.file)) {
      const Suppression& s = known.suppression;
      const auto id = std::ranges::find(s.ids, d.id);
      if (s.line != d.line || id == s.ids.end()) continue;
      known.used[static_cast<std::size_t>(id - s.ids.begin())] = true;
      result.push_back({std::move(d), s.location, s.reason});
      return true;
    }
    return false;
  };
  std::vector<Diagnostic> kept;
  for (Diagnostic& d : diagnostics)
    if (!accepts(d)) kept.push_back(std::move(d));
  diagnostics = std::move(kept);
  return result;
}

std::vector<Diagnostic> Suppressions::problems(bool hasScene) const {
  std::vector<Diagnostic> result;
  const auto add = [&](std::string_view id, const SourceLocation& location, std::string text) {
    result.push_back({findDiagnostic(id)->severity, location.file, location.line, location.column, std::string(id),
                      std::move(text)});
  };
  for (const auto& [file, list] : files_) {
    for (const Known& known : list) {
      const Suppression& s = known.suppression;
      if (!s.problem.empty()) {
        add("Q804", s.location, "this comment suppresses nothing: " + s.problem);
        continue;
      }
      for (std::size_t i = 0; i < s.ids.size(); ++i)
        if (!known.used[i] && !canStayUnused(s.ids[i], hasScene))
          add("Q803", s.location,
              fmt::format("this comment allows {} in line {}, where it is not reported", s.ids[i], s.line));
    }
  }
  return result;
}

}  // namespace quintet::check
