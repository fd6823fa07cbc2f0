// SPDX-License-Identifier: Apache-2.0
// Means of independent batches, and significance tests on them. The distributions are in base/statistics.h.
#ifndef QUINTET_TESTS_GPU_RENDER_STATISTICS_H
#define QUINTET_TESTS_GPU_RENDER_STATISTICS_H

#include <cstddef>

#include "base/statistics.h"

namespace quintet::test {

// Computes mean and variance of a sequence without cancellation (Welford 1962).
class Moments {
 public:
  void add(double value);
  std::size_t count() const { return count_; }
  double mean() const { return mean_; }
  double variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0.0; }
  double standardError() const;  // of the mean
  // Returns the same spread around a different mean.
  Moments movedTo(double mean) const;

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;
};

// Returns the p-value of the hypothesis that the true mean is `exact`. `floor` is the rounding error of the mean.
double pValue(const Moments& m, double exact, double floor = 0.0);

// Returns the p-value of the hypothesis that both have the same mean, by Welch's t-test (1947).
double pValue(const Moments& a, const Moments& b, double floor = 0.0);

}  // namespace quintet::test
#endif
