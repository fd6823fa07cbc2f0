// SPDX-License-Identifier: Apache-2.0
// Floats for people.
#include "output/float_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace quintet::output {
namespace {

TEST(FloatText, HasUpToFiveDigits) {
  EXPECT_EQ(floatText(0.1f), "0.1");
  EXPECT_EQ(floatText(1.0f / 3.0f), "0.33333");
  EXPECT_EQ(floatText(-0.0f), "0");
  EXPECT_EQ(vectorText({1, 2.5f, -3}), "1 2.5 -3");
}

TEST(FloatText, NamesWhatIsNotFinite) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  EXPECT_EQ(floatText(-NAN), "nan");
  EXPECT_EQ(vectorText({INFINITY, -INFINITY, NAN}), "infinity -infinity nan");
  EXPECT_EQ(floatText(kLargest), "infinity") << "a ray without limit";
  EXPECT_EQ(floatText(-kLargest), "-infinity");
  EXPECT_EQ(floatText(3.4e38f), "3.4e+38");
}

}  // namespace
}  // namespace quintet::output
