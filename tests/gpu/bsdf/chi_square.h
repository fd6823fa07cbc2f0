// SPDX-License-Identifier: Apache-2.0
// Pearson's chi-square test with pooling of cells.
#ifndef QUINTET_TESTS_GPU_BSDF_CHI_SQUARE_H
#define QUINTET_TESTS_GPU_BSDF_CHI_SQUARE_H

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/statistics.h"

namespace quintet::test {

// Upper regularised incomplete gamma function Q(a, x): series for small x, else Lentz's continued fraction
// (Press et al., "Numerical Recipes", section 6.2).
inline double gammaQ(double a, double x) {
  if (x <= 0.0) return 1.0;
  const double scale = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a, sum = term;
    for (double n = a + 1.0; term > sum * 1e-15; n += 1.0) sum += term *= x / n;
    return 1.0 - sum * scale;
  }
  double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d;
  for (int i = 1; i < 10'000; ++i) {
    const double an = -i * (i - a);
    b += 2.0;
    d = 1.0 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1.0) < 1e-15) break;
  }
  return scale * h;
}

struct ChiSquare {
  double statistic = 0.0;
  int freedom = 0;
  double pValue = 1.0;
};

// Cells in ascending order of expectation are pooled until the pool expects 5 at least.
inline ChiSquare chiSquareTest(const std::vector<double>& observed, const std::vector<double>& expected) {
  std::vector<std::size_t> order(expected.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return expected[i]; });
  ChiSquare result;
  double o = 0.0, e = 0.0;
  int cells = 0;
  for (const std::size_t i : order) {
    o += observed[i];
    e += expected[i];
    if (e < 5.0) continue;
    result.statistic += (o - e) * (o - e) / e;
    ++cells;
    o = e = 0.0;
  }
  result.freedom = std::max(cells - 1, 1);
  result.pValue = gammaQ(0.5 * result.freedom, 0.5 * result.statistic);
  return result;
}

}  // namespace quintet::test
#endif
