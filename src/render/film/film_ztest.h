// SPDX-License-Identifier: Apache-2.0
// Statistical test of whether two renders show the same image up to their noise. The null hypothesis is that the first
// outputs of two films have the same expectation; the noise is known from the films' batches (varianceOfMean in
// film_state.h).
//
// Welch's t-test is applied per block of pixels and channel, and per channel to the whole image. Half of the
// significance level goes to the blocks and half to the whole image, each with Šidák's correction (base/statistics.h).
// Renderers are tested this way by K. Subr & J. Arvo, "Statistical Hypothesis Testing for Assessing Monte Carlo
// Estimators: Applications to Image Synthesis", 2007. Blocks are used because the mean of a single pixel is far from
// normal where a path finds light rarely.
//
// Assumptions, and what follows where they do not hold:
//  * The films are independent: different seeds, or different samples of one seed.
//  * The batches of a pixel are independent. Batches of a Sobol sequence are negatively correlated, so the variance is
//    overestimated.
//  * The pixels of a block are independent. With blue-noise sampling their errors are negatively correlated, so the
//    variance of the block's mean is overestimated, too. Positively correlated pixels (one random number for all of
//    them) would invalidate the test. Both overestimates make it conservative: it rejects equal images less often than
//    `level` says. `rms` measures by how much.
//  * The difference is approximately normal. A rare bright sample contributes to the mean and to its standard error, so
//    alone it moves t by at most 1. With equal numbers of samples the difference is symmetric for any distribution, and
//    then Student's test is, if anything, conservative (B. Efron, "Student's t-Test Under Symmetry Conditions", 1969).
//    With unequal numbers, heavy tails make it asymmetric.
// Light that neither film has found yet is not tested.
#ifndef QUINTET_RENDER_FILM_FILM_ZTEST_H
#define QUINTET_RENDER_FILM_FILM_ZTEST_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/image.h"
#include "render/film/film_state.h"

namespace quintet::render {

// Smallest number of batches whose spread is a usable estimate.
inline constexpr std::uint64_t kZTestBatches = 8;

struct ZTestOptions {
  double level = 0.01;         // significance level, in (0, 1): largest probability of rejecting equal images
  std::uint32_t block = 8;     // side of a block in pixels, at least 1; blocks are aligned to the whole image
  double tolerance = 1e-5;     // relative difference that counts as rounding error, e.g. between two devices
  std::uint32_t channels = 3;  // 4 includes alpha
};

// The means of both films over some pixels, in one channel.
struct ZTestMeans {
  Region region;  // in pixels of the whole image
  std::uint32_t channel = 0;
  std::array<double, 2> mean{};
  std::array<double, 2> error{};  // standard errors of the means
  double freedom = 1;             // degrees of freedom of the difference
  double p = 1;                   // p-value of the difference

  double difference() const { return mean[0] - mean[1]; }
  double differenceError() const;  // standard error of the difference
  double t() const;                // 0 if the standard error is 0
};

struct ZTest {
  std::vector<ZTestMeans> blocks;  // in row-major order, with the channels of a block adjacent
  std::vector<ZTestMeans> image;   // per channel
  double blockLevel = 0;           // a block with a smaller p-value rejects the images
  double imageLevel = 0;           // the same for the whole image
  std::size_t smallest = 0;        // index of the block with the smallest p-value
  // Distribution of t over the `noisy` blocks, whose standard error is not 0. `rms` is its root mean square: 1 for
  // independent samples, less where variances are overestimated. `beyond` are the fractions beyond kZ of the normal
  // distribution.
  std::size_t noisy = 0;
  double rms = 0;
  static constexpr std::array<double, 3> kZ{1.96, 2.58, 3.29};  // two-sided 5 %, 1 %, 0.1 %
  std::array<double, 3> beyond{};
  std::size_t nonFinitePixels = 0;  // not finite in either film: excluded from all means, and the images are rejected
  std::size_t unknownPixels = 0;    // finite, but too bright for the squares of either film (film_error.h): excluded
  bool rejected = false;
};

// Throws UsageError if the films have different regions, no squares, fewer than kZTestBatches batches, or only unknown
// pixels.
ZTest zTest(const FilmState& a, const FilmState& b, const ZTestOptions& options = {});

// Returns an f32 image of one channel: for each pixel, the largest |t| of its block over the channels, divided by
// `scale` and clamped to [0, 1]. Blocks without standard error whose means differ have the value 1.
io::Image zTestMap(const ZTest& test, const Region& region, double scale = 5.0);

}  // namespace quintet::render
#endif
