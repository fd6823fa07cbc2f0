// SPDX-License-Identifier: Apache-2.0
#include "base/wrap.h"

#include <gmock/gmock.h>

#include "base/plural.h"
#include "base/typographic.h"

namespace quintet {
namespace {

using ::testing::ElementsAre;

TEST(Wrap, BreaksBetweenWords) {
  EXPECT_THAT(wrapText("", 10), ElementsAre(""));
  EXPECT_THAT(wrapText("one two three", 7), ElementsAre("one two", "three"));
  EXPECT_THAT(wrapText("one two three", 6), ElementsAre("one", "two", "three"));
  EXPECT_THAT(wrapText("a averylongword b", 4), ElementsAre("a", "averylongword", "b"));
  EXPECT_THAT(wrapText("one\n\ntwo", 80), ElementsAre("one", "", "two"));
}

TEST(Wrap, CountsCharacters) {
  EXPECT_EQ(columnsOf("σ² ≤ 1"), 6u);
  EXPECT_EQ(columnsOf("\x1b[1;31merror\x1b[0m"), 5u);
  EXPECT_EQ(padded("é", 3), "é  ");
  EXPECT_EQ(padded("long", 2), "long");
}

TEST(Wrap, Indents) {
  EXPECT_EQ(wrapped("one two three", 9, 2), "one two\n  three");
  EXPECT_EQ(wrapped("one two three", 9, 4, 4), "one\n    two\n    three");
  EXPECT_EQ(wrapped("one two", 3, 5, 5), "one\n     two");
}

TEST(Wrap, TwoColumns) {
  EXPECT_EQ(twoColumns("name", "one two", 6, 20), "name  one two\n");
  EXPECT_EQ(twoColumns("name", "one two", 6, 10), "name  one\n      two\n");
  EXPECT_EQ(twoColumns("names", "one two", 6, 20), "names\n      one two\n");
  EXPECT_EQ(twoColumns("", "one", 1, 20), " one\n");
}

TEST(Plural, FollowsTheNumber) {
  EXPECT_EQ(counted(1, "sample"), "1 sample");
  EXPECT_EQ(counted(0, "sample"), "0 samples");
  EXPECT_EQ(counted(2, "batch", "batches"), "2 batches");
  EXPECT_EQ(nounFor(1.0, "sample"), "sample");
}

TEST(Typographic, FindsTheFirstQuote) {
  EXPECT_EQ(findTypographicQuote("plain \"text\" – …"), "");
  EXPECT_EQ(findTypographicQuote("a ’b” c"), "’");
  EXPECT_EQ(findTypographicQuote("\xE2\x80"), "");
  EXPECT_EQ(asciiQuote("‘"), '\'');
  EXPECT_EQ(asciiQuote("”"), '"');
  EXPECT_EQ(typographicQuoteHint("’"), "’ is a typographic quote; type ' instead");
  EXPECT_EQ(typographicQuoteHint("“"), "“ is a typographic quote; type \" instead");
}

}  // namespace
}  // namespace quintet
