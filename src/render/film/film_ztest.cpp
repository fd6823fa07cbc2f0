// SPDX-License-Identifier: Apache-2.0
#include "render/film/film_ztest.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/plural.h"
#include "base/statistics.h"
#include "render/film/fixed_sum.h"

namespace quintet::render {
namespace {

// Squares of batches are stored in steps of 2^-64, so a spread below 2^-32 of a batch is lost.
constexpr double kAbsoluteFloor = 0x1p-30;

// Sums over pixels of both films, for one channel.
struct Sums {
  std::size_t pixels = 0;
  std::array<double, 2> means{};
  std::array<VarianceSum, 2> variances;

  void add(const Sums& other) {
    pixels += other.pixels;
    for (std::size_t f = 0; f < 2; ++f) {
      means[f] += other.means[f];
      variances[f].add(other.variances[f]);
    }
  }
};

void validateFilm(const FilmState& film) {
  if (film.planes.empty() || film.planes[0].squares.empty())
    throw UsageError("a film stores no squares of its first output");
  std::uint64_t least =
      film.counts.cellBatches.empty() ? film.counts.batches() : std::numeric_limits<std::uint64_t>::max();
  for (std::uint32_t y = 0; y < film.region.height && !film.counts.cellBatches.empty(); ++y)
    for (std::uint32_t x = 0; x < film.region.width; ++x)
      least = std::min(least, film.counts.batchesOf(film.cellOf(x, y)));
  if (least < kZTestBatches)
    throw UsageError(fmt::format("a film has {} of {} samples; the test needs at least {} ({} samples)",
                                 counted(least, "batch", "batches"), kBatchSamples, kZTestBatches,
                                 kZTestBatches * kBatchSamples));
}

// Adds one pixel and channel of film f: the mean, and its variance with the degrees of freedom of its batches.
void addPixel(Sums& sums, std::size_t f, const FilmPlane& plane, std::size_t i, double samples, double batches) {
  sums.means[f] += fixedToDouble(plane.sums[i]) / samples;
  sums.variances[f].add(varianceOfMean(plane, i, samples, batches), batches - 1.0);
}

class Tester {
 public:
  Tester(const FilmState& a, const FilmState& b, const ZTestOptions& options)
      : films_{&a, &b},
        options_(options),
        region_(a.region),
        first_(region_.x / options.block, region_.y / options.block),
        blocks_((region_.x + region_.width - 1) / options.block - first_.x + 1,
                (region_.y + region_.height - 1) / options.block - first_.y + 1),
        sums_(std::size_t{blocks_.x} * blocks_.y * options.channels),
        nonFinite_(blocks_.y),
        unknown_(blocks_.y) {}

  ZTest run() {
    parallelFor(blocks_.y, [&](std::size_t row) {
      for (std::uint32_t column = 0; column < blocks_.x; ++column) addBlock(column, static_cast<std::uint32_t>(row));
    });
    ZTest test;
    std::vector<Sums> whole(options_.channels);
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const auto block = static_cast<std::uint32_t>(i / options_.channels);
      const auto channel = static_cast<std::uint32_t>(i % options_.channels);
      whole[channel].add(sums_[i]);
      test.blocks.push_back(means(sums_[i], blockRegion(block % blocks_.x, block / blocks_.x), channel));
    }
    for (std::uint32_t c = 0; c < options_.channels; ++c) test.image.push_back(means(whole[c], region_, c));
    for (const std::size_t pixels : nonFinite_) test.nonFinitePixels += pixels;
    for (const std::size_t pixels : unknown_) test.unknownPixels += pixels;
    return test;
  }

 private:
  Region blockRegion(std::uint32_t column, std::uint32_t row) const {
    const std::uint32_t left = std::max(region_.x, (first_.x + column) * options_.block);
    const std::uint32_t top = std::max(region_.y, (first_.y + row) * options_.block);
    const std::uint32_t right = std::min(region_.x + region_.width, (first_.x + column + 1) * options_.block);
    const std::uint32_t bottom = std::min(region_.y + region_.height, (first_.y + row + 1) * options_.block);
    return {left, top, right - left, bottom - top};
  }

  void addBlock(std::uint32_t column, std::uint32_t row) {
    const Region block = blockRegion(column, row);
    const std::span<Sums> sums(&sums_[(std::size_t{row} * blocks_.x + column) * options_.channels], options_.channels);
    for (std::uint32_t y = block.y - region_.y; y < block.y - region_.y + block.height; ++y)
      for (std::uint32_t x = block.x - region_.x; x < block.x - region_.x + block.width; ++x) {
        const std::size_t pixel = std::size_t{y} * region_.width + x;
        const bool finite = isFinite(pixel, &FilmPlane::sums);
        if (!finite || !isFinite(pixel, &FilmPlane::squares)) {
          ++(finite ? unknown_ : nonFinite_)[row];
          continue;
        }
        const std::uint32_t cell = films_[0]->cellOf(x, y);
        for (Sums& channel : sums) ++channel.pixels;
        for (std::size_t f = 0; f < 2; ++f) {
          const auto samples = static_cast<double>(films_[f]->counts.samplesOf(cell));
          const auto batches = static_cast<double>(films_[f]->counts.batchesOf(cell));
          for (std::size_t c = 0; c < sums.size(); ++c)
            addPixel(sums[c], f, films_[f]->planes[0], 4 * pixel + c, samples, batches);
        }
      }
  }

  bool isFinite(std::size_t pixel, std::vector<shared::FixedSum> FilmPlane::*words) const {
    for (const FilmState* film : films_)
      for (std::size_t i = 4 * pixel; i < 4 * pixel + options_.channels; ++i)
        if (isNotFinite((film->planes[0].*words)[i])) return false;
    return true;
  }

  ZTestMeans means(const Sums& sums, const Region& region, std::uint32_t channel) const {
    ZTestMeans result{.region = region, .channel = channel};
    if (sums.pixels == 0) return result;
    const auto pixels = static_cast<double>(sums.pixels);
    VarianceSum both;
    for (std::size_t f = 0; f < 2; ++f) {
      result.mean[f] = sums.means[f] / pixels;
      result.error[f] = std::sqrt(sums.variances[f].variance()) / pixels;
      both.add(sums.variances[f]);
    }
    result.freedom = both.degreesOfFreedom();
    const double floor =
        options_.tolerance * std::max(std::abs(result.mean[0]), std::abs(result.mean[1])) + kAbsoluteFloor;
    result.p = significance(result.difference(), result.differenceError(), floor, result.freedom);
    return result;
  }

  std::array<const FilmState*, 2> films_;
  ZTestOptions options_;
  Region region_;
  uvec2 first_;   // column and row of the first block in the whole image
  uvec2 blocks_;  // columns and rows of blocks
  std::vector<Sums> sums_;
  std::vector<std::size_t> nonFinite_, unknown_;  // number of pixels per row of blocks
};

// Computes the distribution of t over the blocks.
void summarizeBlocks(ZTest& test) {
  constexpr std::array<double, 3> kP{0.05, 0.01, 0.001};
  for (const ZTestMeans& block : test.blocks) {
    if (block.differenceError() <= 0.0) continue;
    ++test.noisy;
    test.rms += block.t() * block.t();
    for (std::size_t i = 0; i < kP.size(); ++i) test.beyond[i] += block.p < kP[i] ? 1.0 : 0.0;
  }
  if (test.noisy == 0) return;
  const auto noisy = static_cast<double>(test.noisy);
  test.rms = std::sqrt(test.rms / noisy);
  for (double& part : test.beyond) part /= noisy;
}

}  // namespace

double ZTestMeans::differenceError() const { return std::hypot(error[0], error[1]); }

double ZTestMeans::t() const { return differenceError() > 0.0 ? difference() / differenceError() : 0.0; }

ZTest zTest(const FilmState& a, const FilmState& b, const ZTestOptions& options) {
  assert(options.level > 0.0 && options.level < 1.0 && options.block >= 1 && options.channels >= 1 &&
         options.channels <= 4);
  if (a.region != b.region) throw UsageError("the films cover different regions of the image");
  validateFilm(a);
  validateFilm(b);
  ZTest test = Tester(a, b, options).run();
  if (test.unknownPixels == a.pixelCount())
    throw UsageError("the noise of the films is unknown: their squares exceed the range of a film");
  test.blockLevel = sidak(0.5 * options.level, test.blocks.size());
  test.imageLevel = sidak(0.5 * options.level, test.image.size());
  const auto smallest = std::ranges::min_element(test.blocks, {}, &ZTestMeans::p);
  test.smallest = static_cast<std::size_t>(smallest - test.blocks.begin());
  test.rejected = test.nonFinitePixels > 0 || smallest->p < test.blockLevel ||
                  std::ranges::any_of(test.image, [&](const ZTestMeans& m) { return m.p < test.imageLevel; });
  summarizeBlocks(test);
  return test;
}

io::Image zTestMap(const ZTest& test, const Region& region, double scale) {
  io::Image map = io::makeImage(region.width, region.height, 1, io::PixelType::f32, io::ColorEncoding::linear);
  const std::span<float> values = map.samples<float>();
  for (const ZTestMeans& block : test.blocks) {
    const bool certain = block.differenceError() <= 0.0 && block.p < 1.0;
    const auto value = static_cast<float>(certain ? 1.0 : std::min(1.0, std::abs(block.t()) / scale));
    for (std::uint32_t y = block.region.y - region.y; y < block.region.y - region.y + block.region.height; ++y)
      for (std::uint32_t x = block.region.x - region.x; x < block.region.x - region.x + block.region.width; ++x) {
        float& pixel = values[std::size_t{y} * region.width + x];
        pixel = std::max(pixel, value);
      }
  }
  return map;
}

}  // namespace quintet::render
