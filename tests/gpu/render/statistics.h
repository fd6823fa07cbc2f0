// Means of independent batches and the tests on them (distributions: base/statistics.h). No device in it.
#ifndef QUINTET_TESTS_GPU_RENDER_STATISTICS_H
#define QUINTET_TESTS_GPU_RENDER_STATISTICS_H

#include <cstddef>

#include "base/statistics.h"

namespace quintet::test {

// Mean and variance of a sequence without cancellation (Welford 1962).
class Moments {
 public:
  void add(double value);
  std::size_t count() const { return count_; }
  double mean() const { return mean_; }
  double variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0.0; }
  double standardError() const;  // of the mean
  // The same spread around another mean.
  Moments movedTo(double mean) const;

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;
};

// P-value of "the true mean is `exact`"; `floor`: rounding error that the mean has in any case.
double pValue(const Moments& m, double exact, double floor = 0.0);

// P-value of "both have the same mean": Welch's t-test (1947).
double pValue(const Moments& a, const Moments& b, double floor = 0.0);

}  // namespace quintet::test
#endif
