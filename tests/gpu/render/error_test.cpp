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
  explicit Runs(std::uint32_t planned) {
    options.width = options.height = kSide;
    options.plannedSamples = planned;
  }

  // The films after these numbers of batches, ascending.
  std::vector<render::FilmState> render(std::uint32_t seed, const std::vector<std::uint32_t>& looks) {
    options.seed = seed;
    render::Renderer renderer(device, options.program, testCompiler(), nullptr, settingsFor(scene.scene.cameras[0], options));
    std::vector<render::FilmState> films;
    for (std::uint32_t b = 0; films.size() < looks.size();) {
      renderer.renderBatch();
      if (++b == looks[films.size()]) films.push_back(renderer.film().saveFirst());
    }
    return films;
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
        const double error = realError(planeImage(films[i], 0), exact);
        const render::ErrorEstimate estimate = render::estimateError(films[i]);
        covered[i] += error <= estimate.upper;
        stated[i] += estimate.upper;
        real[i] += error;
      }
    }
    for (std::size_t i = 0; i < looks.size(); ++i) {
      std::printf("  planned %d, %u batches: covered in %d of %d runs, stated %.4f, real %.4f, ratio %.2f\n", static_cast<int>(planned), looks[i],
                  covered[i], kRuns, stated[i] / kRuns, real[i] / kRuns, stated[i] / real[i]);
      EXPECT_GE(covered[i], (9 * kRuns + 9) / 10) << looks[i];
      EXPECT_LT(stated[i] / real[i], 2.5) << looks[i] << ": the statement would be of no use";
    }
  }
}

TEST(StatedError, OfAdaptiveSamplingIsRightAndLower) {
  Runs runs(shared::kIndependentPixels);
  const io::Image exact = planeImage(runs.render(1000, {500})[0], 0);
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
