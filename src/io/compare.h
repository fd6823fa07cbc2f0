// How far two pictures are apart. Numbers for programs, a map and a picture for people.
#ifndef QUINTET_IO_COMPARE_H
#define QUINTET_IO_COMPARE_H

#include <cstddef>

#include "io/image.h"

namespace quintet::io {

// Pixels per degree of visual angle: a 0.7 m wide screen of 3840 pixels seen from 0.7 m (Andersson et al. 2020).
inline constexpr float kFlipPixelsPerDegree = 67.0f;

// The means run over all pixels and the three colour channels; a is the test, b the reference.
// Colour is premultiplied (over black); a picture without alpha is opaque, grey is repeated.
struct Comparison {
  double rmse = 0.0;    // root of mean (a-b)², linear values (1: display white)
  double relMse = 0.0;  // mean (a-b)² / (b² + 0.01), linear values, no unit
  // On values as a display gets them: clamped to [0,1], sRGB-encoded, rounded to 0 … 255.
  double mae8 = 0.0;                // mean |a-b|, in steps of 1/255
  double max8 = 0.0;                // largest |a-b|, in steps of 1/255
  double psnr = 0.0;                // 10 log10(255² / mean (a-b)²), dB; infinite for equal pictures
  double flip = 0.0;                // mean of flipMap, 0 (equal) … 1
  double alphaMae8 = 0.0;           // mean |a-b| of alpha, in steps of 1/255
  std::size_t nonFinitePixels = 0;  // with NaN or infinity in a or b: left out of rmse and relMse, else black or white
  Image flipMap;                    // error per pixel in [0,1]: f32, 1 channel, linear
};

// Throws UsageError if the sizes differ, there are no pixels, or pixelsPerDegree is not in [1, 1000].
Comparison compareImages(const Image& a, const Image& b, float pixelsPerDegree = kFlipPixelsPerDegree);

// LDR-FLIP (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: "FLIP: A Difference Evaluator
// for Alternating Images", HPG 2020), the error per pixel: f32, 1 channel, linear, [0,1]. Values are clamped
// to [0,1] first, NaN counts as 0; alpha as in compareImages. Throws as compareImages.
Image flipMap(const Image& a, const Image& b, float pixelsPerDegree = kFlipPixelsPerDegree);

// A one-channel map in [0,1] as colours, u8 RGB: from black over violet and orange to light yellow, with
// steadily rising lightness.
Image colorMap(const Image& map);

}  // namespace quintet::io
#endif
