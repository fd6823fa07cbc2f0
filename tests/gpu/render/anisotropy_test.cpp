// SPDX-License-Identifier: Apache-2.0
// KHR_materials_anisotropy in rendered images, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "rendered_image.h"
#include "scene/geometry/tangents.h"

namespace quintet::test {
namespace {

using glm::dvec2;
using glm::dvec3;

int addTexel(scene::Scene& scene, std::array<std::uint8_t, 4> rgba) {
  io::Image image = io::makeImage(1, 1, 4, io::PixelType::u8, io::ColorEncoding::linear);
  std::ranges::copy(rgba, image.samples<std::uint8_t>().begin());
  scene.images.push_back({"texel", std::move(image)});
  scene.textures.push_back({"texel", static_cast<int>(scene.images.size()) - 1, {}});
  return static_cast<int>(scene.textures.size()) - 1;
}

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

// The radiance of the square, without multiple scattering, which adds 1 to 8 %. Burley 2012, "Physically Based Shading at
// Disney", B.2, with the height-correlated masking of Heitz 2014. The tests expect 4.5 % more, within 4.5 %.
double expectedRadiance(double strength, double angle) {
  const dvec3 wo(0.0, 0.5, std::sqrt(0.75)), wi = glm::normalize(dvec3(0.3, 0.6, -0.5)), h = glm::normalize(wo + wi);
  const double alpha = 0.25;
  const dvec2 widths(alpha + (1.0 - alpha) * strength * strength, alpha);
  const dvec3 along(std::cos(angle), 0.0, std::sin(angle)), across(-std::sin(angle), 0.0, std::cos(angle));
  const auto local = [&](const dvec3& v) { return dvec2(glm::dot(v, along), glm::dot(v, across)); };
  const double q = glm::dot(local(h) / widths, local(h) / widths) + h.y * h.y;
  const double distribution = 1.0 / (kPi * widths.x * widths.y * q * q);
  const auto lambda = [&](const dvec3& w) {
    return 0.5 * (std::sqrt(1.0 + glm::dot(widths * local(w), widths * local(w)) / (w.y * w.y)) - 1.0);
  };
  const double fresnel = 0.02 + 0.98 * std::pow(1.0 - glm::dot(wo, h), 5.0);
  return 1.045 * 2.0 * fresnel * distribution / (4.0 * wo.y * (1.0 + lambda(wo) + lambda(wi)));
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
    expectUniform(renderImage(scene), vec4(vec3(expected), 1.0f), {.error = 0.001, .rounding = 0.043});
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
  expectUniform(renderImage(scene), vec4(vec3(expected), 1.0f), {.error = 0.001, .rounding = 0.043});
}

}  // namespace
}  // namespace quintet::test
