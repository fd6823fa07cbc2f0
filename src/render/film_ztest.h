// Are two renderings the same picture, up to their noise? A test of the hypothesis that the first outputs of two films
// have the same expectations, by the variances that the films' batches tell (film_state.h).
//
// Welch's t-test for each block of pixels and channel, and for the whole image per channel. Half of the level goes to the
// blocks and half to the whole, each by Šidák's correction (base/statistics.h). Testing renderers like that: K. Subr &
// J. Arvo, "Statistical Hypothesis Testing for Assessing Monte Carlo Estimators: Applications to Image Synthesis", 2007.
// Per block, because the mean of one pixel is far from normal where a path finds light seldom.
//
// What is assumed, and what becomes of it here:
//  * The films are independent: other seeds, or other samples of one seed.
//  * The batches of a pixel are independent. Those of a Sobol sequence repel each other, so the variance is overestimated.
//  * The pixels of a block are independent. Those of blue-noise sampling err against each other, so the variance of the
//    block's mean is overestimated, again. Pixels that err alike (one random number for all of them) would break the test.
//    Both overestimates make it conservative: it rejects the same picture less often than `level` says. `rms` tells how much.
//  * The difference is about normal. A rare, bright sample is in the mean and in its standard error, so alone it moves t by
//    no more than 1. With equal numbers of samples the difference is symmetric whatever the distribution, and then Student's
//    test is, if anything, conservative (B. Efron, "Student's t-Test Under Symmetry Conditions", 1969). With unequal
//    numbers heavy tails make it lopsided.
// Light that neither film has found yet is in no test.
#ifndef QUINTET_RENDER_FILM_ZTEST_H
#define QUINTET_RENDER_FILM_ZTEST_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/image.h"
#include "render/film_state.h"

namespace quintet::render {

// Fewer batches tell too little about their own spread.
inline constexpr std::uint64_t kZTestBatches = 8;

struct ZTestOptions {
  double level = 0.01;         // with which the same picture is rejected, at most; in (0, 1)
  std::uint32_t block = 8;     // side of a block, pixels, at least 1; blocks are aligned to the whole image
  double tolerance = 1e-5;     // relative difference that passes for rounding, e.g. of two devices
  std::uint32_t channels = 3;  // 4: alpha, too
};

// The means of both films over some pixels, in one channel.
struct ZTestMeans {
  Region region;  // of the whole image
  std::uint32_t channel = 0;
  std::array<double, 2> mean{};
  std::array<double, 2> error{};  // standard errors of the means
  double freedom = 1;             // degrees of, of the difference
  double p = 1;                   // of a difference as large as this one, if there is none

  double difference() const { return mean[0] - mean[1]; }
  double differenceError() const;  // standard error
  double t() const;                // 0 where there is no error
};

struct ZTest {
  std::vector<ZTestMeans> blocks;  // row by row, the channels of a block together
  std::vector<ZTestMeans> image;   // by channel
  double blockLevel = 0;           // a block's p below this rejects
  double imageLevel = 0;
  std::size_t smallest = 0;  // the block of smallest p
  // Blocks whose means have an error, and how their t is distributed: root mean square (1 for independent samples, less
  // where variances are overestimated) and which part lies beyond z of the normal distribution.
  std::size_t noisy = 0;
  double rms = 0;
  static constexpr std::array<double, 3> kZ{1.96, 2.58, 3.29};  // two-sided 5 %, 1 %, 0.1 %
  std::array<double, 3> beyond{};
  std::size_t nonFinitePixels = 0;  // in either film: in no mean, and the picture is rejected
  std::size_t unknownPixels = 0;    // finite, but in either film too bright for its squares (film_error.h): in no mean
  bool rejected = false;
};

// Throws UsageError for films of other regions, without squares, with fewer than kZTestBatches batches, or of unknown pixels
// alone.
ZTest zTest(const FilmState& a, const FilmState& b, const ZTestOptions& options = {});

// Of each pixel, the largest |t| of its block over the channels, divided by `scale` and clamped to [0, 1]; blocks without error
// whose means differ have 1. f32, 1 channel.
io::Image zTestMap(const ZTest& test, const Region& region, double scale = 5.0);

}  // namespace quintet::render
#endif
