// SPDX-License-Identifier: Apache-2.0
#include "statistics.h"

#include <algorithm>
#include <cmath>

namespace quintet::test {

void Moments::add(double value) {
  ++count_;
  const double delta = value - mean_;
  mean_ += delta / static_cast<double>(count_);
  squares_ += delta * (value - mean_);
}

double Moments::standardError() const { return count_ > 1 ? std::sqrt(variance() / static_cast<double>(count_)) : 0.0; }

Moments Moments::movedTo(double mean) const {
  Moments moved = *this;
  moved.mean_ = mean;
  return moved;
}

double pValue(const Moments& m, double exact, double floor) {
  return significance(m.mean() - exact, m.standardError(), floor, static_cast<double>(m.count()) - 1.0);
}

double pValue(const Moments& a, const Moments& b, double floor) {
  VarianceSum sum;
  for (const Moments* m : {&a, &b})
    sum.add(m->variance() / static_cast<double>(m->count()), static_cast<double>(m->count()) - 1.0);
  return significance(a.mean() - b.mean(), std::sqrt(sum.variance()), floor, std::max(1.0, sum.degreesOfFreedom()));
}

}  // namespace quintet::test
