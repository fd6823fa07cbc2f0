// SPDX-License-Identifier: Apache-2.0
// KHR_materials_anisotropy in rendered images, against the second implementation of the BSDF.
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf/reference.h"
#include "rendered_image.h"
#include "scene/geometry/tangents.h"

namespace quintet::test {
namespace {

// A horizontal square of dark metal under the sun and a camera at 60 degrees to the normal, along z. Its tangent is x, its
// bitangent is z.
SceneBuilder brushedSquare() {
  scene::Geometry floor = quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
  floor.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  scene::Material metal;
  metal.baseColor = vec4(vec3(0.02f), 1.0f);
  metal.roughness = 0.5f;
  SceneBuilder scene;
  scene.add(floor, metal);
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.intensity = vec3(2.0f);
  sun.direction = glm::normalize(vec3(-0.3f, -0.6f, 0.5f));
  return scene.light(sun).camera(orthographic({0, 0.5f, std::sqrt(0.75f)}, vec3(0.0f), 0.1f));
}

// The radiance of the square by the second implementation of the BSDF.
double expectedRadiance(double strength, double angle) {
  const vec3 along(std::cos(angle), 0.0, std::sin(angle)), across(-std::sin(angle), 0.0, std::cos(angle));
  const auto local = [&](const vec3& v) { return vec3(glm::dot(v, along), glm::dot(v, across), v.y); };
  BsdfCase metal;
  metal.alpha = 0.25f;
  metal.metallic = 1.0f;
  metal.baseColor = vec3(0.02f);
  metal.anisotropy = static_cast<float>(strength);
  metal.wo = local(vec3(0.0f, 0.5f, std::sqrt(0.75f)));
  return 2.0 * ReferenceBsdf().eval(metal, glm::dvec3(local(glm::normalize(vec3(0.3f, 0.6f, -0.5f))))).x;
}

TEST(AnisotropyRender, RoughnessGrowsAlongTheRotatedTangent) {
  for (const float angle : {0.0f, 0.6f, 1.8f}) {
    SCOPED_TRACE(angle);
    SceneBuilder scene = brushedSquare();
    scene::Material& metal = scene.scene.materials.back();
    metal.anisotropy = 0.8f;
    metal.anisotropyRotation = angle;
    EXPECT_TRUE(scene::addTangents(scene.scene, 0));
    const float expected = static_cast<float>(expectedRadiance(double{metal.anisotropy}, double{angle}));
    expectUniform(renderImage(scene), vec4(vec3(expected), 1.0f), {.error = 0.001, .rounding = 2e-3});
  }
}

// The texture's direction is rotated further, and its strength is multiplied.
TEST(AnisotropyRender, TextureHasDirectionAndStrength) {
  SceneBuilder scene = brushedSquare();
  scene::Material& metal = scene.scene.materials.back();
  metal.anisotropy = 0.9f;
  metal.anisotropyRotation = 0.5f;
  metal.anisotropyTexture.texture = addTexel(scene.scene, {51, 204, 128, 0});
  EXPECT_TRUE(scene::addTangents(scene.scene, 0));
  const double angle = 0.5 + std::atan2(2.0 * 204.0 / 255.0 - 1.0, 2.0 * 51.0 / 255.0 - 1.0);
  const float expected = static_cast<float>(expectedRadiance(double{metal.anisotropy} * 128.0 / 255.0, angle));
  expectUniform(renderImage(scene), vec4(vec3(expected), 1.0f), {.error = 0.001, .rounding = 2e-3});
}

}  // namespace
}  // namespace quintet::test
