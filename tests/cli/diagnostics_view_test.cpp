// How diagnostics are shown: place, source line, caret; order, limit, JSON.
#include "diagnostics_view.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace quintet::app {
namespace {

using shader::Diagnostic;
using shader::Severity;

SourceLookup oneFile(std::string text) {
  return [text = std::move(text)](const std::string& file) {
    return file == "a.rgen" ? std::optional(text) : std::nullopt;
  };
}

TEST(DiagnosticsView, SourceLineAndCaret) {
  const std::vector<Diagnostic> one{{Severity::error, "a.rgen", 2, 3, "Q101", "bad thing"}};
  EXPECT_EQ(diagnosticsText(one, oneFile("first\n\tsecond\nthird\n"), false),
            "a.rgen:2:3: error: bad thing [Q101]\n"
            "    2 | \tsecond\n"
            "      | \t ^\n");
}

TEST(DiagnosticsView, NoColumnNoCaret) {
  const std::vector<Diagnostic> one{{Severity::warning, "a.rgen", 3, 0, "", "odd"}};
  EXPECT_EQ(diagnosticsText(one, oneFile("first\nsecond\nthird"), false),
            "a.rgen:3: warning: odd\n"
            "    3 | third\n");
}

// A caret stands under the character, not under its byte; control characters do not reach a terminal.
TEST(DiagnosticsView, CaretBehindUmlauts) {
  const std::vector<Diagnostic> one{{Severity::error, "a.rgen", 1, 5, "", "x\x1b[31m"}};
  EXPECT_EQ(diagnosticsText(one, oneFile("\xc3\xa4\xc3\xb6z\x1b\r\n"), false),
            "a.rgen:1:5: error: x?[31m\n"
            "    1 | \xc3\xa4\xc3\xb6z?\n"
            "      |   ^\n");
}

TEST(DiagnosticsView, PlacesThatDoNotExist) {
  const SourceLookup sources = oneFile("one\n");
  for (const Diagnostic& d :
       {Diagnostic{Severity::error, "a.rgen", 7, 1, "", "x"}, Diagnostic{Severity::error, "b.rgen", 1, 1, "", "x"},
        Diagnostic{Severity::error, "a.rgen", 0, 0, "", "x"}, Diagnostic{Severity::error, "", 0, 0, "", "x"}})
    EXPECT_EQ(diagnosticsText({d}, sources, false), d.format() + "\n");
  EXPECT_EQ(diagnosticsText({{Severity::error, "a.rgen", 1, 99, "", "x"}}, sources, false),
            "a.rgen:1:99: error: x\n    1 | one\n");
}

TEST(DiagnosticsView, ErrorsFirstAndTwentyOfThem) {
  std::vector<Diagnostic> many(15, {Severity::note, "n", 0, 0, "", "n"});
  many.insert(many.end(), 15, {Severity::error, "e", 0, 0, "", "e"});
  const std::string text = diagnosticsText(many, sourcesOnDisk(), false);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 21);
  EXPECT_TRUE(text.starts_with("e: error: e\n"));
  EXPECT_TRUE(text.ends_with("... and 10 more\n"));
}

TEST(DiagnosticsView, ColourOnlyWhenAsked) {
  const std::vector<Diagnostic> one{{Severity::error, "a.rgen", 1, 1, "GLSL", "error: error: twice"}};
  EXPECT_EQ(diagnosticsText(one, oneFile("x"), false).find('\x1b'), std::string::npos);
  const std::string colored = diagnosticsText(one, oneFile("x"), true);
  EXPECT_TRUE(colored.starts_with("\x1b[1ma.rgen:1:1: \x1b[0m\x1b[1;31merror: \x1b[0merror: error: twice [GLSL]\n"))
      << colored;
}

TEST(DiagnosticsView, Json) {
  const auto json = nlohmann::json::parse(diagnosticsJson(
      {{Severity::error, "a.rgen", 2, 3, "Q101", "bad \"thing\""}, {Severity::note, "", 0, 0, "GLSL", "x"}}));
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["severity"], "error");
  EXPECT_EQ(json[0]["file"], "a.rgen");
  EXPECT_EQ(json[0]["line"], 2);
  EXPECT_EQ(json[0]["column"], 3);
  EXPECT_EQ(json[0]["text"], "bad \"thing\"");
  EXPECT_FALSE(json[0]["why"].get<std::string>().empty());
  EXPECT_FALSE(json[0]["mend"].get<std::string>().empty());
  EXPECT_FALSE(json[1].contains("why"));
  EXPECT_EQ(diagnosticsJson({}), "[]\n");
}

TEST(DiagnosticsView, FileErrors) {
  const Diagnostic toml = asDiagnostic(FileError("p/program.toml", "line 12", "no such key"));
  EXPECT_EQ(toml.format(), "p/program.toml:12: error: no such key [FILE]");
  const Diagnostic gltf = asDiagnostic(FileError("s.gltf", "/nodes/0", "is bad"));
  EXPECT_EQ(gltf.format(), "s.gltf: error: /nodes/0: is bad [FILE]");
}

TEST(DiagnosticsView, Counts) {
  const Diagnostic e{Severity::error, "", 0, 0, "", ""}, w{Severity::warning, "", 0, 0, "", ""},
      n{Severity::note, "", 0, 0, "", ""};
  EXPECT_EQ(countText({e, w, w, n}), "1 error, 2 warnings");
  EXPECT_EQ(countText({w}), "1 warning");
  EXPECT_EQ(countText({n}), "");
}

}  // namespace
}  // namespace quintet::app
