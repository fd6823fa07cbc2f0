// SPDX-License-Identifier: Apache-2.0
// `quintet explain`: the pages of the diagnostics.
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "base/wrap.h"
#include "check/catalog.h"
#include "cli/parser.h"
#include "cli/terminal.h"

namespace quintet::cli {
namespace {

using Infos = std::vector<const check::DiagnosticInfo*>;

// Returns the words of a text in lower case and without a plural s: "any-hit shaders" has "any", "hit" and "shader".
std::set<std::string> wordsOf(std::string_view text) {
  const auto isPart = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
  std::set<std::string> words;
  for (auto at = text.begin(); at != text.end();) {
    const auto end = std::find_if_not(at, text.end(), isPart);
    std::string word = lowerCase({at, end});
    if (word.size() > 3 && word.ends_with('s')) word.pop_back();
    if (!word.empty()) words.insert(word);
    at = std::find_if(end, text.end(), isPart);
  }
  return words;
}

// Returns the diagnostics about a topic: those that have all its words in the title or the keywords, or ids that start
// with it. If there are none, those whose texts contain all words.
Infos search(const std::string& topic) {
  const std::set<std::string> words = wordsOf(topic);
  if (words.empty()) return {};
  Infos about, mentioning;
  for (const check::DiagnosticInfo& info : check::allDiagnostics()) {
    const std::string id = lowerCase(info.id);
    const std::set<std::string> subjects = wordsOf(fmt::format("{} {}", info.title, info.keywords));
    const std::string text = lowerCase(fmt::format("{} {} {}", info.why, info.fix, check::explanation(info.id)));
    if (std::ranges::all_of(words, [&](const auto& word) { return subjects.contains(word) || id.starts_with(word); }))
      about.push_back(&info);
    if (std::ranges::all_of(words, [&](const auto& word) { return text.find(word) != text.npos; }))
      mentioning.push_back(&info);
  }
  return about.empty() ? mentioning : about;
}

std::string listText(const Infos& infos) {
  const std::size_t width = terminalWidth(STDOUT_FILENO).value_or(std::string::npos);
  std::string text;
  for (const check::DiagnosticInfo* info : infos)
    text += twoColumns(fmt::format("{:<6}{}", info->id, severityName(info->severity)), info->title, 15, width);
  return text;
}

nlohmann::ordered_json toJson(const check::DiagnosticInfo& info) {
  return {{"id", info.id},       {"severity", severityName(info.severity)},
          {"title", info.title}, {"why", info.why},
          {"fix", info.fix},     {"rule", info.rule}};
}

std::string listJson(const Infos& infos) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (const check::DiagnosticInfo* info : infos) array.push_back(toJson(*info));
  return array.dump() + "\n";
}

// An id or a topic. At least one diagnostic.
Infos find(const std::string& text) {
  if (const check::DiagnosticInfo* info = check::findDiagnostic(text)) return {info};
  if (Infos found = search(text); !found.empty()) return found;
  std::vector<std::string> ids;
  for (const check::DiagnosticInfo& info : check::allDiagnostics()) ids.emplace_back(info.id);
  throw UsageError(
      fmt::format("unknown diagnostic '{}'{}; 'quintet explain' lists all", printable(text), suggestion(text, ids)));
}

void printPage(const check::DiagnosticInfo& info, bool json) {
  const std::string page(check::explanation(info.id));
  if (json) {
    nlohmann::ordered_json object = toJson(info);
    object["page"] = page;
    writeFile("-", object.dump() + "\n");
    return;
  }
  writeFile("-", page.empty() ? fmt::format("{}: {}\n\n{}\n{}\n", info.id, info.title, info.why, info.fix) : page);
}

struct ExplainOptions {
  std::vector<std::string> id;  // or words of a topic
  bool json = false;
};

OptionTable declareExplain(ExplainOptions& options) {
  std::vector<std::string> ids;
  for (const check::DiagnosticInfo& info : check::allDiagnostics()) ids.emplace_back(info.id);
  OptionTable table("explain", "Explains a diagnostic of the check, or lists all of them.");
  table.add({{.names = "ID|TOPIC",
              .help = "Id as in the message, e.g. Q101, or words to search for; without it, the list of all",
              .target = &options.id,
              .candidates = {.names = ids}},
             {.names = "--json", .help = "Print JSON instead of text", .target = &options.json}});
  table.addExamples({
      {"quintet explain", "every id, one line each"},
      {"quintet explain Q101", "what it means, why it matters, how to fix it"},
      {"quintet explain payload", "the diagnostics about payloads"},
  });
  return table;
}

}  // namespace

OptionTable explainOptions() {
  ExplainOptions options;
  return declareExplain(options).withoutTargets();
}

int explainCommand(Arguments arguments) {
  ExplainOptions options;
  if (!parse(declareExplain(options), arguments)) return 0;
  Infos found;
  if (options.id.empty())
    for (const check::DiagnosticInfo& info : check::allDiagnostics()) found.push_back(&info);
  else
    found = find(fmt::format("{}", fmt::join(options.id, " ")));
  if (!options.id.empty() && found.size() == 1)
    printPage(*found.front(), options.json);
  else
    writeFile("-", options.json ? listJson(found) : listText(found));
  return 0;
}

}  // namespace quintet::cli
