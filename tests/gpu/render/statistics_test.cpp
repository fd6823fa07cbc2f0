// SPDX-License-Identifier: Apache-2.0
// The statistics of the tests themselves. The distributions are tested in tests/unit/base.
#include <gtest/gtest.h>

#include <cmath>

#include "statistics.h"

namespace quintet::test {
namespace {

TEST(TestStatistics, ComputesMoments) {
  Moments m;
  for (const double v : {1e6 + 1, 1e6 + 2, 1e6 + 3, 1e6 + 4}) m.add(v);
  EXPECT_DOUBLE_EQ(m.mean(), 1e6 + 2.5);
  EXPECT_NEAR(m.variance(), 5.0 / 3.0, 1e-9);
  EXPECT_NEAR(m.standardError(), std::sqrt(5.0 / 12.0), 1e-9);
}

TEST(TestStatistics, ComputesPValues) {
  Moments a, b, constant;
  for (const double v : {1.0, 2.0, 3.0, 4.0}) a.add(v), b.add(v + 5.0), constant.add(2.0);
  EXPECT_EQ(pValue(a, 2.5), 1.0);
  EXPECT_NEAR(pValue(a, 2.5 + 3.182446 * a.standardError()), 0.05, 1e-6);  // 3 degrees of freedom
  EXPECT_EQ(pValue(constant, 2.0), 1.0);
  EXPECT_EQ(pValue(constant, 2.001), 0.0);
  EXPECT_EQ(pValue(constant, 2.001, 0.01), 1.0);
  EXPECT_NEAR(pValue(a, b), studentTwoSided(5.0 / std::sqrt(5.0 / 6.0), 6), 1e-12);
}

}  // namespace
}  // namespace quintet::test
