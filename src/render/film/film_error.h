// SPDX-License-Identifier: Apache-2.0
// Error estimate of a film's image from the spread of its batches.
//
// The error of an image I with the expectation R is relative, and the root mean square over pixels p and channels c:
//   error² = mean_p [ 1/3 Σ_c (I_pc - R_pc)² / (Y_p² + ε²) ]
// with the luminance Y of R and ε = 0.1 times the image's mean luminance. The estimate replaces (I - R)² by
// varianceImage (film_state.h), and Y_p by a luminance from I and its neighborhood
// (ErrorEstimator::referenceLuminance).
#ifndef QUINTET_RENDER_FILM_FILM_ERROR_H
#define QUINTET_RENDER_FILM_FILM_ERROR_H

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "render/film/film_state.h"

namespace quintet::render {

// Sums over the pixels of one cell.
struct CellError {
  std::uint32_t pixels = 0;
  std::uint64_t batches = 0;
  double squares = 0;  // Σ of the squared relative errors
  double fourths = 0;  // Σ of their fourth powers
};

// Sums over the pixels of any number of cells, and the errors that follow from them. With v for the squared relative
// error of a pixel, which is an estimated variance:
struct ErrorSums {
  double pixels = 0;
  double squares = 0;          // Σ v
  double fourths = 0;          // Σ v²
  double fourthsByDegree = 0;  // Σ v² / degrees of freedom of v

  void add(const CellError& cell);
  double estimate() const;  // root mean square of the pixels' errors
  // Square of upper() over the square of estimate(): the 95 % quantile of Fisher's F, with the degrees of freedom of
  // both sums of squares by Satterthwaite 1946. 1 for a black image, which has no error.
  double marginSquared() const;
  double upper() const;  // the true error is below this bound with 95 % confidence
};

// All errors are infinite while they are unknown: with fewer than two batches, or if squares exceed the film's range
// (radiance of 2e9 or more).
struct ErrorEstimate {
  double image = std::numeric_limits<double>::infinity();  // estimate of `error` as defined above
  // Bound that `error` does not exceed with 95 % confidence. This is the error that users see.
  double upper = std::numeric_limits<double>::infinity();
  // Bound of the same kind that 95 % of the tiles do not exceed.
  double tiles = std::numeric_limits<double>::infinity();
  std::vector<CellError> cells;  // in the order of SampleCounts::cellBatches

  bool known() const { return upper < std::numeric_limits<double>::infinity(); }
  bool reaches(double target) const { return upper <= target && tiles <= 2.0 * target; }
};

// Estimates the error of the first output.
//
// `upper`: for normally distributed pixels, the square of the true error over its estimate follows Fisher's F. Its
// degrees of freedom are those of as many pixels of equal variance as have the same sum of squares (Satterthwaite
// 1946). The bound is therefore wider for an image whose noise is in a few pixels, and for few batches. Each tile has a
// bound of the same kind, and `tiles` is their 95th percentile.
//
// Repeated convergence checks (--until-error) need no further margin: the checks decide by the spread of the batches,
// which varies less than the error itself, and Fisher's F covers both. docs/measurements.md reports the coverage at the
// stop.
//
// Limits: light that no sample has found yet does not contribute to the estimate. With blue-noise sampling the pixels
// of a tile are not independent, and the sum of their squared errors varies more. It does so most where samples are
// best distributed, and there the batches overestimate the error by more than that. The test
// ErrorEstimate.CoversTheErrorOfSamplerNumbers measures how much it varies where nothing is overestimated.
ErrorEstimate estimateError(const FilmState& film);

// Estimates the same error from strips, so that a large film need not be in host memory at once.
class ErrorEstimator {
 public:
  ErrorEstimator(const Region& region, const SampleCounts& counts);
  // Adds a strip of whole tile rows, with counts from countsOfRows(). Each strip is added once; the order does not
  // matter.
  void add(const FilmState& strip, std::uint32_t firstRow);
  ErrorEstimate estimate() const;

 private:
  struct Moments {
    float luminance = 0;  // of a pixel's mean
    float variance = 0;   // of that mean, averaged over the channels
  };
  static Moments momentsOf(const FilmPlane& plane, std::size_t pixel, double samples, double batches);
  // Returns the luminance relative to which a pixel's error is taken.
  //
  // The pixel's own luminance I would underestimate the error where noise is skewed: a pixel with a rare bright sample
  // has a large variance v and a large I, and the other pixels have neither. In expectation
  //   v / I² = r (1 + 3 r - 2 κ √r + …)
  // where r is the mean's relative variance and κ its skewness. The pixels around it do not share its samples. The
  // result is therefore the mean luminance of the pixels of the same parity (cells must not depend on each other)
  // within two rows and columns that are not brighter than I + √v. It is clamped to at least I - √v, for edges and
  // texture, and to at most I. For uniform noise it is too low by about 0.4 √v, which vanishes with v.
  double referenceLuminance(std::uint32_t x, std::uint32_t y) const;
  // Returns ε² for the cells with even x + y and for the others. Each is computed from the pixels of its own parity.
  std::array<double, 2> epsilonSquared() const;
  // Adds a row of tiles to its cells. Returns false if the variance of a pixel is unknown.
  bool addTileRow(std::uint32_t row, const std::array<double, 2>& epsilonSquared, std::vector<CellError>& cells) const;

  FilmState shape_;  // region and counts only
  bool known_ = true;
  std::vector<Moments> moments_;
};

}  // namespace quintet::render
#endif
