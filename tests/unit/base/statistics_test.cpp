// SPDX-License-Identifier: Apache-2.0
// Compares distributions and corrections with published tables.
#include <gtest/gtest.h>

#include <cmath>

#include "base/statistics.h"

namespace quintet {
namespace {

TEST(Statistics, MatchesTablesOfStudentsDistribution) {
  EXPECT_NEAR(studentTwoSided(2.228139, 10), 0.05, 1e-7);  // NIST/SEMATECH e-Handbook 1.3.6.7.2
  EXPECT_NEAR(studentTwoSided(12.706205, 1), 0.05, 1e-7);
  EXPECT_NEAR(studentTwoSided(-3.169273, 10), 0.01, 1e-7);
  EXPECT_NEAR(studentTwoSided(1.959964, 1e9), 0.05, 1e-6);  // the normal distribution
  EXPECT_EQ(studentTwoSided(0, 5), 1.0);
  EXPECT_NEAR(studentTwoSided(1.0, 1), 0.5, 1e-12);  // Cauchy
}

TEST(Statistics, CorrectsTheLevelOfManyTests) {
  EXPECT_NEAR(sidak(0.01, 1), 0.01, 1e-15);
  EXPECT_NEAR(std::pow(1.0 - sidak(0.01, 1000), 1000), 0.99, 1e-12);
}

TEST(Statistics, AddsVariancesAndDegreesOfFreedom) {
  VarianceSum sum;
  EXPECT_EQ(sum.variance(), 0.0);
  sum.add(2.0, 7.0);
  EXPECT_DOUBLE_EQ(sum.degreesOfFreedom(), 7.0);
  VarianceSum more;
  for (int i = 0; i < 9; ++i) more.add(2.0, 7.0);
  sum.add(more);
  EXPECT_DOUBLE_EQ(sum.variance(), 20.0);
  EXPECT_DOUBLE_EQ(sum.degreesOfFreedom(), 70.0);  // the degrees of freedom of equal variances add up
  sum.add(1e9, 3.0);
  EXPECT_NEAR(sum.degreesOfFreedom(), 3.0, 1e-6);  // one dominant variance
}

TEST(Statistics, IgnoresRoundingErrorsInSignificance) {
  EXPECT_EQ(significance(0.0, 0.0, 0.0, 5), 1.0);
  EXPECT_EQ(significance(1e-9, 0.0, 0.0, 5), 0.0);
  EXPECT_EQ(significance(-1e-9, 0.0, 1e-8, 5), 1.0);
  EXPECT_NEAR(significance(-2.0 * 2.228139 - 0.5, 2.0, 0.5, 10), 0.05, 1e-7);
}

// NIST/SEMATECH e-Handbook 1.3.6.7.3, upper critical values at 5 %. The values for many degrees of freedom follow from
// the limit of Paulson's formula, 1 + 1.645 √(4/n).
TEST(Statistics, MatchesTablesOfFisherQuantiles) {
  EXPECT_NEAR(fisherQuantile(0.95, 1, 1), 161.448, 0.001);
  EXPECT_NEAR(fisherQuantile(0.95, 1, 3), 10.128, 0.001);
  EXPECT_NEAR(fisherQuantile(0.95, 10, 10), 2.978, 0.001);
  EXPECT_NEAR(fisherQuantile(0.95, 3, 100), 2.696, 0.001);
  EXPECT_NEAR(fisherQuantile(0.95, 20, 7), 3.445, 0.001);
  for (const double freedom : {3990.0, 4010.0})
    EXPECT_NEAR(fisherQuantile(0.95, freedom, freedom), 1.0534, 2e-4) << freedom;
  EXPECT_NEAR(fisherQuantile(0.95, 1e6, 1e6), 1.0 + 1.644854 * std::sqrt(4e-6), 1e-5);
  EXPECT_NEAR(fisherQuantile(0.05, 10, 10), 1.0 / 2.978, 0.001);
}

}  // namespace
}  // namespace quintet
