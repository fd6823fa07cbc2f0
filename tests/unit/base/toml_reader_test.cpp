// SPDX-License-Identifier: Apache-2.0
#include "base/toml_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "base/error.h"

namespace quintet {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Runs `use` on the document's table; returns "line N: problem", or "none".
std::string errorOf(const std::string& text, const std::function<void(TomlReader&)>& use) {
  const TomlValue root = parseToml(text, "t.toml");
  TomlReader reader(root, "[table]", "t.toml");
  try {
    use(reader);
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), "t.toml");
    return error.location() + ": " + error.problem();
  }
  return "none";
}

TEST(TomlReader, ReadsValuesAndFallbacks) {
  const TomlValue root = parseToml(
      "s = 'x'\nb = true\ni = 3\nf = 0.5\np = [1, 2]\nt = [1, 2, 3]\nc = 'two'\nl = ['a', 'b']\nn = { m = 1 }\n"
      "[[k]]\n[[k]]\n",
      "t.toml");
  TomlReader reader(root, "[table]", "t.toml");
  EXPECT_EQ(reader.text("s"), "x");
  EXPECT_EQ(reader.requiredText("s"), "x");
  EXPECT_TRUE(reader.boolean("b"));
  EXPECT_EQ(reader.integer("i", 0, 1, 3), 3u);
  EXPECT_EQ(reader.number("f", 0.0f), 0.5f);
  EXPECT_EQ(reader.number("i", 0.0), 3.0);
  EXPECT_EQ(reader.pair("p", vec2(0.0f)), vec2(1.0f, 2.0f));
  EXPECT_EQ(reader.triple("t", vec3(0.0f)), vec3(1.0f, 2.0f, 3.0f));
  EXPECT_EQ(reader.choice("c", {"one", "two"}, 0), 1u);
  EXPECT_EQ(reader.texts("l"), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(reader.texts("s"), (std::vector<std::string>{"x"}));
  EXPECT_EQ(reader.inlineTable("n", "{}")->find("m")->integer, 1);
  EXPECT_EQ(reader.tables("k").size(), 2u);
  EXPECT_EQ(reader.findOneOf({"u", "s", "v"})->text, "x");
  reader.rejectUnknownKeys();

  EXPECT_EQ(reader.text("none", "y"), "y");
  EXPECT_EQ(reader.integer("none", 7, 0, 1), 7u);
  EXPECT_EQ(reader.choice("none", {"one"}, 5), 5u);
  EXPECT_TRUE(reader.list("none").empty());
  EXPECT_TRUE(reader.tables("none").empty());
  EXPECT_EQ(reader.inlineTable("none", "{}"), nullptr);
  EXPECT_FALSE(reader.has("none"));
}

TEST(TomlReader, ReportsLineKeyAndTable) {
  const std::string text = "a = 1\nb = 'x'\n";
  const auto names = [](const char* line, const char* key) {
    return AllOf(HasSubstr(line), HasSubstr(key), HasSubstr("[table]"));
  };
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.text("a"); }), names("line 1: ", "'a'"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.boolean("b"); }), names("line 2: ", "'b'"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.integer("a", 0, 2, 3); }), names("line 1: ", "2 to 3"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.number("b", 0.0f); }), names("line 2: ", "'b'"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.number("a", 0.0f, {2.0}); }), names("line 1: ", "at least 2"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.pair("a", vec2(0.0f)); }), names("line 1: ", "2 numbers"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.list("a"); }), names("line 1: ", "'a'"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.findOneOf({"a", "b"}); }), names("line 2: ", "'a' and 'b'"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.require("c"); }), names("line 1: ", "'c'"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.tables("a"); }), AllOf(HasSubstr("line 1: "), HasSubstr("[[a]]")));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.inlineTable("a", "{ x }"); }), HasSubstr("{ x }"));
}

TEST(TomlReader, SuggestsNamesOfChoicesAndKeys) {
  const std::string text = "\nkind = 'depht'\n";
  EXPECT_THAT(errorOf(text,
                      [](TomlReader& r) {
                        r.choice("kind", {"color", "depth"}, 0);
                      }),
              AllOf(HasSubstr("line 2: "), HasSubstr("'depht' (did you mean 'depth'?)")));
  EXPECT_THAT(errorOf("kind = 'motion'",
                      [](TomlReader& r) {
                        r.choice("kind", {"color", "depth"}, 0);
                      }),
              HasSubstr("available: color, depth"));
  EXPECT_THAT(errorOf(text, [](TomlReader& r) { r.find("kinds"), r.rejectUnknownKeys(); }),
              AllOf(HasSubstr("line 2: "), HasSubstr("'kind' (did you mean 'kinds'?)")));
  EXPECT_EQ(errorOf(text, [](TomlReader& r) { r.find("kind"), r.rejectUnknownKeys(); }), "none");
}

TEST(TomlReader, RejectsNumbersThatAreNotInTheRange) {
  const auto within = [](const std::string& number, const NumberRange& range) {
    return errorOf("a = " + number, [&](TomlReader& r) { r.number("a", 0.0f, range); }) == "none";
  };
  EXPECT_TRUE(within("0", kUnit) && within("1", kUnit) && within("1e30", kAnyNumber) && within("0", kNotNegative));
  EXPECT_FALSE(within("1.001", kUnit) || within("-1e-9", kUnit) || within("0", kPositive) || within("nan", kAnyNumber));
  EXPECT_FALSE(within("'1'", kAnyNumber) || within("inf", kUnit) || within("-1e300", kNotNegative));
}

float numberOf(const std::string& number, const NumberRange& range) {
  const TomlValue value = parseToml("a = " + number, "t.toml");
  return TomlReader(value, "[table]", "t.toml").number("a", 0.0f, range);
}

// Numbers beyond float are its largest ones, and none that is not 0 becomes 0 or a limit that is excluded.
TEST(TomlReader, KeepsTheMeaningOfNumbersBeyondFloat) {
  constexpr float kLargest = std::numeric_limits<float>::max(), kSmallest = std::numeric_limits<float>::min();
  for (const char* number : {"1e39", "1.7976931348623157e308", "inf"}) {
    EXPECT_EQ(numberOf(number, kAnyNumber), kLargest);
    EXPECT_EQ(numberOf(number, kPositive), kLargest);
    EXPECT_EQ(numberOf(std::string("-") + number, kAnyNumber), -kLargest);
  }
  EXPECT_EQ(numberOf("1e-320", kPositive), kSmallest);
  EXPECT_EQ(numberOf("-1e-45", kAnyNumber), -kSmallest);
  EXPECT_EQ(numberOf("0", kNotNegative), 0.0f);
  EXPECT_LT(numberOf("0.99999999999", {-1.0, 1.0, true, true}), 1.0f);
  EXPECT_GT(numberOf("-0.99999999999", {-1.0, 1.0, true, true}), -1.0f);
}

TEST(TomlReader, ReadsIntegersThatAreWrittenAsReals) {
  const auto integer = [](const std::string& text) {
    const TomlValue value = parseToml("a = " + text, "t.toml");
    return TomlReader(value, "[table]", "t.toml").integer("a", 0, 1, 4294967295);
  };
  EXPECT_EQ(integer("4.0"), 4u);
  EXPECT_EQ(integer("1e0"), 1u);
  EXPECT_EQ(integer("4294967295"), 4294967295u);
  for (const char* wrong : {"1.5", "0.0", "nan", "inf", "1e10", "'1'", "true"})
    EXPECT_THROW(integer(wrong), FileError) << wrong;
}

TEST(TomlReader, NormalizesDirections) {
  const TomlValue value = parseToml("d = [0, 3, 4]\nz = [0, 0, 0]\n", "t.toml");
  TomlReader reader(value, "[table]", "t.toml");
  EXPECT_EQ(reader.toDirection(reader.require("d"), "d"), vec3(0.0f, 0.6f, 0.8f));
  EXPECT_THROW(reader.toDirection(reader.require("z"), "z"), FileError);
}

}  // namespace
}  // namespace quintet
