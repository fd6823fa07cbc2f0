// SPDX-License-Identifier: Apache-2.0
// The contents of a film in host memory: read from the device, stored in files, merged, and converted to images.
// Merging is exact: the parts of a render give the same words as one render of all samples (see film.h).
#ifndef QUINTET_RENDER_FILM_FILM_STATE_H
#define QUINTET_RENDER_FILM_FILM_STATE_H

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/image.h"
#include "program/description/program.h"
#include "quintet/shared/film.h"

namespace quintet::render {

using shared::kBatchSamples;

// Launches begin at multiples of this number of rows, unless they are shorter. However a film is divided, groups of 32
// invocations (8 x 4 pixels on NVIDIA) then have the same pixels, which there decide what a ray hits that meets the
// common edge of two triangles (docs/design/quirks.md).
inline constexpr std::uint32_t kLaunchRows = 8;
// Returns the end of a launch that begins at `row` and has at most `rows` of the rows up to `height`.
std::uint32_t launchEnd(std::uint32_t row, std::uint32_t rows, std::uint32_t height);

// A rectangle of an image in pixels, measured from the top left corner.
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

// The samples that each pixel has: the same for all pixels, or per cell of a tile (shared::FilmTile).
struct SampleCounts {
  std::vector<SampleRange> ranges;  // sorted and disjoint; adjacent ranges are joined
  // Adaptive sampling: number of batches of cell 2 · tile + c, with tiles in row-major order. A cell with n batches has
  // the whole batches [0, n). Empty means that all pixels have the samples of `ranges`.
  std::vector<std::uint32_t> cellBatches;

  void add(SampleRange range);    // throws UsageError if some of the samples are already counted
  std::uint64_t samples() const;  // per pixel, from `ranges`
  std::uint64_t batches() const;  // per pixel, from `ranges`
  std::uint64_t samplesOf(std::uint32_t cell) const {
    return cellBatches.empty() ? samples() : std::uint64_t{cellBatches[cell]} * kBatchSamples;
  }
  std::uint64_t batchesOf(std::uint32_t cell) const { return cellBatches.empty() ? batches() : cellBatches[cell]; }
  bool operator==(const SampleCounts&) const = default;
};

// One output of the program. `pixel` decides which vector holds its values; all vectors are empty for an optional
// output that was not requested.
struct FilmPlane {
  std::string name;
  program::OutputPixel pixel = program::OutputPixel::mean;
  program::OutputKind kind = program::OutputKind::color;
  bool color = true;  // channels R, G and B hold a color (program::holdsColor)
  // OutputPixel::mean: sums over all samples, RGBA per pixel. For the first output also the squares of its batches,
  // Σ (batch sum)² / samples of the batch.
  std::vector<shared::FixedSum> sums;
  std::vector<shared::FixedSum> squares;
  std::vector<vec4> values;                    // OutputPixel::center; or the last frame of a program that accumulates
  std::vector<shared::CoverageSlot> coverage;  // OutputPixel::coverage: kCoverageSlots per pixel

  bool stored() const { return !sums.empty() || !values.empty() || !coverage.empty(); }
};

struct FilmState {
  Region region;
  SampleCounts counts;
  std::vector<FilmPlane> planes;  // one per output of the program
  std::vector<uvec2> statistics;  // per pixel: rays and dropped samples

  std::size_t pixelCount() const { return std::size_t{region.width} * region.height; }
  // Returns the cell of the pixel at column x and row y of the film.
  std::uint32_t cellOf(std::uint32_t x, std::uint32_t y) const;
};

// Rays traced, and samples that the program discarded because they were not finite (countRays of
// quintet/output.glsl).
struct RayCount {
  std::uint64_t rays = 0;
  std::uint64_t droppedSamples = 0;
  uvec2 firstDropped{0};  // the first pixel with such a sample: in the whole image, row by row from the top
};
// `statistics`: FilmState::statistics of a film of this region.
RayCount countRays(std::span<const uvec2> statistics, const Region& region);

// Pixels of an output that have a channel that is not finite. The samples of such a pixel are lost.
struct NotFinitePixels {
  std::string output;
  std::uint64_t count = 0;
  uvec2 first{0};  // in the whole image, row by row from the top
  bool operator==(const NotFinitePixels&) const = default;
};
// Returns the outputs with such pixels, in the order of the film. Outputs that count ids have none.
std::vector<NotFinitePixels> findNotFinite(const FilmState& film);
// Returns the pixel of the whole image with this index in the film.
uvec2 pixelAt(const Region& region, std::uint64_t index);

// Returns the number of tiles in a row of a film of this width in pixels.
std::uint32_t tileColumns(std::uint32_t width);
std::uint32_t tileCount(const Region& region);
// Returns the end of the tiles from `first` on that have the same batch.
std::size_t endOfBatch(std::span<const shared::FilmTile> tiles, std::size_t first);

// Returns whether a render can have these counts: the same whole batches in all pixels from sample 0 on, and then more
// batches per cell. `plan` holds batches per cell; it is empty for a render without a plan.
bool areConsistent(const SampleCounts& counts, const std::vector<std::uint32_t>& plan);

// Returns the number of pixels of each cell, in the order of SampleCounts::cellBatches.
std::vector<std::uint32_t> cellPixels(const Region& region);
// Returns the mean number of samples per pixel.
double averageSamples(const Region& region, const SampleCounts& counts);

// Returns the counts of rows [first, first + rows) of a film of this width. `first` is a multiple of shared::kTileSize.
SampleCounts countsOfRows(const SampleCounts& counts, std::uint32_t width, std::uint32_t first, std::uint32_t rows);

// Returns the mean of all samples, or the values, as linear premultiplied RGBA floats. Throws UsageError for coverage
// and for an output that is not stored.
io::Image planeImage(const FilmState& film, std::size_t output);
// Returns the variance of the mean of word i of `sums`, which is one channel of a pixel with these numbers of samples
// and batches (at least 2), by the formula of varianceImage. NaN if sums or squares exceed the film's range.
double varianceOfMean(const FilmPlane& plane, std::size_t i, double samples, double batches);
// Returns the variance of the mean per pixel and channel, estimated from the spread of the pixel's batches; infinite
// for fewer than two batches. With Q = Σ sᵦ²/nᵦ, S = Σ sᵦ and N = Σ nᵦ over B batches it is (Q - S²/N) / ((B - 1) N).
// For well-distributed samples (Owen-scrambled Sobol) it is an upper bound in expectation, because the batches of a
// pixel are negatively correlated.
io::Image varianceImage(const FilmState& film, std::size_t output = 0);

// Returns whether both films have the same region, outputs and arrays, so that one can replace the other or be merged
// with it.
bool sameArrays(const FilmState& a, const FilmState& b);

// Merges the kCoverageSlots slots of a pixel into those of `into` by the rule of film_coverage.glsl: sorted by id, the
// smallest ids are kept.
void mergeCoverage(shared::CoverageSlot* into, const shared::CoverageSlot* from);

// Merges `part` into `film`: adds sums, merges coverage, and takes center values from the part that has sample 0.
// Throws UsageError if both have the same samples, or if either is adaptive. Asserts sameArrays().
void mergeFilm(FilmState& film, const FilmState& part);

// Adds what other devices have rendered of the same samples (Renderer::takeFilm): sums, coverage and statistics, and the center
// values of pixels that only `part` has. The counts of `film` stay. Asserts sameArrays().
void addFilm(FilmState& film, const FilmState& part);

}  // namespace quintet::render
#endif
