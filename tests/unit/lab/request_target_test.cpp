// SPDX-License-Identifier: Apache-2.0
#include "lab/request_target.h"

#include <gmock/gmock.h>

namespace quintet::lab {
namespace {

using ::testing::Pair;
using ::testing::UnorderedElementsAre;

TEST(RequestTarget, DecodesPathAndQuery) {
  const auto target = parseTarget("/api/files/a%20b+c?name=%3Cprograms%2Fao%3E&to=x+y&flag&to=z");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/api/files/a b+c");
  EXPECT_THAT(target->query, UnorderedElementsAre(Pair("name", "<programs/ao>"), Pair("to", "z"), Pair("flag", "")));
}

TEST(RequestTarget, RejectsWhatIsNotPlain) {
  for (const char* text :
       {"", "x", "http://localhost/", "*", "/%", "/%4", "/%zz", "/a%00b", "/?a=%", "/?%zz=1", "/?a=%00"})
    EXPECT_FALSE(parseTarget(text)) << text;
}

TEST(RequestTarget, DecodesOnlyOnce) { EXPECT_EQ(parseTarget("/%252e%252e/x")->path, "/%2e%2e/x"); }

}  // namespace
}  // namespace quintet::lab
