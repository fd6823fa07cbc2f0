// The stated error of real pictures: it covers the real one, and is not much larger.
#include <gtest/gtest.h>

#include <cmath>

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
  scene.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), glossy).add(box({-0.5f, 0, -0.5f}, {0.5f, 0.8f, 0.5f}), lambert({0.7f, 0.2f, 0.2f}));
  scene.add(quad({-0.3f, 2, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}), emitter(vec3(12.0f)));
  scene.sky(vec3(0.2f)).camera(perspective({1.5f, 1.5f, 3.0f}, {0, 0.4f, 0}, 40.0f));
  return scene;
}

constexpr std::uint32_t kSide = 14;

struct Runs {
  SceneBuilder scene = room();
  render::DeviceScene device{testContext(), scene.scene, scene.environment};
  PictureOptions options;
  Runs() { options.width = options.height = kSide; }

  render::FilmState render(std::uint32_t seed, std::uint32_t batches) {
    render::RenderSettings settings = settingsFor(scene.scene.cameras[0], options);
    settings.seed = seed;
    render::Renderer renderer(device, options.program, testCompiler(), nullptr, settings);
    for (std::uint32_t b = 0; b < batches; ++b) renderer.renderBatch();
    return renderer.film().saveFirst();
  }
};

// By the definition in film_error.h, against a picture of many samples.
double realError(const io::Image& image, const io::Image& exact) {
  const auto luminance = [](std::span<const float> p) { return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]; };
  double mean = 0, sum = 0;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) mean += luminance(exact.pixel<float>(i % kSide, i / kSide)) / (kSide * kSide);
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const auto a = image.pixel<float>(i % kSide, i / kSide), b = exact.pixel<float>(i % kSide, i / kSide);
    const double y = luminance(b);
    for (std::size_t c = 0; c < 3; ++c) sum += std::pow(static_cast<double>(a[c]) - b[c], 2) / 3 / (y * y + 0.01 * mean * mean);
  }
  return std::sqrt(sum / (kSide * kSide));
}

TEST(StatedError, CoversTheRealOne) {
  Runs runs;
  const io::Image exact = planeImage(runs.render(1000, 500), 0);
  for (const std::uint32_t batches : {4u, 16u}) {
    constexpr int kRuns = 20;
    int covered = 0;
    double stated = 0, real = 0;
    for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
      const render::FilmState film = runs.render(seed, batches);
      const double error = realError(planeImage(film, 0), exact);
      const render::ErrorEstimate estimate = render::estimateError(film);
      covered += error <= estimate.upper;
      stated += estimate.upper;
      real += error;
    }
    std::printf("%u batches: covered in %d of %d runs, stated %.4f, real %.4f, ratio %.2f\n", batches, covered, kRuns, stated / kRuns, real / kRuns,
                stated / real);
    EXPECT_GE(covered, (9 * kRuns + 9) / 10) << batches;
    EXPECT_LT(stated / real, 2.5) << batches << ": the statement would be of no use";
  }
}

TEST(StatedError, OfAdaptiveSamplingIsRightAndLower) {
  Runs runs;
  const io::Image exact = planeImage(runs.render(1000, 500), 0);
  render::RenderSettings settings = settingsFor(runs.scene.scene.cameras[0], runs.options);
  render::Renderer renderer(runs.device, runs.options.program, testCompiler(), nullptr, settings);
  for (int b = 0; b < 4; ++b) renderer.renderBatch();
  const std::vector<std::uint32_t> plan = render::planCells(render::estimateError(renderer.film().saveFirst()), {0, 16});
  while (renderer.film().counts().cellBatches != plan) ASSERT_TRUE(renderer.renderCells(plan));
  const render::FilmState film = renderer.film().saveFirst();
  EXPECT_LE(realError(planeImage(film, 0), exact), render::estimateError(film).upper);
}

}  // namespace
}  // namespace quintet::test
