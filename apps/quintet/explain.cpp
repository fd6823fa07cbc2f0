// `quintet explain`: the pages of the diagnostics.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "cli.h"
#include "program/diagnostic_catalog.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr const char* kExamples =
    "  quintet explain            every id, one line each\n"
    "  quintet explain Q101       what it means, why it matters, how to mend it\n";

std::string_view severityName(shader::Severity severity) {
  return severity == shader::Severity::error ? "error" : severity == shader::Severity::warning ? "warning" : "note";
}

std::string listText() {
  std::string text;
  for (const program::DiagnosticInfo& info : program::allDiagnostics())
    text += fmt::format("{:<6}{:<9}{}\n", info.id, severityName(info.severity), info.title);
  return text;
}

nlohmann::ordered_json toJson(const program::DiagnosticInfo& info) {
  return {{"id", info.id},
          {"severity", severityName(info.severity)},
          {"title", info.title},
          {"why", info.why},
          {"mend", info.mend}};
}

std::string listJson() {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (const program::DiagnosticInfo& info : program::allDiagnostics()) array.push_back(toJson(info));
  return array.dump() + "\n";
}

const program::DiagnosticInfo& find(const std::string& id) {
  if (const program::DiagnosticInfo* info = program::findDiagnostic(id)) return *info;
  std::vector<std::string> ids;
  for (const program::DiagnosticInfo& info : program::allDiagnostics()) ids.emplace_back(info.id);
  throw UsageError(fmt::format("no diagnostic '{}'{}; 'quintet explain' lists them", id, suggestion(id, ids)));
}

}  // namespace

int explainCommand(Arguments arguments) {
  CLI::App app("Explains a diagnostic of the check, or lists them all.", "quintet explain");
  std::string id;
  bool json = false;
  app.add_option("ID", id, "As in the message: Q101; none: the list")->type_name("");
  app.add_flag("--json", json, "JSON instead of text");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return 0;
  if (app.count("ID") == 0) {
    writeFile("-", json ? listJson() : listText());
    return 0;
  }
  const program::DiagnosticInfo& info = find(id);
  const std::string page(program::explanation(info.id));
  if (json) {
    nlohmann::ordered_json object = toJson(info);
    object["page"] = page;
    writeFile("-", object.dump() + "\n");
    return 0;
  }
  writeFile("-", page.empty() ? fmt::format("{}: {}\n\n{}\n{}\n", info.id, info.title, info.why, info.mend) : page);
  return 0;
}

}  // namespace quintet::app
