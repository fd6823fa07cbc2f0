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

// A sheet has no inside: a volume around it absorbs light on both sides. The camera is in the volume, too, 1 m from the sheet.
TEST(DiffuseTransmission, ASheetInAVolumeDoesNotEndIt) {
  constexpr float kSize = 0.4f, kRadiance = 5.0f;
  const vec3 corner(0.1f, -0.5f, 0.3f), color(0.5f, 0.9f, 1.0f);
  scene::Material sheet = lambert(vec3(0.0f)), water = clearGlass(1.0f, 1.0f);
  sheet.diffuseTransmission = 1.0f;
  water.attenuationColor = color;
  water.attenuationDistance = 0.3f;
  vec4 expected(0.0f, 0.0f, 0.0f, 1.0f);
  for (glm::length_t i = 0; i < 3; ++i) {
    const double absorption = -std::log(static_cast<double>(color[i])) / 0.3;
    expected[i] = transmittedFrom(corner, kSize, kRadiance, absorption) * static_cast<float>(std::exp(-absorption));
  }
  for (const float priority : {0.0f, 1.0f}) {  // without and with nested media
    for (const float side : {-2.0f, 2.0f}) {   // the sheet is seen from the front, and from behind
      SCOPED_TRACE(testing::Message() << "priority " << priority << ", side " << side);
      water.dielectricPriority = priority;
      SceneBuilder scene;
      scene.add(box(vec3(-9.0f), vec3(9.0f)), water)
          .add(quad({-1, 0, -0.5f * side}, {2, 0, 0}, {0, 0, side}), sheet)
          .add(quad(corner, {kSize, 0, 0}, {0, 0, -kSize}), emitter(vec3(kRadiance)));
      scene.camera(orthographic({0, 0.5f, std::sqrt(0.75f)}, vec3(0.0f), 1e-4f));
      expectUniform(renderImage(scene), expected, {.error = 0.01, .rounding = 1e-3});
    }
  }
}

// A red square above a leaf and a green one below it fill about half of the directions on their side, those near the normal. A path
// chooses a side; its direction does not depend on this choice.
TEST(DiffuseTransmission, TheDirectionIsIndependentOfTheSide) {
  constexpr float kReflected = 0.8f, kTransmitted = 0.4f;
  scene::Material leaf = lambert(vec3(kReflected));
  leaf.diffuseTransmission = 0.5f;
  leaf.diffuseTransmissionColor = vec3(kTransmitted);
  SceneBuilder scene;
  scene.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), leaf);
  for (const float y : {-1.0f, 1.0f})
    scene.add(quad({-1, y, 1}, {2, 0, 0}, {0, 0, -2}), emitter(y > 0.0f ? vec3(1, 0, 0) : vec3(0, 1, 0)));
  scene.camera(orthographic({0, 0.5f, 0}, vec3(0.0f), 1e-4f));
  const float fromSquare = 0.5f * transmittedFrom({-1, -1, 1}, 2.0f, 1.0f, 0.0);
  for (const char* program : {"pathtracer", "naive"}) {
    SCOPED_TRACE(program);
    ImageOptions options;
    options.program = program::loadProgram(program);
    options.batches = 32;
    expectUniform(renderImage(scene, options), {kReflected * fromSquare, kTransmitted * fromSquare, 0.0f, 1.0f},
                  {.error = 0.03, .rounding = 1e-3});
  }
}

}  // namespace
}  // namespace quintet::test
