// SPDX-License-Identifier: Apache-2.0
// The catalog of diagnostics: unique sorted ids, texts, pages, and the rule that reports each id.
#include "check/catalog.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "base/file.h"

namespace quintet::check {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

const fs::path kRoot = QUINTET_SOURCE_ROOT;

TEST(DiagnosticCatalog, HasSortedUniqueIds) {
  const auto all = allDiagnostics();
  ASSERT_GT(all.size(), 40u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_TRUE(std::regex_match(std::string(all[i].id), std::regex("Q[0-9]{3}"))) << all[i].id;
    if (i > 0) {
      EXPECT_LT(all[i - 1].id, all[i].id);
    }
  }
}

TEST(DiagnosticCatalog, HasTitleReasonAndFixForEachId) {
  for (const DiagnosticInfo& info : allDiagnostics()) {
    EXPECT_GT(info.title.size(), 10u) << info.id;
    EXPECT_NE(info.title.back(), '.') << info.id;
    EXPECT_GT(info.why.size(), 20u) << info.id;
    EXPECT_EQ(info.why.back(), '.') << info.id;
    EXPECT_GT(info.fix.size(), 10u) << info.id;
    EXPECT_EQ(info.fix.back(), '.') << info.id;
  }
}

TEST(DiagnosticCatalog, KeywordsAreNotInTheTitle) {
  for (const DiagnosticInfo& info : allDiagnostics()) {
    const std::string title = " " + std::string(info.title) + " ";
    std::istringstream keywords{std::string(info.keywords)};
    for (std::string word; keywords >> word;)
      EXPECT_EQ(title.find(" " + word + " "), std::string::npos) << info.id << ' ' << word;
  }
}

TEST(DiagnosticCatalog, FindsIdsIgnoringCase) {
  for (const DiagnosticInfo& info : allDiagnostics()) EXPECT_EQ(findDiagnostic(info.id), &info);
  ASSERT_NE(findDiagnostic("q101"), nullptr);
  EXPECT_EQ(findDiagnostic("q101")->id, "Q101");
  EXPECT_EQ(findDiagnostic("q101")->severity, Severity::error);
  EXPECT_EQ(findDiagnostic("Q102")->severity, Severity::note);
  EXPECT_EQ(findDiagnostic("Q999"), nullptr);
  EXPECT_EQ(findDiagnostic("Q10"), nullptr);
  EXPECT_EQ(findDiagnostic("Q1011"), nullptr);
  EXPECT_EQ(findDiagnostic(""), nullptr);
}

TEST(DiagnosticCatalog, HasAPageWithAllSectionsForEachId) {
  for (const DiagnosticInfo& info : allDiagnostics()) {
    const std::string page(explanation(info.id));
    EXPECT_THAT(page, StartsWith("# " + std::string(info.id) + ": " + std::string(info.title) + "\n"));
    std::string severity(severityName(info.severity));
    severity.front() = static_cast<char>(std::toupper(severity.front()));
    EXPECT_THAT(page, HasSubstr("\n*" + severity + ".*\n")) << info.id;
    std::size_t at = 0;
    for (const char* part : {"\n## Example\n", "\n```", "\n## Why it matters\n", "\n## Fix\n", "\n## References\n"}) {
      at = page.find(part, at);
      ASSERT_NE(at, std::string::npos) << info.id << " has no " << part << " in this order";
    }
  }
  EXPECT_TRUE(explanation("Q999").empty());
  EXPECT_TRUE(explanation("README").empty());
}

TEST(DiagnosticCatalog, ListsEachPage) {
  const std::string list = readTextFile(kRoot / "docs/diagnostics/README.md");
  std::size_t pages = 0;
  for (const auto& entry : fs::directory_iterator(kRoot / "docs/diagnostics")) {
    const std::string name = entry.path().stem().string();
    if (name == "README") continue;
    ++pages;
    const DiagnosticInfo* info = findDiagnostic(name);
    ASSERT_NE(info, nullptr) << name;
    const std::string link = "| [" + name + "](" + name + ".md) | ";
    const std::size_t row = list.find(link);
    ASSERT_NE(row, std::string::npos) << name << " is not in docs/diagnostics/README.md";
    EXPECT_THAT(list.substr(row, list.find('\n', row) - row), HasSubstr("| " + std::string(info->title) + " |"));
  }
  EXPECT_EQ(pages, allDiagnostics().size());
}

TEST(DiagnosticCatalog, HasAllIdsOfTheSources) {
  const std::regex literal("\"(Q[0-9]{3})\"");
  std::set<std::string> used;
  for (const char* folder : {"src", "apps"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      const std::string text = readTextFile(entry.path());
      for (std::sregex_iterator i(text.begin(), text.end(), literal), end; i != end; ++i) used.insert((*i)[1]);
    }
  }
  for (const std::string& id : used)
    EXPECT_NE(findDiagnostic(id), nullptr) << id << " is reported, but not in the catalog";
}

TEST(DiagnosticCatalog, NamesTheFileThatReportsEachId) {
  const fs::path folder = kRoot / "src/check/rules";
  std::map<std::string, std::string> rules;  // file without extension, relative to the folder -> text
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".cpp")
      rules[fs::relative(entry.path(), folder).replace_extension().generic_string()] = readTextFile(entry.path());
  for (const DiagnosticInfo& info : allDiagnostics()) {
    const std::string rule(info.rule), literal = '"' + std::string(info.id) + '"';
    const std::string text =
        rules.contains(rule) ? rules.at(rule) : readTextFile(kRoot / "src" / fs::path(rule).concat(".cpp"));
    // The instrumented run formats its ids.
    const bool formatted = info.id < "Q010" && text.find("\"Q00{}\"") != std::string::npos;
    EXPECT_TRUE(formatted || text.find(literal) != std::string::npos) << rule << " does not report " << info.id;
    for (const auto& [other, otherText] : rules) {
      const bool mentions = other != rule && otherText.find(literal) != std::string::npos;
      EXPECT_FALSE(mentions) << other << " mentions " << info.id;
    }
  }
}

}  // namespace
}  // namespace quintet::check
