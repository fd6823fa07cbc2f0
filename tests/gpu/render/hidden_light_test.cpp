// SPDX-License-Identifier: Apache-2.0
// Light sampling in media and behind hidden surfaces (quintet/media.glsl), which shadow rays do not pass: against integrals over the
// emitter, and against `naive`.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "harness.h"
#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

using glm::dvec3;

const vec3 kEmitted(2.0f, 3.0f, 5.0f);

// ∫ cos θ cos θ' exp(-σ r) / r² dA over the square of 2 m at this distance below a point with a normal downward. Its center is at x.
double throughMedium(double distance, double x, double sigma) {
  constexpr int kSteps = 400;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const dvec3 to(x - 1.0 + 2.0 * (i + 0.5) / kSteps, -1.0 + 2.0 * (j + 0.5) / kSteps, -distance);
      const double r = glm::length(to), cosine = distance / r;
      sum += cosine * cosine * std::exp(-sigma * r) / (r * r) * 4.0 / (kSteps * kSteps);
    }
  return sum;
}

// The square emitter of throughMedium() at a height.
scene::Geometry squareEmitter(float x, float z) { return quad({x - 1, -1, z}, {2, 0, 0}, {0, 2, 0}); }

scene::Material absorbing(scene::Material m, const vec3& sigma, float priority) {
  m.thickness = 1.0f;
  m.attenuationColor = glm::exp(-sigma);
  m.attenuationDistance = 1.0f;
  m.dielectricPriority = priority;
  return m;
}

scene::Material cloudy(const vec3& color, const vec3& sigma, float priority) {
  scene::Material m = lambert(color);
  m.diffuseTransmission = 1.0f;
  m.diffuseTransmissionColor = color;
  return absorbing(m, sigma, priority);
}

ImageOptions mediumOptions(const char* program, std::uint32_t batches) {
  ImageOptions options;
  options.program = program::loadProgram(program);
  options.width = options.height = 8;
  options.batches = batches;
  options.set = {"bounces=20"};
  return options;
}

enum class Hidden { none, one, two, ofTheSameMaterial };

// Adds solids whose surfaces do not exist, between z = -1.5 and -0.3 inside of solid 0.
void addHidden(SceneBuilder& scene, Hidden hidden) {
  const scene::Material inner = absorbing(clearGlass(1.7f, 1.0f), vec3(0.4f), 0.0f);
  scene.add(box({90, 90, 90}, {91, 91, 91}), inner);  // out of sight, so that all scenes have priorities
  if (hidden == Hidden::ofTheSameMaterial) {
    scene.scene.instances.push_back(scene.scene.instances[0]);
    scene.scene.instances.back().worldFromObject =
        glm::translate(glm::scale(mat4(1.0f), vec3(0.5f, 0.5f, 0.3f)), vec3(0, 0, -2));
    return;
  }
  if (hidden != Hidden::none) scene.add(box({-15, -15, -1.5f}, {15, 15, -1.1f}), inner);
  if (hidden == Hidden::two) scene.add(box({-15, -15, -0.7f}, {15, 15, -0.3f}), inner);
}

// A surface that transmits light diffusely, over a solid that absorbs, and an emitter in it.
TEST(HiddenSurfaces, LightInASolidArrivesAtItsSurface) {
  const vec3 color(0.9f, 0.6f, 0.3f), sigma(0.1f, 0.5f, 0.0f);
  vec4 exact(0, 0, 0, 1);
  for (glm::length_t c = 0; c < 3; ++c)
    exact[c] = static_cast<float>(double{kEmitted[c]} * double{color[c]} / double{kPi} *
                                  throughMedium(2.0, 0.5, double{sigma[c]}));
  for (const Hidden hidden : {Hidden::none, Hidden::one, Hidden::two, Hidden::ofTheSameMaterial}) {
    SceneBuilder scene;
    scene.add(box({-30, -30, -3}, {30, 30, 0}), cloudy(color, sigma, 1.0f))
        .add(squareEmitter(0.5f, -2), emitter(kEmitted));
    addHidden(scene, hidden);
    scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.001f));
    for (const char* program : {"pathtracer", "naive"}) {
      SCOPED_TRACE(testing::Message() << program << " " << static_cast<int>(hidden));
      expectUniform(renderImage(scene, mediumOptions(program, 128)), exact, {.error = 0.02, .rounding = 1e-3});
    }
  }
}

// A camera and a diffuse floor in a liquid: absorption on the way to the light, and to the camera.
TEST(HiddenSurfaces, LightInASolidArrivesAtAFloor) {
  const vec3 color(0.8f, 0.5f, 0.9f), sigma(0.2f, 0.0f, 0.6f);
  vec4 exact(0, 0, 0, 1);
  for (glm::length_t c = 0; c < 3; ++c)
    exact[c] = static_cast<float>(double{kEmitted[c]} * double{color[c]} / double{kPi} *
                                  std::exp(-2.5 * double{sigma[c]}) * throughMedium(2.0, 3.0, double{sigma[c]}));
  for (const Hidden hidden : {Hidden::none, Hidden::one}) {
    SceneBuilder scene;
    scene.add(box({-30, -30, -4}, {30, 30, 4}), absorbing(clearGlass(1.0f, 1.0f), sigma, 1.0f));
    scene.add(quad({-30, -30, -2.5f}, {60, 0, 0}, {0, 60, 0}), lambert(color))
        .add(squareEmitter(3.0f, -0.5f), emitter(kEmitted));
    addHidden(scene, hidden);
    scene.camera(orthographic({0, 0, 0}, {0, 0, -1}, 0.001f));
    for (const char* program : {"pathtracer", "naive"}) {
      SCOPED_TRACE(testing::Message() << program << " " << static_cast<int>(hidden));
      expectUniform(renderImage(scene, mediumOptions(program, 512)), exact, {.error = 0.04, .rounding = 1e-3});
    }
  }
}

// A camera in a liquid, and a solid in the liquid whose surfaces do not exist: the outputs describe the floor.
TEST(HiddenSurfaces, AreNotTheFirstSurface) {
  const vec3 color(0.8f, 0.5f, 0.9f);
  SceneBuilder scene;
  scene.add(box({-30, -30, -4}, {30, 30, 4}), absorbing(clearGlass(1.0f, 1.0f), vec3(0.1f), 1.0f))
      .add(quad({-30, -30, -2.5f}, {60, 0, 0}, {0, 60, 0}), lambert(color));
  addHidden(scene, Hidden::one);
  scene.camera(orthographic({0, 0, 0}, {0, 0, -1}, 0.5f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  const Layers layers = renderLayers(device, scene.scene, program::loadProgram("pathtracer"), {"albedo", "normal"});
  ASSERT_EQ(layers.planes.size(), 3u);
  for (std::size_t i = 0; i < layers.planes[0].size(); ++i) {
    const float samples = render::kBatchSamples;
    EXPECT_EQ(layers.planes[0][i].w, samples) << "alpha of pixel " << i;
    EXPECT_LT(glm::length(vec3(layers.planes[1][i]) / samples - color), 1e-5f) << "albedo of pixel " << i;
    EXPECT_LT(glm::length(vec3(layers.planes[2][i]) / samples - vec3(0, 0, 1)), 1e-5f) << "normal of pixel " << i;
  }
}

// Mean over the image, by batches.
std::vector<Moments> imageMeans(const SceneBuilder& scene, const char* program, std::uint32_t batches) {
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment,
                             {.compiler = &testCompiler()});
  const ImageOptions options = mediumOptions(program, batches);
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(scene.scene.cameras.at(0), options));
  std::vector<Moments> means(3);
  for (std::uint32_t i = 0; i < batches; ++i) {
    renderer.renderBatch();
    glm::dvec3 sum(0.0);
    for (const vec4& pixel : renderer.film().downloadBatch(0)) sum += glm::dvec3(pixel);
    for (glm::length_t c = 0; c < 3; ++c)
      means[static_cast<std::size_t>(c)].add(sum[c] / (64.0 * render::kBatchSamples));
  }
  return means;
}

void expectNaive(const SceneBuilder& scene, std::uint32_t batches, double error) {
  const std::vector<Moments> tracer = imageMeans(scene, "pathtracer", batches),
                             naive = imageMeans(scene, "naive", 4 * batches);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_GT(pValue(tracer[c], naive[c], 1e-4 * naive[c].mean()), sidak(0.001, 3))
        << tracer[c].mean() << " instead of " << naive[c].mean() << ", channel " << c;
    EXPECT_LT(naive[c].standardError(), error * naive[c].mean()) << "the test is not sensitive";
    EXPECT_LT(tracer[c].standardError(), error * tracer[c].mean()) << "the test is not sensitive";
  }
}

// Rough glass in front of an emitter, with and without hidden surfaces between.
TEST(HiddenSurfaces, RoughGlassShowsWhatNaiveShows) {
  for (const Hidden hidden : {Hidden::none, Hidden::two}) {
    SCOPED_TRACE(static_cast<int>(hidden));
    scene::Material glass = absorbing(clearGlass(1.5f, 1.0f), vec3(0.1f, 0.2f, 0.3f), 1.0f);
    glass.roughness = 0.7f;
    SceneBuilder scene;
    scene.add(box({-30, -30, -3}, {30, 30, 0}), glass).add(squareEmitter(0.3f, -2), emitter(kEmitted));
    addHidden(scene, hidden);
    scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.001f));
    expectNaive(scene, 128, 0.03);
  }
}

// A scattering medium with an emitter, with and without hidden surfaces between.
TEST(HiddenSurfaces, ScatteringMediaShowWhatNaiveShows) {
  for (const Hidden hidden : {Hidden::none, Hidden::one}) {
    SCOPED_TRACE(static_cast<int>(hidden));
    scene::Material fog = absorbing(clearGlass(1.0f, 1.0f), vec3(0.3f, 0.5f, 0.7f), 1.0f);
    fog.multiscatterColor = vec3(0.8f);
    fog.scatterAnisotropy = 0.3f;
    SceneBuilder scene;
    scene.add(box({-30, -30, -4}, {30, 30, 0}), fog).add(squareEmitter(1.5f, -2), emitter(kEmitted));
    addHidden(scene, hidden);
    scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.001f));
    expectNaive(scene, 128, 0.04);
  }
}

}  // namespace
}  // namespace quintet::test
