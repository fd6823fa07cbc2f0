// SPDX-License-Identifier: Apache-2.0
#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace quintet {
namespace {

// Continued fraction of the regularized incomplete beta function I_x(a, b) (DLMF 8.17.22, evaluated with the method of
// Lentz 1976). It converges quickly for x < (a + 1) / (a + b + 2).
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
  return std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x)) *
         betaFraction(a, b, x) / a;
}

// Returns z with P(Z <= z) = probability for the standard normal distribution.
double normalQuantile(double probability) {
  double low = -40.0, high = 40.0;
  for (int i = 0; i < 100; ++i) {
    const double z = 0.5 * (low + high);
    (0.5 * std::erfc(-z * std::numbers::sqrt2 / 2.0) < probability ? low : high) = z;
  }
  return low;
}

}  // namespace

double studentTwoSided(double t, double degreesOfFreedom) {
  return incompleteBeta(0.5 * degreesOfFreedom, 0.5, degreesOfFreedom / (degreesOfFreedom + t * t));
}

double fisherQuantile(double probability, double a, double b) {
  // The continued fraction needs about sqrt(a + b) terms. More than kMany degrees of freedom do not change the result
  // noticeably as long as the other number is small.
  constexpr double kSome = 200.0, kMany = 4000.0;
  if (a > kSome && b > kSome) {
    // The cube roots of both mean squares are nearly normal (E. Paulson, "An Approximate Normalization of the Analysis
    // of Variance Distribution", 1942): solve (1 - v) x - (1 - u) = z sqrt(v x² + u) for x, with x³ = F.
    const double u = 2.0 / (9.0 * a), v = 2.0 / (9.0 * b), z = normalQuantile(probability);
    const double p = (1.0 - v) * (1.0 - v) - z * z * v, q = (1.0 - u) * (1.0 - v),
                 r = (1.0 - u) * (1.0 - u) - z * z * u;
    const double root = (q + std::copysign(std::sqrt(q * q - p * r), z)) / p;
    return root * root * root;
  }
  a = std::min(a, kMany);
  b = std::min(b, kMany);
  // I_y(a/2, b/2) with y = a x / (a x + b) increases with y.
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 64; ++i) {
    const double y = 0.5 * (low + high);
    (incompleteBeta(0.5 * a, 0.5 * b, y) < probability ? low : high) = y;
  }
  const double y = 0.5 * (low + high);
  return b * y / (a * (1.0 - y));
}

double sidak(double level, std::size_t n) { return -std::expm1(std::log1p(-level) / static_cast<double>(n)); }

double significance(double difference, double error, double floor, double degreesOfFreedom) {
  if (std::abs(difference) <= floor) return 1.0;
  if (error <= 0.0) return 0.0;
  return studentTwoSided((std::abs(difference) - floor) / error, degreesOfFreedom);
}

}  // namespace quintet
