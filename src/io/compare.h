// SPDX-License-Identifier: Apache-2.0
// Differences of two images: error metrics, FLIP and a color map for error images.
#ifndef QUINTET_IO_COMPARE_H
#define QUINTET_IO_COMPARE_H

#include <cstddef>

#include "io/image.h"

namespace quintet::io {

// Pixels per degree of visual angle for a 0.7 m wide screen of 3840 pixels at a distance of 0.7 m (Andersson et al.
// 2020).
inline constexpr float kFlipPixelsPerDegree = 67.0f;

// Means are taken over all pixels and the three color channels; a is the test image, b the reference. Color is
// premultiplied (over black), gray is repeated, and an image without alpha is opaque.
struct Comparison {
  double rmse = 0.0;    // root of mean (a-b)², linear values (1 is display white)
  double relMse = 0.0;  // mean (a-b)² / (b² + 0.01), linear values
  // Of display values: clamped to [0,1], sRGB-encoded, rounded to 0 … 255.
  double mae8 = 0.0;       // mean |a-b|, in steps of 1/255
  double max8 = 0.0;       // largest |a-b|, in steps of 1/255
  double psnr = 0.0;       // 10 log10(255² / mean (a-b)²) in dB; infinite for equal images
  double flip = 0.0;       // mean of flipMap, from 0 (equal) to 1
  double alphaMae8 = 0.0;  // mean |a-b| of alpha, in steps of 1/255
  std::size_t nonFinitePixels =
      0;          // with NaN or infinity in a or b: excluded from rmse and relMse, black or white elsewhere
  Image flipMap;  // FLIP error per pixel in [0,1]: f32, 1 channel, linear
};

// Throws UsageError if the sizes differ, an image has no pixels, or pixelsPerDegree is not in [1, 1000].
Comparison compareImages(const Image& a, const Image& b, float pixelsPerDegree = kFlipPixelsPerDegree);

// LDR-FLIP (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: "FLIP: A Difference Evaluator
// for Alternating Images", HPG 2020): the error per pixel in [0,1]; f32, 1 channel, linear. Values are clamped to [0,1]
// first and NaN counts as 0. Alpha and errors are handled as in compareImages.
Image flipMap(const Image& a, const Image& b, float pixelsPerDegree = kFlipPixelsPerDegree);

// Converts a one-channel map in [0,1] to u8 RGB, from black over violet and orange to light yellow with increasing
// lightness.
Image colorMap(const Image& map);

}  // namespace quintet::io
#endif
