#include "base/statistics.h"

#include <cmath>
#include <initializer_list>

namespace quintet {
namespace {

// Regularised incomplete beta function I_x(a, b) by its continued fraction (DLMF 8.17.22, evaluated after
// Lentz 1976); converges quickly for x < (a + 1) / (a + b + 2).
double betaFraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;
  const auto inverted = [](double v) { return 1.0 / (std::abs(v) < kTiny ? kTiny : v); };
  double c = 1.0;
  double d = inverted(1.0 - (a + b) * x / (a + 1.0));
  double result = d;
  for (int m = 1; m < 500; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    double step = 1.0;
    for (const double term : {even, odd}) {
      d = inverted(1.0 + term * d);
      c = 1.0 + term / (std::abs(c) < kTiny ? kTiny : c);
      step = c * d;
      result *= step;
    }
    if (std::abs(step - 1.0) < 1e-14) break;
  }
  return result;
}

double incompleteBeta(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  if (x > (a + 1.0) / (a + b + 2.0)) return 1.0 - incompleteBeta(b, a, 1.0 - x);
  return std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x)) * betaFraction(a, b, x) / a;
}

}  // namespace

double studentTwoSided(double t, double freedom) { return incompleteBeta(0.5 * freedom, 0.5, freedom / (freedom + t * t)); }

double sidak(double level, std::size_t n) { return -std::expm1(std::log1p(-level) / static_cast<double>(n)); }

double significance(double difference, double error, double floor, double freedom) {
  if (std::abs(difference) <= floor) return 1.0;
  if (error <= 0.0) return 0.0;
  return studentTwoSided((std::abs(difference) - floor) / error, freedom);
}

}  // namespace quintet
