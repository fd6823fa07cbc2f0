// SPDX-License-Identifier: Apache-2.0
// SARIF: the properties that the standard requires, rules, locations, columns and suppressions.
#include "check/sarif.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "check/catalog.h"

namespace quintet::check {
namespace {

nlohmann::json sarif(const std::vector<Diagnostic>& diagnostics, const std::vector<SuppressedDiagnostic>& suppressed = {}) {
  const SourceLookup sources = [](const std::string& file) {
    return file == "a b.rgen" ? std::optional<std::string>("\xc3\xa4\xc3\xb6 trace\n") : std::nullopt;
  };
  return nlohmann::json::parse(sarifText(diagnostics, suppressed, sources, "1.2.3"));
}

TEST(Sarif, IsALogOfOneRun) {
  const nlohmann::json log = sarif({});
  EXPECT_EQ(log.at("version"), "2.1.0");
  ASSERT_EQ(log.at("runs").size(), 1u);
  const nlohmann::json& run = log["runs"][0];
  EXPECT_EQ(run.at("tool").at("driver").at("name"), "quintet");
  EXPECT_EQ(run["tool"]["driver"].at("version"), "1.2.3");
  EXPECT_EQ(run.at("results"), nlohmann::json::array());
}

TEST(Sarif, HasTheRulesOfItsResults) {
  const nlohmann::json run = sarif({{Severity::error, "x.rgen", 3, 0, "Q101", "bad"},
                                    {Severity::warning, "x.rgen", 4, 0, "Q604", "odd"},
                                    {Severity::error, "x.rgen", 5, 0, "Q101", "bad"},
                                    {Severity::error, "x.rgen", 6, 0, "GLSL", "syntax"}})["runs"][0];
  const nlohmann::json& rules = run["tool"]["driver"]["rules"];
  ASSERT_EQ(rules.size(), 2u);
  for (const nlohmann::json& result : run["results"]) {
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
  d.related = {{"/tmp/sky.rmiss", 4, 7, "received here"}, {"<quintet/hit.glsl>", 2, 0, "included"}};
  const nlohmann::json result = sarif({d})["runs"][0]["results"][0];
  const nlohmann::json& at = result["locations"][0]["physicalLocation"];
  EXPECT_EQ(at["artifactLocation"]["uri"], "a%20b.rgen");
  EXPECT_EQ(at["region"]["startLine"], 1);
  EXPECT_EQ(at["region"]["startColumn"], 4);  // the line starts with two characters of two bytes
  const nlohmann::json& related = result["relatedLocations"];
  ASSERT_EQ(related.size(), 2u);
  EXPECT_EQ(related[0]["message"]["text"], "received here");
  EXPECT_EQ(related[0]["physicalLocation"]["artifactLocation"]["uri"], "file:///tmp/sky.rmiss");
  EXPECT_EQ(related[0]["physicalLocation"]["region"]["startColumn"], 7);
  EXPECT_EQ(related[1]["physicalLocation"]["artifactLocation"]["uri"], "quintet/hit.glsl");
  EXPECT_FALSE(related[1]["physicalLocation"]["region"].contains("startColumn"));
}

TEST(Sarif, OmitsUnknownLocations) {
  const nlohmann::json results =
      sarif({{Severity::error, "x.rgen", 0, 0, "Q001", "bad"}, {Severity::note, "", 0, 0, "", "so"}})["runs"][0]["results"];
  EXPECT_FALSE(results[0]["locations"][0]["physicalLocation"].contains("region"));
  EXPECT_TRUE(results[1]["locations"].empty());
  EXPECT_FALSE(results[1].contains("ruleId"));
}

TEST(Sarif, ListsSuppressedResults) {
  const Diagnostic d{Severity::warning, "a.rgen", 3, 1, "Q604", "odd"};
  const nlohmann::json results = sarif({d}, {{d, {"a.rgen", 2, 3}, "leaves are solid"}})["runs"][0]["results"];
  ASSERT_EQ(results.size(), 2u);
  EXPECT_TRUE(results[0]["suppressions"].empty());
  const nlohmann::json& suppression = results[1]["suppressions"][0];
  EXPECT_EQ(suppression["kind"], "inSource");
  EXPECT_EQ(suppression["justification"], "leaves are solid");
  EXPECT_EQ(suppression["location"]["physicalLocation"]["region"]["startLine"], 2);
}

}  // namespace
}  // namespace quintet::check
