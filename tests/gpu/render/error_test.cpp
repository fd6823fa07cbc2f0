// SPDX-License-Identifier: Apache-2.0
// The error estimate of rendered images: its bound covers the true error, and is not much larger.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "harness.h"
#include "render/film/adaptive_plan.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

// A scene with penumbra, a small lamp, a glossy floor, and the sky.
SceneBuilder room() {
  SceneBuilder scene;
  scene::Material glossy;
  glossy.metallic = 0.0f;
  glossy.roughness = 0.4f;
  glossy.baseColor = {0.6f, 0.5f, 0.4f, 1.0f};
  scene.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), glossy)
      .add(box({-0.5f, 0, -0.5f}, {0.5f, 0.8f, 0.5f}), lambert({0.7f, 0.2f, 0.2f}));
  scene.add(quad({-0.3f, 2, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}), emitter(vec3(12.0f)));
  scene.sky(vec3(0.2f)).camera(perspective({1.5f, 1.5f, 3.0f}, {0, 0.4f, 0}, 40.0f));
  return scene;
}

constexpr std::uint32_t kErrorSide = 14;

struct Runs {
  SceneBuilder scene = room();
  render::DeviceScene device{testContext(), scene::Scene(scene.scene), scene.environment};
  ImageOptions options;
  explicit Runs(std::uint32_t planned) {
    options.width = options.height = kErrorSide;
    options.plannedSamples = planned;
  }

  // Returns the films after these numbers of batches, which are ascending.
  std::vector<render::FilmState> render(std::uint32_t seed, const std::vector<std::uint32_t>& batches) {
    options.seed = seed;
    render::Renderer renderer = makeRenderer(device, options.program, settingsFor(scene.scene.cameras[0], options));
    std::vector<render::FilmState> films;
    for (std::uint32_t b = 0; films.size() < batches.size();) {
      renderer.renderBatch();
      if (++b == batches[films.size()]) films.push_back(renderer.film().saveFirst());
    }
    return films;
  }
};

struct TrueError {
  double image = 0;
  double tiles = 0;  // the percentile of ErrorEstimate::tiles
};

// Computes the error by the definition in film_error.h, against an image with many samples.
TrueError trueError(const io::Image& image, const io::Image& exact) {
  const auto luminance = [](std::span<const float> p) { return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]; };
  const std::uint32_t width = image.width, height = image.height;
  double mean = 0, all = 0;
  for (std::uint32_t i = 0; i < width * height; ++i)
    mean += luminance(exact.pixel<float>(i % width, i / width)) / (width * height);
  std::map<std::pair<std::uint32_t, std::uint32_t>, Moments> tiles;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const auto a = image.pixel<float>(x, y), b = exact.pixel<float>(x, y);
      const double l = luminance(b);
      double square = 0;
      for (std::size_t c = 0; c < 3; ++c)
        square += std::pow(static_cast<double>(a[c]) - b[c], 2) / 3 / (l * l + 0.01 * mean * mean);
      all += square / (width * height);
      tiles[{y / shared::kTileSize, x / shared::kTileSize}].add(square);
    }
  std::vector<double> squares;
  for (const auto& [position, tile] : tiles) squares.push_back(tile.mean());
  std::ranges::sort(squares);
  return {std::sqrt(all), std::sqrt(squares[static_cast<std::size_t>(0.95 * static_cast<double>(squares.size() - 1))])};
}

// Uses the sample plans of `render` with --time or --until-error (0), and with --spp 64.
TEST(ErrorEstimate, CoversTheTrueError) {
  const io::Image exact = planeImage(Runs(shared::kIndependentPixels).render(1000, {500})[0], 0);
  for (const std::uint32_t planned : {0u, 64u}) {
    constexpr int kRuns = 20;
    Runs runs(planned);
    const std::vector<std::uint32_t> batches = {4, 16};
    std::vector<int> covered(batches.size());
    std::vector<double> bound(batches.size()), actual(batches.size());
    for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
      const std::vector<render::FilmState> films = runs.render(seed, batches);
      for (std::size_t i = 0; i < batches.size(); ++i) {
        const double error = trueError(planeImage(films[i], 0), exact).image;
        const render::ErrorEstimate estimate = render::estimateError(films[i]);
        covered[i] += error <= estimate.upper;
        bound[i] += estimate.upper;
        actual[i] += error;
      }
    }
    for (std::size_t i = 0; i < batches.size(); ++i) {
      std::printf("  planned %d, %u batches: covered in %d of %d runs, bound %.4f, actual %.4f, ratio %.2f\n",
                  static_cast<int>(planned), batches[i], covered[i], kRuns, bound[i] / kRuns, actual[i] / kRuns,
                  bound[i] / actual[i]);
      EXPECT_GE(covered[i], (9 * kRuns + 9) / 10) << batches[i];
      EXPECT_LT(bound[i] / actual[i], 2.5) << batches[i] << ": the bound is too wide to be useful";
    }
  }
}

// An image of 2 x 2 tiles: one shows a glossy ball below a small lamp, one an evenly lit wall, and two an unlit board.
// The plan assigns samples to tiles with a large spread. With the same total number of samples the image's error is
// lower than with equal numbers per tile. The bound covers it, and the bounds of the tiles cover their errors (95 % of
// four: all but the worst).
TEST(ErrorEstimate, CoversAndLowersTheErrorOfAdaptiveSampling) {
  constexpr std::uint32_t kWide = 2 * shared::kTileSize;
  constexpr int kRuns = 6;
  SceneBuilder scene;
  scene::Material glossy;
  glossy.metallic = 0.0f;
  glossy.roughness = 0.3f;
  scene.add(quad({-4, -4, -1}, {8, 0, 0}, {0, 8, 0}), lambert(vec3(0.5f)))
      .add(sphere({-0.75f, 0.75f, 0}, 0.5f, 2), glossy);
  scene.add(quad({0, -4, 0.5f}, {4, 0, 0}, {0, 8, 0}), unlit(vec3(0.5f)));
  scene.add(quad({-0.8f, 1.3f, 0.2f}, {0.1f, 0, 0}, {0, 0, 0.1f}), emitter(vec3(30.0f)));
  scene.sky(vec3(0.5f)).camera(orthographic({0, 0, 4}, {0, 0, 0}, 1.5f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.width = options.height = kWide;
  options.set = {"bounces=2"};
  const auto rendererFor = [&](std::uint32_t seed) {
    options.seed = seed;
    return makeRenderer(device, options.program, settingsFor(scene.scene.cameras[0], options));
  };
  const auto batches = [](render::Renderer& renderer, int count) {
    for (int b = 0; b < count; ++b) renderer.renderBatch();
  };
  render::Renderer many = rendererFor(1000);
  batches(many, 192);
  const io::Image exact = many.image();
  int covered = 0, tilesCovered = 0, lower = 0;
  double adaptive = 0, uniform = 0;
  for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
    render::Renderer renderer = rendererFor(seed);
    batches(renderer, 4);
    const std::vector<std::uint32_t> plan =
        render::planCells(render::estimateError(renderer.film().saveFirst()), {0, 12});
    while (renderer.film().counts().cellBatches != plan) ASSERT_TRUE(renderer.renderCells(plan));
    const render::FilmState film = renderer.film().saveFirst();
    const double samples = render::averageSamples(film.region, film.counts);
    EXPECT_LE(samples, 13.0 * render::kBatchSamples) << "more samples than uniform sampling";
    renderer.restart();
    batches(renderer, static_cast<int>(std::ceil(samples / render::kBatchSamples)));
    const TrueError adaptiveError = trueError(planeImage(film, 0), exact);
    const TrueError uniformError = trueError(renderer.image(), exact);
    const render::ErrorEstimate estimate = render::estimateError(film);
    covered += adaptiveError.image <= estimate.upper;
    tilesCovered += adaptiveError.tiles <= estimate.tiles;
    lower += adaptiveError.image < uniformError.image;
    adaptive += adaptiveError.image / kRuns;
    uniform += uniformError.image / kRuns;
    std::printf("  seed %u: adaptive %.4f (bound %.4f), tiles %.4f (bound %.4f), uniform %.4f, %.1f samples\n", seed,
                adaptiveError.image, estimate.upper, adaptiveError.tiles, estimate.tiles, uniformError.image, samples);
  }
  EXPECT_EQ(covered, kRuns);
  EXPECT_EQ(tilesCovered, kRuns);
  EXPECT_EQ(lower, kRuns);
  EXPECT_LT(adaptive, 0.9 * uniform);
}

}  // namespace
}  // namespace quintet::test
