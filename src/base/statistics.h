// Tests of hypotheses about means: Student's distribution, variances that are estimates, many tests at once.
#ifndef QUINTET_BASE_STATISTICS_H
#define QUINTET_BASE_STATISTICS_H

#include <cstddef>

namespace quintet {

// P(|T| >= |t|) for Student's t with so many degrees of freedom (any positive real).
double studentTwoSided(double t, double freedom);

// x with P(F <= x) = probability for Fisher's F, the ratio of two means of squares with a and b degrees of freedom (any
// positive reals); probability in (0,1), relative error below 1e-3.
double fisherQuantile(double probability, double a, double b);

// The level at which each of n tests runs so that all together reject true hypotheses with probability `level`
// (Z. Šidák, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions", 1967): exact for
// independent tests, at most `level` for correlated normal ones.
double sidak(double level, std::size_t n);

// The variance of a sum of independent terms, each estimated with its own degrees of freedom. Those of the sum:
// (Σ v)² / Σ v²/ν (F. Satterthwaite 1946; for the difference of two means B. L. Welch, "The Generalization of 'Student's'
// Problem when Several Different Population Variances are Involved", 1947).
class VarianceSum {
 public:
  void add(double variance, double freedom) {
    variance_ += variance;
    squares_ += variance * variance / freedom;
  }
  void add(const VarianceSum& other) {
    variance_ += other.variance_;
    squares_ += other.squares_;
  }
  double variance() const { return variance_; }
  double freedom() const { return squares_ > 0.0 ? variance_ * variance_ / squares_ : 1.0; }

 private:
  double variance_ = 0.0;
  double squares_ = 0.0;
};

// P-value of "the expectation of `difference` is 0", by its standard error; `floor`: what rounding may make of it in any case.
// Without error: 1 within the floor, else 0.
double significance(double difference, double error, double floor, double freedom);

}  // namespace quintet
#endif
