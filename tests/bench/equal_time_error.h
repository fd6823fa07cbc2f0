// SPDX-License-Identifier: Apache-2.0
// Error of a noisy image relative to a reference.
#ifndef QUINTET_TESTS_BENCH_EQUAL_TIME_ERROR_H
#define QUINTET_TESTS_BENCH_EQUAL_TIME_ERROR_H

#include <vector>

#include "io/image.h"

namespace quintet::bench {

struct ImageError {
  double relMse = 0;  // mean over pixels and channels of (I - R)² / (R² + eps), eps = 0.01 · (mean luminance of R)²
  double trimmed = 0;  // relMse without the 0.1 % of the pixels with the largest error
  double flip = 0;     // mean FLIP error of the display values
  double mean = 0;     // mean luminance of I over that of R
};

// `exposure` multiplies both images before FLIP. Throws UsageError if the sizes differ.
ImageError imageError(const io::Image& image, const io::Image& reference, float exposure);

// Factor that maps the mean luminance of the reference to a middle gray; 1 for a black image.
float middleExposure(const io::Image& reference);

// a | b | reference, multiplied by the exposure, in 8 bits.
io::Image sideBySide(const io::Image& a, const io::Image& b, const io::Image& reference, float exposure);

// Mean and standard error of the mean.
struct Estimate {
  double mean = 0;
  double error = 0;
};
Estimate estimate(const std::vector<double>& values);

}  // namespace quintet::bench
#endif
