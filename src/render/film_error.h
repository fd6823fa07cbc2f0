// How wrong a film's picture still is, from the spread of its batches; and how many batches each cell of adaptive
// sampling should get.
//
// The error of a picture I with the expectation R is relative and a root mean square over pixels p and channels c:
//   error² = mean_p [ 1/3 Σ_c (I_pc - R_pc)² / (Y_p² + ε²) ],   Y: luminance, ε = a tenth of the picture's mean luminance.
// The estimate puts varianceImage (film_state.h) in the place of (I - R)², and in that of R what I and the pixels around it
// say (ErrorEstimator::weightOf).
#ifndef QUINTET_RENDER_FILM_ERROR_H
#define QUINTET_RENDER_FILM_ERROR_H

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "render/film_state.h"

namespace quintet::render {

// Of one cell, sums over its pixels.
struct CellError {
  std::uint32_t pixels = 0;
  std::uint64_t batches = 0;
  double squares = 0;  // of the pixels' relative errors
  double fourths = 0;  // fourth powers
};

struct ErrorEstimate {
  // Infinite as long as they are not known: below two batches, or where squares were beyond the film's range (radiance of
  // 2e9 and more).
  double image = std::numeric_limits<double>::infinity();  // the estimate of `error`
  double upper = std::numeric_limits<double>::infinity();  // with 95 % confidence `error` is below this; what is stated
  double tiles =
      std::numeric_limits<double>::infinity();  // 95 % of the tiles have a smaller error, with such confidence
  std::vector<CellError> cells;                 // SampleCounts::cellBatches' order

  bool known() const { return upper < std::numeric_limits<double>::infinity(); }
  bool reaches(double target) const { return upper <= target && tiles <= 2.0 * target; }
};

// Of the first output. `upper`: the square of the real error over its estimate follows Fisher's F for normally distributed
// pixels, with so many degrees of freedom as pixels of equal variance would have (Satterthwaite 1946): a picture whose
// noise is in a few pixels, or of few batches, is stated with the room it needs. So is each tile; `tiles` is the percentile of
// what is stated of them. Nothing is added for looking several times (--until-error): what the looks choose by, the spread of
// the batches, scatters less than the error itself, and Fisher's F has room for both; docs/measurements.md has the coverage at
// the stop. Light that no sample has found yet is in nothing. The pixels of a tile are not independent where errors are
// blue noise, and the sum of their squares scatters more. It does so most where samples are spread best, and there batches
// overstate the error by more than that; StatedError.CoversWhatTheSamplerDraws has what scatters with nothing overstated.
ErrorEstimate estimateError(const FilmState& film);

// The same for a film that is read in strips of whole tile rows (their counts: countsOfRows), each once, in any order: a film is large.
class ErrorEstimator {
 public:
  ErrorEstimator(const Region& region, const SampleCounts& counts);
  void add(const FilmState& strip, std::uint32_t firstRow);
  ErrorEstimate estimate() const;

 private:
  struct Moments {
    float luminance = 0;  // of a pixel's mean
    float variance = 0;   // of that mean, averaged over the channels
  };
  static Moments momentsOf(const FilmPlane& plane, std::size_t pixel, double samples, double batches);
  // The luminance that a pixel's error is taken relative to. Its own, I, would understate it where noise is skewed: a pixel
  // that has met a rare bright sample has the large variance v and the large I, those that have not have neither, and in
  // expectation v / I² = r (1 + 3 r - 2 κ √r + …) with the mean's relative variance r and skewness κ. So it is what the pixels around it say, which know nothing of its luck: the mean of those of its parity
  // within two rows and columns (cells must know nothing of each other) that are not brighter than I + √v, but not below I - √v
  // (edges, texture), and I at most. For even noise that is too low by some 0.4 √v, which goes with v.
  double weightOf(std::uint32_t x, std::uint32_t y) const;
  // To the cells of a row of tiles, with ε² by parity; false: some variance is not known.
  bool addTileRow(std::uint32_t row, const std::array<double, 2>& darkness, std::vector<CellError>& cells) const;

  FilmState shape_;  // region and counts
  bool known_ = true;
  std::vector<Moments> moments_;
};

struct CellGoal {
  double error = 0;    // for ErrorEstimate::reaches; 0: none, use all of `batches`
  double batches = 0;  // per pixel on average, at most; 0: no limit
};

// How many batches each cell should have at the end, at least as many as it has. Of all ways to reach a mean square error
// the cheapest has numbers in proportion to the standard deviation (Neyman 1934). The spread of a cell is taken from
// the other cell of its tile, whose pixels are drawn independently: the number of a cell's samples then does not depend on
// their values, which would bias the mean (Kirk & Arvo 1991, "Unbiased Sampling Techniques for Image Synthesis"). So do the
// factor that all even cells share, their part of the batches or of the error, and ε: they come from the odd ones, and
// the reverse. (Only a tile that has no other cell, one pixel at an edge, decides by itself.) In later decisions a dependence
// remains through the numbers of earlier ones. docs/design/path-tracer.md, "How many samples".
std::vector<std::uint32_t> planCells(const ErrorEstimate& estimate, const CellGoal& goal);

}  // namespace quintet::render
#endif
