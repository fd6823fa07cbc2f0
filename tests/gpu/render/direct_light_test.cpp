// SPDX-License-Identifier: Apache-2.0
// Area, point, spot and directional lights on a Lambert plane, against closed forms.
#include <gtest/gtest.h>

#include <array>

#include "rendered_image.h"

namespace quintet::test {
namespace {

const vec3 kLitAlbedo(0.6f, 0.5f, 0.3f);
constexpr float kHalf = 0.5f;  // half the width of the image on the plane y = 0, in meters

// A plane under a camera that looks straight down from below all lights, with x to the right and z down.
SceneBuilder plane() {
  SceneBuilder scene;
  scene.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), lambert(kLitAlbedo));
  scene.camera(orthographic({0, 0.25f, 0}, vec3(0.0f), kHalf));
  return scene;
}

vec3 pointOf(vec2 pixel, std::uint32_t size) {
  const vec2 p = kHalf * (2.0f * pixel / static_cast<float>(size) - 1.0f);
  return {p.x, 0.0f, p.y};
}

// Returns the irradiance at p with normal n from a polygon of radiance 1 that is above the horizon (Lambert 1760; Baum
// et al. 1989): the sum over its edges of half their angle times the normal of their plane.
float irradiance(const vec3& p, const vec3& n, const std::vector<vec3>& polygon) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = glm::normalize(glm::dvec3(polygon[i] - p));
    const glm::dvec3 b = glm::normalize(glm::dvec3(polygon[(i + 1) % polygon.size()] - p));
    sum += 0.5 * std::acos(glm::clamp(glm::dot(a, b), -1.0, 1.0)) * glm::normalize(glm::cross(a, b));
  }
  return static_cast<float>(std::abs(glm::dot(sum, glm::dvec3(n))));
}

ImageOptions batchesOf(std::uint32_t count) {
  ImageOptions options;
  options.batches = count;
  return options;
}

struct AreaCase {
  const char* name;
  vec3 corner, a, b;
};

class AreaLight : public testing::TestWithParam<AreaCase> {};

TEST_P(AreaLight, MatchesTheFormFactor) {
  const AreaCase& c = GetParam();
  const vec3 radiance(5.0f, 3.0f, 1.0f);
  SceneBuilder scene = plane();
  scene.add(quad(c.corner, c.a, c.b), emitter(radiance));
  const std::vector<vec3> polygon = {c.corner, c.corner + c.a, c.corner + c.a + c.b, c.corner + c.b};
  expectPixels(renderImage(scene, batchesOf(24)),
               [&](vec2 pixel) {
                 return kLitAlbedo / kPi * radiance * irradiance(pointOf(pixel, 8), {0, 1, 0}, polygon);
               },
               {.error = 0.01, .rounding = 2e-4});
}

INSTANTIATE_TEST_SUITE_P(Quads, AreaLight,
                         testing::Values(AreaCase{"Above", {-0.5f, 1.0f, -0.5f}, {1, 0, 0}, {0, 0, 1}},
                                         AreaCase{"AboveFacingUp", {-0.5f, 1.0f, -0.5f}, {0, 0, 1}, {1, 0, 0}},
                                         AreaCase{"UprightBeside", {0.7f, 0.05f, -0.6f}, {0, 0.8f, 0}, {0.3f, 0, 1.2f}},
                                         AreaCase{
                                             "SmallAndLow", {-0.05f, 0.3f, -0.05f}, {0.1f, 0.03f, 0}, {0, 0, 0.1f}},
                                         AreaCase{"FarAndHuge", {-300, 1000, -250}, {600, 0, 0}, {0, 80, 500}}),
                         [](const auto& test) { return std::string(test.param.name); });

// Lights that only next-event estimation finds have no noise except that of the position within the pixel.
constexpr Tolerance kPunctual{.error = 0.01, .rounding = 5e-4};

scene::Light lampAt(scene::LightType type) {
  scene::Light light;
  light.type = type;
  light.intensity = {3.0f, 2.0f, 1.0f};
  light.position = {0.3f, 0.9f, -0.2f};
  light.direction = glm::normalize(vec3(-0.4f, -1.0f, 0.3f));
  light.innerConeAngle = 0.15f;
  light.outerConeAngle = 0.6f;
  return light;
}

vec3 reflected(const scene::Light& light, const vec3& p) {
  const vec3 d = light.position - p;
  const float distance = glm::length(d);
  const vec3 wi = d / distance;
  if (light.type == scene::LightType::directional) return kLitAlbedo / kPi * light.intensity * -light.direction.y;
  float cone = 1.0f;
  if (light.type == scene::LightType::spot) {  // KHR_lights_punctual
    const float outer = std::cos(light.outerConeAngle);
    cone = glm::clamp((glm::dot(-wi, light.direction) - outer) / (std::cos(light.innerConeAngle) - outer), 0.0f, 1.0f);
    cone *= cone;
  }
  return kLitAlbedo / kPi * light.intensity * (cone * wi.y / (distance * distance));
}

class PunctualLight : public testing::TestWithParam<scene::LightType> {};

TEST_P(PunctualLight, MatchesItsFormula) {
  const scene::Light light = lampAt(GetParam());
  SceneBuilder scene = plane();
  scene.light(light);
  ImageOptions options = batchesOf(16);
  options.width = options.height = 16;
  expectPixels(
      renderImage(scene, options), [&](vec2 pixel) { return reflected(light, pointOf(pixel, options.width)); },
      kPunctual);
}

INSTANTIATE_TEST_SUITE_P(
    Types, PunctualLight,
    testing::Values(scene::LightType::point, scene::LightType::spot, scene::LightType::directional),
    [](const auto& test) {
      return std::string(std::array{"Point", "Spot", "Directional"}[static_cast<std::size_t>(test.param)]);
    });

// Light and surfaces of a single channel, and dim lights: no test of "is there any light" may ask a single channel, or for
// more than 0.
TEST(PunctualLights, ShineInASingleChannel) {
  for (int channel = 0; channel < 3; ++channel) {
    SCOPED_TRACE(channel);
    vec3 one(0.0f);
    one[channel] = 1.0f;
    for (const auto type : {scene::LightType::point, scene::LightType::directional}) {
      scene::Light light = lampAt(type);
      light.intensity = 0.125f * one;
      SceneBuilder scene = plane();
      scene.light(light);
      expectPixels(
          renderImage(scene, batchesOf(4)), [&](vec2 pixel) { return reflected(light, pointOf(pixel, 8)); }, kPunctual);
    }
    // Inside an emitting sphere that reflects one channel: the light is found by samples of the light and of directions.
    scene::Material m = lambert(0.5f * one);
    m.emissive = 0.125f * one;
    SceneBuilder scene;
    scene.add(sphere(vec3(0.0f), 1.0f, 2), m).camera(perspective(vec3(0.1f), vec3(1.0f), 90.0f));
    ImageOptions options = batchesOf(8);
    options.set = {"bounces=2"};
    expectUniform(renderImage(scene, options), vec4(0.125f * 1.75f * one, 1.0f), {.error = 0.01});
    // A constant sky.
    SceneBuilder open = plane();
    open.sky(0.125f * one);
    expectUniform(renderImage(open, batchesOf(8)), vec4(0.125f * kLitAlbedo * one, 1.0f), {.error = 0.01});
  }
}

// A sun below the horizon of the plane, and a lamp behind it.
TEST(PunctualLights, DoNotShineThroughSurfaces) {
  scene::Light lamp = lampAt(scene::LightType::point), sun = lampAt(scene::LightType::directional);
  lamp.position.y = -0.9f;
  sun.direction.y = 1.0f;
  expectBlack(renderImage(plane().light(lamp).light(sun), batchesOf(4)));
}

TEST(PunctualLights, AddUpWithAreaLights) {
  SceneBuilder scene = plane();
  std::array lights = {lampAt(scene::LightType::point), lampAt(scene::LightType::directional)};
  lights[1].direction.x *= -1.0f;  // the panel casts no shadow within the image
  for (const scene::Light& light : lights) scene.light(light);
  const vec3 corner(0.7f, 0.05f, -0.6f), a(0, 0.8f, 0), b(0.3f, 0, 1.2f), radiance(4.0f, 5.0f, 6.0f),
      sky(0.5f, 0.4f, 0.3f);
  scene.add(quad(corner, a, b), emitter(radiance)).sky(sky);
  expectPixels(renderImage(scene, batchesOf(512)),
               [&](vec2 pixel) {
                 const vec3 p = pointOf(pixel, 8);
                 vec3 sum = reflected(lights[0], p) + reflected(lights[1], p);
                 const float panel = irradiance(p, {0, 1, 0}, {corner, corner + a, corner + a + b, corner + b});
                 return sum + kLitAlbedo / kPi * (radiance * panel + sky * (kPi - panel));
               },
               {.error = 0.01, .rounding = 5e-4});
}

// A blocker between lamp and plane removes all light, also at a tiny distance from the lamp.
TEST(PunctualLights, CastShadows) {
  scene::Light lamp = lampAt(scene::LightType::point);
  for (const float height : {0.5f, 0.8999f}) {
    SceneBuilder scene = plane();
    scene.light(lamp).add(quad({-9, height, 9}, {18, 0, 0}, {0, 0, -18}), lambert(vec3(0.0f)));
    expectBlack(renderImage(scene, batchesOf(4)));
  }
}

// A thin wall that is lit from behind only, with vertex normals that are almost in its plane or point away from the
// camera. No material lets light through.
TEST(BentNormals, LeakNoLight) {
  const std::array<scene::Material, 3> materials = [] {
    std::array<scene::Material, 3> m;
    m[0] = lambert(vec3(0.9f));
    m[1].roughness = 0.3f;  // metal
    m[2].metallic = 0.0f;
    m[2].roughness = 0.5f;
    m[2].clearcoat = 1.0f;
    return m;
  }();
  for (const vec3 normal : {vec3(0.99f, 0.0f, 0.14f), vec3(-0.7f, 0.7f, 0.1f), vec3(0.6f, 0.0f, -0.8f)}) {
    for (const scene::Material& material : materials) {
      SceneBuilder scene;
      scene::Geometry wall = quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0});
      wall.normals = {normal, normal, vec3(-normal.x, normal.y, normal.z), normal};
      for (vec3& n : wall.normals) n = glm::normalize(n);
      scene::Light lamp = lampAt(scene::LightType::point), sun = lampAt(scene::LightType::directional);
      lamp.position = {0.5f, 0.3f, -1.0f};
      sun.direction = glm::normalize(vec3(-0.5f, 0.1f, 1.0f));
      scene.add(wall, material).add(quad({-20, -20, -3}, {40, 0, 0}, {0, 40, 0}), emitter(vec3(10.0f)));
      scene.scene.materials.insert(scene.scene.materials.end(), materials.begin(),
                                   materials.end());  // the same shaders for all materials
      scene.light(lamp).light(sun).camera(perspective({0.2f, 0.1f, 1.5f}, {0, 0, 0}, 60.0f));
      expectBlack(renderImage(scene, batchesOf(8)));
    }
  }
}

}  // namespace
}  // namespace quintet::test
