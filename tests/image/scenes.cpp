// SPDX-License-Identifier: Apache-2.0
// Lights are large and scenes are open, so that `naive` finds light often enough. There are no point, spot or directional
// lights, because `naive` cannot find them.
#include "scenes.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <utility>

#include "base/file.h"
#include "demo/test_scenes.h"
#include "scene/defaults/default_environment.h"
#include "scene/gltf/gltf.h"

namespace quintet::test {
namespace {

// What the demo generators write as glTF.
SceneBuilder load(std::vector<std::byte> (*make)(), const scene::Environment& environment = {}) {
  const auto file = std::filesystem::temp_directory_path() / ("quintet-test-" + std::to_string(getpid()) + ".glb");
  writeFile(file, make());
  SceneBuilder scene;
  scene.scene = scene::loadGltf(file);
  scene.environment = environment;
  std::filesystem::remove(file);
  return scene;
}

SceneBuilder cornell() { return load(demo::cornell); }
SceneBuilder glass() { return load(demo::glass, scene::defaultEnvironment()); }
SceneBuilder manyLights() {
  SceneBuilder scene = load(demo::manyLights);
  return scene.sky(vec3(0.5f));
}

// --- parts -----------------------------------------------------------------------------------------------------------

scene::Material plastic(const vec3& color, float roughness, float metallic = 0.0f) {
  scene::Material m;
  m.baseColor = vec4(color, 1.0f);
  m.roughness = roughness;
  m.metallic = metallic;
  return m;
}

scene::Geometry smooth(scene::Geometry ball, const vec3& center) {
  for (const vec3& p : ball.positions) ball.normals.push_back(glm::normalize(p - center));
  return ball;
}

scene::Geometry withUvs(scene::Geometry quad) {
  quad.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return quad;
}

int addTexture(SceneBuilder& builder, std::uint32_t size, io::ColorEncoding encoding, auto color) {
  io::Image image = io::makeImage(size, size, 4, io::PixelType::u8, encoding);
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const vec4 c = glm::clamp(color(x, y), 0.0f, 1.0f);
      for (std::uint32_t k = 0; k < 4; ++k)
        image.pixel<std::uint8_t>(x, y)[k] =
            static_cast<std::uint8_t>(255.0f * c[static_cast<glm::length_t>(k)] + 0.5f);
    }
  builder.scene.images.push_back({"texture", std::move(image)});
  scene::Texture texture;
  texture.image = static_cast<int>(builder.scene.images.size()) - 1;
  builder.scene.textures.push_back(texture);
  return static_cast<int>(builder.scene.textures.size()) - 1;
}

scene::TextureUse use(int texture) {
  scene::TextureUse u;
  u.texture = texture;
  return u;
}

// A floor of 6 x 6 m, a panel of light 3 m above it and a dim sky.
SceneBuilder stage(const vec3& panel = vec3(3.0f), const vec3& sky = vec3(0.3f)) {
  SceneBuilder scene;
  scene.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), lambert({0.6f, 0.5f, 0.4f}));
  scene.add(quad({-1.5f, 3, -1.5f}, {3, 0, 0}, {0, 0, 3}), emitter(panel));
  scene.sky(sky).camera(perspective({0, 2, 5}, {0, 0.7f, 0}, 40.0f));
  return scene;
}

// --- scenes ------------------------------------------------------------------------------------------------------------

// Color, roughness and metalness from textures, and a bumpy normal map.
SceneBuilder textures() {
  SceneBuilder scene = stage();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  scene::Material m = plastic(vec3(1.0f), 1.0f, 1.0f);
  m.baseColorTexture = use(addTexture(scene, 8, io::ColorEncoding::sRgb, [](auto x, auto y) {
    return (x + y) % 2 ? vec4(0.9f, 0.7f, 0.2f, 1) : vec4(0.2f, 0.4f, 0.8f, 1);
  }));
  m.metallicRoughnessTexture = use(addTexture(scene, 4, io::ColorEncoding::linear, [](auto x, auto y) {
    return vec4(0, 0.3f + 0.2f * static_cast<float>(x), y % 2 ? 1 : 0, 1);
  }));
  m.normalTexture = use(addTexture(scene, 16, io::ColorEncoding::linear, [&](auto, auto) {
    return vec4(0.5f + 0.5f * glm::normalize(vec3(uniform(random) - 0.5f, uniform(random) - 0.5f, 1.0f)), 1.0f);
  }));
  scene.add(withUvs(quad({-1.5f, 0.1f, 0.5f}, {3, 0, 0}, {0, 1.8f, -1})), m);
  return scene;
}

// Clearcoat over metal, over a diffuse ball, and over the emitter.
SceneBuilder clearcoat() {
  SceneBuilder scene = stage();
  scene::Material red = plastic({0.8f, 0.1f, 0.1f}, 0.5f), panel = emitter({2, 4, 3});
  red.clearcoat = 1.0f, red.clearcoatRoughness = 0.2f;
  panel.clearcoat = 1.0f, panel.clearcoatRoughness = 0.4f;
  scene::Material metal = plastic({0.9f, 0.7f, 0.3f}, 0.6f, 1.0f);
  metal.clearcoat = 0.7f;
  scene.add(smooth(sphere({-0.8f, 0.7f, 0}, 0.7f, 3), {-0.8f, 0.7f, 0}), red);
  scene.add(smooth(sphere({0.8f, 0.7f, 0}, 0.7f, 3), {0.8f, 0.7f, 0}), metal);
  scene.add(quad({-2, 0, -2}, {4, 0, 0}, {0, 2, 0}), panel);
  return scene;
}

// Sheen over a diffuse ball, over metal, and under a clearcoat.
SceneBuilder sheen() {
  SceneBuilder scene = stage();
  scene::Material velvet = plastic({0.5f, 0.05f, 0.1f}, 0.8f), metal = plastic({0.9f, 0.7f, 0.3f}, 0.4f, 1.0f);
  velvet.sheenColor = {1.0f, 0.6f, 0.8f}, velvet.sheenRoughness = 0.3f;
  metal.sheenColor = vec3(0.7f), metal.sheenRoughness = 0.8f;
  scene::Material lacquered = velvet;
  lacquered.clearcoat = 1.0f;
  scene.add(smooth(sphere({-0.8f, 0.7f, 0}, 0.7f, 3), {-0.8f, 0.7f, 0}), velvet);
  scene.add(smooth(sphere({0.8f, 0.7f, 0}, 0.7f, 3), {0.8f, 0.7f, 0}), metal);
  scene.add(quad({-2, 0, -2}, {4, 0, 0}, {0, 2, 0}), lacquered);
  return scene;
}

// Brushed metal, plastic under a film, glass that disperses, and all of them on a wall.
SceneBuilder opticalEffects() {
  SceneBuilder scene = stage(vec3(3.0f), vec3(0.6f));
  scene::Material brushed = plastic({0.9f, 0.7f, 0.3f}, 0.3f, 1.0f), soap = plastic({0.1f, 0.2f, 0.3f}, 0.3f);
  brushed.anisotropy = 0.8f, brushed.anisotropyRotation = 0.7f;
  soap.iridescence = 1.0f, soap.iridescenceThicknessMaximum = 450.0f;
  scene::Material prism = clearGlass(1.5f, 1.0f), wall = brushed;
  prism.dispersion = 2.0f;
  wall.iridescence = 0.6f, wall.metallic = 0.5f, wall.transmission = 0.3f;
  scene.add(smooth(sphere({-1.2f, 0.6f, 0}, 0.6f, 3), {-1.2f, 0.6f, 0}), brushed);
  scene.add(smooth(sphere({0, 0.6f, 0}, 0.6f, 3), {0, 0.6f, 0}), soap);
  scene.add(box({0.8f, 0.1f, -0.4f}, {1.6f, 1.0f, 0.4f}), prism);
  scene.add(quad({-2, 0, -2}, {4, 0, 0}, {0, 2, 0}), wall);
  return scene;
}

// Leaves and a volume of wax that light passes diffusely, in front of light and under a sheen.
SceneBuilder translucent() {
  SceneBuilder scene = stage();
  scene::Material leaf = plastic({0.2f, 0.6f, 0.1f}, 0.5f), wax = plastic({0.8f, 0.7f, 0.5f}, 0.4f);
  leaf.diffuseTransmission = 0.6f, leaf.diffuseTransmissionColor = {0.6f, 0.9f, 0.1f};
  wax.diffuseTransmission = 1.0f, wax.thickness = 1.0f;
  wax.attenuationColor = {0.9f, 0.5f, 0.3f}, wax.attenuationDistance = 0.7f;
  scene::Material velvet = leaf;
  velvet.sheenColor = vec3(0.6f), velvet.sheenRoughness = 0.4f;
  scene.add(smooth(sphere({-0.8f, 0.7f, 0}, 0.7f, 3), {-0.8f, 0.7f, 0}), wax);
  scene.add(quad({0.2f, 0.1f, 0}, {1.4f, 0, 0.3f}, {0, 1.4f, 0.2f}), leaf);
  scene.add(quad({-2, 0, -2}, {4, 0, 0}, {0, 2, 0}), velvet);
  return scene;
}

// Frosted, colored glass around light, and a clear ball.
SceneBuilder roughGlass() {
  SceneBuilder scene = stage(vec3(3.0f), vec3(0.6f));
  scene::Material frosted = clearGlass(1.5f, 1.0f), clear = clearGlass(1.3f, 1.0f);
  frosted.roughness = 0.5f;
  frosted.attenuationColor = {0.4f, 0.8f, 0.6f}, frosted.attenuationDistance = 0.5f;
  scene.add(smooth(sphere({-0.8f, 0.7f, 0}, 0.7f, 3), {-0.8f, 0.7f, 0}), frosted);
  scene.add(sphere({0.8f, 0.7f, 0}, 0.7f, 2), clear);
  return scene;
}

// Colored water in a frosted bowl, with a ball of glass that reaches out of it and light in the water. The bowl and the
// ball diffuse the light, so that light sampling matters in all media.
SceneBuilder nestedSolids() {
  SceneBuilder scene = stage(vec3(3.0f), vec3(0.6f));
  scene::Material bowl = clearGlass(1.5f, 1.0f), water = clearGlass(1.33f, 1.0f),
                  ball = plastic({0.8f, 0.9f, 0.7f}, 0.4f);
  bowl.roughness = 0.4f, bowl.dielectricPriority = 1.0f;
  water.attenuationColor = {0.3f, 0.7f, 0.9f}, water.attenuationDistance = 0.5f;
  ball.diffuseTransmission = 1.0f, ball.thickness = 1.0f, ball.ior = 1.7f, ball.dielectricPriority = 2.0f;
  ball.attenuationColor = {0.9f, 0.6f, 0.3f}, ball.attenuationDistance = 0.4f;
  scene.add(box({-1, 0.05f, -0.6f}, {1, 0.4f, 0.6f}), bowl);
  scene.add(box({-0.9f, 0.3f, -0.5f}, {0.9f, 1.1f, 0.5f}), water);
  scene.add(smooth(sphere({0.4f, 0.9f, 0}, 0.45f, 3), {0.4f, 0.9f, 0}), ball);
  scene.add(quad({-0.7f, 0.6f, -0.3f}, {0.6f, 0, 0}, {0, 0.4f, 0.1f}), emitter({1, 2, 1}));
  return scene;
}

// A milky solid with light and a red ball inside, and a wax ball that scatters forwards, with a dark one in front.
SceneBuilder milk() {
  SceneBuilder scene = stage(vec3(3.0f), vec3(0.6f));
  scene::Material milky = clearGlass(1.33f, 1.0f), wax = plastic({0.8f, 0.7f, 0.5f}, 0.4f);
  milky.attenuationColor = {0.3f, 0.4f, 0.5f}, milky.attenuationDistance = 0.4f;
  milky.multiscatterColor = {0.9f, 0.8f, 0.6f};
  wax.diffuseTransmission = 1.0f, wax.thickness = 1.0f;
  wax.attenuationColor = {0.2f, 0.1f, 0.05f}, wax.attenuationDistance = 0.3f;
  wax.multiscatterColor = {0.8f, 0.5f, 0.3f}, wax.scatterAnisotropy = 0.6f;
  scene.add(box({-1.5f, 0.05f, -0.6f}, {-0.1f, 1.2f, 0.6f}), milky);
  scene.add(quad({-1.3f, 0.4f, -0.3f}, {0.5f, 0, 0}, {0, 0.5f, 0.1f}), emitter({2, 2, 4}));
  scene.add(sphere({-0.5f, 0.7f, 0.1f}, 0.25f, 2), lambert({0.8f, 0.2f, 0.1f}));
  scene.add(smooth(sphere({0.8f, 0.7f, 0}, 0.6f, 3), {0.8f, 0.7f, 0}), wax);
  return scene;
}

// A sky with a large, soft sun that casts shadows on diffuse and shiny things.
SceneBuilder sunAndSky() {
  SceneBuilder scene;
  demo::SkySettings sky = demo::testSky();
  sky.sunDirection = glm::normalize(vec3(0.6f, 0.5f, 0.4f));
  sky.sunRadius = glm::radians(15.0f);
  scene.environment.image = demo::skyImage(sky, 64, 32);
  scene.environment.present = true;
  scene.environment.rotation = 0.4f;
  scene.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), lambert(vec3(0.5f)));
  scene.add(box({-1, 0, -0.5f}, {-0.2f, 1.2f, 0.3f}), lambert({0.7f, 0.3f, 0.2f}));
  scene.add(smooth(sphere({0.7f, 0.6f, 0}, 0.6f, 3), {0.7f, 0.6f, 0}), plastic(vec3(0.8f), 0.4f, 1.0f));
  scene.camera(perspective({0, 1.5f, 4}, {0, 0.5f, 0}, 40.0f));
  return scene;
}

scene::Primitive solid(scene::PrimitiveType type, const vec3& center, const vec3& size, int material) {
  scene::Primitive p;
  p.type = type;
  p.objectFromPrimitive = glm::scale(glm::translate(mat4(1.0f), center), size);
  p.material = material;
  return p;
}

void addSet(SceneBuilder& scene, scene::PrimitiveSet set) {
  scene::Instance instance;
  instance.mesh = static_cast<int>(scene.scene.meshes.size());
  scene.scene.instances.push_back(instance);
  scene.scene.meshes.emplace_back().primitiveSets.push_back(std::move(set));
}

// Solids of all kinds, three of which emit light, and a box with a ball cut out of it.
SceneBuilder solids() {
  using enum scene::PrimitiveType;
  SceneBuilder scene = stage(vec3(0.5f), vec3(0.2f));
  const auto material = [&](const scene::Material& m) {
    scene.scene.materials.push_back(m);
    return static_cast<int>(scene.scene.materials.size()) - 1;
  };
  const int light = material(emitter({4, 3, 2})), gray = material(lambert(vec3(0.6f))),
            metal = material(plastic(vec3(0.9f), 0.4f, 1.0f));
  scene::PrimitiveSet set;
  set.primitives = {solid(sphere, {-1.6f, 0.6f, 0.5f}, vec3(0.6f), light),
                    solid(box, {1.9f, 0.4f, 0.2f}, {0.3f, 0.4f, 0.3f}, light),
                    solid(torus, {0.2f, 0.25f, 1.0f}, vec3(0.45f), light),
                    solid(cone, {-0.6f, 0.6f, -0.8f}, {0.4f, 0.6f, 0.4f}, metal),
                    solid(cylinder, {1.0f, 0.6f, -0.9f}, {0.3f, 0.6f, 0.3f}, gray)};
  addSet(scene, set);
  scene::PrimitiveSet tree;
  tree.kind = scene::PrimitiveSetKind::csg;
  tree.primitives = {solid(box, {0.2f, 0.7f, -0.1f}, vec3(0.5f), gray),
                     solid(sphere, {0.2f, 1.0f, 0.3f}, vec3(0.5f), metal)};
  tree.nodes = {{scene::CsgOperation::leaf, 0}, {scene::CsgOperation::leaf, 1}, {scene::CsgOperation::subtract, 0}};
  tree.trees = {{0, 3}};
  addSet(scene, tree);
  return scene;
}

// Leaves with a cut-off, half transparent glass, and a light that is not everywhere.
SceneBuilder alpha() {
  SceneBuilder scene = stage(vec3(2.0f), vec3(0.4f));
  const auto holes = [](auto x, auto y) { return vec4(0.3f, 0.6f, 0.2f, (x * y) % 3 ? 0.9f : 0.2f); };
  scene::Material mask = lambert(vec3(1.0f)), blend = mask, panel = emitter({4, 3, 2});
  mask.baseColorTexture = blend.baseColorTexture = panel.baseColorTexture =
      use(addTexture(scene, 8, io::ColorEncoding::sRgb, holes));
  mask.alphaMode = scene::AlphaMode::mask;
  blend.alphaMode = panel.alphaMode = scene::AlphaMode::blend;
  blend.baseColor.a = 0.6f;
  scene.add(withUvs(quad({-2, 0.2f, 0.5f}, {1.8f, 0, 0}, {0, 1.5f, 0})), mask);
  scene.add(withUvs(quad({0.2f, 0.2f, 0.5f}, {1.8f, 0, 0}, {0, 1.5f, 0})), blend);
  scene.add(withUvs(quad({-2, 0, -1.5f}, {4, 0, 0}, {0, 2, 0})), panel);
  return scene;
}

// Near and far things out of focus.
SceneBuilder lens() {
  SceneBuilder scene = stage();
  for (int i = 0; i < 5; ++i) {
    const float x = -1.2f + 0.6f * static_cast<float>(i), z = 2.0f - static_cast<float>(i);
    scene.add(box({x, 0, z}, {x + 0.4f, 1.0f, z + 0.4f}),
              lambert(vec3(0.2f + 0.15f * static_cast<float>(i), 0.5f, 0.4f)));
  }
  scene.scene.cameras[0].apertureRadius = 0.15f;
  scene.scene.cameras[0].focusDistance = 4.5f;
  return scene;
}

// Frosted and clear thin walls before the light.
SceneBuilder thinWalls() {
  SceneBuilder scene = stage(vec3(2.0f), vec3(0.4f));
  scene::Material frosted = clearGlass(1.5f, 0.0f), clear = frosted;
  frosted.roughness = 0.6f;
  frosted.baseColor = {0.9f, 0.6f, 0.5f, 1.0f};
  scene.add(quad({-2, 0.2f, 0.8f}, {1.8f, 0, 0}, {0, 1.5f, 0}), frosted);
  scene.add(quad({0.2f, 0.2f, 0.8f}, {1.8f, 0, 0}, {0, 1.5f, 0}), clear);
  scene.add(quad({-2, 0, -1}, {4, 0, 0}, {0, 2, 0}), emitter({2, 3, 4}));
  return scene;
}

// Small versions of the scenes of tests/bench/scenes.txt, with what makes those hard: `naive` must still find the light.

// Emissive triangles of very different power between low walls.
SceneBuilder lanterns() {
  SceneBuilder scene;
  scene.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), lambert({0.5f, 0.47f, 0.42f}));
  std::mt19937 random(17);
  const auto draw = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random() % 65536) / 65536.0f;
  };
  for (int i = 0; i < 8; ++i) {
    const vec3 low(draw(-2.6f, 2.0f), 0, draw(-2.6f, 1.5f));
    scene.add(box(low, low + (i % 2 ? vec3(0.8f, 0.6f, 0.08f) : vec3(0.08f, 0.6f, 0.8f))), lambert(vec3(0.7f)));
  }
  for (int strength = 0; strength < 6; ++strength) {
    scene::Geometry lights;
    for (std::uint32_t i = 0; i < 50; ++i) {
      const vec3 center(draw(-2.8f, 2.8f), draw(0.15f, 1.2f), draw(-2.8f, 2.8f));
      for (int corner = 0; corner < 3; ++corner)
        lights.positions.push_back(center + vec3(draw(-0.2f, 0.2f), draw(-0.2f, 0.2f), draw(-0.2f, 0.2f)));
      lights.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    scene.add(lights,
              emitter(std::exp2(static_cast<float>(strength)) * vec3(draw(0.3f, 1), draw(0.3f, 1), draw(0.3f, 1))));
  }
  scene.camera(perspective({0, 2, 5}, {0, 0.4f, 0}, 45.0f));
  return scene;
}

void addSunAndSky(SceneBuilder& scene, const vec3& sun) {
  demo::SkySettings sky = demo::testSky();
  sky.sunDirection = glm::normalize(sun);
  sky.sunRadius = glm::radians(15.0f);
  scene.environment.image = demo::skyImage(sky, 64, 32);
  scene.environment.present = true;
}

// A room that is lit through one opening, in the right wall.
SceneBuilder window() {
  SceneBuilder scene;
  const scene::Material white = lambert({0.8f, 0.78f, 0.74f});
  scene.add(box({-2, -0.2f, -2}, {2, 0, 2}), plastic({0.42f, 0.27f, 0.16f}, 0.4f))
      .add(box({-2, 2.4f, -2}, {2, 2.6f, 2}), white);
  scene.add(box({-2, 0, -2}, {-1.8f, 2.4f, 2}), lambert({0.35f, 0.45f, 0.62f}))
      .add(box({-1.8f, 0, -2}, {1.8f, 2.4f, -1.8f}), white);
  scene.add(box({-1.8f, 0, 1.8f}, {1.8f, 2.4f, 2}), white)
      .add(box({1.8f, 0, -2}, {2, 0.5f, 2}), white)
      .add(box({1.8f, 2.1f, -2}, {2, 2.4f, 2}), white);
  scene.add(box({1.8f, 0.5f, -2}, {2, 2.1f, -1.1f}), white).add(box({1.8f, 0.5f, 1.1f}, {2, 2.1f, 2}), white);
  scene.add(box({-0.6f, 0, -1}, {0.2f, 0.7f, -0.3f}), lambert({0.7f, 0.16f, 0.13f}));
  addSunAndSky(scene, {0.78f, 0.55f, 0.28f});
  scene.camera(perspective({-0.9f, 1.4f, 1.7f}, {0.2f, 0.8f, -1.5f}, 55.0f));
  return scene;
}

// Leaves with an alpha mask in many layers under the sun.
SceneBuilder foliage() {
  SceneBuilder scene;
  scene.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), lambert({0.33f, 0.27f, 0.2f}));
  scene::Material leaf = plastic(vec3(1.0f), 0.5f);
  leaf.alphaMode = scene::AlphaMode::mask;
  leaf.baseColorTexture = use(addTexture(scene, 32, io::ColorEncoding::sRgb, [](auto x, auto y) {
    const vec2 p = (vec2(x, y) + 0.5f) / 16.0f - 1.0f;
    return vec4(0.25f, 0.5f, 0.1f, p.x * p.x + 3.0f * p.y * p.y < 1.0f ? 1.0f : 0.0f);
  }));
  std::mt19937 random(29);
  const auto draw = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random() % 65536) / 65536.0f;
  };
  scene::Geometry leaves;
  for (std::uint32_t i = 0; i < 250; ++i) {
    const float angle = draw(0, 2 * kPi), size = draw(0.25f, 0.5f);
    const vec3 a = size * vec3(std::cos(angle), draw(-0.4f, 0.4f), std::sin(angle)),
               b = size * vec3(-std::sin(angle), draw(-0.4f, 0.4f), std::cos(angle));
    const scene::Geometry one = withUvs(quad({draw(-2, 2), draw(0.1f, 1.5f), draw(-2, 2)}, a, b));
    for (const uvec3& t : one.triangles) leaves.triangles.push_back(t + 4 * i);
    leaves.positions.insert(leaves.positions.end(), one.positions.begin(), one.positions.end());
    leaves.uvs[0].insert(leaves.uvs[0].end(), one.uvs[0].begin(), one.uvs[0].end());
  }
  scene.add(leaves, leaf);
  addSunAndSky(scene, {0.6f, 0.5f, 0.4f});
  scene.camera(perspective({0, 1.5f, 4}, {0, 0.6f, 0}, 40.0f));
  return scene;
}

}  // namespace

std::span<const ImageScene> imageScenes() {
  // name, scene, width, height, block, samples of pathtracer and naive, light samples matter
  static const ImageScene kScenes[] = {
      {"cornell", cornell, 48, 48, 4, 128, 512, true},
      {"glass", glass, 64, 36, 4, 128, 512, true},
      {"many_lights", manyLights, 64, 36, 4, 256, 1536, true},
      {"textures", textures, 32, 20, 4, 128, 256, false},
      {"clearcoat", clearcoat, 32, 20, 4, 128, 256, false},
      {"sheen", sheen, 32, 20, 4, 128, 256, false},
      {"translucent", translucent, 32, 20, 4, 128, 256, false},
      {"optical_effects", opticalEffects, 32, 20, 4, 128, 256, false},
      {"rough_glass", roughGlass, 32, 20, 4, 128, 256, false},
      {"milk", milk, 32, 20, 4, 1024, 2048, false},
      {"nested_solids", nestedSolids, 32, 20, 4, 128, 256, false},
      {"sun_and_sky", sunAndSky, 32, 20, 4, 256, 1024, true},
      {"solids", solids, 32, 20, 4, 128, 512, false},
      {"alpha", alpha, 32, 20, 4, 128, 256, false},
      {"lens", lens, 32, 20, 4, 128, 256, false},
      {"thin_walls", thinWalls, 32, 20, 4, 128, 256, true},
      {"lanterns", lanterns, 32, 20, 4, 256, 2048, true},
      {"window", window, 32, 20, 4, 256, 2048, true},
      {"foliage", foliage, 32, 20, 4, 512, 2048, true},
  };
  return kScenes;
}

}  // namespace quintet::test
