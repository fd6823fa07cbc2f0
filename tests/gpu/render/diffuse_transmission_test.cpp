// SPDX-License-Identifier: Apache-2.0
// KHR_materials_diffuse_transmission in rendered images, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "rendered_image.h"

namespace quintet::test {
namespace {

// A horizontal square seen from above, which the sun illuminates from `side`: 1 is above, -1 below.
SceneBuilder leafInTheSun(float side) {
  scene::Material leaf = lambert({0.5f, 0.25f, 0.125f});
  leaf.diffuseTransmission = 0.75f;
  leaf.diffuseTransmissionColor = {0.2f, 0.8f, 0.4f};
  SceneBuilder scene;
  scene.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), leaf);
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.intensity = vec3(kPi);
  sun.direction = {0.8f, -0.6f * side, 0.0f};
  scene.light(sun).camera(orthographic({0, 0.5f, std::sqrt(0.75f)}, vec3(0.0f), 0.1f));
  return scene;
}

// color / pi times the irradiance, 0.6 pi: a quarter of the light is reflected, the rest is transmitted.
TEST(DiffuseTransmission, SplitsTheLightOfTheSun) {
  const Tolerance tolerance{.error = 0.001, .rounding = 1e-3};
  expectUniform(renderImage(leafInTheSun(1.0f)), vec4(0.6f * 0.25f * vec3(0.5f, 0.25f, 0.125f), 1.0f), tolerance);
  expectUniform(renderImage(leafInTheSun(-1.0f)), vec4(0.6f * 0.75f * vec3(0.2f, 0.8f, 0.4f), 1.0f), tolerance);
}

// A white leaf is invisible in front of a white sky: it reflects and transmits everything.
TEST(DiffuseTransmission, WhiteLeafIsInvisibleInAFurnace) {
  scene::Material leaf = lambert(vec3(1.0f));
  leaf.diffuseTransmission = 0.4f;
  SceneBuilder scene;
  scene.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), leaf);
  scene.sky(vec3(1.0f)).camera(orthographic({0, 0.5f, std::sqrt(0.75f)}, vec3(0.0f), 0.1f));
  expectUniform(renderImage(scene), vec4(1.0f), {.error = 0.01, .rounding = 1e-3});
}

// The radiance at the origin of a horizontal surface that transmits the light of a square below it diffusely, through a
// medium that absorbs `absorption` per meter.
float transmittedFrom(const vec3& corner, float size, float radiance, double absorption) {
  constexpr int kCells = 64;
  const double cell = double{size} / kCells;
  double sum = 0.0;
  for (int x = 0; x < kCells; ++x) {
    for (int z = 0; z < kCells; ++z) {
      const glm::dvec3 point = glm::dvec3(corner) + cell * glm::dvec3(x + 0.5, 0.0, -(z + 0.5));
      const double r = glm::length(point), cosine = -point.y / r;
      sum += cell * cell * cosine * cosine / (r * r) * std::exp(-absorption * r);
    }
  }
  return static_cast<float>(double{radiance} * sum / glm::pi<double>());
}

// Light below the surface is absorbed on its way if it is inside of the solid, which is behind the front face.
TEST(DiffuseTransmission, EntersAVolumeThatAbsorbs) {
  constexpr float kSize = 0.4f, kRadiance = 5.0f;
  const vec3 corner(0.1f, -0.5f, 0.3f), color(0.5f, 0.9f, 1.0f);
  scene::Material wax = lambert(vec3(0.0f));
  wax.diffuseTransmission = 1.0f;
  wax.thickness = 1.0f;
  wax.attenuationColor = color;
  wax.attenuationDistance = 0.3f;
  for (const bool inside : {true, false}) {
    SCOPED_TRACE(inside);
    const vec3 side = inside ? vec3(0, 0, -2) : vec3(0, 0, 2);
    SceneBuilder scene;
    scene.add(quad({-1, 0, 0.5f * -side.z}, {2, 0, 0}, side), wax);
    scene.add(quad(corner, {kSize, 0, 0}, {0, 0, -kSize}), emitter(vec3(kRadiance)));
    scene.camera(orthographic({0, 0.5f, std::sqrt(0.75f)}, vec3(0.0f), 1e-4f));
    vec4 expected(0.0f, 0.0f, 0.0f, 1.0f);
    for (glm::length_t i = 0; i < 3; ++i)
      expected[i] =
          transmittedFrom(corner, kSize, kRadiance, inside ? -std::log(static_cast<double>(color[i])) / 0.3 : 0.0);
    expectUniform(renderImage(scene), expected, {.error = 0.01, .rounding = 1e-3});
  }
}

}  // namespace
}  // namespace quintet::test
