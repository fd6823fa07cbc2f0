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

}  // namespace
}  // namespace quintet::test
