// SPDX-License-Identifier: Apache-2.0
// Pixels that share nets: blocks of pixels are nets, and errors cancel over small neighborhoods. Within each pixel, the
// numbers are uniform, independent between draws, and as well distributed as those of independent pixels.
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "base/math.h"
#include "bsdf/chi_square.h"
#include "harness.h"
#include "quintet/shared/frame.h"
#include "sampling/nets.h"
#include "sampling/sobol_reference.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kIndependent = shared::kIndependentPixels;

struct PixelDraw {
  uvec2 pixel;
  std::uint32_t index;      // of the sample
  std::uint32_t dimension;  // number of earlier draws
  std::uint32_t seed;
  std::uint32_t planned;
};

std::vector<vec2> evaluatePixels(const std::vector<PixelDraw>& draws, const Defines& defines = {}) {
  ComputeOptions options;
  options.defines = defines;
  return runCompute<vec2>(R"(
    #include <quintet/frame.glsl>
    #include <quintet/sampling/sobol.glsl>
    struct In { uvec2 pixel; uint index; uint dimension; uint seed; uint planned; };
    #define Out vec2
    vec2 run(uint i, In value) {
      Sampler s = makeSampler(value.pixel, value.index, value.seed, value.planned);
      s.dimension = value.dimension;
    #ifdef ONE
      return vec2(next1D(s), 0.0);
    #else
      return next2D(s);
    #endif
    }
  )",
                          draws, draws.size(), options);
}

// Samples [first, first + count) of the pixels of a square.
std::vector<PixelDraw> squareOfDraws(uvec2 corner, std::uint32_t side, std::uint32_t first, std::uint32_t count,
                                     std::uint32_t planned, std::uint32_t dimension = 0, std::uint32_t seed = 1) {
  std::vector<PixelDraw> result;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      for (std::uint32_t i = 0; i < count; ++i)
        result.push_back({corner + uvec2(x, y), first + i, dimension, seed, planned});
  return result;
}

double planeUniformity(const std::vector<vec2>& points) {
  constexpr int kCells = 24;
  std::vector<double> observed(kCells * kCells, 0.0);
  const std::vector<double> expected(kCells * kCells, static_cast<double>(points.size()) / (kCells * kCells));
  for (const vec2& p : points)
    observed[static_cast<std::size_t>(p.y * kCells) * kCells + static_cast<std::size_t>(p.x * kCells)] += 1.0;
  return chiSquareTest(observed, expected).pValue;
}

// The shaders use short cuts; the numbers are those of the definition, bit for bit.
TEST(BlueNoise, NumbersAreThoseOfTheDefinition) {
  std::vector<PixelDraw> draws;
  std::uint32_t random = 1;
  const auto next = [&] { return random = random * 1664525u + 1013904223u; };
  for (int i = 0; i < 20000; ++i) {
    const std::uint32_t planned = i % 4 == 0 ? kIndependent : i % 4 == 1 ? 0u : next() >> (8 + i % 20);
    draws.push_back({{next() >> 18, next() >> 18}, next() >> i % 32, next() >> 22, next(), planned});
  }
  for (const std::uint32_t index : {0u, 1u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu})
    for (const std::uint32_t planned : {0u, 1u, index, 0x7FFFFFFFu, kIndependent})
      draws.push_back({{65535u, 63u}, index, 0u, 7u, planned});
  const std::vector<vec2> two = evaluatePixels(draws), one = evaluatePixels(draws, {{"ONE", "1"}});
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const PixelDraw& d = draws[i];
    const vec2 wanted = SobolReference(d.pixel, d.index, d.seed, d.planned).at(d.dimension);
    ASSERT_EQ(two[i], wanted) << "pixel " << d.pixel.x << " " << d.pixel.y << ", sample " << d.index << " of "
                              << d.planned << ", draw " << d.dimension << ", seed " << d.seed;
    ASSERT_EQ(one[i].x, wanted.x) << i;
  }
}

struct Range {
  std::uint32_t first, count, planned;
};

// Counts that are powers of two, planned or not, and the ranges that a planned number consists of: 24 = 16 + 8 and
// 3 = 2 + 1.
constexpr Range kRanges[] = {{0, 1, 1},   {0, 1, 0},   {0, 2, 0}, {0, 4, 4}, {0, 16, 16},   {0, 8, 0},
                             {0, 16, 24}, {16, 8, 24}, {0, 2, 3}, {2, 1, 3}, {64, 32, 100}, {96, 4, 100}};

TEST(BlueNoise, BlocksOfPixelsAreNets) {
  for (const Range& r : kRanges)
    for (const std::uint32_t dimension : {0u, 7u}) {
      EXPECT_TRUE(isNet(evaluatePixels(squareOfDraws({66, 130}, 1, r.first, r.count, r.planned, dimension))));
      EXPECT_TRUE(isNet(evaluatePixels(squareOfDraws({66, 130}, 2, r.first, r.count, r.planned, dimension))))
          << r.first << " " << r.count;
      EXPECT_TRUE(isNet(evaluatePixels(squareOfDraws({64, 136}, 8, r.first, r.count, r.planned, dimension))))
          << r.first << " " << r.count;
    }
  EXPECT_TRUE(isNet(evaluatePixels(squareOfDraws({64, 128}, 64, 0, 4, 4))));
  // Cases that are not nets, which the test must detect.
  EXPECT_FALSE(isNet(evaluatePixels(squareOfDraws({64, 136}, 8, 0, 4, kIndependent))));
  EXPECT_FALSE(isNet(evaluatePixels(squareOfDraws({65, 136}, 8, 0, 4, 4))));  // not aligned
  EXPECT_FALSE(
      isNet(evaluatePixels(squareOfDraws({64, 136}, 8, 16, 8, 64))));  // not a range of the plan, so shuffled per pixel
}

// For any plan, each prefix of 2^k samples of a pixel is a (0,k,2)-net.
TEST(BlueNoise, EachPixelHasNets) {
  for (const std::uint32_t planned : {0u, 1u, 24u, 100u, 1024u, kIndependent})
    for (const uvec2 pixel : {uvec2(0, 0), uvec2(63, 64), uvec2(1919, 1079)})
      for (const std::uint32_t dimension : {0u, 1u, 40u}) {
        const std::vector<vec2> points = evaluatePixels(squareOfDraws(pixel, 1, 0, 1024, planned, dimension));
        for (std::ptrdiff_t count = 1; count <= 1024; count *= 2)
          EXPECT_TRUE(isNet({points.begin(), points.begin() + count})) << planned << " " << count;
      }
}

// Over random seeds, each number of a pixel is uniform. Independent are two draws of one sample, draws of different
// samples, and the same draw of two pixels in different tiles.
TEST(BlueNoise, NumbersOfAPixelAreUniformAndIndependentOverSeeds) {
  struct Pair {
    PixelDraw a, b;
  };
  std::vector<Pair> pairs;
  for (const std::uint32_t planned : {0u, 16u, 24u}) {
    pairs.push_back({{{5, 9}, 0, 0, 0, planned}, {{5, 9}, 0, 1, 0, planned}});
    pairs.push_back({{{5, 9}, 3, 4, 0, planned}, {{5, 9}, 3, 9, 0, planned}});
    pairs.push_back({{{5, 9}, 1, 2, 0, planned}, {{5, 9}, 2, 3, 0, planned}});
    pairs.push_back({{{63, 9}, 3, 2, 0, planned}, {{64, 9}, 3, 2, 0, planned}});  // in two tiles
    pairs.push_back({{{5, 9}, 3, 2, 0, planned}, {{6, 9}, 3, 3, 0, planned}});    // neighbors, but two draws
  }
  constexpr std::uint32_t kSeeds = 1u << 16;
  const double least = sidak(0.01, pairs.size() * 5);
  const auto overSeeds = [](PixelDraw draw) {
    std::vector<PixelDraw> draws(kSeeds, draw);
    for (std::uint32_t i = 0; i < kSeeds; ++i) draws[i].seed = i;
    return evaluatePixels(draws);
  };
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const std::vector<vec2> a = overSeeds(pairs[k].a), b = overSeeds(pairs[k].b);
    EXPECT_GT(planeUniformity(a), least) << "pair " << k;
    for (int c = 0; c < 4; ++c) {
      std::vector<vec2> both(kSeeds);
      for (std::size_t i = 0; i < kSeeds; ++i) both[i] = {a[i][c & 1], b[i][c >> 1]};
      EXPECT_GT(planeUniformity(both), least) << "pair " << k << " " << c;
    }
  }
  // The test detects dependence: neighbors in one draw are dependent by design.
  const std::vector<vec2> a = overSeeds({{4, 8}, 0, 2, 0, 1}), b = overSeeds({{5, 8}, 0, 2, 0, 1});
  std::vector<vec2> both(kSeeds);
  for (std::size_t i = 0; i < kSeeds; ++i) both[i] = {a[i].x, b[i].x};
  EXPECT_LT(planeUniformity(both), 1e-9);
}

// The variance of the error of a pixel, and 64 times that of the mean over 8 x 8 pixels. The ratio is 1 for white
// noise. The squares are not aligned to the hierarchy, so high frequencies at their edges remain.
struct Noise {
  double pixel = 0;
  double square = 0;
};
template <class F>
Noise noise(std::uint32_t count, std::uint32_t planned, double exact, const F& f) {
  constexpr std::uint32_t kSide = 128, kSquare = 8;
  Noise result;
  const std::vector<vec2> points = evaluatePixels(squareOfDraws({3, 5}, kSide, 0, count, planned, 2));
  std::vector<double> squares(kSide * kSide / (kSquare * kSquare), 0.0);
  for (std::uint32_t pixel = 0; pixel < kSide * kSide; ++pixel) {
    double error = -exact;
    for (std::uint32_t i = 0; i < count; ++i)
      error += f(points[std::size_t{pixel} * count + i]) / static_cast<float>(count);
    result.pixel += error * error / (kSide * kSide);
    squares[pixel / kSide / kSquare * (kSide / kSquare) + pixel % kSide / kSquare] += error;
  }
  for (const double sum : squares) result.square += sum * sum / (kSide * kSide);
  return result;
}

TEST(BlueNoise, LowFrequenciesOfTheErrorAreSuppressed) {
  const auto smooth = [](const vec2& p) { return std::sin(kPi * p.x) * p.y * p.y; };
  const auto edge = [](const vec2& p) { return p.x + 0.6f * p.y < 0.7f ? 1.0 : 0.0; };
  const double smoothMean = 2.0 / (3.0 * kPi), edgeMean = 0.5 * 0.7 * 0.7 / 0.6 - 0.5 * 0.1 * 0.1 / 0.6;
  for (const std::uint32_t count : {1u, 4u, 16u, 3u, 24u}) {
    const Noise a = noise(count, count, smoothMean, smooth), white = noise(count, kIndependent, smoothMean, smooth);
    const Noise b = noise(count, count, edgeMean, edge);
    std::printf("%u samples: 8 x 8 pixels, smooth %.3f (independent pixels %.3f), edge %.3f\n", count,
                a.square / a.pixel, white.square / white.pixel, b.square / b.pixel);
    EXPECT_LT(a.square / a.pixel, 0.45) << count;
    EXPECT_LT(b.square / b.pixel, 0.6) << count;
    EXPECT_GT(white.square / white.pixel, 0.7) << count;
    EXPECT_LT(white.square / white.pixel, 1.5) << count;
  }
  for (const std::uint32_t count : {1u, 4u, 16u}) {  // nothing planned; counts are powers of two
    const Noise a = noise(count, 0, smoothMean, smooth);
    EXPECT_LT(a.square / a.pixel, 0.45) << count;
  }
}

}  // namespace
}  // namespace quintet::test
