// SPDX-License-Identifier: Apache-2.0
// The scenes of test_scenes.h that are difficult to sample, for comparisons of error at equal time.
#include <array>

#include "demo/scene_parts.h"
#include "demo/test_scenes.h"
#include "demo/textures.h"

namespace quintet::demo {
namespace {

// A triangle of about this size at p with a random orientation.
TriangleMesh anyTriangle(vec3 p, float size, Random& random) {
  const vec3 a = anyDirection(random);
  const vec3 b = glm::normalize(glm::cross(a, anyDirection(random)));
  TriangleMesh triangle = quad(p, size * a, size * b);
  triangle.triangles.pop_back();
  return triangle;
}

// The curve of a leaning stem.
std::vector<vec3> stem(vec3 foot, float height, vec3 lean) {
  std::vector<vec3> curve;
  for (int i = 0; i <= 12; ++i) {
    const float t = static_cast<float>(i) / 12.0f;
    curve.push_back(foot + height * (vec3(0, t, 0) + 0.35f * t * t * lean));
  }
  return curve;
}

}  // namespace

std::vector<std::byte> lanterns() {
  constexpr int kColors = 20, kWalls = 90;
  constexpr float kSide = 24.0f, kHills = 0.8f;
  GlbWriter glb;
  glb.addObject("ground", terrain(kSide, 96, kHills, 41), addDiffuse(glb, "ground", {0.50f, 0.47f, 0.42f}));
  Random random(17);
  const auto ground = [&](float x, float z) { return vec3(x, terrainHeight(x, z, kHills, 41), z); };

  const int plaster = addDiffuse(glb, "plaster", {0.72f, 0.70f, 0.66f});
  const int polished =
      glb.addMaterial({.name = "polished stone", .baseColor = {0.30f, 0.30f, 0.33f, 1}, .roughness = 0.2f});
  const int wall = glb.addMesh("wall", box({-1.1f, -0.6f, -0.06f}, {1.1f, 0.9f, 0.06f}), plaster);
  const int block = glb.addMesh("block", box({-0.25f, -0.5f, -0.25f}, {0.25f, 0.7f, 0.25f}), polished);
  for (int i = 0; i < kWalls; ++i) {
    const vec3 p = ground(random(-0.48f, 0.48f) * kSide, random(-0.48f, 0.42f) * kSide);
    glb.addInstance("wall", i % 3 == 2 ? block : wall, rotated(p, i % 2 == 0 ? 0.0f : 90.0f));
  }

  for (int c = 0; c < kColors; ++c) {
    const vec3 hue = glm::mix(vec3(1.0f), vec3(random(), random(), random()), 0.8f);
    const float strength = std::exp2(static_cast<float>(c % 8));  // 1 … 128
    const int light = addLight(glb, "lantern", hue * strength);
    TriangleMesh mesh;
    for (std::size_t i = 0; i < kLanterns / kColors; ++i) {
      const float x = random(-0.49f, 0.49f) * kSide, z = random(-0.49f, 0.49f) * kSide;
      mesh.append(anyTriangle(ground(x, z) + vec3(0, random(0.05f, 1.4f), 0), random(0.012f, 0.05f), random));
    }
    glb.addObject("lanterns", mesh, light);
  }
  glb.addCamera("main", {0, 4.0f, 12.5f}, {0, -0.2f, 2.0f}, 42.0f, kWide);
  return glb.finish();
}

std::vector<std::byte> panes() {
  GlbWriter glb;
  const int ground = addDiffuse(glb, "ground", {0.62f, 0.60f, 0.56f});
  const auto pane = [&](const char* name, vec3 tint, float roughness) {
    return glb.addMaterial({.name = name,
                            .baseColor = vec4(tint, 1.0f),
                            .roughness = roughness,
                            .doubleSided = true,
                            .transmission = 1.0f});
  };
  const std::array sheets = {pane("clear pane", vec3(0.97f), 0.0f), pane("red pane", {0.85f, 0.18f, 0.12f}, 0.0f),
                             pane("blue pane", {0.15f, 0.30f, 0.85f}, 0.0f), pane("frosted pane", vec3(0.92f), 0.3f)};
  const int solid = glb.addMaterial({.name = "green glass",
                                     .roughness = 0.0f,
                                     .transmission = 1.0f,
                                     .thickness = 0.4f,
                                     .attenuationColor = {0.55f, 0.90f, 0.60f},
                                     .attenuationDistance = 0.4f});
  const int clay = addDiffuse(glb, "clay", {0.70f, 0.45f, 0.33f});

  glb.addObject("ground", quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}), ground);
  glb.addObject("back wall", quad({-4, 0, -2.2f}, {8, 0, 0}, {0, 3.5f, 0}), ground);
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const int mesh = glb.addMesh("pane", quad({-0.5f, 0, 0}, {1, 0, 0}, {0, 1.3f, 0}), sheets[i]);
    glb.addInstance("pane", mesh,
                    rotated({-1.65f + 1.1f * static_cast<float>(i), 0.001f, -0.35f}, i % 2 == 0 ? 12.0f : -12.0f));
    glb.addInstance("clay", glb.addMesh("clay", icosphere(0.16f, 4), clay),
                    rotated({-1.65f + 1.1f * static_cast<float>(i), 0.16f, -0.95f}, 0));
  }
  glb.addObject("roof", quad({-1.2f, 1.5f, 0.6f}, {2.4f, 0, 0}, {0, 0, -2.0f}), sheets[0]);
  glb.addInstance("sphere", glb.addMesh("sphere", icosphere(0.22f, 5), solid), rotated({-0.55f, 0.221f, 0.45f}, 0));
  glb.addInstance("slab", glb.addMesh("slab", box({-0.2f, 0, -0.2f}, {0.2f, 0.35f, 0.2f}), solid),
                  rotated({0.55f, 0.001f, 0.45f}, 30.0f));
  glb.addObject("lamp above", quad({-0.3f, 3.0f, -0.8f}, {0.6f, 0, 0}, {0, 0, 0.6f}),
                addLight(glb, "lamp", vec3(40, 36, 30)));
  glb.addObject("lamp aside", quad({-3.6f, 0.6f, -1.6f}, {0, 0.8f, 0}, {0, 0, 0.8f}),
                addLight(glb, "cool lamp", vec3(6, 8, 10)));
  glb.addCamera("main", {0, 1.35f, 4.2f}, {0, 0.55f, -0.4f}, 36.0f, kWide);
  return glb.finish();
}

std::vector<std::byte> window() {
  GlbWriter glb;
  const int white = addDiffuse(glb, "plaster", {0.80f, 0.78f, 0.74f});
  const int blue = addDiffuse(glb, "blue wall", {0.35f, 0.45f, 0.62f});
  const int boards = glb.addMaterial({.name = "boards", .baseColor = {0.42f, 0.27f, 0.16f, 1}, .roughness = 0.35f});
  const int brass = glb.addMaterial(
      {.name = "brass", .baseColor = {0.86f, 0.68f, 0.36f, 1.0f}, .metallic = 1.0f, .roughness = 0.25f});
  const int cloth = addDiffuse(glb, "cloth", {0.70f, 0.16f, 0.13f});

  // 4 m wide (x), 2.6 m high, 5 m deep; walls 0.2 m thick; the opening is in the right wall.
  glb.addObject("floor", box({-2.2f, -0.2f, -2.7f}, {2.2f, 0, 2.7f}), boards);
  glb.addObject("ceiling", box({-2.2f, 2.6f, -2.7f}, {2.2f, 2.8f, 2.7f}), white);
  glb.addObject("left", box({-2.2f, 0, -2.7f}, {-2.0f, 2.6f, 2.7f}), blue);
  glb.addObject("back", box({-2.0f, 0, -2.7f}, {2.2f, 2.6f, -2.5f}), white);
  glb.addObject("front", box({-2.0f, 0, 2.5f}, {2.2f, 2.6f, 2.7f}), white);
  glb.addObject("below the window", box({2.0f, 0, -2.5f}, {2.2f, 0.9f, 2.5f}), white);
  glb.addObject("above the window", box({2.0f, 2.2f, -2.5f}, {2.2f, 2.6f, 2.5f}), white);
  glb.addObject("behind the window", box({2.0f, 0.9f, -2.5f}, {2.2f, 2.2f, -1.2f}), white);
  glb.addObject("before the window", box({2.0f, 0.9f, 0.0f}, {2.2f, 2.2f, 2.5f}), white);

  glb.addObject("table", box({-0.7f, 0.70f, -1.6f}, {0.7f, 0.75f, -0.7f}), boards);
  for (const vec2 leg : {vec2(-0.65f, -1.55f), vec2(0.6f, -1.55f), vec2(-0.65f, -0.75f), vec2(0.6f, -0.75f)})
    glb.addObject("leg", box({leg.x, 0, leg.y}, {leg.x + 0.05f, 0.70f, leg.y + 0.05f}), boards);
  glb.addInstance("ball", glb.addMesh("ball", icosphere(0.18f, 5), brass), rotated({-0.25f, 0.931f, -1.1f}, 0));
  glb.addInstance("block", glb.addMesh("block", box({-0.15f, 0, -0.15f}, {0.15f, 0.22f, 0.15f}), cloth),
                  rotated({0.3f, 0.751f, -1.1f}, 25.0f));
  glb.addObject("outside ground", quad({2.2f, -0.2f, 8}, {20, 0, 0}, {0, 0, -16}),
                addDiffuse(glb, "grass", {0.18f, 0.25f, 0.10f}));
  glb.addCamera("main", {-0.9f, 1.45f, 2.3f}, {0.25f, 0.95f, -1.5f}, 52.0f, kWide);
  return glb.finish();
}

std::vector<std::byte> foliage() {
  constexpr int kPlants = 70, kLeavesPerPlant = 40;
  constexpr float kSide = 6.0f, kHills = 0.35f;
  GlbWriter glb;
  glb.addObject("ground", terrain(kSide, 64, kHills, 5), addDiffuse(glb, "soil", {0.33f, 0.27f, 0.20f}));
  const int bark = glb.addMaterial({.name = "bark", .baseColor = {0.24f, 0.18f, 0.12f, 1.0f}, .roughness = 0.85f});
  const int leafMaterial = glb.addMaterial({.name = "leaf",
                                            .baseColorTexture = glb.addTexture("leaf", leafCutout(256)),
                                            .roughness = 0.5f,
                                            .alphaCutoff = 0.5f,
                                            .doubleSided = true});
  const int sheet = glb.addMesh("leaf", quad({-0.5f, 0, 0.0f}, {1, 0, 0}, {0, 0.3f, -1}), leafMaterial);

  Random random(29);
  TriangleMesh stems;
  for (int p = 0; p < kPlants; ++p) {
    const float x = random(-0.45f, 0.45f) * kSide, z = random(-0.45f, 0.30f) * kSide;
    const std::vector<vec3> curve =
        stem({x, terrainHeight(x, z, kHills, 5) - 0.02f, z}, random(0.5f, 1.4f), anyDirection(random) * vec3(1, 0, 1));
    stems.append(tube(curve, 0.012f, 0.004f, 6));
    for (int i = 0; i < kLeavesPerPlant; ++i) {
      const auto at = static_cast<std::size_t>(random(3.0f, 12.99f));
      glb.addInstance("leaf", sheet,
                      rotated(curve[at] + vec3(0, random(-0.05f, 0.05f), 0), random(0, 360), random(0.14f, 0.32f)));
    }
  }
  glb.addObject("stems", stems, bark);
  glb.addCamera("main", {0, 1.25f, 3.6f}, {0, 0.45f, 0}, 40.0f, kWide);
  return glb.finish();
}

std::vector<std::byte> thicket() {
  constexpr int kStems = 160, kLeavesPerStem = 12;
  constexpr float kSide = 5.0f, kHills = 0.3f;
  GlbWriter glb;
  const int soil = addDiffuse(glb, "soil", {0.33f, 0.27f, 0.20f});
  glb.addObject("ground", terrain(kSide, 64, kHills, 7), soil);
  Random random(43);
  TriangleMesh stems, leaves;
  for (int s = 0; s < kStems; ++s) {
    const float x = random(-0.45f, 0.45f) * kSide, z = random(-0.45f, 0.30f) * kSide;
    const std::vector<vec3> curve =
        stem({x, terrainHeight(x, z, kHills, 7) - 0.02f, z}, random(0.3f, 1.1f), anyDirection(random) * vec3(1, 0, 1));
    stems.append(tube(curve, 0.010f, 0.003f, 6));
    for (int i = 0; i < kLeavesPerStem; ++i) {
      const auto at = static_cast<std::size_t>(random(2.0f, 12.99f));
      const vec3 outward = glm::normalize(vec3(random(-1, 1), random(-0.2f, 0.5f), random(-1, 1)) + 1e-3f);
      const float length = random(0.10f, 0.28f);
      // A sheet of 44 triangles, pointed at both ends, bent downwards.
      const vec3 side = glm::normalize(glm::cross(outward, vec3(0, 1, 0)));
      leaves.append(parametric(2, 12, false, false, [&](float u, float v) {
        const bool tip = v == 0.0f || v == 1.0f;
        const float half = tip ? 0.0f : 0.2f * length * std::sin(3.1415927f * v) * (2.0f * u - 1.0f);
        return curve[at] + length * v * (outward - vec3(0, 0.5f * v, 0)) + half * side + vec3(0, std::abs(half), 0);
      }));
    }
  }
  computeNormals(leaves);
  glb.addObject("stems", stems,
                glb.addMaterial({.name = "bark", .baseColor = {0.24f, 0.18f, 0.12f, 1}, .roughness = 0.85f}));
  glb.addObject(
      "leaves", leaves,
      glb.addMaterial({.name = "leaf", .baseColor = {0.20f, 0.42f, 0.10f, 1}, .roughness = 0.4f, .doubleSided = true}));
  glb.addCamera("main", {0, 1.15f, 3.0f}, {0, 0.35f, 0}, 40.0f, kWide);
  return glb.finish();
}

SkySettings testSky() {
  SkySettings sky;
  sky.sunDirection = glm::normalize(vec3(0.78f, 0.55f, 0.28f));
  sky.skyIrradiance = 1.2f;
  sky.sunIrradiance = 4.0f;
  sky.sunRadius = glm::radians(1.5f);
  return sky;
}

}  // namespace quintet::demo
