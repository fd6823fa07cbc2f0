// SPDX-License-Identifier: Apache-2.0
// Values and lines of TOML documents, and the rejection of dotted keys that would overflow the parser's stack.
#include "base/toml_value.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace quintet {
namespace {

// A dotted key of `parts` parts.
std::string key(int parts, const std::string& part = "a") {
  std::string text = part;
  for (int i = 1; i < parts; ++i) text += "." + part;
  return text;
}

// The line of the error about a deep key; 0 if the text parses or has another error.
int lineOfDeepKey(const std::string& text) {
  try {
    parseToml(text, "t.toml");
  } catch (const FileError& error) {
    if (error.problem() == "more than 16 dots in a key") return std::stoi(error.location().substr(5));
  }
  return 0;
}

TEST(TomlValue, HoldsValuesOfEveryKindWithTheirLines) {
  const TomlValue root =
      parseToml("z = 1\n\na = true\nt = { r = 1.5, s = 'x' }\n\nl = [1,\n2]\n[x.y]\nk = 1\n", "t.toml");
  ASSERT_EQ(root.members.size(), 5u);
  EXPECT_EQ(root.members[0].key, "a");
  EXPECT_TRUE(root.find("a")->boolean);
  EXPECT_EQ(root.find("a")->line, 3);
  EXPECT_EQ(root.find("z")->integer, 1);
  EXPECT_EQ(root.find("z")->real, 1.0);
  EXPECT_EQ(root.find("t")->find("r")->real, 1.5);
  EXPECT_EQ(root.find("t")->find("s")->text, "x");
  EXPECT_EQ(root.find("t")->find("s")->line, 4);
  EXPECT_EQ(root.find("l")->elements[1].line, 7);
  EXPECT_EQ(root.find("x")->find("y")->find("k")->line, 9);
  EXPECT_EQ(root.find("none"), nullptr);
}

TEST(TomlValue, ReportsSyntaxErrorsDatesAndDeepNestingWithTheirLine) {
  const auto place = [](const std::string& text) {
    try {
      parseToml(text, "t.toml");
    } catch (const FileError& error) {
      return error.location();
    }
    return std::string("none");
  };
  EXPECT_EQ(place("a = 1\n\nb = \n"), "line 3");
  EXPECT_EQ(place("a = 1\nb = 1979-05-27\n"), "line 2");
  std::string nested = "1";
  for (int i = 0; i < 250; ++i) nested = "{ " + key(kMaxTomlKeyDots + 1) + " = " + nested + " }";
  EXPECT_EQ(place("\nb = " + nested + "\n"), "line 2");
}

TEST(TomlDeepKey, ReportsItsLine) {
  const std::string deep = key(kMaxTomlKeyDots + 2), fine = key(kMaxTomlKeyDots + 1);
  EXPECT_EQ(lineOfDeepKey(fine + " = 1\n"), 0);
  EXPECT_EQ(lineOfDeepKey(deep + " = 1\n"), 1);
  EXPECT_EQ(lineOfDeepKey("x = 1\n[" + deep + "]\n"), 2);
  EXPECT_EQ(lineOfDeepKey("x = 1\n\n[[" + deep + "]]\n"), 3);
  EXPECT_EQ(lineOfDeepKey("x = [ 1,\n { " + deep + " = 1 } ]"), 2);
  EXPECT_EQ(lineOfDeepKey("x = { " + fine + " = 1, " + fine + " = 2 }"), 0);
}

TEST(TomlDeepKey, CountsQuotedPartsAsOne) {
  const int deep = kMaxTomlKeyDots + 2;
  EXPECT_EQ(lineOfDeepKey(key(deep, "\"a,=[]{}\"") + " = 1"), 1);
  EXPECT_EQ(lineOfDeepKey(key(deep, "'a,=[]{}#\\'") + " = 1"), 1);
  EXPECT_EQ(lineOfDeepKey(key(deep, "\"\\\"\\\\\"") + " = 1"), 1);
  EXPECT_EQ(lineOfDeepKey(key(deep, " a ") + " = 1"), 1);
  EXPECT_EQ(lineOfDeepKey("\"" + key(100) + "\" = 1"), 0) << "one part that contains dots";
}

TEST(TomlDeepKey, IgnoresDotsOfNumbersStringsAndComments) {
  std::string numbers = "x = [";
  for (int i = 0; i < 1000; ++i) numbers += "1.5, ";
  EXPECT_EQ(lineOfDeepKey(numbers + "]"), 0);
  const std::string dots(1000, '.');
  EXPECT_EQ(lineOfDeepKey("x = \"" + dots + "\""), 0);
  EXPECT_EQ(lineOfDeepKey("x = '" + dots + "'"), 0);
  EXPECT_EQ(lineOfDeepKey("# it's" + dots + "\n"), 0);
  EXPECT_EQ(lineOfDeepKey("x = \"\"\"\n" + dots + "\n\"" + dots + "\\\"\"\"" + "\"\"\"\n"), 0);
  EXPECT_EQ(lineOfDeepKey("x = '''\n" + dots + "\n'" + dots + "'''''\n"), 0);
}

TEST(TomlDeepKey, CountsLinesInStrings) {
  EXPECT_EQ(lineOfDeepKey("x = \"\"\"\n\n\"\"\"\n" + key(100) + " = 1"), 4);
  EXPECT_EQ(lineOfDeepKey("x = \"not closed\n" + key(100) + " = 1"), 2);
}

TEST(TomlDeepKey, AcceptsTextThatEndsAnywhere) {
  const std::string text = "a.\"b\\\"\".'c' = \"\"\"x\"\"\" # y";
  for (std::size_t length = 0; length <= text.size(); ++length) EXPECT_EQ(lineOfDeepKey(text.substr(0, length)), 0);
  EXPECT_EQ(lineOfDeepKey("\"\\"), 0);
}

}  // namespace
}  // namespace quintet
