// SPDX-License-Identifier: Apache-2.0
// The statistical test of two films whose samples are known: what it accepts, what it rejects, and its error rate.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/statistics.h"
#include "render/film/film_ztest.h"
#include "render/film/fixed_sum.h"

namespace quintet::render {
namespace {

using Random = std::mt19937_64;
using Draw = std::function<double(std::uint32_t x, std::uint32_t y)>;  // one sample of one channel

FilmState emptyFilm(const Region& region) {
  FilmState film;
  film.region = region;
  const std::vector<shared::FixedSum> zero(4 * film.pixelCount());
  film.planes = {{.name = "color", .sums = zero, .squares = zero}};
  return film;
}

void addBatchSum(FilmState& film, std::size_t i, float sum, std::uint32_t samples) {
  FilmPlane& plane = film.planes[0];
  plane.sums[i] = addFixed(plane.sums[i], fixedFromFloat(sum));
  plane.squares[i] = addFixed(plane.squares[i], fixedFromFloat(sum * sum * (1.0f / static_cast<float>(samples))));
}

// Renders as a device does: in batches of 4 samples, of which the last can be smaller.
FilmState film(const Region& region, std::uint32_t samples, const Draw& draw) {
  FilmState result = emptyFilm(region);
  for (std::uint32_t y = 0; y < region.height; ++y)
    for (std::uint32_t x = 0; x < region.width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        for (std::uint32_t done = 0; done < samples; done += kBatchSamples) {
          const std::uint32_t count = std::min(kBatchSamples, samples - done);
          double sum = 0;
          for (std::uint32_t s = 0; s < count; ++s) sum += draw(x, y);
          addBatchSum(result, 4 * (std::size_t{y} * region.width + x) + c, static_cast<float>(sum), count);
        }
  result.counts.add({0, samples});
  return result;
}

// Returns exponentially distributed samples with this mean and standard deviation.
Draw exponential(Random& random, double mean = 1.0) {
  return [&random, mean](auto, auto) { return std::exponential_distribution<double>(1.0 / mean)(random); };
}

int rejections(int pairs, double level, const std::function<std::pair<FilmState, FilmState>()>& make) {
  int count = 0;
  for (int i = 0; i < pairs; ++i) {
    const auto [a, b] = make();
    count += zTest(a, b, {.level = level}).rejected ? 1 : 0;
  }
  return count;
}

constexpr Region kSmall{0, 0, 16, 16};

TEST(FilmZTest, AcceptsTheSameImage) {
  Random random(1);
  const Region region{0, 0, 64, 40};
  const auto bright = [](std::uint32_t x, std::uint32_t y) { return 0.01 + x * y; };  // differs between pixels
  const Draw draw = [&](std::uint32_t x, std::uint32_t y) {
    return std::exponential_distribution<double>(1.0 / bright(x, y))(random);
  };
  const ZTest test = zTest(film(region, 64, draw), film(region, 64, draw));
  EXPECT_FALSE(test.rejected);
  ASSERT_EQ(test.blocks.size(), 3u * 8 * 5);
  EXPECT_EQ(test.noisy, test.blocks.size());
  EXPECT_DOUBLE_EQ(test.blockLevel, sidak(0.005, 120));
  EXPECT_DOUBLE_EQ(test.imageLevel, sidak(0.005, 3));
  EXPECT_NEAR(test.rms, 1.0, 0.2);  // 3 standard deviations of 120 values
  EXPECT_LT(test.beyond[0], 0.12);  // 0.05 + 3.5 standard deviations
  double mean = 0;
  for (std::uint32_t y = 0; y < 40; ++y)
    for (std::uint32_t x = 0; x < 64; ++x) mean += bright(x, y) / (64 * 40);
  EXPECT_NEAR(test.image[0].mean[0], mean, 4 * test.image[0].error[0]);
}

TEST(FilmZTest, ComputesErrorsOfTheMeans) {
  Random random(2);
  const ZTest test = zTest(film(kSmall, 400, exponential(random)), film(kSmall, 100, exponential(random)));
  for (const ZTestMeans& m : test.blocks) {
    EXPECT_NEAR(m.error[0], 1.0 / std::sqrt(64.0 * 400), 0.05 / std::sqrt(64.0 * 400));
    EXPECT_NEAR(m.error[1], 1.0 / std::sqrt(64.0 * 100), 0.10 / std::sqrt(64.0 * 100));
    // Welch: 64 pixels with 99 and 24 degrees of freedom, and variances 1 : 4. The mean squares of the estimated
    // variances are 1 + 2/24 + 1.5/25, by the kurtosis of the sum of four samples.
    EXPECT_NEAR(m.freedom, 64 * 25.0 / (1.035 / 99 + 16.0 * 1.143 / 24), 200);
  }
  EXPECT_NEAR(test.image[1].error[0], 1.0 / std::sqrt(256.0 * 400), 0.05 / std::sqrt(256.0 * 400));
}

TEST(FilmZTest, MatchesWelchsTestByHand) {
  // One pixel, eight batches whose means are 1 … 8 and 3, 5 … 17: means 4.5 and 10, variances 6/8 and 24/8.
  FilmState films[2] = {emptyFilm({0, 0, 1, 1}), emptyFilm({0, 0, 1, 1})};
  for (int b = 1; b <= 8; ++b) {
    addBatchSum(films[0], 0, 4.0f * static_cast<float>(b), 4);
    addBatchSum(films[1], 0, 4.0f * static_cast<float>(2 * b + 1), 4);
  }
  for (FilmState& state : films) state.counts.add({0, 32});
  const ZTest test = zTest(films[0], films[1], {.level = 0.2, .tolerance = 0.0, .channels = 1});
  for (const ZTestMeans& m : {test.blocks[0], test.image[0]}) {
    EXPECT_DOUBLE_EQ(m.mean[0], 4.5);
    EXPECT_DOUBLE_EQ(m.mean[1], 10.0);
    EXPECT_NEAR(m.error[0], std::sqrt(0.75), 1e-6);
    EXPECT_NEAR(m.error[1], std::sqrt(3.0), 1e-6);
    EXPECT_NEAR(m.t(), -5.5 / std::sqrt(3.75), 1e-6);
    EXPECT_NEAR(m.freedom, 7 * 3.75 * 3.75 / (0.75 * 0.75 + 9.0), 1e-5);
    EXPECT_NEAR(m.p, 0.0171, 0.0002);  // t = 2.840 with 10.29 degrees of freedom: between 0.0175 (10) and 0.0161 (11)
  }
  EXPECT_EQ(test.beyond, (std::array<double, 3>{1.0, 0.0, 0.0}));
  EXPECT_TRUE(test.rejected);
  EXPECT_FALSE(zTest(films[0], films[1], {.level = 0.03, .channels = 1}).rejected);
}

TEST(FilmZTest, RejectsAtItsLevel) {
  // Binomial distribution of 200 runs and 0.05: 2 to 20 with a probability of 99.8 %.
  Random random(3);
  const int count = rejections(200, 0.05, [&] {
    return std::pair(film(kSmall, 32, exponential(random)), film(kSmall, 32, exponential(random)));
  });
  EXPECT_GE(count, 2);
  EXPECT_LE(count, 20);
}

TEST(FilmZTest, KeepsItsLevelWithDifferentSampleCounts) {
  Random random(4);
  const int count = rejections(200, 0.05, [&] {
    return std::pair(film(kSmall, 42, exponential(random)), film(kSmall, 90, exponential(random)));
  });
  EXPECT_LE(count, 20);
}

TEST(FilmZTest, AcceptsFireflies) {
  // One sample in 2,000 is 500 times as bright as the others: 4 per block, so most pixels have none.
  Random random(5);
  const Draw draw = [&](auto, auto) { return random() % 2000 == 0 ? 500.0 : 1.0; };
  const int count = rejections(200, 0.05, [&] { return std::pair(film(kSmall, 128, draw), film(kSmall, 128, draw)); });
  EXPECT_LE(count, 20);
  // A single one on a black image is accepted, too.
  FilmState a = film(kSmall, 64, [](auto, auto) { return 0.0; }), b = a;
  addBatchSum(b, 4 * 37, 1e4f, 4);
  const ZTest test = zTest(a, b);
  EXPECT_FALSE(test.rejected);
  EXPECT_NEAR(std::abs(test.blocks[test.smallest].t()), 1.0, 1e-6);
  EXPECT_NEAR(test.blocks[test.smallest].freedom, 15.0, 1e-9);
}

TEST(FilmZTest, RejectsAWrongMean) {
  // Three standard errors of the difference in each of three channels are found with a probability of at least 0.93,
  // with the threshold at 2.64.
  Random random(6);
  const double error = std::sqrt(2.0 / (256 * 64));
  const auto pair = [&](double factor) {
    return [&random, factor] {
      return std::pair(film(kSmall, 64, exponential(random)), film(kSmall, 64, exponential(random, factor)));
    };
  };
  EXPECT_GE(rejections(40, 0.05, pair(1 + 3 * error)), 32);
  EXPECT_EQ(rejections(20, 0.01, pair(1 + 6 * error)), 20);
  EXPECT_EQ(rejections(20, 0.01, pair(1 - 6 * error)), 20);
}

TEST(FilmZTest, RejectsAWrongBlock) {
  Random random(7);
  const Region region{13, 6, 80, 48};
  const Draw right = exponential(random);
  // Brighter in the block at 32,16 of the whole image, and darker elsewhere so that the mean is the same.
  const Draw wrong = [&](std::uint32_t x, std::uint32_t y) {
    const bool inside = x + region.x >= 32 && x + region.x < 40 && y + region.y >= 16 && y + region.y < 24;
    return right(x, y) * (inside ? 1.2 : 1.0 - 0.2 * 64 / (80 * 48 - 64));
  };
  const ZTest test = zTest(film(region, 128, right), film(region, 128, wrong));
  EXPECT_TRUE(test.rejected);
  EXPECT_EQ(test.blocks[test.smallest].region, (Region{32, 16, 8, 8}));
  for (const ZTestMeans& m : test.image) EXPECT_GT(m.p, test.imageLevel);
  const io::Image map = zTestMap(test, region);
  EXPECT_EQ(map.samples<float>()[(20 - 6) * 80 + 35 - 13], 1.0f);
  EXPECT_LT(map.samples<float>()[0], 1.0f);
}

TEST(FilmZTest, AlignsBlocksToTheWholeImage) {
  Random random(8);
  const Region region{5, 3, 12, 6};
  const ZTest test = zTest(film(region, 32, exponential(random)), film(region, 32, exponential(random)));
  ASSERT_EQ(test.blocks.size(), 3u * 3 * 2);
  EXPECT_EQ(test.blocks[0].region, (Region{5, 3, 3, 5}));
  EXPECT_EQ(test.blocks[4].region, (Region{8, 3, 8, 5}));
  EXPECT_EQ(test.blocks[17].region, (Region{16, 8, 1, 1}));
  EXPECT_EQ(test.blocks[4].channel, 1u);
  EXPECT_EQ(test.image[2].region, region);
}

TEST(FilmZTest, AllowsOnlyRoundingErrorWithoutNoise) {
  const auto constant = [](double value) { return film(kSmall, 32, [=](auto, auto) { return value; }); };
  for (const double value : {0.0, 1.0, 1e-11}) EXPECT_FALSE(zTest(constant(value), constant(value)).rejected) << value;
  EXPECT_FALSE(zTest(constant(1.0), constant(1.000005)).rejected);
  EXPECT_FALSE(zTest(constant(0.0), constant(1e-11)).rejected);  // too dark for the film's squares
  const ZTest test = zTest(constant(0.5), constant(0.50002));
  EXPECT_TRUE(test.rejected);
  EXPECT_EQ(test.blocks[test.smallest].p, 0.0);
  EXPECT_FALSE(zTest(constant(0.5), constant(0.50002), {.tolerance = 1e-4}).rejected);
  EXPECT_TRUE(zTest(constant(0.0), constant(1e-6)).rejected);
  EXPECT_EQ(zTestMap(test, kSmall).samples<float>()[0], 1.0f);
}

TEST(FilmZTest, RejectsPixelsThatAreNotFinite) {
  Random random(9);
  const FilmState a = film(kSmall, 32, exponential(random));
  FilmState b = film(kSmall, 32, exponential(random));
  ASSERT_FALSE(zTest(a, b).rejected);
  addBatchSum(b, 4 * 100 + 2, std::numeric_limits<float>::quiet_NaN(), 4);
  const ZTest test = zTest(a, b);
  EXPECT_TRUE(test.rejected);
  EXPECT_EQ(test.nonFinitePixels, 1u);
  for (const ZTestMeans& m : test.image) EXPECT_TRUE(std::isfinite(m.mean[1]));
}

// The sun in cd/m²: its mean is known, but its noise is not. This is not a difference.
TEST(FilmZTest, SkipsPixelsTooBrightForTheirSquares) {
  Random random(11);
  const FilmState a = film(kSmall, 32, exponential(random));
  FilmState b = film(kSmall, 32, exponential(random));
  b.planes[0].squares[4 * 100 + 2] = fixedFromFloat(std::numeric_limits<float>::infinity());
  const ZTest test = zTest(a, b);
  EXPECT_FALSE(test.rejected);
  EXPECT_EQ(test.unknownPixels, 1u);
  EXPECT_EQ(test.nonFinitePixels, 0u);
  for (shared::FixedSum& square : b.planes[0].squares) square = fixedFromFloat(std::numeric_limits<float>::infinity());
  EXPECT_THROW(zTest(a, b), UsageError);
}

TEST(FilmZTest, UsesTheBatchesOfEachCell) {
  Random random(10);
  const auto make = [&] {
    FilmState result = emptyFilm({0, 0, 40, 8});
    result.counts.cellBatches = {8, 40, 16, 9};
    for (std::uint32_t y = 0; y < 8; ++y)
      for (std::uint32_t x = 0; x < 40; ++x)
        for (std::size_t c = 0; c < 3; ++c)
          for (std::uint32_t b = 0; b < result.counts.cellBatches[result.cellOf(x, y)]; ++b)
            addBatchSum(result, 4 * (std::size_t{y} * 40 + x) + c,
                        static_cast<float>(std::gamma_distribution<double>(4.0)(random)), 4);
    return result;
  };
  FilmState a = make();
  const FilmState b = make();
  const ZTest test = zTest(a, b);
  EXPECT_FALSE(test.rejected);
  EXPECT_NEAR(test.image[0].mean[0], 1.0, 0.05);
  double variance = 0;  // of the four blocks of the first tile, three channels, two films
  for (std::size_t i = 0; i < 12; ++i)
    variance += (std::pow(test.blocks[i].error[0], 2) + std::pow(test.blocks[i].error[1], 2)) / 24;
  EXPECT_NEAR(variance, (32.0 / 32 + 32.0 / 160) / (64 * 64), 0.07 * variance);
  a.counts.cellBatches[2] = 7;
  EXPECT_THROW(zTest(a, b), UsageError);
  // A cell without pixels has no batches: the second tile is one pixel wide and high.
  FilmState narrow = emptyFilm({0, 0, 33, 1});
  narrow.counts.cellBatches = {8, 8, 8, 0};
  EXPECT_FALSE(zTest(narrow, narrow).rejected);
}

TEST(FilmZTest, RejectsUnsuitableFilms) {
  Random random(11);
  const auto problem = [](const FilmState& a, const FilmState& b) {
    try {
      zTest(a, b);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const FilmState right = film(kSmall, 32, exponential(random));
  EXPECT_EQ(problem(right, right), "");
  EXPECT_NE(problem(right, film(kSmall, 28, exponential(random))).find("7 batches of 4 samples"), std::string::npos);
  EXPECT_NE(problem(right, film({0, 0, 16, 15}, 32, exponential(random))).find("regions"), std::string::npos);
  FilmState without = right;
  without.planes[0].squares.clear();
  EXPECT_NE(problem(without, right).find("squares"), std::string::npos);
}

}  // namespace
}  // namespace quintet::render
