// Dotted keys that are too deep are found wherever TOML allows them, and nothing else is taken for one.
#include "base/toml_depth.h"

#include <gtest/gtest.h>

#include <string>

namespace quintet {
namespace {

std::string key(int parts, const std::string& part = "a") {
  std::string text = part;
  for (int i = 1; i < parts; ++i) text += "." + part;
  return text;
}

TEST(TomlDepth, FindsTheLineOfADeepKey) {
  const std::string deep = key(kMaxTomlKeyDots + 2), fine = key(kMaxTomlKeyDots + 1);
  EXPECT_EQ(deepTomlKey(fine + " = 1\n"), 0);
  EXPECT_EQ(deepTomlKey(deep + " = 1\n"), 1);
  EXPECT_EQ(deepTomlKey("x = 1\n[" + deep + "]\n"), 2);
  EXPECT_EQ(deepTomlKey("x = 1\n\n[[" + deep + "]]\n"), 3);
  EXPECT_EQ(deepTomlKey("x = [ 1,\n { " + deep + " = 1 } ]"), 2);
  EXPECT_EQ(deepTomlKey("x = { " + fine + " = 1, " + fine + " = 2 }"), 0);
}

TEST(TomlDepth, KnowsQuotedPartsOfKeys) {
  const int deep = kMaxTomlKeyDots + 2;
  EXPECT_EQ(deepTomlKey(key(deep, "\"a,=[]{}\"") + " = 1"), 1);
  EXPECT_EQ(deepTomlKey(key(deep, "'a,=[]{}#\\'") + " = 1"), 1);
  EXPECT_EQ(deepTomlKey(key(deep, "\"\\\"\\\\\"") + " = 1"), 1);
  EXPECT_EQ(deepTomlKey(key(deep, " a ") + " = 1"), 1);
  EXPECT_EQ(deepTomlKey("\"" + key(100) + "\" = 1"), 0) << "one part with dots in it";
}

TEST(TomlDepth, TakesNothingElseForAKey) {
  std::string numbers = "x = [";
  for (int i = 0; i < 1000; ++i) numbers += "1.5, ";
  EXPECT_EQ(deepTomlKey(numbers + "]"), 0);
  const std::string dots(1000, '.');
  EXPECT_EQ(deepTomlKey("x = \"" + dots + "\""), 0);
  EXPECT_EQ(deepTomlKey("x = '" + dots + "'"), 0);
  EXPECT_EQ(deepTomlKey("# it's" + dots + "\n"), 0);
  EXPECT_EQ(deepTomlKey("x = \"\"\"\n" + dots + "\n\"" + dots + "\\\"\"\"" + "\"\"\"\n"), 0);
  EXPECT_EQ(deepTomlKey("x = '''\n" + dots + "\n'" + dots + "'''''\n"), 0);
}

TEST(TomlDepth, CountsLinesInStrings) {
  EXPECT_EQ(deepTomlKey("x = \"\"\"\n\n\"\"\"\n" + key(100) + " = 1"), 4);
  EXPECT_EQ(deepTomlKey("x = \"not closed\n" + key(100) + " = 1"), 2);
}

TEST(TomlDepth, SurvivesAnyEnd) {
  const std::string text = "a.\"b\\\"\".'c' = \"\"\"x\"\"\" # y";
  for (std::size_t length = 0; length <= text.size(); ++length) EXPECT_EQ(deepTomlKey(text.substr(0, length)), 0);
  EXPECT_EQ(deepTomlKey("\"\\"), 0);
}

}  // namespace
}  // namespace quintet
