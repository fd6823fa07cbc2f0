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

// |difference| in units of its standard error, at least `floor` of which nobody can know better.
double significance(double difference, double error, double floor, double freedom) {
  if (std::abs(difference) <= floor) return 1.0;
  if (error <= 0.0) return 0.0;
  return studentTwoSided((std::abs(difference) - floor) / error, freedom);
}

}  // namespace

double studentTwoSided(double t, double freedom) { return incompleteBeta(0.5 * freedom, 0.5, freedom / (freedom + t * t)); }

double sidak(double alpha, std::size_t n) { return -std::expm1(std::log1p(-alpha) / static_cast<double>(n)); }

double pValue(const Moments& m, double exact, double floor) {
  return significance(m.mean() - exact, m.standardError(), floor, static_cast<double>(m.count()) - 1.0);
}

double pValue(const Moments& a, const Moments& b, double floor) {
  const double va = a.variance() / static_cast<double>(a.count());
  const double vb = b.variance() / static_cast<double>(b.count());
  const double sum = va + vb;
  // Welch and Satterthwaite's degrees of freedom.
  const double freedom = sum > 0.0 ? sum * sum / (va * va / static_cast<double>(a.count() - 1) + vb * vb / static_cast<double>(b.count() - 1)) : 1.0;
  return significance(a.mean() - b.mean(), std::sqrt(sum), floor, std::max(1.0, freedom));
}

}  // namespace quintet::test
