// SPDX-License-Identifier: Apache-2.0
// The error estimate of images computed from the sampler's own numbers with the sample plans of `render`. The pixels of
// a tile share their scrambles, so the error of an image varies more than with independent pixels. The integrands
// depend on up to four sample dimensions, on one whole tile of 64 x 64: with simpler integrands low discrepancy would
// widen the bound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>

#include "base/parallel.h"
#include "harness.h"
#include "quintet/shared/frame.h"
#include "render/film/film_error.h"
#include "render/film/fixed_sum.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kSamplerSide = 64, kPixels = kSamplerSide * kSamplerSide, kSamplerRuns = 60;

struct Job {
  std::uint32_t seed, planned, kind;
};

struct Sums {
  float sum;      // of all samples of a pixel
  float squares;  // as FilmPlane::squares
};
struct PixelSums {
  Sums first;  // after FIRST batches
  Sums last;   // after LAST batches
};

// The invocation index is pixel · RUNS + run.
const std::string kIntegratePixel = R"(
  #include <quintet/frame.glsl>
  #include <quintet/sampling/sobol.glsl>
  struct In { uint seed, planned, kind; };
  struct Sums { float sum, squares; };
  struct PixelSums { Sums first, last; };
  #define Out PixelSums
  float draw(inout Sampler s, vec2 position, uint kind) {
    vec2 a = next2D(s), b = next2D(s), c = next2D(s), d = next2D(s);
    if (kind == 0u) return 16.0 * a.x * b.x * c.x * (d.y < 0.3 + 0.2 * position.x ? 1.0 : 0.1);                 // skewed
    if (kind == 1u) return 1.0 + 0.5 * sign(a.x - 0.5) * sign(b.x - 0.5) * sign(c.x - 0.5) * sign(d.x - 0.5);  // no gain from low discrepancy
    return a.x * b.y + c.x * d.y;                                                                              // correlated in a tile
  }
  Out run(uint i, In v) {
    uvec2 pixel = uvec2(i / RUNS % SIDE, i / RUNS / SIDE);
    PixelSums o;
    float sum = 0.0, squares = 0.0;
    for (uint batch = 0u; batch < LAST; ++batch) {
      if (batch == FIRST) o.first = Sums(sum, squares);
      float part = 0.0;
      for (uint k = 0u; k < 4u; ++k) {
        Sampler s = makeSampler(pixel, 4u * batch + k, v.seed, v.planned);
        part += draw(s, (vec2(pixel) + 0.5) / float(SIDE), v.kind);
      }
      sum += part;
      squares += part * part / 4.0;
    }
    o.last = Sums(sum, squares);
    return o;
  }
)";

std::vector<PixelSums> draw(const std::vector<Job>& jobs, std::uint32_t first, std::uint32_t last) {
  const auto number = [](std::size_t n) { return std::to_string(n) + "u"; };
  const Defines defines = {
      {"RUNS", number(jobs.size())}, {"SIDE", number(kSamplerSide)}, {"FIRST", number(first)}, {"LAST", number(last)}};
  return runCompute<PixelSums>(kIntegratePixel, jobs, jobs.size() * kPixels, {.defines = defines});
}

struct ImageError {
  double actual = 0, bound = 0;
};

ImageError errorOf(const std::vector<double>& exact, std::uint32_t batches,
                   const std::function<Sums(std::size_t)>& at) {
  const double samples = double{render::kBatchSamples} * batches;
  const double mean = std::accumulate(exact.begin(), exact.end(), 0.0) / kPixels;
  render::FilmState film;
  film.region = {0, 0, kSamplerSide, kSamplerSide};
  film.planes = {{.name = "color",
                  .sums = std::vector<shared::FixedSum>(4 * kPixels),
                  .squares = std::vector<shared::FixedSum>(4 * kPixels)}};
  film.counts.add({0, render::kBatchSamples * batches});
  double squares = 0;
  for (std::size_t p = 0; p < kPixels; ++p) {
    const Sums sums = at(p);
    for (std::size_t c = 0; c < 3; ++c) {
      film.planes[0].sums[4 * p + c] = render::fixedFromFloat(sums.sum);
      film.planes[0].squares[4 * p + c] = render::fixedFromFloat(sums.squares);
    }
    squares +=
        std::pow(static_cast<double>(sums.sum) / samples - exact[p], 2) / (exact[p] * exact[p] + 0.01 * mean * mean);
  }
  return {std::sqrt(squares / kPixels), render::estimateError(film).upper};
}

TEST(ErrorEstimate, CoversTheErrorOfSamplerNumbers) {
  constexpr std::uint32_t kFirst = 4, kLast = 8;
  for (const std::uint32_t kind : {0u, 1u, 2u}) {
    std::vector<double> exact(kPixels, 0.0);
    const auto many = draw({{900, shared::kIndependentPixels, kind}, {901, shared::kIndependentPixels, kind}}, 1, 512);
    for (std::size_t i = 0; i < many.size(); ++i) exact[i / 2] += static_cast<double>(many[i].last.sum) / 4096;
    for (const std::uint32_t planned : {shared::kIndependentPixels, 0u, 4 * kLast}) {
      std::vector<Job> jobs;
      for (std::uint32_t run = 0; run < kSamplerRuns; ++run) jobs.push_back({run, planned, kind});
      const std::vector<PixelSums> sums = draw(jobs, kFirst, kLast);
      for (const std::uint32_t batches : {kFirst, kLast}) {
        std::vector<ImageError> errors(kSamplerRuns);
        parallelFor(kSamplerRuns, [&](std::size_t run) {
          errors[run] = errorOf(exact, batches, [&](std::size_t p) {
            const PixelSums& pixel = sums[p * kSamplerRuns + run];
            return batches == kFirst ? pixel.first : pixel.last;
          });
        });
        int covered = 0;
        double actual = 0, bound = 0;
        for (const ImageError& e : errors)
          covered += e.actual <= e.bound, actual += e.actual / kSamplerRuns, bound += e.bound / kSamplerRuns;
        std::printf("  integrand %u, planned %d, %u batches: covered %d of %u, bound %.4f, actual %.4f\n", kind,
                    static_cast<int>(planned), batches, covered, kSamplerRuns, bound, actual);
        EXPECT_GE(covered, static_cast<int>(9 * kSamplerRuns / 10)) << kind << " " << planned << " " << batches;
        EXPECT_LT(bound, 1.35 * actual) << "the bound is too wide to be useful: " << kind << " " << planned << " "
                                        << batches;
      }
    }
  }
}

}  // namespace
}  // namespace quintet::test
