// The catalogue of diagnostics: every id once, in order, with words and a page.
#include "program/diagnostic_catalog.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace quintet::program {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

const fs::path kRoot = QUINTET_SOURCE_ROOT;

std::string textOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(DiagnosticCatalog, IdsAreSortedAndUnique) {
  const auto all = allDiagnostics();
  ASSERT_GT(all.size(), 40u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_TRUE(std::regex_match(std::string(all[i].id), std::regex("Q[0-9]{3}"))) << all[i].id;
    if (i > 0) {
      EXPECT_LT(all[i - 1].id, all[i].id);
    }
  }
}

TEST(DiagnosticCatalog, EveryRowSaysWhatWhyAndHow) {
  for (const DiagnosticInfo& info : allDiagnostics()) {
    EXPECT_GT(info.title.size(), 10u) << info.id;
    EXPECT_NE(info.title.back(), '.') << info.id;
    EXPECT_GT(info.why.size(), 20u) << info.id;
    EXPECT_EQ(info.why.back(), '.') << info.id;
    EXPECT_GT(info.mend.size(), 10u) << info.id;
    EXPECT_EQ(info.mend.back(), '.') << info.id;
  }
}

TEST(DiagnosticCatalog, FindsAnIdInEitherCase) {
  for (const DiagnosticInfo& info : allDiagnostics()) EXPECT_EQ(findDiagnostic(info.id), &info);
  ASSERT_NE(findDiagnostic("q101"), nullptr);
  EXPECT_EQ(findDiagnostic("q101")->id, "Q101");
  EXPECT_EQ(findDiagnostic("q101")->severity, shader::Severity::error);
  EXPECT_EQ(findDiagnostic("Q102")->severity, shader::Severity::note);
  EXPECT_EQ(findDiagnostic("Q999"), nullptr);
  EXPECT_EQ(findDiagnostic("Q10"), nullptr);
  EXPECT_EQ(findDiagnostic("Q1011"), nullptr);
  EXPECT_EQ(findDiagnostic(""), nullptr);
}

std::string_view severityName(shader::Severity severity) {
  constexpr std::string_view kNames[] = {"Note", "Warning", "Error"};
  return kNames[static_cast<int>(severity)];
}

TEST(DiagnosticCatalog, EveryIdHasAPageWithAllParts) {
  for (const DiagnosticInfo& info : allDiagnostics()) {
    const std::string page(explanation(info.id));
    EXPECT_THAT(page, StartsWith("# " + std::string(info.id) + ": " + std::string(info.title) + "\n"));
    EXPECT_THAT(page, HasSubstr("\n*" + std::string(severityName(info.severity)) + ".*\n")) << info.id;
    for (const char* part : {"\n## Why it matters\n", "\n## Wrong\n", "\n## Repaired\n", "\n## References\n", "\n```"})
      EXPECT_THAT(page, HasSubstr(part)) << info.id;
  }
  EXPECT_TRUE(explanation("Q999").empty());
  EXPECT_TRUE(explanation("README").empty());
}

TEST(DiagnosticCatalog, EveryPageHasAnIdAndIsListed) {
  const std::string list = textOf(kRoot / "docs/diagnostics/README.md");
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

TEST(DiagnosticCatalog, NoIdOfTheSourceIsMissing) {
  const std::regex literal("\"(Q[0-9]{3})\"");
  std::set<std::string> used;
  for (const char* folder : {"src", "apps"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (entry.path().stem() == "diagnostic_catalog") continue;
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      const std::string text = textOf(entry.path());
      for (std::sregex_iterator i(text.begin(), text.end(), literal), end; i != end; ++i) used.insert((*i)[1]);
    }
  }
  for (const std::string& id : used)
    EXPECT_NE(findDiagnostic(id), nullptr) << id << " is reported, but not in the catalogue";
}

}  // namespace
}  // namespace quintet::program
