// SPDX-License-Identifier: Apache-2.0
// SARIF: the properties that the standard requires, rules, locations, columns and suppressions.
#include "check/sarif.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "check/catalog.h"

namespace quintet::check {
namespace {

using Json = nlohmann::json;
using Names = std::set<std::string>;

// The schema of SARIF 2.1.0, as far as our logs use it: properties that an object must have, and those that it may have.
void expectObject(const Json& object, const Names& required, const Names& optional = {}) {
  ASSERT_TRUE(object.is_object()) << object;
  for (const std::string& name : required) EXPECT_TRUE(object.contains(name)) << name << " in " << object;
  for (const auto& [name, value] : object.items())
    EXPECT_TRUE(required.contains(name) || optional.contains(name)) << name << " in " << object;
}

void expectText(const Json& message, const Names& optional = {}) {
  expectObject(message, {"text"}, optional);
  for (const auto& [name, value] : message.items()) EXPECT_FALSE(value.get<std::string>().empty()) << name;
}

void expectLocation(const Json& location) {
  expectObject(location, {"physicalLocation"}, {"message"});
  if (location.contains("message")) expectText(location["message"]);
  const Json& physical = location.at("physicalLocation");
  expectObject(physical, {"artifactLocation"}, {"region"});
  const Json& artifact = physical.at("artifactLocation");
  expectObject(artifact, {"uri"}, {"uriBaseId"});
  EXPECT_EQ(artifact.at("uri").get<std::string>().find_first_of(" <>{}\\\"^`"), std::string::npos) << artifact;
  if (!physical.contains("region")) return;
  expectObject(physical["region"], {"startLine"}, {"startColumn"});
  for (const auto& [name, value] : physical["region"].items()) EXPECT_GE(value.get<int>(), 1) << name;
}

void expectRule(const Json& rule) {
  expectObject(rule, {"id"}, {"shortDescription", "fullDescription", "help", "defaultConfiguration"});
  expectText(rule.at("shortDescription"));
  expectText(rule.at("fullDescription"));
  expectText(rule.at("help"), {"markdown"});
  expectObject(rule.at("defaultConfiguration"), {"level"});
}

void expectResult(const Json& result, std::size_t ruleCount) {
  expectObject(result, {"message", "level", "locations", "suppressions"}, {"ruleId", "ruleIndex", "relatedLocations"});
  EXPECT_TRUE((Names{"error", "warning", "note"}).contains(result.at("level"))) << result;
  if (result.contains("ruleIndex")) {
    EXPECT_LT(result["ruleIndex"].get<std::size_t>(), ruleCount);
  }
  expectText(result.at("message"));
  for (const Json& location : result.at("locations")) expectLocation(location);
  const Json related = result.value("relatedLocations", Json::array());
  for (const Json& location : related) {
    expectLocation(location);
    EXPECT_EQ(std::ranges::count(related, location), 1) << location;
  }
  for (const Json& suppression : result.at("suppressions")) {
    expectObject(suppression, {"kind"}, {"justification", "location"});
    EXPECT_THAT(suppression.at("kind"), testing::AnyOf(Json("inSource"), Json("external")));
    expectLocation(suppression.at("location"));
  }
}

void expectLog(const Json& log) {
  expectObject(log, {"$schema", "version", "runs"});
  EXPECT_EQ(log.at("version"), "2.1.0");
  ASSERT_EQ(log.at("runs").size(), 1u);
  const Json& run = log["runs"][0];
  expectObject(run, {"tool", "results"}, {"columnKind", "invocations"});
  ASSERT_EQ(run.at("invocations").size(), 1u);
  expectObject(run["invocations"][0], {"executionSuccessful"}, {});
  EXPECT_EQ(run.at("columnKind"), "unicodeCodePoints");
  expectObject(run.at("tool"), {"driver"});
  const Json& driver = run["tool"].at("driver");
  expectObject(driver, {"name"}, {"version", "rules"});
  for (const Json& rule : driver.at("rules")) expectRule(rule);
  for (const Json& result : run.at("results")) expectResult(result, driver["rules"].size());
}

// The log of these diagnostics, which is valid.
Json sarif(const std::vector<Diagnostic>& diagnostics, const std::vector<SuppressedDiagnostic>& suppressed = {},
           bool complete = true) {
  const SourceLookup sources = [](const std::string& file) {
    return file == "a b.rgen" ? std::optional<std::string>("\xc3\xa4\xc3\xb6 trace\n") : std::nullopt;
  };
  const Json log = Json::parse(sarifText(diagnostics, suppressed, sources, "1.2.3", complete));
  expectLog(log);
  return log;
}

TEST(Sarif, IsALogOfOneRun) {
  const Json log = sarif({});
  const Json& run = log["runs"][0];
  EXPECT_EQ(run.at("tool").at("driver").at("name"), "quintet");
  EXPECT_EQ(run["tool"]["driver"].at("version"), "1.2.3");
  EXPECT_EQ(run.at("results"), Json::array());
}

TEST(Sarif, StatesWhetherItIsComplete) {
  EXPECT_EQ(sarif({}, {}, true)["runs"][0]["invocations"][0]["executionSuccessful"], true);
  EXPECT_EQ(sarif({}, {}, false)["runs"][0]["invocations"][0]["executionSuccessful"], false);
}

TEST(Sarif, HasTheRulesOfItsResults) {
  const Json run = sarif({{Severity::error, "x.rgen", 3, 0, "Q101", "bad"},
                          {Severity::warning, "x.rgen", 4, 0, "Q604", "odd"},
                          {Severity::error, "x.rgen", 5, 0, "Q101", "bad"},
                          {Severity::error, "x.rgen", 6, 0, "GLSL", "syntax"}})["runs"][0];
  const Json& rules = run["tool"]["driver"]["rules"];
  ASSERT_EQ(rules.size(), 2u);
  for (const Json& result : run["results"]) {
    if (result["ruleId"] == "GLSL") {
      EXPECT_FALSE(result.contains("ruleIndex"));
    } else {
      EXPECT_EQ(rules[result["ruleIndex"].get<std::size_t>()]["id"], result["ruleId"]);
    }
  }
  EXPECT_EQ(rules[1]["shortDescription"]["text"], findDiagnostic("Q604")->title);
  EXPECT_EQ(rules[1]["defaultConfiguration"]["level"], "warning");
  EXPECT_EQ(rules[1]["help"]["text"], findDiagnostic("Q604")->fix);
  EXPECT_EQ(rules[1]["help"]["markdown"], explanation("Q604"));
}

TEST(Sarif, HasBothLocations) {
  Diagnostic d{Severity::error, "a b.rgen", 1, 6, "Q101", "bad"};
  d.related = {{"/programs/sky.rmiss", 4, 7, "received here"}, {"<quintet/hit.glsl>", 2, 0, "included"}};
  const Json result = sarif({d})["runs"][0]["results"][0];
  const Json& at = result["locations"][0]["physicalLocation"];
  EXPECT_EQ(at["artifactLocation"]["uri"], "a%20b.rgen");
  EXPECT_EQ(at["region"]["startLine"], 1);
  EXPECT_EQ(at["region"]["startColumn"], 4);  // the line starts with two characters of two bytes
  const Json& related = result["relatedLocations"];
  ASSERT_EQ(related.size(), 2u);
  EXPECT_EQ(related[0]["message"]["text"], "received here");
  EXPECT_EQ(related[0]["physicalLocation"]["artifactLocation"]["uri"], "file:///programs/sky.rmiss");
  EXPECT_EQ(related[0]["physicalLocation"]["region"]["startColumn"], 7);
  EXPECT_EQ(related[1]["physicalLocation"]["artifactLocation"]["uri"], "quintet/hit.glsl");
  EXPECT_FALSE(related[1]["physicalLocation"]["region"].contains("startColumn"));
}

// Every rule of the catalog is valid, with its page.
TEST(Sarif, HasAnyRule) {
  std::vector<Diagnostic> all;
  for (const DiagnosticInfo& info : allDiagnostics())
    all.push_back({info.severity, "x.rgen", 1, 1, std::string(info.id), "bad"});
  EXPECT_EQ(sarif(all)["runs"][0]["tool"]["driver"]["rules"].size(), all.size());
}

// Braces are placeholders otherwise.
TEST(Sarif, DoublesBracesOfMessages) {
  Diagnostic d{Severity::error, "{x}.rgen", 1, 1, "Q101", "sent as struct P { vec3 c; }"};
  d.related = {{"x.rmiss", 2, 1, "received as struct P { vec4 c; }"}};
  const Json result = sarif({d})["runs"][0]["results"][0];
  EXPECT_EQ(result["message"]["text"], "sent as struct P {{ vec3 c; }}");
  EXPECT_EQ(result["relatedLocations"][0]["message"]["text"], "received as struct P {{ vec4 c; }}");
  EXPECT_EQ(result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"], "%7Bx%7D.rgen");
}

TEST(Sarif, OmitsUnknownLocations) {
  const Json results = sarif(
      {{Severity::error, "x.rgen", 0, 0, "Q001", "bad"}, {Severity::note, "", 0, 0, "", "so"}})["runs"][0]["results"];
  EXPECT_FALSE(results[0]["locations"][0]["physicalLocation"].contains("region"));
  EXPECT_TRUE(results[1]["locations"].empty());
  EXPECT_FALSE(results[1].contains("ruleId"));
}

TEST(Sarif, ListsSuppressedResults) {
  const Diagnostic d{Severity::warning, "a.rgen", 3, 1, "Q604", "odd"};
  const Json results = sarif({d}, {{d, {"a.rgen", 2, 3}, "leaves are solid"}})["runs"][0]["results"];
  ASSERT_EQ(results.size(), 2u);
  EXPECT_TRUE(results[0]["suppressions"].empty());
  const Json& suppression = results[1]["suppressions"][0];
  EXPECT_EQ(suppression["kind"], "inSource");
  EXPECT_EQ(suppression["justification"], "leaves are solid");
  EXPECT_EQ(suppression["location"]["physicalLocation"]["region"]["startLine"], 2);
  const Json listed = sarif({}, {{d, {"accepted.txt", 2, 1}, "", false}})["runs"][0]["results"];  // of a list
  EXPECT_EQ(listed[0]["suppressions"][0]["kind"], "external");
}

}  // namespace
}  // namespace quintet::check
