// SPDX-License-Identifier: Apache-2.0
#include "viewer/false_color.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/color.h"

namespace quintet::viewer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> labels(const FalseColorRange& range, int count) {
  std::vector<std::string> result;
  for (const LegendTick& tick : legendTicks(range, count)) result.push_back(tick.label);
  return result;
}

// CIELAB L*.
double lightness(const vec3& color) {
  const double y = 0.2126 * io::linearFromSrgb(color.r) + 0.7152 * io::linearFromSrgb(color.g) +
                   0.0722 * io::linearFromSrgb(color.b);
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

TEST(FalseColor, BecomesLighterAtAnEvenRate) {
  double last = -1.0;
  for (int i = 0; i <= 256; ++i) {
    const double position = i / 256.0;
    const double value = lightness(falseColor(position));
    EXPECT_GT(value, last) << position;
    EXPECT_NEAR(value, 15.0 + 76.0 * position, 3.0) << position;
    last = value;
  }
}

TEST(FalseColor, ClampsPositionsAndMarksNan) {
  EXPECT_EQ(falseColor(-1.0), falseColor(0.0));
  EXPECT_EQ(falseColor(2.0), falseColor(1.0));
  EXPECT_EQ(falseColor(std::numeric_limits<double>::quiet_NaN()), vec3(1, 0, 1));
}

TEST(FalseColor, MapsValuesToPositionsAndBack) {
  const FalseColorRange linear{-1.0, 3.0, false};
  EXPECT_DOUBLE_EQ(linear.position(0.0), 0.25);
  EXPECT_DOUBLE_EQ(linear.position(-5.0), 0.0);
  EXPECT_DOUBLE_EQ(linear.position(5.0), 1.0);
  EXPECT_DOUBLE_EQ(linear.valueAt(0.25), 0.0);
  const FalseColorRange logarithmic{0.01, 100.0, true};
  EXPECT_DOUBLE_EQ(logarithmic.position(1.0), 0.5);
  EXPECT_DOUBLE_EQ(logarithmic.position(0.0), 0.0);
  EXPECT_DOUBLE_EQ(logarithmic.position(-1.0), 0.0);
  EXPECT_NEAR(logarithmic.valueAt(0.5), 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(linear.position(std::numeric_limits<double>::quiet_NaN())));
}

TEST(FalseColor, LabelsRoundNumbers) {
  EXPECT_THAT(labels({0.0, 1.0, false}, 5), ElementsAre("0", "0.2", "0.4", "0.6", "0.8", "1"));
  EXPECT_THAT(labels({-0.7, 0.9, false}, 4), ElementsAre("-0.5", "0", "0.5"));
  EXPECT_THAT(labels({0.01, 100.0, true}, 6), ElementsAre("0.01", "0.1", "1", "10", "100"));
  EXPECT_THAT(labels({0.002, 30.0, true}, 6), ElementsAre("0.01", "0.1", "1", "10"));
  EXPECT_THAT(labels({1.0, 1.0, false}, 6), IsEmpty());
  for (const LegendTick& tick : legendTicks({0.0, 7.3, false}, 6)) {
    EXPECT_GE(tick.position, 0.0);
    EXPECT_LE(tick.position, 1.0);
    EXPECT_NEAR(std::stod(tick.label), 7.3 * tick.position, 1e-9);
  }
}

TEST(FalseColor, RoundsRanges) {
  const FalseColorRange range = roundRange(0.13, 0.96);
  EXPECT_DOUBLE_EQ(range.least, 0.1);
  EXPECT_DOUBLE_EQ(range.most, 1.0);
  EXPECT_LT(roundRange(2.0, 2.0).least, roundRange(2.0, 2.0).most);
  EXPECT_DOUBLE_EQ(roundRange(0.0, std::numeric_limits<double>::infinity()).most, 1.0);
}

}  // namespace
}  // namespace quintet::viewer
