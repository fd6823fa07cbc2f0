// SPDX-License-Identifier: Apache-2.0
// The two samplers: range, uniformity, independence of pixels and of draws, stratification, and convergence. Every
// statistical test also runs on a deliberately wrong input, which it must reject.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/math.h"
#include "bsdf/chi_square.h"
#include "harness.h"
#include "sampling/nets.h"

namespace quintet::test {
namespace {

constexpr double kLevel = 0.01;  // of each TEST, divided among its chi-square tests by Šidák's correction

// One 2D number (or 1D, then y = 0).
struct Draw {
  uvec2 pixel;
  std::uint32_t index;      // of the sample
  std::uint32_t dimension;  // number of earlier draws
  std::uint32_t seed = 0;
};

// WRONG sets one member of the input to 0, as a deliberate mistake.
const std::string kBody = R"(
#include <quintet/frame.glsl>
#ifdef PCG
#include <quintet/sampling/pcg.glsl>
#else
#include <quintet/sampling/sobol.glsl>
#endif
struct In { uvec2 pixel; uint index; uint dimension; uint seed; };
#define Out vec2
vec2 run(uint i, In value) {
#ifdef WRONG
  value.WRONG = 0u;
#endif
  Sampler s = makeSampler(value.pixel, value.index, value.seed);
  s.dimension = value.dimension;
#ifdef ONE
  return vec2(next1D(s), 0.0);
#elif defined(BITS)
  const uint bits = nextBits(s);
  return vec2(unitFloat(bits), unitFloat(bits << 16));
#else
  return next2D(s);
#endif
}
)";

std::vector<vec2> evaluate(const std::vector<Draw>& draws, const Defines& defines = {}) {
  ComputeOptions options;
  options.defines = defines;
  return runCompute<vec2>(kBody, draws, draws.size(), options);
}

// Demands over a 512 x 256 image, each pixel once.
std::vector<Draw> image(std::uint32_t index, std::uint32_t dimension, std::uint32_t seed = 0, std::uint32_t shift = 0) {
  std::vector<Draw> result;
  for (std::uint32_t y = 0; y < 256; ++y)
    for (std::uint32_t x = 0; x < 512; ++x) result.push_back({{x + shift, y}, index, dimension, seed});
  return result;
}

// Consecutive samples of one pixel.
std::vector<Draw> series(uvec2 pixel, std::uint32_t dimension, std::uint32_t count, std::uint32_t first = 0) {
  std::vector<Draw> result;
  for (std::uint32_t i = 0; i < count; ++i) result.push_back({pixel, first + i, dimension, 0});
  return result;
}

// p-value of the hypothesis that the points (x, y) are uniform in the unit square: chi-square on 32 x 32 cells.
double uniformity(const std::vector<float>& x, const std::vector<float>& y) {
  constexpr int kCells = 32;
  std::vector<double> observed(kCells * kCells, 0.0);
  const std::vector<double> expected(kCells * kCells, static_cast<double>(x.size()) / (kCells * kCells));
  for (std::size_t i = 0; i < x.size(); ++i)
    observed[static_cast<std::size_t>(y[i] * kCells) * kCells + static_cast<std::size_t>(x[i] * kCells)] += 1.0;
  return chiSquareTest(observed, expected).pValue;
}

std::vector<float> component(const std::vector<vec2>& points, int c) {
  std::vector<float> result;
  for (const vec2& p : points) result.push_back(p[c]);
  return result;
}

const std::vector<Defines> kSamplers{{}, {{"PCG", "1"}}};

TEST(Sampler, StaysBelowOne) {
  for (Defines defines : kSamplers)
    for (const char* kind : {"TWO", "ONE", "BITS"}) {
      defines.emplace_back(kind, "1");
      for (const vec2& p : evaluate(series({7, 9}, 3, 1 << 18), defines)) {
        ASSERT_GE(glm::min(p.x, p.y), 0.0f);
        ASSERT_LT(glm::max(p.x, p.y), 1.0f);
      }
      defines.pop_back();
    }
  const auto largest = runCompute<vec2>(R"(
    #include <quintet/sampling/hash.glsl>
    #define Out vec2
    vec2 run(uint i) { return vec2(unitFloat(0xFFFFFFFFu), unitFloat(0u)); }
  )",
                                        1);
  EXPECT_EQ(largest[0].x, 1.0f - 0x1p-24f);
  EXPECT_EQ(largest[0].y, 0.0f);
}

// Prefixes and aligned blocks of 2^k samples are (0,k,2)-nets for every draw and pixel; scrambling keeps that.
TEST(Sobol, BlocksAreNets) {
  for (const uvec2 pixel : {uvec2(0, 0), uvec2(3, 7), uvec2(1919, 1079)})
    for (const std::uint32_t dimension : {0u, 1u, 5u, 40u})
      for (const std::uint32_t first : {0u, 1024u, 3u << 20}) {
        const std::vector<vec2> points = evaluate(series(pixel, dimension, 1024, first));
        for (std::size_t count = 1; count <= points.size(); count *= 2)
          EXPECT_TRUE(isNet({points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count)})) << count;
        EXPECT_TRUE(isNet({points.begin() + 512, points.end()}));
      }
  EXPECT_FALSE(isNet(evaluate(series({3, 7}, 0, 1024), {{"PCG", "1"}})));
  EXPECT_FALSE(isNet(evaluate(series({3, 7}, 0, 1024, 512))));  // not aligned
}

TEST(Sobol, OneDimensionalDrawsAreStratified) {
  for (const std::uint32_t dimension : {0u, 3u, 17u}) {
    const std::vector<vec2> points = evaluate(series({11, 5}, dimension, 4096), {{"ONE", "1"}});
    for (std::size_t count = 1; count <= points.size(); count *= 2) {
      std::vector<bool> seen(count, false);
      for (std::size_t i = 0; i < count; ++i)
        seen[static_cast<std::size_t>(points[i].x * static_cast<float>(count))] = true;
      EXPECT_EQ(std::ranges::count(seen, true), static_cast<std::ptrdiff_t>(count));
    }
  }
}

// The position of a point within its stratum of 1/64. Without the nested scramble (a digital shift alone), it would be the same
// for all 64 points of a pixel; with equal scrambles of x and y, both positions of a point would be related.
TEST(Sobol, PointsAreScrambledWithinTheirStrata) {
  constexpr std::uint32_t kCount = 64;
  const auto within = [](float v) { return double(v) * kCount - std::floor(double(v) * kCount); };
  for (const char* kind : {"ONE", "TWO"}) {
    const bool two = kind[0] == 'T';
    double sum = 0, squares = 0, products = 0;
    int count = 0;
    for (const std::uint32_t dimension : {0u, 1u, 2u, 9u, 31u})
      for (const uvec2 pixel : {uvec2(0, 0), uvec2(5, 2), uvec2(640, 359), uvec2(1023, 7)}) {
        std::set<float> x, y;
        for (const vec2& p : evaluate(series(pixel, dimension, kCount), {{kind, "1"}})) {
          const double fx = within(p.x), fy = within(p.y);
          x.insert(static_cast<float>(fx)), y.insert(static_cast<float>(fy));
          sum += fx, squares += fx * fx, products += (fx - 0.5) * (fy - 0.5), count++;
        }
        EXPECT_GT(x.size(), 60u) << kind << ", draw " << dimension;
        EXPECT_GT(y.size(), two ? 60u : 0u) << kind << ", draw " << dimension;
      }
    // 1,280 positions: standard errors of 0.008 and 0.0083 for the mean and the mean square, 0.0023 for the product.
    EXPECT_NEAR(sum / count, 0.5, 0.04) << kind;
    EXPECT_NEAR(squares / count, 1.0 / 3.0, 0.04) << kind;
    EXPECT_NEAR(products / count, 0.0, two ? 0.012 : 1.0) << kind;
  }
}

// One sample of each pixel is uniform over the pixels, for any sample index, draw and seed.
TEST(Sampler, EachNumberIsUniformOverPixels) {
  constexpr std::size_t kTests = 2 * 2 * 4 + 2;
  const double least = sidak(kLevel, kTests);
  for (const Defines& defines : kSamplers) {
    for (const std::uint32_t index : {0u, 1u, 100u, 65535u})
      for (const std::uint32_t dimension : {0u, 9u}) {
        const std::vector<vec2> points = evaluate(image(index, dimension, index), defines);
        EXPECT_GT(uniformity(component(points, 0), component(points, 1)), least) << index << " " << dimension;
      }
    Defines bits = defines;
    bits.emplace_back("BITS", "1");
    const std::vector<vec2> points = evaluate(image(3, 4), bits);
    EXPECT_GT(uniformity(component(points, 0), component(points, 1)), least);
  }
}

// Numbers that a path multiplies: of two draws, two samples, two pixels, two seeds. With WRONG, the two are equal.
TEST(Sampler, PairsAreIndependent) {
  struct Pair {
    std::vector<Draw> a, b;
    const char* wrong;
  };
  std::vector<Pair> pairs;
  for (const std::uint32_t other : {1u, 2u, 3u, 16u, 64u}) pairs.push_back({image(5, 0), image(5, other), "dimension"});
  pairs.push_back({image(0, 7), image(0, 8), "dimension"});
  pairs.push_back({image(0, 0), image(1, 1), "dimension = value.index"});
  for (const std::uint32_t shift : {1u, 2u, 64u}) pairs.push_back({image(5, 3), image(5, 3, 0, shift), "pixel.x"});
  pairs.push_back({image(5, 3, 0), image(5, 3, 1), "seed"});
  pairs.push_back({image(5, 3, 1), image(5, 3, 0x80000000u), "seed"});
  const double least = sidak(kLevel, pairs.size() * 2 * 4);
  for (const Defines& defines : kSamplers)
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const std::vector<vec2> a = evaluate(pairs[k].a, defines), b = evaluate(pairs[k].b, defines);
      for (int i = 0; i < 4; ++i)
        EXPECT_GT(uniformity(component(a, i & 1), component(b, i >> 1)), least) << "pair " << k << " " << i;
      Defines wrong = defines;
      wrong.emplace_back("WRONG", pairs[k].wrong);
      const std::vector<vec2> c = evaluate(pairs[k].a, wrong), d = evaluate(pairs[k].b, wrong);
      EXPECT_LT(uniformity(component(c, 0), component(d, 0)), 1e-9) << "pair " << k;
    }
}

// Draws of any kind use the next dimension, whatever was drawn before.
TEST(Sampler, DrawsUseSuccessiveDimensions) {
  struct Out {
    std::uint32_t draws;        // dimension after four draws
    std::uint32_t differences;  // from the same draws of a sampler that starts at their dimension
  };
  const std::string body = R"(
    #include <quintet/frame.glsl>
    #ifdef PCG
    #include <quintet/sampling/pcg.glsl>
    #else
    #include <quintet/sampling/sobol.glsl>
    #endif
    struct Out_ { uint draws; uint differences; };
    #define Out Out_
    Sampler at(uint index, uint dimension) {
      Sampler s = makeSampler(uvec2(index % 7u, index / 7u), index, 5u);
      s.dimension = dimension;
      return s;
    }
    Out run(uint index) {
      Sampler s = at(index, 0u);
      const vec2 a = next2D(s);
      const float b = next1D(s);
      const uint bits = nextBits(s);
      const vec2 c = next2D(s);
      Sampler first = at(index, 0u), second = at(index, 1u), third = at(index, 2u), fourth = at(index, 1u);
      skipDraw(fourth);
      skipDraw(fourth);
      const uint differences = uint(a != next2D(first)) + uint(b != next1D(second)) + uint(bits != nextBits(third)) +
                               uint(c != next2D(fourth));
      return Out(s.dimension, differences + uint(a == c));
    }
  )";
  for (const Defines& defines : kSamplers) {
    ComputeOptions options;
    options.defines = defines;
    for (const Out& out : runCompute<Out>(body, 64, options)) {
      EXPECT_EQ(out.draws, 4u);
      EXPECT_EQ(out.differences, 0u);
    }
  }
}

// "pcg4d" of Jarzynski and Olano (2020).
uvec4 mixedWords(uvec4 v) {
  v = v * 1664525u + 1013904223u;
  for (int round = 0; round < 2; ++round) {
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    if (round == 0) v ^= v >> 16u;
  }
  return v;
}

// Word by word, because a wrong mixer can still give numbers that look independent.
TEST(Pcg, MixesAsPublished) {
  const std::vector<uvec4> inputs{{0, 0, 0, 0},
                                  {1, 0, 0, 0},
                                  {0, 1, 0, 0},
                                  {0, 0, 1, 0},
                                  {0, 0, 0, 1},
                                  {7, 65536, 3, 9},
                                  {0xFFFFFFFFu, 0x12345678u, 0x9ABCDEF0u, 0x80000000u}};
  const auto seen = runCompute<uvec4>(R"(
    #include <quintet/frame.glsl>
    #include <quintet/sampling/pcg.glsl>
    struct In { uvec4 words; };
    #define Out uvec4
    uvec4 run(uint index, In value) { return pcg4d(value.words); }
  )",
                                      inputs);
  for (std::size_t i = 0; i < inputs.size(); ++i) EXPECT_EQ(seen[i], mixedWords(inputs[i])) << i;
  const Defines pcg{{"PCG", "1"}};
  for (const Draw& draw : {Draw{{5, 9}, 3, 2, 1}, Draw{{640, 359}, 70000, 31, 0xABCDEF01u}}) {
    const uvec4 words = mixedWords({draw.pixel.x | draw.pixel.y << 16, draw.index, draw.dimension, draw.seed});
    const vec2 point = evaluate({draw}, pcg).at(0);
    EXPECT_EQ(point.x, std::ldexp(static_cast<float>(words.x >> 8), -24));
    EXPECT_EQ(point.y, std::ldexp(static_cast<float>(words.y >> 8), -24));
  }
}

// PCG numbers are also independent between the samples of one pixel. Sobol points are not, by design.
TEST(Pcg, SuccessiveSamplesAreIndependent) {
  constexpr std::uint32_t kCount = 1 << 17;
  const std::vector<float> x = component(evaluate(series({12, 34}, 6, kCount + 8), {{"PCG", "1"}}), 0);
  const auto lagged = [](const std::vector<float>& v, std::ptrdiff_t lag) {
    return uniformity({v.begin(), v.begin() + kCount}, {v.begin() + lag, v.begin() + lag + kCount});
  };
  for (const std::ptrdiff_t lag : {1, 2, 8}) EXPECT_GT(lagged(x, lag), sidak(kLevel, 3));
  EXPECT_LT(lagged(component(evaluate(series({12, 34}, 6, kCount + 8)), 0), 1), 1e-9);
}

// Root mean square error of the mean of `count` values of f over 256 pixels; f(p, q) of two draws.
template <class F>
double integrationError(std::uint32_t count, const Defines& defines, double exact, const F& f) {
  std::vector<Draw> first, second;
  for (std::uint32_t pixel = 0; pixel < 256; ++pixel) {
    const auto append = [&](std::vector<Draw>& to, std::uint32_t dimension) {
      const std::vector<Draw> more = series({pixel % 16, pixel / 16}, dimension, count);
      to.insert(to.end(), more.begin(), more.end());
    };
    append(first, 2);
    append(second, 3);
  }
  const std::vector<vec2> p = evaluate(first, defines), q = evaluate(second, defines);
  double sum = 0.0;
  for (std::size_t pixel = 0; pixel < 256; ++pixel) {
    double mean = 0.0;
    for (std::size_t i = pixel * count; i < (pixel + 1) * count; ++i) mean += f(p[i], q[i]);
    const double error = mean / count - exact;
    sum += error * error;
  }
  return std::sqrt(sum / 256.0);
}

// For a smooth function of one draw, the error is about N^-1.5 instead of N^-0.5.
TEST(Sobol, ConvergesFasterThanRandom) {
  const auto smooth = [](const vec2& p, const vec2&) { return std::sin(kPi * p.x) * p.y * p.y; };
  const double exact = 2.0 / (3.0 * kPi);
  const double sobol64 = integrationError(64, {}, exact, smooth), sobol1024 = integrationError(1024, {}, exact, smooth);
  const double random64 = integrationError(64, {{"PCG", "1"}}, exact, smooth);
  const double random1024 = integrationError(1024, {{"PCG", "1"}}, exact, smooth);
  EXPECT_NEAR(random64 / random1024, 4.0, 0.8);
  EXPECT_GT(sobol64 / sobol1024, 32.0);  // 64 in theory
  EXPECT_LT(sobol64, 0.1 * random64);
  EXPECT_LT(sobol1024, 0.01 * random1024);
}

// The cost of padding: samples 2i and 2i + 1 are in opposite halves in *every* draw. A product of two draws can
// therefore have up to twice the variance of random points (the gain of the coarsest Walsh terms), but not more.
TEST(Sobol, ProductsOfTwoDrawsHaveAtMostTwiceTheVariance) {
  const auto product = [](const vec2& p, const vec2& q) { return (p.x - 0.5) * (q.x - 0.5); };
  for (const std::uint32_t count : {16u, 256u, 1024u}) {
    const double random = 1.0 / 12.0 / std::sqrt(static_cast<double>(count));
    const double gain = std::pow(integrationError(count, {}, 0.0, product) / random, 2.0);
    EXPECT_LT(gain, 2.0 * 1.4) << count;  // 1.4: four standard deviations of a variance from 256 pixels
    EXPECT_GT(gain, 0.2) << count;
  }
}

}  // namespace
}  // namespace quintet::test
