// SPDX-License-Identifier: Apache-2.0
#include "base/json.h"

#include <string>

#include <gmock/gmock.h>

namespace quintet {
namespace {

using ::testing::HasSubstr;

std::string nested(std::size_t levels, const std::string& open = "[", const std::string& close = "]") {
  std::string text;
  for (std::size_t i = 0; i < levels; ++i) text += open;
  for (std::size_t i = 0; i < levels; ++i) text += close;
  return text;
}

TEST(Json, AcceptsTheDeepestAllowedText) {
  EXPECT_TRUE(findJson(nested(kMaxJsonDepth)));
  EXPECT_TRUE(findJson(nested(kMaxJsonDepth - 1, R"({"a":)", "}").replace((kMaxJsonDepth - 1) * 5, 0, "1")));
  EXPECT_FALSE(findJson(nested(kMaxJsonDepth + 1)));
  EXPECT_FALSE(findJson("{"));
}

TEST(Json, RejectsDeepTextsBeforeTheyAreParsed) {
  for (const std::size_t levels : {std::size_t{200'000}, std::size_t{10'000'000}}) {
    EXPECT_THROW(parseJson(nested(levels)), JsonLimitError);
    EXPECT_THROW(parseJson(std::string(levels, '[')), JsonLimitError);  // never closed
    EXPECT_THROW(parseJson(nested(levels, R"({"a":)", "}")), JsonLimitError);
    EXPECT_FALSE(findJson(nested(levels)));
  }
  try {
    parseJson("file.json", "[\n" + nested(1000));
    FAIL();
  } catch (const FileError& error) {
    EXPECT_STREQ(error.what(), "file.json: line 2, column 256: more than 256 nested arrays and objects");
  }
}

TEST(Json, CountsNoBracketsInStringsAndComments) {
  const std::string brackets(1000, '[');
  EXPECT_EQ(parseJson("\"\\\"" + brackets + "\"").get<std::string>(), "\"" + brackets);
  EXPECT_TRUE(findJson("[1] // " + brackets, {.comments = true}));
  EXPECT_TRUE(findJson("[1] /* " + brackets + " */", {.comments = true}));
  // A quote in a comment begins no string.
  EXPECT_THROW(parseJson("// \"\n" + nested(1000), {.comments = true}), JsonLimitError);
  EXPECT_THROW(parseJson("/* \" */" + nested(1000), {.comments = true}), JsonLimitError);
  EXPECT_THROW(parseJson("[1] // x"), nlohmann::json::parse_error);
}

TEST(Json, RejectsLargeTexts) {
  EXPECT_TRUE(findJson("[100]", {.bytes = 5}));
  try {
    parseJson("[1000]", {.bytes = 5});
    FAIL();
  } catch (const JsonLimitError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the limit is"));
  }
}

}  // namespace
}  // namespace quintet
