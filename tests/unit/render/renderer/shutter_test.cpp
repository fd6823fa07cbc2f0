// SPDX-License-Identifier: Apache-2.0
// The times of samples cover the shutter, and the error estimate is an upper bound although all pixels share them.
#include "render/renderer/shutter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "../film/film_simulation.h"
#include "render/film/film_error.h"

namespace quintet::render {
namespace {

constexpr ShutterInterval kUnit{0.0, 1.0};

// Each aligned range of 2^k samples has one time in each of 2^k equal parts of the interval, for any seed.
TEST(Shutter, RangesOfSamplesAreStratified) {
  const ShutterInterval shutter{2.75, 3.25};
  for (const std::uint32_t seed : {0u, 1u, 77u, 0xFFFFFFFFu})
    for (const std::uint32_t count : {4u, 16u, 64u})
      for (const std::uint32_t first : {0u, 64u, 1u << 20}) {
        std::set<int> parts;
        for (std::uint32_t i = first; i < first + count; ++i) {
          const double time = sampleTime(shutter, i, seed);
          ASSERT_GE(time, shutter.open);
          ASSERT_LT(time, shutter.close);
          // Relative to the first time, which the seed shifts.
          double shifted = (time - sampleTime(shutter, first, seed)) / 0.5;
          if (shifted < 0) shifted += 1.0;
          parts.insert(static_cast<int>(std::floor(shifted * count + 1e-4)));
        }
        EXPECT_EQ(parts.size(), count) << "seed " << seed << ", from " << first;
      }
}

// Over the seeds, the time of each sample is uniform.
TEST(Shutter, TimesAreUniformOverTheSeeds) {
  constexpr std::uint32_t kSeeds = 4096, kBins = 16;
  for (const std::uint32_t sample : {0u, 1u, 5u, 1000u}) {
    std::vector<double> bins(kBins);
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed)
      ++bins[static_cast<std::size_t>(kBins * sampleTime(kUnit, sample, seed))];
    double chiSquared = 0;
    for (const double count : bins) chiSquared += (count - 256) * (count - 256) / 256;
    EXPECT_LT(chiSquared, 37.7) << sample;  // 99.9 % quantile for 15 degrees of freedom
  }
}

// All samples of a launch share their time, so the pixels that a moving object covers have correlated errors. The batches
// of a pixel then overestimate its error, because their times repel each other, and the bound holds. The object covers
// each pixel during a part of the interval, which begins where the object arrives.
TEST(Shutter, TheErrorEstimateCoversSharedTimes) {
  constexpr std::uint32_t kWidth = 24;
  for (const double duration : {0.04, 0.3, 0.7})
    for (const std::uint32_t batches : {4u, 8u, 16u}) {
      int covered = 0;
      constexpr std::uint32_t kSeeds = 40;
      for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
        FilmSimulation simulation(kWidth, 1);
        const auto arrival = [](std::uint32_t x) { return (x + 0.5) / kWidth * 1.4 - 0.2; };
        std::vector<std::uint32_t> next(kWidth);
        simulation.render(
            [&](std::uint32_t x, std::uint32_t) {
              const double since = sampleTime(kUnit, next[x]++, seed) - arrival(x);
              return since >= 0 && since < duration ? 1.0 : 0.0;
            },
            batches);
        const io::Image image = planeImage(simulation.film, 0);
        std::vector<double> exact(kWidth);
        double mean = 0, square = 0;
        for (std::uint32_t x = 0; x < kWidth; ++x) {
          exact[x] = std::max(0.0, std::min(1.0, arrival(x) + duration) - std::max(0.0, arrival(x)));
          mean += exact[x] / kWidth;
        }
        for (std::uint32_t x = 0; x < kWidth; ++x) {
          const double error = static_cast<double>(image.pixel<float>(x, 0)[0]) - exact[x];
          square += error * error / (exact[x] * exact[x] + 0.01 * mean * mean) / kWidth;
        }
        if (std::sqrt(square) <= estimateError(simulation.film).upper) ++covered;
      }
      EXPECT_GE(covered, 38) << "covered for " << duration << " of the shutter, " << batches << " batches";
    }
}

}  // namespace
}  // namespace quintet::render
