// How far a noisy picture is from a long reference.
#ifndef QUINTET_TESTS_BENCH_EQUAL_TIME_ERROR_H
#define QUINTET_TESTS_BENCH_EQUAL_TIME_ERROR_H

#include <vector>

#include "io/image.h"

namespace quintet::bench {

struct PictureError {
  double relMse = 0;  // mean over pixels and channels of (I - R)² / (R² + eps), eps = 0.01 · (mean luminance of R)²
  double trimmed = 0;  // the same without the 0.1 % of pixels that are furthest off
  double flip = 0;     // mean FLIP error of the display values
  double mean = 0;     // mean luminance of I over that of R
};

// `exposure`: factor of both before FLIP. Throws UsageError if the sizes differ.
PictureError pictureError(const io::Image& image, const io::Image& reference, float exposure);

// A factor that brings the reference's mean luminance to a middle grey; 1 for a black picture.
float middleExposure(const io::Image& reference);

// a | b | reference, exposed, as bytes.
io::Image threePictures(const io::Image& a, const io::Image& b, const io::Image& reference, float exposure);

// Mean and standard error of the mean.
struct Estimate {
  double mean = 0;
  double error = 0;
};
Estimate estimate(const std::vector<double>& values);

}  // namespace quintet::bench
#endif
