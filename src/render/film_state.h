// What a film holds, on the host: read from the device, stored, merged with other parts, and turned into pictures. A merge
// is exact: the parts of a rendering give the words that one rendering would have given (see film.h).
#ifndef QUINTET_RENDER_FILM_STATE_H
#define QUINTET_RENDER_FILM_STATE_H

#include <cstdint>
#include <string>
#include <vector>

#include "io/image.h"
#include "program/program.h"
#include "quintet/shared/film.h"

namespace quintet::render {

using shared::kBatchSamples;

// Part of an image in pixels from the top left corner.
struct Region {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  bool operator==(const Region&) const = default;
};

// Samples [begin, end) of every pixel; begin is a multiple of kBatchSamples.
struct SampleRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  bool operator==(const SampleRange&) const = default;
};

// How many samples the pixels have: all alike, or by cell of a tile (shared::FilmTile).
struct SampleCounts {
  std::vector<SampleRange> ranges;  // sorted, disjoint, adjoining ones joined
  // Adaptive sampling: batches of cell 2 · tile + c, tiles row by row; batches [0, n), each whole. Empty: all alike.
  std::vector<std::uint32_t> cellBatches;

  void add(SampleRange range);    // throws UsageError where samples are there already
  std::uint64_t samples() const;  // of every pixel where all are alike
  std::uint64_t batches() const;
  std::uint64_t samplesOf(std::uint32_t cell) const {
    return cellBatches.empty() ? samples() : std::uint64_t{cellBatches[cell]} * kBatchSamples;
  }
  std::uint64_t batchesOf(std::uint32_t cell) const { return cellBatches.empty() ? batches() : cellBatches[cell]; }
  bool operator==(const SampleCounts&) const = default;
};

// One output. Which vector is filled follows from `pixel`; all are empty for an optional output that nobody wanted.
struct FilmPlane {
  std::string name;
  program::OutputPixel pixel = program::OutputPixel::mean;
  std::vector<shared::FixedSum> sums;  // mean: RGBA per pixel, sum over all samples
  std::vector<shared::FixedSum>
      squares;               // mean of the first output: sum over batches of (batch sum)² / samples of the batch
  std::vector<vec4> values;  // center; or the last frame, where the program accumulates
  std::vector<shared::CoverageSlot> coverage;  // coverage: kCoverageSlots per pixel

  bool stored() const { return !sums.empty() || !values.empty() || !coverage.empty(); }
};

struct FilmState {
  Region region;
  SampleCounts counts;
  std::vector<FilmPlane> planes;  // one per output of the program
  std::vector<uvec2> statistics;  // per pixel: rays, samples dropped

  std::size_t pixelCount() const { return std::size_t{region.width} * region.height; }
  // Cell of a pixel (from the film's first one).
  std::uint32_t cellOf(std::uint32_t x, std::uint32_t y) const;
};

// Number of tiles in a row of a film of this width.
std::uint32_t tileColumns(std::uint32_t width);
std::uint32_t tileCount(const Region& region);

// A rendering may have got there: all pixels have the first samples, whole batches of them, then each cell its own.
// `plan`: numbers of batches by cell, or empty.
bool arePossible(const SampleCounts& counts, const std::vector<std::uint32_t>& plan);

// Pixels of each cell, in the order of SampleCounts::cellBatches.
std::vector<std::uint32_t> cellPixels(const Region& region);
// Samples per pixel, on average.
double averageSamples(const Region& region, const SampleCounts& counts);

// The counts of rows [first, first + rows) of a film of this width; `first` is a multiple of shared::kTileSize.
SampleCounts countsOfRows(const SampleCounts& counts, std::uint32_t width, std::uint32_t first, std::uint32_t rows);

// RGBA floats, linear, premultiplied: the mean of all samples, or the values. Throws UsageError for coverage and for an
// output that is not stored.
io::Image planeImage(const FilmState& film, std::size_t output);
// Of word i of `sums`, a pixel's channel with so many samples in so many batches, at least 2: the variance of its mean, as
// varianceImage states it. NaN where sums or squares are beyond the film's range.
double varianceOfMean(const FilmPlane& plane, std::size_t i, double samples, double batches);
// Variance of that mean per pixel and channel, estimated from the spread of its batches; infinite below two batches. For
// well-distributed samples (Owen-scrambled Sobol) it is an upper bound in expectation: batches of a pixel repel each other.
// Q = Σ sᵦ²/nᵦ, S = Σ sᵦ, N = Σ nᵦ over B batches: (Q - S²/N) / ((B - 1) N).
io::Image varianceImage(const FilmState& film, std::size_t output = 0);

// The same region, outputs and arrays: one may stand for the other, or join it.
bool sameArrays(const FilmState& a, const FilmState& b);

// `part` joins `film`: sums add up, coverage is counted together, centres come from the part that has sample 0. Throws
// UsageError where both have the same samples, and for adaptive parts; asserts that planes and region agree.
void mergeFilm(FilmState& film, const FilmState& part);

}  // namespace quintet::render
#endif
