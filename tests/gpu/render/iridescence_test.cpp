// SPDX-License-Identifier: Apache-2.0
// KHR_materials_iridescence in rendered images, against the reference of the reflectance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bsdf/reference.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

// A horizontal square under a white sky, with a camera at 60 degrees to the normal.
SceneBuilder squareUnderTheSky(const scene::Material& material) {
  scene::Geometry floor = quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
  floor.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  SceneBuilder scene;
  scene.add(floor, material);
  return scene.sky(vec3(1.0f)).camera(orthographic({0, 0.5f, std::sqrt(0.75f)}, vec3(0.0f), 0.1f));
}

// A smooth metal reflects the sky by the film's reflectance. The factor is 128 / 255 of 1, and the thickness is at 204 / 255
// between 100 and 600 nm: 500 nm.
TEST(IridescenceRender, MetalReflectsTheColorsOfTheFilm) {
  scene::Material metal;
  metal.roughness = 0.0f;
  metal.baseColor = {0.9f, 0.6f, 0.3f, 1.0f};
  metal.iridescence = 1.0f;
  metal.iridescenceIor = 1.4f;
  metal.iridescenceThicknessMaximum = 600.0f;
  SceneBuilder scene = squareUnderTheSky(metal);
  scene::Material& material = scene.scene.materials.back();
  material.iridescenceTexture.texture = addTexel(scene.scene, {128, 0, 0, 0});
  material.iridescenceThicknessTexture.texture = addTexel(scene.scene, {0, 204, 0, 0});
  const glm::dvec3 color(0.9, 0.6, 0.3), bare = color + (1.0 - color) * std::pow(0.5, 5.0);
  const glm::dvec3 film = referenceFilm({1.4, 500.0}, 0.5, color);
  EXPECT_GT(glm::length(film - bare), 0.1);
  expectUniform(renderImage(scene), vec4(glm::mix(bare, film, 128.0 / 255.0), 1.0f),
                {.error = 0.001, .rounding = 2e-3});
}

// What the film does not reflect reaches the diffuse base, limited by the largest channel.
TEST(IridescenceRender, DielectricKeepsTheLightOfTheLargestChannel) {
  scene::Material plastic = lambert(vec3(1.0f));
  plastic.specular = 1.0f;
  plastic.roughness = 0.0f;
  plastic.iridescence = 1.0f;
  plastic.iridescenceThicknessMaximum = 250.0f;
  const glm::dvec3 film = referenceFilm({1.3, 250.0}, 0.5, glm::dvec3(0.04));
  const double largest = std::max({film.x, film.y, film.z});
  const glm::dvec3 expected = film + (1.0 - largest);
  EXPECT_GT(1.0 - std::min({expected.x, expected.y, expected.z}), 0.005);
  expectUniform(renderImage(squareUnderTheSky(plastic)), vec4(expected, 1.0f), {.error = 0.01, .rounding = 5e-3});
}

}  // namespace
}  // namespace quintet::test
