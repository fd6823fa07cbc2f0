// SPDX-License-Identifier: Apache-2.0
#include "check/sarif.h"

#include <algorithm>
#include <cctype>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/wrap.h"
#include "check/catalog.h"
#include "check/sources.h"
#include "spirv/source_text.h"

namespace quintet::check {
namespace {

using Json = nlohmann::ordered_json;

// Returns a path as a URI reference: bytes other than unreserved characters and '/' are percent-encoded.
std::string uriOf(std::string_view path) {
  std::string uri = path.starts_with('/') ? "file://" : "";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain =
        byte < 0x80 && (std::isalnum(byte) || std::string_view("-._~/").find(c) != std::string_view::npos);
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
  }
  return uri;
}

Json artifactOf(const std::string& file) {
  const std::string path = withoutBrackets(file);
  if (path != file) return {{"uri", uriOf(path)}, {"uriBaseId", "SHADER_LIBRARY"}};
  return {{"uri", uriOf(file)}};
}

// SARIF 2.1.0, section 3.11.5: braces enclose placeholders, so those of a text are doubled.
Json messageOf(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped.append(c == '{' || c == '}' ? 2 : 1, c);
  return {{"text", escaped}};
}

class SarifRun {
 public:
  explicit SarifRun(const SourceLookup& sources) : sources_(sources) {}

  void add(const Diagnostic& d, const SuppressedDiagnostic* suppressed) {
    Json result;
    if (!d.id.empty()) result["ruleId"] = d.id;
    if (const DiagnosticInfo* info = findDiagnostic(d.id)) result["ruleIndex"] = indexOf(*info);
    result["level"] = severityName(d.severity);
    result["message"] = messageOf(d.text);
    result["locations"] = Json::array();
    if (!d.file.empty()) result["locations"].push_back(locationOf(d.file, d.line, d.column));
    for (const RelatedLocation& r : d.related) {
      Json location = locationOf(r.file, r.line, r.column);
      location["message"] = messageOf(r.text);
      result["relatedLocations"].push_back(std::move(location));
    }
    if (suppressed) {
      Json entry{{"kind", suppressed->inSource ? "inSource" : "external"}};
      if (!suppressed->reason.empty()) entry["justification"] = suppressed->reason;
      const SourceLocation& comment = suppressed->comment;
      entry["location"] = locationOf(comment.file, comment.line, comment.column);
      result["suppressions"].push_back(std::move(entry));
    } else {
      result["suppressions"] = Json::array();  // "not suppressed", once another result of the run is
    }
    results_.push_back(std::move(result));
  }

  Json take(const std::string& version, bool complete) {
    Json driver{{"name", "quintet"}, {"version", version}, {"rules", rules_}};
    return {{"tool", {{"driver", std::move(driver)}}},
            {"columnKind", "unicodeCodePoints"},
            {"invocations", Json::array({Json{{"executionSuccessful", complete}}})},
            {"results", std::move(results_)}};
  }

 private:
  std::size_t indexOf(const DiagnosticInfo& info) {
    const auto [found, isNew] = indices_.try_emplace(info.id, rules_.size());
    if (!isNew) return found->second;
    Json help{{"text", info.fix}};
    if (const std::string_view page = explanation(info.id); !page.empty()) help["markdown"] = page;
    rules_.push_back({{"id", info.id},
                      {"shortDescription", {{"text", info.title}}},
                      {"fullDescription", {{"text", info.why}}},
                      {"help", std::move(help)},
                      {"defaultConfiguration", {{"level", severityName(info.severity)}}}});
    return found->second;
  }

  Json locationOf(const std::string& file, int line, int column) {
    Json physical{{"artifactLocation", artifactOf(file)}};
    if (line > 0) {
      physical["region"] = {{"startLine", line}};
      if (column > 0) physical["region"]["startColumn"] = codePoints(file, line, column);
    }
    return {{"physicalLocation", std::move(physical)}};
  }

  // Converts a column in bytes.
  std::size_t codePoints(const std::string& file, int line, int column) {
    const auto [found, isNew] = texts_.try_emplace(file);
    if (isNew) found->second = sources_(file).value_or("");
    const std::string_view before = spirv::lineOf(found->second, line).substr(0, static_cast<std::size_t>(column) - 1);
    const std::size_t missing = static_cast<std::size_t>(column) - 1 - before.size();
    return columnsOf(before) + missing + 1;
  }

  const SourceLookup& sources_;
  std::map<std::string_view, std::size_t> indices_;  // of rules_, by id
  std::map<std::string, std::string> texts_;
  Json rules_ = Json::array(), results_ = Json::array();
};

}  // namespace

std::string sarifText(const std::vector<Diagnostic>& diagnostics, const std::vector<SuppressedDiagnostic>& suppressed,
                      const SourceLookup& sources, const std::string& version, bool complete) {
  SarifRun run(sources);
  for (const Diagnostic& d : diagnostics) run.add(d, nullptr);
  for (const SuppressedDiagnostic& s : suppressed) run.add(s.diagnostic, &s);
  Json log{{"$schema", "https://json.schemastore.org/sarif-2.1.0.json"}, {"version", "2.1.0"}};
  log["runs"].push_back(run.take(version, complete));
  return log.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace quintet::check
