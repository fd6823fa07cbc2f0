// SPDX-License-Identifier: Apache-2.0
// Statistical hypothesis tests of means: Student's t, Fisher's F, Welch-Satterthwaite variances, Šidák correction.
#ifndef QUINTET_BASE_STATISTICS_H
#define QUINTET_BASE_STATISTICS_H

#include <cstddef>

namespace quintet {

// Returns P(|T| >= |t|) for Student's t distribution with `degreesOfFreedom` degrees of freedom (any positive real).
double studentTwoSided(double t, double degreesOfFreedom);

// Returns x with P(F <= x) = probability for Fisher's F distribution, the ratio of two mean squares with a and b
// degrees of freedom (any positive reals). `probability` is in (0,1); the relative error is below 1e-3.
double fisherQuantile(double probability, double a, double b);

// Returns the significance level of each of n tests for which the probability of at least one false rejection is
// `level` (Z. Šidák, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions", 1967). This
// is exact for independent tests and conservative for correlated normal ones.
double sidak(double level, std::size_t n);

// Variance of a sum of independent terms, each estimated with its own degrees of freedom ν. The sum has (Σ v)² / Σ v²/ν
// degrees of freedom (F. Satterthwaite 1946; for the difference of two means B. L. Welch, "The Generalization of
// 'Student's' Problem when Several Different Population Variances are Involved", 1947).
class VarianceSum {
 public:
  void add(double variance, double degreesOfFreedom) {
    variance_ += variance;
    squares_ += variance * variance / degreesOfFreedom;
  }
  void add(const VarianceSum& other) {
    variance_ += other.variance_;
    squares_ += other.squares_;
  }
  double variance() const { return variance_; }
  double degreesOfFreedom() const { return squares_ > 0.0 ? variance_ * variance_ / squares_ : 1.0; }

 private:
  double variance_ = 0.0;
  double squares_ = 0.0;
};

// Returns the p-value of the hypothesis that the expectation of `difference` is 0. `error` is the standard error,
// `floor` the largest difference that rounding alone can cause. For error 0 the result is 1 within the floor and 0
// otherwise.
double significance(double difference, double error, double floor, double degreesOfFreedom);

}  // namespace quintet
#endif
