// The stated error of real pictures: it covers the real one, and is not much larger.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "harness.h"
#include "picture.h"
#include "render/film_error.h"

namespace quintet::test {
namespace {

// Half light and half shadow, a small lamp, a glossy floor and the sky.
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

constexpr std::uint32_t kSide = 14;

struct Runs {
  SceneBuilder scene = room();
  render::DeviceScene device{testContext(), scene.scene, scene.environment};
  PictureOptions options;
  explicit Runs(std::uint32_t planned) {
    options.width = options.height = kSide;
    options.plannedSamples = planned;
  }

  // The films after these numbers of batches, ascending.
  std::vector<render::FilmState> render(std::uint32_t seed, const std::vector<std::uint32_t>& looks) {
    options.seed = seed;
    render::Renderer renderer(device, options.program, testCompiler(), nullptr,
                              settingsFor(scene.scene.cameras[0], options));
    std::vector<render::FilmState> films;
    for (std::uint32_t b = 0; films.size() < looks.size();) {
      renderer.renderBatch();
      if (++b == looks[films.size()]) films.push_back(renderer.film().saveFirst());
    }
    return films;
  }
};

struct RealError {
  double image = 0;
  double tiles = 0;  // the tile of the percentile that ErrorEstimate::tiles takes
};

// By the definition in film_error.h, against a picture of many samples.
RealError realError(const io::Image& image, const io::Image& exact) {
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
  for (const auto& [place, tile] : tiles) squares.push_back(tile.mean());
  std::ranges::sort(squares);
  return {std::sqrt(all), std::sqrt(squares[static_cast<std::size_t>(0.95 * static_cast<double>(squares.size() - 1))])};
}

// In the modes of `render`: --time and --until-error; --spp 64.
TEST(StatedError, CoversTheRealOne) {
  const io::Image exact = planeImage(Runs(shared::kIndependentPixels).render(1000, {500})[0], 0);
  for (const std::uint32_t planned : {0u, 64u}) {
    constexpr int kRuns = 20;
    Runs runs(planned);
    const std::vector<std::uint32_t> looks = {4, 16};
    std::vector<int> covered(looks.size());
    std::vector<double> stated(looks.size()), real(looks.size());
    for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
      const std::vector<render::FilmState> films = runs.render(seed, looks);
      for (std::size_t i = 0; i < looks.size(); ++i) {
        const double error = realError(planeImage(films[i], 0), exact).image;
        const render::ErrorEstimate estimate = render::estimateError(films[i]);
        covered[i] += error <= estimate.upper;
        stated[i] += estimate.upper;
        real[i] += error;
      }
    }
    for (std::size_t i = 0; i < looks.size(); ++i) {
      std::printf("  planned %d, %u batches: covered in %d of %d runs, stated %.4f, real %.4f, ratio %.2f\n",
                  static_cast<int>(planned), looks[i], covered[i], kRuns, stated[i] / kRuns, real[i] / kRuns,
                  stated[i] / real[i]);
      EXPECT_GE(covered[i], (9 * kRuns + 9) / 10) << looks[i];
      EXPECT_LT(stated[i] / real[i], 2.5) << looks[i] << ": the statement would be of no use";
    }
  }
}

// A picture of 2 x 2 tiles, one with a glossy ball below a small lamp, one with a wall in even light, two of an unlit board:
// where the spread is, the plan sends samples. With as many samples in all, the picture's error is lower than with equal numbers; it is
// covered by its statement; so are the tiles' by theirs (95 % of four: all but the worst).
TEST(StatedError, OfAdaptiveSamplingIsRightAndLower) {
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
  render::DeviceScene device(testContext(), scene.scene, scene.environment);
  PictureOptions options;
  options.width = options.height = kWide;
  options.set = {"bounces=2"};
  const auto makeRenderer = [&](std::uint32_t seed) {
    options.seed = seed;
    return render::Renderer(device, options.program, testCompiler(), nullptr,
                            settingsFor(scene.scene.cameras[0], options));
  };
  const auto batches = [](render::Renderer& renderer, int count) {
    for (int b = 0; b < count; ++b) renderer.renderBatch();
  };
  render::Renderer many = makeRenderer(1000);
  batches(many, 192);
  const io::Image exact = many.image();
  int covered = 0, tilesCovered = 0, lower = 0;
  double adaptive = 0, uniform = 0;
  for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
    render::Renderer renderer = makeRenderer(seed);
    batches(renderer, 4);
    const std::vector<std::uint32_t> plan =
        render::planCells(render::estimateError(renderer.film().saveFirst()), {0, 12});
    while (renderer.film().counts().cellBatches != plan) ASSERT_TRUE(renderer.renderCells(plan));
    const render::FilmState film = renderer.film().saveFirst();
    const double samples = render::averageSamples(film.region, film.counts);
    EXPECT_LE(samples, 13.0 * render::kBatchSamples) << "no more samples than uniform";
    renderer.restart();
    batches(renderer, static_cast<int>(std::ceil(samples / render::kBatchSamples)));
    const RealError is = realError(planeImage(film, 0), exact), without = realError(renderer.image(), exact);
    const render::ErrorEstimate stated = render::estimateError(film);
    covered += is.image <= stated.upper;
    tilesCovered += is.tiles <= stated.tiles;
    lower += is.image < without.image;
    adaptive += is.image / kRuns;
    uniform += without.image / kRuns;
    std::printf("  seed %u: adaptive %.4f (stated %.4f), tiles %.4f (stated %.4f), uniform %.4f, %.1f samples\n", seed,
                is.image, stated.upper, is.tiles, stated.tiles, without.image, samples);
  }
  EXPECT_EQ(covered, kRuns);
  EXPECT_EQ(tilesCovered, kRuns);
  EXPECT_EQ(lower, kRuns);
  EXPECT_LT(adaptive, 0.9 * uniform);
}

}  // namespace
}  // namespace quintet::test
