// SPDX-License-Identifier: Apache-2.0
// Films on the host: sample counts, means and variances, and parts that merge to the same words as one film.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "base/error.h"
#include "render/film/film_file.h"
#include "render/film/film_state.h"
#include "render/film/fixed_sum.h"

namespace quintet::render {
namespace {

TEST(SampleCounts, JoinsAdjacentRanges) {
  SampleCounts counts;
  counts.add({8, 12});
  counts.add({0, 4});
  EXPECT_EQ(counts.ranges, (std::vector<SampleRange>{{0, 4}, {8, 12}}));
  counts.add({4, 8});
  EXPECT_EQ(counts.ranges, (std::vector<SampleRange>{{0, 12}}));
  counts.add({12, 13});
  EXPECT_EQ(counts.samples(), 13u);
  EXPECT_EQ(counts.batches(), 4u);
}

TEST(SampleCounts, RejectsDuplicateSamples) {
  for (const SampleRange range : {SampleRange{0, 8}, {4, 8}, {6, 7}, {8, 20}, {0, 100}}) {
    SampleCounts counts;
    counts.add({4, 12});
    EXPECT_THROW(counts.add(range), UsageError) << range.begin;
    EXPECT_EQ(counts.ranges.size(), 1u);
  }
}

// Makes films as programs render them: batch sums of a few pixels, ids, and center values in the first batch.
struct Maker {
  std::mt19937 random{3};
  Region region{2, 1, 5, 3};
  std::vector<std::vector<vec4>> sums;  // by batch
  std::vector<std::vector<std::uint32_t>> ids;

  explicit Maker(int batches) {
    std::normal_distribution<float> normal(2.0f, 1.0f);
    for (int b = 0; b < batches; ++b) {
      std::vector<vec4> pixels;
      std::vector<std::uint32_t> drawn;
      for (std::uint32_t p = 0; p < region.width * region.height; ++p) {
        pixels.emplace_back(normal(random), 10.0f * normal(random), 1e-5f * normal(random), 4.0f);
        for (std::uint32_t s = 0; s < kBatchSamples; ++s)
          drawn.push_back(1 + static_cast<std::uint32_t>(random() % (p == 0 ? 40 : 5)));
      }
      sums.push_back(pixels);
      ids.push_back(drawn);
    }
  }

  FilmState film(const std::vector<int>& batches) const {
    FilmState film{region, {}, {}, std::vector<uvec2>(15)};
    using program::OutputPixel;
    film.planes.resize(3);
    film.planes[0] = {
        .name = "color", .sums = std::vector<shared::FixedSum>(60), .squares = std::vector<shared::FixedSum>(60)};
    film.planes[1] = {.name = "depth", .pixel = OutputPixel::center, .values = std::vector<vec4>(15)};
    film.planes[2] = {.name = "ids",
                      .pixel = OutputPixel::coverage,
                      .coverage = std::vector<shared::CoverageSlot>(15 * shared::kCoverageSlots)};
    for (const int b : batches) add(film, static_cast<std::size_t>(b));
    return film;
  }

  void add(FilmState& film, std::size_t b) const {
    film.counts.add({static_cast<std::uint32_t>(4 * b), static_cast<std::uint32_t>(4 * b + 4)});
    for (std::size_t i = 0; i < 60; ++i) {
      const float sum = sums[b][i / 4][static_cast<int>(i % 4)];
      film.planes[0].sums[i] = addFixed(film.planes[0].sums[i], fixedFromFloat(sum));
      film.planes[0].squares[i] = addFixed(film.planes[0].squares[i], fixedFromFloat(sum * sum * 0.25f));
      if (b == 0) film.planes[1].values[i / 4] = sums[0][i / 4];
    }
    for (std::size_t p = 0; p < 15; ++p) {
      film.statistics[p] += uvec2(b + p, 1);
      // The rule in its simplest form: count all ids, and keep the smallest.
      std::map<std::uint32_t, std::uint32_t> counted;
      shared::CoverageSlot* slots = &film.planes[2].coverage[p * shared::kCoverageSlots];
      for (std::uint32_t s = 0; s < shared::kCoverageSlots; ++s)
        if (slots[s].samples > 0) counted[slots[s].id] = slots[s].samples;
      for (std::uint32_t s = 0; s < kBatchSamples; ++s) ++counted[ids[b][p * kBatchSamples + s]];
      std::uint32_t slot = 0;
      for (const auto& [id, samples] : counted)
        if (slot < shared::kCoverageSlots) slots[slot++] = {id, samples};
    }
  }
};

// Compares all contents, which a film file stores without loss.
bool sameBytes(const FilmState& a, const FilmState& b) { return encodeFilm({{}, {}, a}) == encodeFilm({{}, {}, b}); }

TEST(FilmState, MergesPartsInAnyOrder) {
  const Maker maker(10);
  const FilmState whole = maker.film({0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  const std::vector<std::vector<int>> parts{{0, 1, 2}, {3}, {4, 5, 6, 7}, {8, 9}};
  std::vector<std::size_t> order{0, 1, 2, 3};
  do {
    FilmState joined = maker.film(parts[order[0]]);
    for (std::size_t i = 1; i < 4; ++i) mergeFilm(joined, maker.film(parts[order[i]]));
    ASSERT_TRUE(sameBytes(joined, whole));
  } while (std::ranges::next_permutation(order).found);
  FilmState left = maker.film(parts[0]), right = maker.film(parts[2]);
  mergeFilm(right, maker.film(parts[3]));
  mergeFilm(left, maker.film(parts[1]));
  mergeFilm(left, right);
  EXPECT_TRUE(sameBytes(left, whole));
}

TEST(FilmState, RejectsDuplicateSamplesWithoutChange) {
  const Maker maker(4);
  FilmState film = maker.film({0, 1});
  EXPECT_THROW(mergeFilm(film, maker.film({1, 2})), UsageError);
  EXPECT_TRUE(sameBytes(film, maker.film({0, 1})));
}

// The films of devices that share batches: none has the counts, and each has the center values of some pixels.
TEST(FilmState, AddsFilmsOfSharedBatches) {
  const Maker maker(6);
  const FilmState whole = maker.film({0, 1, 2, 3, 4, 5});
  for (const bool reversed : {false, true}) {
    FilmState first = maker.film({3, 0, 4}), second = maker.film({1, 2, 5});
    second.planes[1].values = first.planes[1].values;
    for (std::size_t p = 0; p < 15; ++p) (p < 7 ? first : second).planes[1].values[p] = vec4(0.0f);
    first.counts = second.counts = {};
    if (reversed) std::swap(first, second);
    addFilm(first, second);
    EXPECT_TRUE(first.counts.ranges.empty());
    first.counts = whole.counts;
    EXPECT_TRUE(sameBytes(first, whole));
  }
}

TEST(FilmState, ComputesMeansAndVariancesFromBatches) {
  const int count = 12;
  const Maker maker(count);
  std::vector<int> all(count);
  std::iota(all.begin(), all.end(), 0);
  const FilmState film = maker.film(all);
  const io::Image mean = planeImage(film, 0), variance = varianceImage(film);
  for (std::uint32_t y = 0; y < 3; ++y)
    for (std::uint32_t x = 0; x < 5; ++x)
      for (int c = 0; c < 3; ++c) {
        double sum = 0, spread = 0;
        for (const auto& batch : maker.sums) sum += static_cast<double>(batch[y * 5 + x][c]) / 4 / count;
        for (const auto& batch : maker.sums) spread += std::pow(static_cast<double>(batch[y * 5 + x][c]) / 4 - sum, 2);
        EXPECT_NEAR(mean.pixel<float>(x, y)[static_cast<std::size_t>(c)] / sum, 1.0, 1e-5);
        EXPECT_NEAR(variance.pixel<float>(x, y)[static_cast<std::size_t>(c)] / (spread / (count - 1) / count), 1.0,
                    1e-4);
      }
}

TEST(FilmState, HasInfiniteVarianceBelowTwoBatches) {
  EXPECT_TRUE(std::isinf(varianceImage(Maker(1).film({0})).pixel<float>(0, 0)[0]));
}

TEST(FilmState, DividesByTheSamplesOfACell) {
  const Maker maker(3);
  FilmState film = maker.film({0, 1, 2});
  film.counts.cellBatches = {3, 1};  // a single tile
  EXPECT_EQ(tileCount(film.region), 1u);
  const io::Image all = planeImage(maker.film({0, 1, 2}), 0), image = planeImage(film, 0);
  EXPECT_EQ(image.pixel<float>(2, 0)[1], all.pixel<float>(2, 0)[1]);
  EXPECT_NEAR(image.pixel<float>(1, 0)[1], 3.0f * all.pixel<float>(1, 0)[1], 1e-5f * all.pixel<float>(1, 0)[1] + 1e-4f);
  EXPECT_THROW(mergeFilm(film, maker.film({})), UsageError);
}

TEST(FilmState, CoversTheRegionWithTiles) {
  EXPECT_EQ(tileCount({0, 0, 32, 32}), 1u);
  EXPECT_EQ(tileCount({0, 0, 33, 32}), 2u);
  const FilmState film{{0, 0, 70, 40}, {}, {}, {}};
  EXPECT_EQ(film.cellOf(0, 0), 0u);
  EXPECT_EQ(film.cellOf(1, 0), 1u);
  EXPECT_EQ(film.cellOf(32, 0), 2u);
  EXPECT_EQ(film.cellOf(69, 39), 2u * 5u);
}

TEST(FilmState, DividesAllPixelsAmongCells) {
  for (const Region& region : {Region{0, 0, 70, 40}, {3, 5, 1, 1}, {0, 0, 33, 31}, {1, 0, 64, 3}}) {
    const FilmState film{region, {}, {}, {}};
    std::vector<std::uint32_t> pixels(2 * tileCount(region)), batches;
    for (std::uint32_t y = 0; y < region.height; ++y)
      for (std::uint32_t x = 0; x < region.width; ++x) ++pixels[film.cellOf(x, y)];
    EXPECT_EQ(cellPixels(region), pixels);
    double sum = 0;
    for (std::uint32_t c = 0; c < pixels.size(); ++c) {
      batches.push_back(2 + c * c);
      sum += 4.0 * pixels[c] * batches[c];
    }
    EXPECT_DOUBLE_EQ(averageSamples(region, {{{0, 8}}, batches}), sum / static_cast<double>(film.pixelCount()));
  }
  EXPECT_EQ(averageSamples({0, 0, 70, 40}, {{{0, 8}, {12, 14}}, {}}), 10.0);
}

TEST(FilmState, HasNoImageOfCoverage) { EXPECT_THROW(planeImage(Maker(1).film({0}), 2), UsageError); }

TEST(FilmState, LaunchesBeginAtMultiplesOfRows) {
  for (const std::uint32_t height : {1u, 7u, 8u, 45u, 64u})
    for (std::uint32_t rows = 1; rows <= height + 9; ++rows)
      for (std::uint32_t row = 0; row < height;) {
        const std::uint32_t end = launchEnd(row, rows, height);
        ASSERT_GT(end, row);
        ASSERT_LE(end - row, rows);
        ASSERT_LE(end, height);
        const bool isAligned = end % kLaunchRows == 0 || end == height;
        ASSERT_TRUE(isAligned || rows < kLaunchRows) << row << ' ' << rows;
        ASSERT_TRUE(end == height || row + rows < height) << row << ' ' << rows;
        row = end;
      }
}

}  // namespace
}  // namespace quintet::render
