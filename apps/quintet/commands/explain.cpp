// SPDX-License-Identifier: Apache-2.0
// `quintet explain`: the pages of the diagnostics.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/suggestion.h"
#include "check/catalog.h"
#include "cli/option_table.h"

namespace quintet::cli {
namespace {

std::string listText() {
  std::string text;
  for (const check::DiagnosticInfo& info : check::allDiagnostics())
    text += fmt::format("{:<6}{:<9}{}\n", info.id, severityName(info.severity), info.title);
  return text;
}

nlohmann::ordered_json toJson(const check::DiagnosticInfo& info) {
  return {{"id", info.id},       {"severity", severityName(info.severity)},
          {"title", info.title}, {"why", info.why},
          {"fix", info.fix},     {"rule", info.rule}};
}

std::string listJson() {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (const check::DiagnosticInfo& info : check::allDiagnostics()) array.push_back(toJson(info));
  return array.dump() + "\n";
}

const check::DiagnosticInfo& find(const std::string& id) {
  if (const check::DiagnosticInfo* info = check::findDiagnostic(id)) return *info;
  std::vector<std::string> ids;
  for (const check::DiagnosticInfo& info : check::allDiagnostics()) ids.emplace_back(info.id);
  throw UsageError(fmt::format("unknown diagnostic '{}'{}; 'quintet explain' lists all", id, suggestion(id, ids)));
}

struct Options {
  std::optional<std::string> id;
  bool json = false;
};

OptionTable declare(Options& options) {
  std::vector<std::string> ids;
  for (const check::DiagnosticInfo& info : check::allDiagnostics()) ids.emplace_back(info.id);
  OptionTable table("explain", "Explains a diagnostic of the check, or lists all of them.");
  table.add({{.names = "ID",
              .help = "Id as in the message, e.g. Q101; without it, the list of all",
              .target = &options.id,
              .candidates = {.names = ids}},
             {.names = "--json", .help = "Print JSON instead of text", .target = &options.json}});
  table.addExamples({
      {"quintet explain", "every id, one line each"},
      {"quintet explain Q101", "what it means, why it matters, how to fix it"},
  });
  return table;
}

}  // namespace

OptionTable explainOptions() {
  Options options;
  return declare(options).withoutTargets();
}

int explainCommand(Arguments arguments) {
  Options options;
  if (!declare(options).parse(arguments)) return 0;
  if (!options.id) {
    writeFile("-", options.json ? listJson() : listText());
    return 0;
  }
  const check::DiagnosticInfo& info = find(*options.id);
  const std::string page(check::explanation(info.id));
  if (options.json) {
    nlohmann::ordered_json object = toJson(info);
    object["page"] = page;
    writeFile("-", object.dump() + "\n");
    return 0;
  }
  writeFile("-", page.empty() ? fmt::format("{}: {}\n\n{}\n{}\n", info.id, info.title, info.why, info.fix) : page);
  return 0;
}

}  // namespace quintet::cli
