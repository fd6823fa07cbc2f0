// SPDX-License-Identifier: Apache-2.0
// The path tracer's AOVs: the components of the light add up to the image, and the properties of the first surface are
// correct.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "harness.h"
#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

struct AovLayers {
  program::Program program = program::loadProgram("pathtracer");
  std::map<std::string, io::Image> images;
  render::FilmState film;

  AovLayers(render::DeviceScene& device, const scene::Camera& camera, ImageOptions options,
            const std::vector<std::string>& outputs) {
    render::RenderSettings settings = settingsFor(camera, options);
    settings.outputs = outputs;
    render::Renderer renderer = makeRenderer(device, program, settings);
    for (std::uint32_t b = 0; b < options.batches; ++b) renderer.renderBatch();
    film = renderer.saveFilm();
    for (std::size_t i = 0; i < program.outputs.size(); ++i)
      if (film.planes[i].stored() && film.planes[i].coverage.empty())
        images.emplace(program.outputs[i].name, renderer.image(i));
  }
  std::span<const float> at(const std::string& name, std::uint32_t x, std::uint32_t y) const {
    return images.at(name).pixel<float>(x, y);
  }
  const render::FilmPlane& plane(const std::string& name) const {
    return *std::ranges::find(film.planes, name, &render::FilmPlane::name);
  }
};

// A scene with all kinds of scattering: diffuse, metal, coat, glass, and thin glass, with two lights and the sky.
SceneBuilder mixed() {
  SceneBuilder scene;
  scene::Material metal, coated = lambert({0.7f, 0.2f, 0.1f}), plastic, frosted = clearGlass(1.5f, 0.0f);
  frosted.roughness = 0.4f;  // light through a clear pane would count as emission or background
  metal.roughness = 0.3f;
  coated.clearcoat = 1.0f;
  plastic.metallic = 0.0f;
  plastic.roughness = 0.5f;
  plastic.baseColor = {0.1f, 0.5f, 0.2f, 1.0f};
  scene.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), plastic);
  scene.add(sphere({-1.0f, 0.5f, 0}, 0.5f, 2), metal).add(sphere({0.1f, 0.5f, 0}, 0.5f, 2), clearGlass(1.5f, 1.0f));
  scene.add(sphere({1.1f, 0.5f, 0}, 0.4f, 2), coated).add(quad({-0.3f, 0.1f, 1}, {0.9f, 0, 0}, {0, 0.9f, 0}), frosted);
  scene.add(quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}), emitter(vec3(8.0f)));
  scene::Light lamp;
  lamp.position = {1.0f, 2.0f, 1.0f};
  scene.light(lamp).sky(vec3(0.3f)).camera(perspective({0.5f, 1.0f, 3.5f}, {0, 0.5f, 0}, 45.0f));
  return scene;
}

TEST(Aov, LightComponentsAddUpToTheImage) {
  const SceneBuilder scene = mixed();
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.width = 24;
  options.height = 16;
  options.batches = 4;
  const program::Program program = program::loadProgram("pathtracer");
  const AovLayers layers(device, scene.scene.cameras[0], options, optionalOutputs(program));
  const AovLayers plain(device, scene.scene.cameras[0], options, {});
  const std::vector<std::string> parts{"emission",          "background",           "direct_diffuse",
                                       "direct_specular",   "direct_transmission",  "indirect_diffuse",
                                       "indirect_specular", "indirect_transmission"};
  std::map<std::string, double> totals;
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 24; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (const std::string& part : parts) {
          sum += layers.at(part, x, y)[c];
          totals[part] += layers.at(part, x, y)[c];
          ASSERT_GE(layers.at(part, x, y)[c], -1e-6f) << part;
        }
        ASSERT_NEAR(sum, layers.at("color", x, y)[c], 1e-4 * (1 + sum)) << x << ", " << y;
        ASSERT_NEAR(layers.at("color", x, y)[c], plain.at("color", x, y)[c], 1e-5 * (1 + sum))
            << "the image depends on the requested layers";
      }
  for (const std::string& part : parts) EXPECT_GT(totals[part], 0.0) << part;
}

TEST(Aov, SortsLightByTheFirstScattering) {
  // A Lambert surface under a lamp in the dark has direct diffuse light only. Seen in a mirror, it is indirect
  // specular.
  SceneBuilder scene;
  scene::Light lamp;
  lamp.position = {0, 1, 0};
  scene.add(quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}), lambert(vec3(0.5f)))
      .light(lamp)
      .camera(perspective({0, 1, 2}, {0, 0, 0}, 30.0f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.batches = 1;
  const AovLayers layers(device, scene.scene.cameras[0], options, optionalOutputs(program::loadProgram("pathtracer")));
  EXPECT_GT(layers.at("direct_diffuse", 4, 4)[0], 0.01f);
  EXPECT_EQ(layers.at("direct_diffuse", 4, 4)[0], layers.at("color", 4, 4)[0]);
  for (const char* other :
       {"emission", "background", "direct_specular", "direct_transmission", "indirect_diffuse", "indirect_specular"})
    EXPECT_EQ(layers.at(other, 4, 4)[0], 0.0f) << other;

  SceneBuilder mirrored = scene;
  mirrored.scene.cameras.clear();
  scene::Material mirror;
  mirror.roughness = 0.0f;
  mirrored.add(quad({-5, -5, 3}, {0, 10, 0}, {10, 0, 0}), mirror).camera(perspective({0, 1, 2}, {0, 1, 3}, 30.0f));
  render::DeviceScene second(testContext(), scene::Scene(mirrored.scene), mirrored.environment);
  const AovLayers seen(second, mirrored.scene.cameras[0], options, optionalOutputs(program::loadProgram("pathtracer")));
  EXPECT_GT(seen.at("indirect_specular", 4, 6)[0], 0.001f);
  EXPECT_NEAR(seen.at("indirect_specular", 4, 6)[0], seen.at("color", 4, 6)[0], 1e-6);
}

const std::vector<std::string> kParts{"emission",          "background",           "direct_diffuse",
                                      "direct_specular",   "direct_transmission",  "indirect_diffuse",
                                      "indirect_specular", "indirect_transmission"};

// Expects all light of the image's center in this one layer.
void expectOnly(const SceneBuilder& scene, const std::string& layer, double least) {
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.batches = 2;
  const AovLayers layers(device, scene.scene.cameras.at(0), options, kParts);
  for (const std::string& other : kParts) {
    double sum = 0, color = 0;
    for (const uvec2 p : {uvec2(3, 3), uvec2(4, 3), uvec2(3, 4), uvec2(4, 4)}) {
      sum += layers.at(other, p.x, p.y)[1] / 4;
      color += layers.at("color", p.x, p.y)[1] / 4;
    }
    EXPECT_NEAR(sum, layer == other ? color : 0.0, 1e-6 * color) << other << " in the scene for " << layer;
    EXPECT_GT(color, least) << layer;
  }
}

TEST(Aov, AssignsLightToASingleLayer) {
  scene::Material mirror, frosted = clearGlass(1.5f, 0.0f);
  mirror.roughness = 0.0f;
  frosted.roughness = 0.5f;
  const scene::Camera ahead = perspective({0, 0, 2}, {0, 0, 0}, 30.0f);
  const scene::Geometry before = quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  // Two mirrors under the sky, one smooth and one rough, which light samples reach, too.
  SceneBuilder mirrors;
  mirrors.add(quad({-2, -2, 0}, {2, 0, 0}, {0, 4, 0}), mirror);
  mirror.roughness = 0.5f;
  expectOnly(mirrors.add(quad({0, -2, 0}, {2, 0, 0}, {0, 4, 0}), mirror).sky(vec3(1.0f)).camera(ahead),
             "direct_specular", 0.9);
  // An emitter behind a rough pane, and darkness in front of it.
  SceneBuilder pane;
  pane.add(before, frosted).add(quad({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}), emitter(vec3(2.0f))).camera(ahead);
  expectOnly(pane, "direct_transmission", 0.5);
  // A light that shines along a floor onto a wall: the floor is lit by the wall only.
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.direction = {1, 0, 0};
  SceneBuilder corner;
  corner.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), lambert(vec3(0.5f)))
      .add(quad({2, 0, 2}, {0, 0, -4}, {0, 3, 0}), lambert(vec3(0.8f)));
  corner.light(sun).camera(perspective({0.5f, 2, 0.5f}, {1.2f, 0, 0}, 30.0f));
  expectOnly(corner, "indirect_diffuse", 0.01);
  // A lit floor behind a rough pane, with a light that shines along the pane.
  sun.direction = {0, -1, 0};
  SceneBuilder behind;
  behind.add(before, frosted)
      .add(quad({-2, -1, -0.1f}, {4, 0, 0}, {0, 0, -4}), lambert(vec3(0.8f)))
      .light(sun)
      .camera(ahead);
  expectOnly(behind, "indirect_transmission", 0.01);
}

TEST(Aov, AveragesNormalsOfAPixel) {
  // A crease within the pixels of column 8: normals z and (1, 0, 1) / √2.
  SceneBuilder scene;
  scene.add(quad({-2, -2, 0}, {2.12f, 0, 0}, {0, 4, 0}), lambert(vec3(0.5f)))
      .add(quad({0.12f, -2, 0}, {2, 0, -2}, {0, 4, 0}), lambert(vec3(0.5f)));
  scene.sky(vec3(1.0f)).camera(perspective({0, 0, 2}, {0, 0, 0}, 90.0f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.width = options.height = 16;
  options.batches = 4;
  const AovLayers layers(device, scene.scene.cameras[0], options, {"normal"});
  for (const std::uint32_t y : {4u, 9u, 12u}) {
    const std::span<const float> n = layers.at("normal", 8, y);
    EXPECT_GT(n[0], 0.15f);
    EXPECT_LT(n[0], 0.55f);
    EXPECT_NEAR(n[1], 0.0, 1e-5);
    EXPECT_NEAR(n[2], 1.0 - n[0] * (std::sqrt(2.0) - 1.0), 1e-5) << "the mean of two normals, not normalized";
    EXPECT_NEAR(layers.at("normal", 10, y)[0], std::sqrt(0.5), 1e-5);
    EXPECT_NEAR(layers.at("normal", 4, y)[2], 1.0, 1e-5);
  }
}

TEST(Aov, DescribesTheFirstSurface) {
  // A wall that faces the camera, two units away, red on the left half and green on the right, sky above.
  SceneBuilder scene;
  for (const float x : {-2.0f, 0.0f}) {
    scene::Geometry half = quad({x, -2, 0}, {2, 0, 0}, {0, 2.5f, 0});
    half.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    scene.add(half, lambert(x < 0 ? vec3(0.8f, 0, 0) : vec3(0, 0.6f, 0)));
  }
  // Behind the camera, so that the scene has any-hit shaders.
  scene.add(quad({-1, -1, 5}, {2, 0, 0}, {0, 2, 0}), unlit(vec3(0.5f), 0.5f));
  scene.scene.materials.back().alphaMode = scene::AlphaMode::blend;
  scene.sky(vec3(1.0f)).camera(perspective({0, 0, 2}, {0, 0, 0}, 90.0f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  ImageOptions options;
  options.width = options.height = 16;
  options.batches = 2;
  const AovLayers layers(device, scene.scene.cameras[0], options, optionalOutputs(program::loadProgram("pathtracer")));
  const auto where = [](std::uint32_t x, std::uint32_t y) {
    return vec2(-2 + 4 * (x + 0.5) / 16, 2 - 4 * (y + 0.5) / 16);
  };
  for (const uvec2 p :
       {uvec2(2, 12), uvec2(13, 9), uvec2(6, 14), uvec2(9, 14), uvec2(1, 7), uvec2(14, 7), uvec2(1, 14)}) {
    const vec2 at = where(p.x, p.y);
    const bool left = at.x < 0;
    EXPECT_NEAR(layers.at("position", p.x, p.y)[0], at.x, 1e-5);
    EXPECT_NEAR(layers.at("position", p.x, p.y)[1], at.y, 1e-5);
    EXPECT_NEAR(layers.at("depth", p.x, p.y)[0], 2.0, 1e-5);
    EXPECT_NEAR(layers.at("distance", p.x, p.y)[0], std::sqrt(4.0 + dot(at, at)), 1e-5);
    EXPECT_NEAR(layers.at("normal", p.x, p.y)[2], 1.0, 1e-5);
    EXPECT_NEAR(layers.at("albedo", p.x, p.y)[left ? 0 : 1], left ? 0.8 : 0.6, 1e-6);
    EXPECT_EQ(layers.at("instance_id", p.x, p.y)[0], left ? 1.0f : 2.0f);
    EXPECT_EQ(layers.at("material_id", p.x, p.y)[0], left ? 1.0f : 2.0f);
    const vec2 uv((at.x + (left ? 2 : 0)) / 2, (at.y + 2) / 2.5);
    EXPECT_NEAR(layers.at("uv", p.x, p.y)[0], uv.x, 1e-5);
    EXPECT_NEAR(layers.at("uv", p.x, p.y)[1], uv.y, 1e-5);
    EXPECT_EQ(layers.at("primitive_id", p.x, p.y)[0], uv.x > uv.y ? 1.0f : 2.0f)
        << "the two triangles on either side of the diagonal";
    EXPECT_EQ(layers.at("motion", p.x, p.y)[0], 0.0f);
    for (const char* center : {"position", "depth", "distance", "uv", "instance_id", "material_id", "primitive_id"})
      EXPECT_EQ(layers.at(center, p.x, p.y)[3], 1.0f) << center;
    const shared::CoverageSlot* slots =
        &layers.plane("cryptomatte_object").coverage[shared::kCoverageSlots * (p.y * 16 + p.x)];
    EXPECT_EQ(slots[0].id, shared::kCoverageId + (left ? 0 : 1));
    EXPECT_EQ(slots[0].samples, 8u);
  }
  EXPECT_EQ(layers.at("depth", 3, 1)[0], 1e10f);
  EXPECT_EQ(layers.at("distance", 3, 1)[0], 1e10f);
  for (const char* id : {"instance_id", "material_id", "primitive_id", "uv", "position", "motion", "albedo", "normal"})
    for (const std::size_t c : {0u, 1u, 2u}) EXPECT_EQ(layers.at(id, 3, 1)[c], 0.0f) << id;
  for (const char* center : {"position", "depth", "distance", "uv", "instance_id", "material_id", "primitive_id"})
    EXPECT_EQ(layers.at(center, 3, 1)[3], 0.0f) << center;
  EXPECT_EQ(layers.plane("cryptomatte_material").coverage[shared::kCoverageSlots * (16 + 3)].samples, 0u);
  // At the seam, colors are averaged and ids are not.
  int mixed = 0;
  for (std::uint32_t y = 7; y < 16; ++y) {
    const float red = layers.at("albedo", 8, y)[0];
    mixed += red > 0.0f && red < 0.8f;
    EXPECT_EQ(layers.at("instance_id", 8, y)[0], 2.0f);
  }
  EXPECT_GT(mixed, 0) << "the filter of a pixel beside the seam crosses it in a twentieth of the samples";
}

TEST(Aov, MeasuresMotionInPixels) {
  SceneBuilder scene;
  scene.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), lambert(vec3(0.5f)));
  scene.scene.instances[0].keyframes = {{0, vec3(0), quat(1, 0, 0, 0), vec3(1)},
                                        {10, vec3(1, 0.5f, 0), quat(1, 0, 0, 0), vec3(1)}};
  scene.camera(perspective({0, 0, 2}, {0, 0, 0}, 90.0f));
  render::DeviceScene device(testContext(), scene::Scene(scene.scene), scene.environment);
  device.setFrame(5);
  ImageOptions options;
  options.width = options.height = 16;
  options.batches = 1;
  const AovLayers layers(device, scene.scene.cameras[0], options, {"motion"});
  EXPECT_NEAR(layers.at("motion", 9, 7)[0], 0.1 * 4, 1e-4);  // 4 pixels per meter
  EXPECT_NEAR(layers.at("motion", 9, 7)[1], 0.05 * 4, 1e-4);
  EXPECT_EQ(layers.at("motion", 0, 0)[0], 0.0f);
}

}  // namespace
}  // namespace quintet::test
