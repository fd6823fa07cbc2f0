// SPDX-License-Identifier: Apache-2.0
// Numbers and lists in text: the whole text must be valid.
#include "base/parse.h"

#include <gmock/gmock.h>

#include <cstdint>
#include <limits>

namespace quintet {
namespace {

using testing::ElementsAre;

TEST(ParseNumber, Integers) {
  EXPECT_EQ(parseNumber<std::uint32_t>("0"), 0u);
  EXPECT_EQ(parseNumber<std::uint32_t>("+42"), 42u);
  EXPECT_EQ(parseNumber<std::uint32_t>("4294967295"), 4294967295u);
  EXPECT_EQ(parseNumber<std::uint64_t>("18446744073709551615"), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(parseNumber<int>("-7"), -7);
  for (const char* text : {"", "+", "-", "-1", "4294967296", "1.5", "1e3", "0x1", " 1", "1 ", "1x", "++1", "+-1"})
    EXPECT_EQ(parseNumber<std::uint32_t>(text), std::nullopt) << text;
}

TEST(ParseNumber, RealNumbers) {
  EXPECT_EQ(parseNumber<double>("2.5"), 2.5);
  EXPECT_EQ(parseNumber<double>("-.5"), -0.5);
  EXPECT_EQ(parseNumber<double>("+3e1"), 30.0);
  EXPECT_EQ(parseNumber<float>("0.1"), 0.1f);
  EXPECT_EQ(parseNumber<double>("inf"), std::numeric_limits<double>::infinity()) << "callers check the range";
  for (const char* text : {"", "+", ".", "e3", "1e", "1,5", "0x1", " 1", "1 ", "1s", "+-1", "1e999"})
    EXPECT_EQ(parseNumber<double>(text), std::nullopt) << text;
  EXPECT_EQ(parseNumber<float>("1e99"), std::nullopt) << "out of the range of float";
}

TEST(SplitText, KeepsEmptyParts) {
  EXPECT_THAT(splitText("1,2,3", ','), ElementsAre("1", "2", "3"));
  EXPECT_THAT(splitText(",1,,", ','), ElementsAre("", "1", "", ""));
  EXPECT_THAT(splitText("a b", ','), ElementsAre("a b"));
  EXPECT_THAT(splitText("", ','), ElementsAre(""));
}

TEST(ParseVec3, ThreeFiniteNumbers) {
  EXPECT_EQ(parseVec3("1,-2.5,+3e1"), vec3(1, -2.5f, 30));
  EXPECT_EQ(parseVec3("-.5,0,0"), vec3(-0.5f, 0, 0));
  for (const char* text : {"", "1,2", "1,2,3,4", "1,,3", "1,2,nan", "1,2,inf", "1,2,1e99", "1, 2,3", "+-1,2,3"})
    EXPECT_EQ(parseVec3(text), std::nullopt) << text;
}

}  // namespace
}  // namespace quintet
