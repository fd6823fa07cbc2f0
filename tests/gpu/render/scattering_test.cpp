// SPDX-License-Identifier: Apache-2.0
// KHR_materials_volume_scatter in rendered images, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

// The formula of the extension.
double singleAlbedo(double multiple) {
  const double root =
      4.09712 + 4.20863 * multiple - std::sqrt(9.59217 + 41.6808 * multiple + 17.7126 * multiple * multiple);
  return 1.0 - root * root;
}
// Its inverse.
double multipleAlbedo(double single) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) (singleAlbedo(0.5 * (low + high)) < single ? low : high) = 0.5 * (low + high);
  return low;
}

// A solid with the attenuation of 1/m in all channels, without reflection.
scene::Material fog(const vec3& multiple, float anisotropy = 0.0f, float ior = 1.0f) {
  scene::Material m = clearGlass(ior, 1.0f);
  m.attenuationColor = vec3(std::exp(-1.0f));
  m.attenuationDistance = 1.0f;
  m.multiscatterColor = multiple;
  m.scatterAnisotropy = anisotropy;
  return m;
}

ImageOptions longPaths(const char* program, std::uint32_t batches) {
  ImageOptions options;
  options.program = program::loadProgram(program);
  options.batches = batches;
  options.set = {"bounces=60"};
  return options;
}

// A white medium absorbs nothing.
TEST(Scattering, WhiteMediaAreInvisibleInAFurnace) {
  for (const char* program : {"pathtracer", "naive"}) {
    for (const auto& [anisotropy, ior] : {std::pair(0.0f, 1.0f), std::pair(0.7f, 1.5f), std::pair(-0.5f, 1.2f)}) {
      SCOPED_TRACE(testing::Message() << program << " g " << anisotropy << " ior " << ior);
      SceneBuilder scene;
      scene.add(sphere(vec3(0.0f), 2.0f, 3), fog(vec3(1.0f), anisotropy, ior)).sky(vec3(1.0f));
      scene.camera(perspective({0, 0, 6}, vec3(0.0f), 20.0f));
      expectUniform(renderImage(scene, longPaths(program, 8)), vec4(1.0f), {.error = 0.03, .rounding = 2e-3});
    }
  }
}

// A surface leads into a medium without an end. Red never reaches the sky: it scatters until the path ends. The medium neither absorbs
// nor scatters green and blue.
TEST(Scattering, OpenMediaAbsorbAllLightFromInfinity) {
  scene::Material red = fog(vec3(0.8f));
  red.attenuationColor = {0.5f, 1.0f, 1.0f};
  red.specular = 0.0f;
  SceneBuilder scene;
  scene.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), red).sky(vec3(1.0f));
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.05f));
  for (const char* program : {"pathtracer", "naive"}) {
    SCOPED_TRACE(program);
    ImageOptions options = longPaths(program, 16);
    options.set = {"bounces=1"};  // a path that returns to the surface ends there
    expectUniform(renderImage(scene, options), {0.0f, 1.0f, 1.0f, 1.0f}, {.error = 0.03});
  }
}

// Chandrasekhar's H function for isotropic scattering at μ = 1 (Radiative Transfer, 1950, section 38), by fixed-point
// iteration of 1/H(μ) = sqrt(1-ω) + ω/2 ∫ μ' H(μ') / (μ + μ') dμ'.
double chandrasekharH(double omega) {
  constexpr int kNodes = 400;
  std::vector<double> h(kNodes, 1.0), next(kNodes);
  const auto inverse = [&](double mu) {
    double sum = 0.0;
    for (int k = 0; k < kNodes; ++k) {
      const double node = (k + 0.5) / kNodes;
      sum += node * h[static_cast<std::size_t>(k)] / (mu + node) / kNodes;
    }
    return std::sqrt(1.0 - omega) + 0.5 * omega * sum;
  };
  for (int round = 0; round < 200; ++round) {
    for (int k = 0; k < kNodes; ++k) next[static_cast<std::size_t>(k)] = 1.0 / inverse((k + 0.5) / kNodes);
    h = next;
  }
  return 1.0 / inverse(1.0);
}

// A half space under a uniform sky reflects 1 - sqrt(1-ω) H(μ) (the same book, section 42).
vec4 reflectanceOfHalfSpace(const vec3& multiple) {
  vec4 exact(1.0f);
  for (glm::length_t c = 0; c < 3; ++c) {
    const double omega = singleAlbedo(static_cast<double>(multiple[c]));
    exact[c] = static_cast<float>(1.0 - std::sqrt(1.0 - omega) * chandrasekharH(omega));
  }
  return exact;
}

SceneBuilder halfSpace(const vec3& multiple) {
  SceneBuilder scene;
  scene.add(box({-60, -60, -40}, {60, 60, 0}), fog(multiple)).sky(vec3(1.0f));
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.05f));
  return scene;
}

const vec3 kDark(0.02f, 0.04f, 0.06f);  // light hardly ever scatters

TEST(Scattering, AHalfSpaceHasChandrasekharsReflectance) {
  for (const vec3& multiple : {vec3(0.2f, 0.5f, 0.8f), kDark}) {
    const vec4 exact = reflectanceOfHalfSpace(multiple);
    const SceneBuilder scene = halfSpace(multiple);
    for (const char* program : {"pathtracer", "naive"}) {
      SCOPED_TRACE(testing::Message() << program << " " << multiple.x);
      expectUniform(renderImage(scene, longPaths(program, multiple.x < 0.1f ? 32 : 16)), exact,
                    {.error = 0.04, .rounding = 1e-3});
    }
  }
}

// After the first event, about half of the paths survive (ω is 0.25 in blue), whatever their directions are. If only those that
// the medium scatters forwards survived, hardly any path would return to the sky, which is found by no shadow ray.
TEST(Scattering, RouletteIsIndependentOfTheDirection) {
  ImageOptions options = longPaths("pathtracer", 64);
  options.set.emplace_back("roulette_start=1");
  expectUniform(renderImage(halfSpace(kDark), options), reflectanceOfHalfSpace(kDark),
                {.error = 0.03, .rounding = 1e-3});
}

// A point light in the medium around the camera. Light that scatters once is ω ∫ p(θ) I/r² exp(-(t+r)) dt along the
// ray; more scatterings are of higher order in ω. Channels with ω and 2ω give the first order.
TEST(Scattering, LightsInMediaScatterOnce) {
  constexpr double kOmega = 0.04, kAnisotropy = 0.4, kIntensity = 10.0;
  const vec3 position(1.0f, 0.0f, -2.0f);
  SceneBuilder scene;
  scene.add(box(vec3(-30.0f), vec3(30.0f)), fog(vec3(static_cast<float>(multipleAlbedo(kOmega)),
                                                     static_cast<float>(multipleAlbedo(2.0 * kOmega)), 0.0f),
                                                static_cast<float>(kAnisotropy)));
  scene::Light lamp;
  lamp.intensity = vec3(static_cast<float>(kIntensity));
  lamp.position = position;
  scene.light(lamp).camera(orthographic(vec3(0.0f), {0, 0, -1}, 0.01f));
  double exact = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) * 20.0 / kSteps;
    const glm::dvec3 toLight = glm::dvec3(position) - glm::dvec3(0, 0, -t);
    const double r = glm::length(toLight), g = kAnisotropy;
    // Light travels along -toLight, and then to the camera along +z.
    const double cosine = glm::dot(-toLight / r, glm::dvec3(0, 0, 1));
    const double phase =
        (1.0 - g * g) / (4.0 * static_cast<double>(kPi) * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
    exact += phase * kIntensity / (r * r) * std::exp(-t - r) * 20.0 / kSteps;
  }
  const RenderedImage image = renderImage(scene, longPaths("pathtracer", 64));
  double red = 0.0, green = 0.0;
  for (std::uint32_t i = 0; i < 64; ++i) {
    red += image.at(i % 8, i / 8, 0).mean() / 64.0;
    green += image.at(i % 8, i / 8, 1).mean() / 64.0;
    EXPECT_EQ(image.at(i % 8, i / 8, 2).mean(), 0.0);
  }
  EXPECT_NEAR(2.0 * red / kOmega - green / (2.0 * kOmega), exact, 0.03 * exact);
  EXPECT_GT(green / (2.0 * kOmega), red / kOmega);  // more than one scattering
}

}  // namespace
}  // namespace quintet::test
