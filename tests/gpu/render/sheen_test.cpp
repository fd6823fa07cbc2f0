// SPDX-License-Identifier: Apache-2.0
// KHR_materials_sheen in rendered images, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "rendered_image.h"

namespace quintet::test {
namespace {

// Estevez and Kulla 2017, table 1, for alpha 0.25: a quarter of the way is (1 - 0.25)² = 0.5625.
double sheenLambda(double cosine) {
  const auto fit = [](double x) {
    const auto mixed = [](double rough, double smooth) { return rough + 0.5625 * (smooth - rough); };
    return mixed(21.5473, 25.3245) / (1.0 + mixed(3.82987, 3.32435) * std::pow(x, mixed(0.19823, 0.16801))) +
           mixed(-1.97760, -1.27393) * x + mixed(-4.32054, -4.85967);
  };
  return std::exp(cosine < 0.5 ? fit(cosine) : 2.0 * fit(0.5) - fit(1.0 - cosine));
}

// A horizontal square under a camera that looks down at 60 degrees to the normal.
SceneBuilder clothSquare(const scene::Material& material) {
  scene::Geometry floor = quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
  floor.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  SceneBuilder scene;
  scene.add(floor, material);
  scene.camera(orthographic({0, 0.5f, std::sqrt(0.75f)}, vec3(0.0f), 0.1f));
  return scene;
}

// Black cloth in the light of the sun: color D V cos E. Color and roughness are products of factor and texture: the sRGB
// value 206 is 0.61721, and 128 / 255 of the roughness is 0.5. Drivers decode other sRGB values with errors of up to 0.2 %.
TEST(SheenRender, BlackClothReflectsTheSun) {
  scene::Material cloth = lambert(vec3(0.0f));
  cloth.sheenColor = {1.0f, 0.5f, 0.2f};
  cloth.sheenRoughness = 255.0f / 256.0f;
  SceneBuilder scene = clothSquare(cloth);
  scene::Material& material = scene.scene.materials.back();
  material.sheenColorTexture.texture = addTexel(scene.scene, {255, 206, 255, 0}, io::ColorEncoding::sRgb);
  material.sheenRoughnessTexture.texture = addTexel(scene.scene, {0, 0, 0, 128}, io::ColorEncoding::linear);
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.intensity = vec3(2.0f);
  sun.direction = glm::normalize(vec3(-0.8f, -0.6f, 0.0f));
  scene.light(sun);

  const glm::dvec3 wo(0.0, 0.5, std::sqrt(0.75)), wi(0.8, 0.6, 0.0), h = glm::normalize(wo + wi);
  const double distribution = 6.0 * std::pow(1.0 - h.y * h.y, 2.0) / (2.0 * kPi);
  const double visible = distribution / (4.0 * wo.y * (1.0 + sheenLambda(wo.y) + sheenLambda(wi.y)));
  const glm::dvec3 color(1.0, 0.5 * 0.617207, 0.2);
  expectUniform(renderImage(scene), vec4(vec3(2.0 * visible * color), 1.0f), {.error = 0.001, .rounding = 2e-3});
}

// What a white sheen does not reflect reaches the white base: the square is invisible in front of a white sky.
TEST(SheenRender, WhiteClothIsInvisibleInAFurnace) {
  for (const float roughness : {0.1f, 0.4f, 1.0f}) {
    SCOPED_TRACE(roughness);
    scene::Material cloth = lambert(vec3(1.0f));
    cloth.sheenColor = vec3(1.0f);
    cloth.sheenRoughness = roughness;
    SceneBuilder scene = clothSquare(cloth);
    scene.sky(vec3(1.0f));
    expectUniform(renderImage(scene), vec4(1.0f), {.error = 0.01, .rounding = 0.01});
  }
}

}  // namespace
}  // namespace quintet::test
