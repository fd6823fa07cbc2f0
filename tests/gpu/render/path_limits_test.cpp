// SPDX-License-Identifier: Apache-2.0
// The limits of paths, by counting their rays: bounces, scattering events in media, and the start of Russian roulette. And decisions
// that must not share random numbers: Russian roulette does not change an image, whatever a path has decided before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "harness.h"
#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

ImageOptions limitedOptions(const std::string& program, std::vector<std::string> set, std::uint32_t batches = 8) {
  ImageOptions options;
  options.program = program::loadProgram(program);
  options.set = std::move(set);
  options.width = options.height = 4;
  options.batches = batches;
  return options;
}

double raysPerSample(const SceneBuilder& scene, const ImageOptions& options) {
  return static_cast<double>(renderImage(scene, options).rays) / (16.0 * options.batches * render::kBatchSamples);
}

// A closed room without light, so that each ray but the last scatters, and no shadow rays are traced.
SceneBuilder darkRoom(float albedo) {
  SceneBuilder scene;
  scene::Geometry room = box(vec3(-1.0f), vec3(1.0f));
  scene.add(room, lambert(vec3(albedo))).camera(perspective({0.2f, 0.1f, 0.3f}, {0, 0, -1}, 40));
  return scene;
}

TEST(PathLimits, APathHasOneRayMoreThanBounces) {
  const SceneBuilder scene = darkRoom(0.9f);
  for (const int bounces : {1, 2, 7}) {
    const std::string set = "bounces=" + std::to_string(bounces);
    EXPECT_EQ(raysPerSample(scene, limitedOptions("pathtracer", {set, "roulette_start=1000"})), bounces + 1.0);
    EXPECT_EQ(raysPerSample(scene, limitedOptions("naive", {set})), bounces + 1.0);
  }
}

// After the event `start` a path with the throughput ρ^k survives with the probability 2 ρ^k, and has half of that afterwards.
TEST(PathLimits, RouletteBeginsAfterItsFirstEvent) {
  const SceneBuilder scene = darkRoom(0.1f);
  for (const int start : {1, 2, 3}) {
    // From event `start` on: 2 ρ^start, then twice ρ/2 for each further event.
    const double first = std::min(0.95, 2.0 * std::pow(0.1, start)), next = 0.1;
    double expected = start, alive = 1;
    for (int event = start; event <= 6; ++event) expected += alive *= event == start ? first : next;
    const double found = raysPerSample(
        scene, limitedOptions("pathtracer", {"bounces=6", "roulette_start=" + std::to_string(start)}, 64));
    // 4096 samples; the number of rays after the start is nearly a Bernoulli variable.
    EXPECT_NEAR(found, expected, 5.0 * std::sqrt(first / 4096.0) + 0.002) << start;
  }
}

// Light that scatters in a white medium without an end: the number of events is the limit.
TEST(PathLimits, MediaHave64EventsPerBounce) {
  scene::Material milk = clearGlass(1.0f, 1.0f);
  milk.attenuationColor = vec3(std::exp(-1.0f));
  milk.attenuationDistance = 1e-3f;
  milk.multiscatterColor = vec3(1.0f);
  SceneBuilder scene;
  scene.add(box(vec3(-50.0f), vec3(50.0f)), milk).camera(orthographic(vec3(0.0f), {0, 0, -1}, 0.01f));
  for (const int bounces : {0, 1, 2}) {
    const std::string set = "bounces=" + std::to_string(bounces);
    EXPECT_EQ(raysPerSample(scene, limitedOptions("pathtracer", {set, "roulette_start=1000"}, 1)),
              64.0 * bounces + 1.0);
    EXPECT_EQ(raysPerSample(scene, limitedOptions("naive", {set}, 1)), 64.0 * bounces + 1.0);
  }
}

// The mean over the image, by batches.
Moments luminanceOf(const SceneBuilder& scene, const ImageOptions& options) {
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment,
                             {.compiler = &testCompiler()});
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(scene.scene.cameras.at(0), options));
  Moments mean;
  for (std::uint32_t i = 0; i < options.batches; ++i) {
    renderer.renderBatch();
    double sum = 0;
    for (const vec4& pixel : renderer.film().downloadBatch(0))
      sum += static_cast<double>(pixel.x) + static_cast<double>(pixel.y) + static_cast<double>(pixel.z);
    mean.add(sum / (16.0 * 3.0 * render::kBatchSamples));
  }
  return mean;
}

void expectMeanWithoutRoulette(const SceneBuilder& scene, const std::vector<std::string>& set,
                               const std::string& what) {
  constexpr std::uint32_t kBatches = 512;
  const Moments a = luminanceOf(scene, limitedOptions("pathtracer", {"bounces=6", "roulette_start=1000"}, kBatches));
  std::vector<std::string> changed{"bounces=6"};
  changed.insert(changed.end(), set.begin(), set.end());
  const Moments b = luminanceOf(scene, limitedOptions("pathtracer", changed, kBatches));
  EXPECT_GT(pValue(a, b, 1e-4 * a.mean()), 1e-3) << what << ": " << b.mean() << " instead of " << a.mean();
  EXPECT_LT(a.standardError(), 0.015 * a.mean()) << what << ": not sensitive";
  EXPECT_LT(b.standardError(), 0.015 * b.mean()) << what << ": not sensitive";
}

// Surfaces with two lobes of different colors, whose directions find different light. With the random number of the lobe, of the
// direction or of the light, roulette would end the paths of one kind.
TEST(PathLimits, RouletteIsIndependentOfTheLobe) {
  scene::Material coated = lambert({0.02f, 0.2f, 0.05f});
  coated.specular = 1.0f;
  coated.roughness = 0.3f;
  coated.clearcoat = 1.0f;
  coated.clearcoatRoughness = 0.1f;
  SceneBuilder scene;
  scene.add(quad({-9, 0, -9}, {0, 0, 18}, {18, 0, 0}), coated)
      .add(quad({-9, 0, -4}, {18, 0, 0}, {0, 9, 0}), coated)
      .add(quad({-2, 3, -3.9f}, {4, 0, 0}, {0, 1, 0}), emitter({5, 1, 1}))
      .add(quad({2, 1, -3.9f}, {1, 0, 0}, {0, 1, 0}), emitter({1, 1, 20}));
  scene.camera(perspective({0, 1.5f, 4}, {0, 0.5f, 0}, 20));
  expectMeanWithoutRoulette(scene, {"roulette_start=1"}, "two lobes");
}

TEST(PathLimits, RouletteIsIndependentOfScattering) {
  scene::Material fog = clearGlass(1.0f, 1.0f);
  fog.attenuationColor = vec3(std::exp(-0.5f), std::exp(-1.0f), std::exp(-2.0f));
  fog.attenuationDistance = 1.0f;
  fog.multiscatterColor = {0.9f, 0.6f, 0.3f};
  fog.scatterAnisotropy = 0.5f;
  SceneBuilder scene;
  scene.add(box({-3, -3, -3}, {3, 3, 0}), fog).add(quad({-9, 4, -9}, {18, 0, 0}, {0, 0, 18}), emitter({2, 2, 2}));
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.5f));
  expectMeanWithoutRoulette(scene, {"roulette_start=1"}, "fog");
}

// A lens and the filter of the pixel use different points: for an edge out of focus, the image of the edge is the convolution of both.
TEST(PathLimits, LensAndPixelFilterAreIndependent) {
  SceneBuilder scene;
  scene.add(quad({-100, 0, -20}, {200, 0, 0}, {0, 100, 0}), unlit(vec3(1.0f)));
  scene::Camera camera = perspective(vec3(0.0f), {0, 0, -1}, 20);
  camera.focusDistance = 10.0f;
  ImageOptions options = limitedOptions("pathtracer", {"bounces=1"}, 256);
  // The edge is at the middle of the image. The circle of confusion has the radius of two thirds of the filter's, which makes the
  // product of both offsets visible.
  const float pixel = 2.0f * 20.0f * std::tan(glm::radians(10.0f)) / 4.0f;  // at 20 m
  camera.apertureRadius = pixel;                                            // at 20 m as large as at the lens
  scene.camera(camera);
  const RenderedImage image = renderImage(scene, options);
  // Fraction of light at half a pixel above the edge: the offset of the filter (a tent of 0.75 pixels) plus that of the lens (a disk
  // of one pixel), by integration.
  double sum = 0, weights = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double offset = 0.75 * (2.0 * (i + 0.5) / kSteps - 1.0), weight = 1.0 - std::abs(offset) / 0.75;
    // Part of the disk above -(0.5 + offset).
    const double h = std::clamp(0.5 + offset, -1.0, 1.0);
    sum += weight * (0.5 + (std::asin(h) + h * std::sqrt(1.0 - h * h)) / static_cast<double>(kPi));
    weights += weight;
  }
  Moments above;
  for (std::uint32_t x = 0; x < 4; ++x) above.add(image.at(x, 1, 0).mean());
  EXPECT_NEAR(above.mean(), sum / weights, 0.02);
}

}  // namespace
}  // namespace quintet::test
