// SPDX-License-Identifier: Apache-2.0
// Light through panes (smooth thin walls) and alpha. Shadow rays carry exactly the light that goes straight through; a
// lamp's light is compared with closed forms. All other light, and the weights, are compared with brute force in
// pane_weights_test.cpp.
#include <gtest/gtest.h>

#include "pane_scenes.h"
#include "program/load.h"

namespace quintet::test {
namespace {

const vec3 kPaneAlbedo(0.6f, 0.5f, 0.3f);
constexpr float kPaneHalf = 0.5f;  // half the width of the image on the plane y = 0, in meters

// Returns the transmittance of a pane at this cosine to the shading normal, by KHR_materials_transmission, _specular,
// _ior and _clearcoat with Schlick's reflectance.
vec3 straight(const scene::Material& m, float cosine) {
  const float x = 1.0f - cosine, grazing = x * x * x * x * x;
  const float index = (m.ior - 1.0f) / (m.ior + 1.0f);
  const float f0 = index * index * m.specular;
  const float coat = m.clearcoat * (0.04f + 0.96f * grazing);
  return (1.0f - coat) * (1.0f - m.metallic) * m.transmission * (1.0f - glm::mix(f0, m.specular, grazing)) *
         vec3(m.baseColor);
}

struct Sheet {
  scene::Material material;
  vec3 normal{0, 1, 0};  // of the plane through (0, height, 0)
  float height = 0.5f;
  vec3 shadingNormal{0, 0, 0};  // 0 means that of the plane
  vec4 color{1.0f};             // vertex color
  float coverage = 1.0f;        // alpha
  bool passes = true;           // shadow rays pass
};

scene::Geometry geometryOf(const Sheet& sheet) {
  const vec3 a = glm::normalize(glm::cross(sheet.normal, vec3(0.3f, 0.1f, 1.0f))), b = glm::cross(sheet.normal, a);
  scene::Geometry g = quad(vec3(0, sheet.height, 0) - 5.0f * (a + b), 10.0f * a, 10.0f * b);
  if (sheet.shadingNormal != vec3(0.0f)) g.normals.assign(4, glm::normalize(sheet.shadingNormal));
  if (sheet.color != vec4(1.0f)) g.colors.assign(4, sheet.color);
  return g;
}

struct LampCase {
  const char* name;
  std::vector<Sheet> sheets;
  scene::LightType lamp = scene::LightType::point;
};

void PrintTo(const LampCase& c, std::ostream* out) { *out << c.name; }

std::vector<LampCase> lampCases();

class LampBehindPanes : public testing::TestWithParam<LampCase> {};

// Only light samples find the lamp, so the position within the pixel is the only source of noise.
TEST_P(LampBehindPanes, IsTintedByThem) {
  scene::Light lamp;
  lamp.intensity = {3.0f, 2.0f, 1.0f};
  lamp.position = {0.3f, 0.9f, -0.2f};
  lamp.type = GetParam().lamp;
  lamp.direction = glm::normalize(vec3(-0.4f, -1.0f, 0.3f));
  SceneBuilder scene;
  scene.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), lambert(kPaneAlbedo)).light(lamp);
  for (const Sheet& sheet : GetParam().sheets) scene.add(geometryOf(sheet), sheet.material);
  for (const LampCase& c : lampCases())  // the same shaders for all cases
    for (const Sheet& sheet : c.sheets) scene.scene.materials.push_back(sheet.material);
  scene.camera(orthographic({0, 0.25f, 0}, vec3(0.0f), kPaneHalf));
  ImageOptions options;
  options.set = {"bounces=1"};
  const auto exact = [&](vec2 pixel) {
    const vec2 at = kPaneHalf * (2.0f * pixel / static_cast<float>(options.width) - 1.0f);
    const vec3 p(at.x, 0.0f, at.y);
    const bool near = lamp.type == scene::LightType::point;
    const vec3 d = near ? lamp.position - p : -lamp.direction;
    const vec3 wi = glm::normalize(d);
    vec3 light = kPaneAlbedo / kPi * lamp.intensity * wi.y / (near ? glm::dot(d, d) : 1.0f);
    for (const Sheet& sheet : GetParam().sheets) {
      const vec3 n = sheet.shadingNormal == vec3(0.0f) ? sheet.normal : glm::normalize(sheet.shadingNormal);
      scene::Material m = sheet.material;
      m.baseColor *= sheet.color;
      const vec3 passed = sheet.passes ? straight(m, std::abs(glm::dot(wi, glm::normalize(n)))) : vec3(0.0f);
      light *= 1.0f - sheet.coverage + sheet.coverage * passed;
    }
    return light;
  };
  const RenderedImage image = renderImage(scene, options);
  if (exact(vec2(4.0f)) == vec3(0.0f))
    expectBlack(image);
  else
    expectPixels(image, exact, {.error = 0.01, .rounding = 1.5e-3});  // error of the BSDF's tables
}

const vec3 kUp(0, 1, 0), kTilted = glm::normalize(vec3(0.3f, 1.0f, 0.2f));

Sheet sheetOf(scene::Material material, const vec3& normal = kUp, float height = 0.5f) {
  return {std::move(material), normal, height};
}

std::vector<LampCase> lampCases() {
  const scene::Material green = pane({0.3f, 0.9f, 0.5f}), red = pane({0.9f, 0.4f, 0.2f});
  scene::Material dense = green, halfMetal = green, coated = green, rough = green, solid = clearGlass(1.5f, 0.1f);
  dense.ior = 2.4f, dense.specular = 0.7f;
  halfMetal.metallic = 0.4f, halfMetal.transmission = 0.7f;
  coated.clearcoat = 0.8f;
  rough.roughness = 0.1f;
  Sheet bent = sheetOf(green), colored = sheetOf(green), fromBelow = sheetOf(green, -kTilted);
  bent.shadingNormal = {-0.15f, 1.0f, 0.2f};
  colored.color = {0.5f, 1.0f, 0.25f, 1.0f};
  Sheet blend = sheetOf(veil(red, 0.3f, scene::AlphaMode::blend)),
        blendedPane = sheetOf(veil(green, 0.6f, scene::AlphaMode::blend));
  Sheet hole = sheetOf(veil(lambert(vec3(0.5f)), 0.3f, scene::AlphaMode::mask)), stays = hole;
  Sheet paint = sheetOf(veil(lambert(vec3(0.5f)), 0.3f, scene::AlphaMode::blend), kTilted, 0.6f);
  blend.coverage = paint.coverage = 0.3f, blendedPane.coverage = 0.6f, hole.coverage = 0.0f;
  stays.material.baseColor.a = 0.6f;
  paint.passes = stays.passes = hole.passes = false;
  Sheet frosted = sheetOf(rough), block = sheetOf(solid);
  frosted.passes = block.passes = false;
  return {{"Clear", {sheetOf(clearGlass(1.5f, 0.0f))}},
          {"Tilted", {sheetOf(green, kTilted)}},
          {"FromBelow", {fromBelow}},
          {"Dark", {sheetOf(pane({0.2f, 0.25f, 0.1f}), kTilted)}},
          {"Two", {sheetOf(green, kTilted), sheetOf(red, kUp, 0.7f)}},
          {"TwoInFrontOfTheSun", {sheetOf(green, kTilted), sheetOf(red, kUp, 0.7f)}, scene::LightType::directional},
          {"DenseAndDim", {sheetOf(dense, kTilted)}},
          {"HalfMetal", {sheetOf(halfMetal)}},
          {"Coated", {sheetOf(coated, kTilted)}},
          {"BentNormals", {bent}},
          {"VertexColors", {colored}},
          {"Blend", {paint}},
          {"BlendAndBlendedPane", {blendedPane, paint}},
          {"BlendedRed", {blend}},
          {"MaskedAway", {hole, sheetOf(green, kTilted, 0.6f)}},
          {"MaskedButPresent", {stays}},
          {"Rough", {frosted}},
          {"Solid", {block}},
          {"PaneInFrontOfRough", {frosted, sheetOf(green, kUp, 0.6f)}}};
}

INSTANTIATE_TEST_SUITE_P(Cases, LampBehindPanes, testing::ValuesIn(lampCases()),
                         [](const auto& test) { return std::string(test.param.name); });

// The light of a lamp in a bubble passes its wall once, for both kinds of primitive sets. The camera is outside.
TEST(LampInABubble, ShinesThroughItsWall) {
  const scene::Material green = pane({0.3f, 0.9f, 0.5f});
  scene::Light lamp;
  lamp.intensity = vec3(2.0f);
  lamp.position = {0, 1, 0};
  for (const bool tree : {false, true}) {
    SceneBuilder scene;
    scene.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), lambert(kPaneAlbedo)).light(lamp);
    addBubble(scene, green, lamp.position, 0.4f, tree);
    scene.camera(orthographic({0, 0.25f, 0}, vec3(0.0f), kPaneHalf));
    ImageOptions options;
    options.set = {"bounces=1"};
    expectPixels(renderImage(scene, options),
                 [&](vec2 pixel) {
                   const vec2 at = kPaneHalf * (2.0f * pixel / 8.0f - 1.0f);
                   const vec3 d = lamp.position - vec3(at.x, 0.0f, at.y);
                   return kPaneAlbedo / kPi * lamp.intensity * glm::normalize(d).y / glm::dot(d, d) *
                          straight(green, 1.0f);
                 },
                 {.error = 0.01, .rounding = 1.5e-3});
  }
}

// The light of a lamp behind a bubble passes two walls, which one ray hits in one box.
TEST(LampBehindABubble, ShinesThroughBothWalls) {
  const scene::Material green = pane({0.3f, 0.9f, 0.5f});
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.direction = {0, -1, 0};
  const float radius = 3.0f;
  for (const bool tree : {false, true}) {
    SceneBuilder scene;
    scene.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), lambert(kPaneAlbedo)).light(sun);
    addBubble(scene, green, {0, 4, 0}, radius, tree);
    scene.camera(orthographic({0, 0.25f, 0}, vec3(0.0f), kPaneHalf));
    ImageOptions options;
    options.set = {"bounces=1"};
    expectPixels(renderImage(scene, options),
                 [&](vec2 pixel) {
                   const vec2 at = kPaneHalf * (2.0f * pixel / 8.0f - 1.0f);
                   const float cosine = std::sqrt(1.0f - glm::dot(at, at) / (radius * radius));
                   const vec3 wall = straight(green, cosine);
                   return kPaneAlbedo / kPi * wall * wall;
                 },
                 {.error = 0.01, .rounding = 3e-3});
  }
}

// Passing a pane is not a bounce: with 0 bounces, an emitter behind three panes is visible.
TEST(Panes, CountNoBounces) {
  const scene::Material green = pane({0.3f, 0.9f, 0.5f});
  SceneBuilder scene;
  for (const float z : {0.0f, 1.0f, 2.0f}) scene.add(quad({-3, -3, z}, {6, 0, 0}, {0, 6, 0}), green);
  scene.add(quad({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}), emitter({1.0f, 0.5f, 2.0f}));
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.05f));
  const vec3 wall = straight(green, 1.0f);
  for (const char* program : {"pathtracer", "naive"}) {
    ImageOptions options;
    options.program = program::loadProgram(program);
    options.set = {"bounces=0"};
    options.batches = 64;
    expectUniform(renderImage(scene, options), vec4(wall * wall * wall * vec3(1.0f, 0.5f, 2.0f), 1.0f),
                  {.error = 0.02, .rounding = 4e-3});
  }
}

// The environment behind a pane is visible through it, and the pane covers the pixel.
TEST(Panes, CoverATransparentBackground) {
  const scene::Material green = pane({0.3f, 0.9f, 0.5f});
  SceneBuilder scene;
  scene.add(quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}), green).sky(vec3(1.0f));
  scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 0.05f));
  for (const char* program : {"pathtracer", "naive"}) {
    ImageOptions options;
    options.program = program::loadProgram(program);
    options.transparent = true;
    options.batches = 64;
    expectUniform(renderImage(scene, options), vec4(0.04f + straight(green, 1.0f), 1.0f),
                  {.error = 0.02, .rounding = 2e-3});
  }
}

}  // namespace
}  // namespace quintet::test
