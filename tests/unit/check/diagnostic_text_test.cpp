// SPDX-License-Identifier: Apache-2.0
// Text and JSON of diagnostics: location, source line, caret, order, limit, keys.
#include "check/diagnostic_text.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace quintet::check {
namespace {

SourceLookup oneFile(std::string text) {
  return [text = std::move(text)](const std::string& file) {
    return file == "a.rgen" ? std::optional(text) : std::nullopt;
  };
}

TEST(DiagnosticText, HasASourceLineAndACaret) {
  const std::vector<Diagnostic> one{{Severity::error, "a.rgen", 2, 3, "Q101", "bad thing"}};
  EXPECT_EQ(diagnosticsText(one, oneFile("first\n\tsecond\nthird\n")),
            "a.rgen:2:3: error: bad thing [Q101]\n"
            "    2 | \tsecond\n"
            "      | \t ^\n");
}

TEST(DiagnosticText, OmitsTheCaretWithoutAColumn) {
  const std::vector<Diagnostic> one{{Severity::warning, "a.rgen", 3, 0, "", "odd"}};
  EXPECT_EQ(diagnosticsText(one, oneFile("first\nsecond\nthird")),
            "a.rgen:3: warning: odd\n"
            "    3 | third\n");
}

// The caret counts characters, not bytes. Control characters do not reach the terminal.
TEST(DiagnosticText, AlignsTheCaretAfterMultibyteCharacters) {
  const std::vector<Diagnostic> one{{Severity::error, "a.rgen", 1, 5, "", "x\x1b[31m"}};
  EXPECT_EQ(diagnosticsText(one, oneFile("\xc3\xa4\xc3\xb6z\x1b\r\n")),
            "a.rgen:1:5: error: x?[31m\n"
            "    1 | \xc3\xa4\xc3\xb6z?\n"
            "      |   ^\n");
}

TEST(DiagnosticText, OmitsUnknownSourceLines) {
  const SourceLookup sources = oneFile("one\n");
  for (const Diagnostic& d :
       {Diagnostic{Severity::error, "a.rgen", 7, 1, "", "x"}, Diagnostic{Severity::error, "b.rgen", 1, 1, "", "x"},
        Diagnostic{Severity::error, "a.rgen", 0, 0, "", "x"}, Diagnostic{Severity::error, "", 0, 0, "", "x"}})
    EXPECT_EQ(diagnosticsText({d}, sources), d.format() + "\n");
  EXPECT_EQ(diagnosticsText({{Severity::error, "a.rgen", 1, 99, "", "x"}}, sources),
            "a.rgen:1:99: error: x\n    1 | one\n");
}

TEST(DiagnosticText, ShowsTwentyWithErrorsFirst) {
  std::vector<Diagnostic> many(15, {Severity::note, "n", 0, 0, "", "n"});
  many.insert(many.end(), 15, {Severity::error, "e", 0, 0, "", "e"});
  const std::string text = diagnosticsText(many, sourcesOnDisk());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 21);
  EXPECT_TRUE(text.starts_with("e: error: e\n"));
  EXPECT_TRUE(text.ends_with("... and 10 more\n"));
}

TEST(DiagnosticText, UsesColorOnRequest) {
  const std::vector<Diagnostic> one{{Severity::error, "a.rgen", 1, 1, "GLSL", "error: error: twice"}};
  EXPECT_EQ(diagnosticsText(one, oneFile("x")).find('\x1b'), std::string::npos);
  const std::string colored = diagnosticsText(one, oneFile("x"), {.color = true});
  EXPECT_TRUE(colored.starts_with("\x1b[1ma.rgen:1:1: \x1b[0m\x1b[1;31merror: \x1b[0merror: error: twice [GLSL]\n"))
      << colored;
}

TEST(DiagnosticText, WritesJson) {
  const auto json = nlohmann::json::parse(diagnosticsJson(
      {{Severity::error, "a.rgen", 2, 3, "Q101", "bad \"thing\""}, {Severity::note, "", 0, 0, "GLSL", "x"}}));
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["severity"], "error");
  EXPECT_EQ(json[0]["file"], "a.rgen");
  EXPECT_EQ(json[0]["line"], 2);
  EXPECT_EQ(json[0]["column"], 3);
  EXPECT_EQ(json[0]["text"], "bad \"thing\"");
  EXPECT_FALSE(json[0]["why"].get<std::string>().empty());
  EXPECT_FALSE(json[0]["fix"].get<std::string>().empty());
  EXPECT_FALSE(json[1].contains("why"));
  EXPECT_EQ(diagnosticsJson({}), "[]\n");
}

}  // namespace
}  // namespace quintet::check
