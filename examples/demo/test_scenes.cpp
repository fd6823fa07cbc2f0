// SPDX-License-Identifier: Apache-2.0
#include "demo/test_scenes.h"

#include <array>

#include "demo/scene_parts.h"
#include "demo/textures.h"

namespace quintet::demo {
std::vector<std::byte> cornell() {
  GlbWriter glb;
  const int white = addDiffuse(glb, "white", vec3(0.73f));
  const int red = addDiffuse(glb, "red", {0.61f, 0.06f, 0.05f});
  const int green = addDiffuse(glb, "green", {0.12f, 0.44f, 0.10f});
  const int light = addLight(glb, "light", {17.0f, 12.0f, 6.0f});
  const int metal = glb.addMaterial(
      {.name = "rough metal", .baseColor = {0.90f, 0.78f, 0.56f, 1.0f}, .metallic = 1.0f, .roughness = 0.35f});

  const vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2);  // the room: 2 m wide, high and deep, around (0, 1, 0)
  glb.addObject("floor", quad({-1, 0, -1}, z, x), white);
  glb.addObject("ceiling", quad({-1, 2, -1}, x, z), white);
  glb.addObject("back", quad({-1, 0, -1}, x, y), white);
  glb.addObject("front", quad({-1, 0, 1}, y, x), white);
  glb.addObject("left", quad({-1, 0, -1}, y, z), red);
  glb.addObject("right", quad({1, 0, -1}, z, y), green);
  glb.addObject("lamp", quad({-0.25f, 1.99f, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}), light);
  glb.addInstance("metal block", glb.addMesh("metal block", box({-0.28f, 0, -0.28f}, {0.28f, 1.15f, 0.28f}), metal),
                  rotated({-0.35f, 0, -0.35f}, 18.0f));
  glb.addInstance("block", glb.addMesh("block", box({-0.28f, 0, -0.28f}, {0.28f, 0.56f, 0.28f}), white),
                  rotated({0.36f, 0, 0.28f}, -17.0f));
  glb.addCamera("main", {0, 1, 0.98f}, {0, 0.98f, 0}, 90.0f, 1.0f);
  return glb.finish();
}

std::vector<std::byte> glass() {
  GlbWriter glb;
  const int ground = addDiffuse(glb, "ground", {0.55f, 0.52f, 0.48f});
  const int rough = glb.addMaterial({.name = "rough glass",
                                     .roughness = 0.30f,
                                     .transmission = 1.0f,
                                     .thickness = 0.6f,
                                     .attenuationColor = {0.65f, 0.90f, 0.80f},
                                     .attenuationDistance = 0.6f});
  const int clear = glb.addMaterial(
      {.name = "clear glass", .roughness = 0.0f, .ior = 1.45f, .transmission = 1.0f, .thickness = 0.08f});
  const int warm = addLight(glb, "warm panel", {7.0f, 5.5f, 4.0f});
  const int cool = addLight(glb, "cool panel", {2.5f, 3.2f, 4.2f});

  glb.addObject("ground", quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), ground);
  glb.addInstance("sphere", glb.addMesh("sphere", icosphere(0.30f, 5), rough), rotated({-0.36f, 0.30f, 0}, 0.0f));
  glb.addInstance("slab", glb.addMesh("slab", box({-0.30f, 0, -0.04f}, {0.30f, 0.62f, 0.04f}), clear),
                  rotated({0.38f, 0.001f, 0.05f}, -25.0f));
  glb.addObject("panel above", quad({-0.8f, 1.7f, -0.6f}, {1.6f, 0, 0}, {0, 0, 1.2f}), warm);
  glb.addObject("panel behind", quad({-1.2f, 0.1f, -1.3f}, {2.4f, 0, 0}, {0, 0.9f, 0}), cool);
  glb.addObject("panel left", quad({-1.6f, 0.1f, -0.5f}, {0, 1.0f, 0}, {0, 0, 1.0f}), warm);
  glb.addCamera("main", {0.1f, 0.75f, 2.1f}, {0, 0.30f, 0}, 32.0f, kWide);
  return glb.finish();
}

std::vector<std::byte> furnace() {
  GlbWriter glb;
  glb.addObject("sphere", icosphere(1.0f, 6), addDiffuse(glb, "lambert", vec3(kFurnaceAlbedo)));
  glb.addCamera("main", {0, 0, 4}, {0, 0, 0}, 35.0f, 1.0f);
  return glb.finish();
}

std::vector<std::byte> manyLights() {
  constexpr int kColors = 8, kLightsPerColor = 50, kLeaves = 120;
  constexpr float kSide = 4.0f, kHills = 0.5f;
  GlbWriter glb;
  glb.addObject("terrain", terrain(kSide, 80, kHills, 7), addDiffuse(glb, "soil", {0.45f, 0.40f, 0.33f}));

  Random random(3);
  const auto somewhere = [&](float low, float high) {
    const float x = random(-0.47f, 0.47f) * kSide, z = random(-0.47f, 0.47f) * kSide;
    return vec3(x, terrainHeight(x, z, kHills, 7) + random(low, high), z);
  };
  for (int c = 0; c < kColors; ++c) {
    const vec3 hue = glm::mix(vec3(1.0f), vec3(random(), random(), random()), 0.7f);
    const int light = addLight(glb, "light", hue * std::exp2(static_cast<float>(c) - 1.0f));  // 0.5 … 64
    TriangleMesh mesh;
    for (int i = 0; i < kLightsPerColor; ++i) {
      const vec3 p = somewhere(0.10f, 0.60f), a = anyDirection(random),
                 b = glm::normalize(glm::cross(a, anyDirection(random)));
      const float size = random(0.015f, 0.07f);
      TriangleMesh triangle = quad(p, size * a, size * b);
      triangle.triangles.pop_back();
      mesh.append(triangle);
    }
    glb.addObject("lights", mesh, light);
  }

  const int leafMaterial = glb.addMaterial({.name = "leaf",
                                            .baseColorTexture = glb.addTexture("leaf", leafCutout(256)),
                                            .roughness = 0.6f,
                                            .alphaCutoff = 0.5f,
                                            .doubleSided = true});
  const int sheet = glb.addMesh("leaf", quad({-0.5f, 0, 0.5f}, {1, 0, 0}, {0, 0.35f, -1}), leafMaterial);
  for (int i = 0; i < kLeaves; ++i) {
    glb.addInstance("leaf", sheet, rotated(somewhere(0.02f, 0.35f), random(0, 360), random(0.12f, 0.30f)));
  }
  glb.addCamera("main", {0, 1.5f, 2.9f}, {0, 0.1f, 0}, 42.0f, kWide);
  return glb.finish();
}

std::vector<std::byte> bench() {
  constexpr int kRocks = 60;
  constexpr float kSide = 12.0f, kHills = 1.2f;
  GlbWriter glb;
  const int soil = glb.addMaterial({.name = "soil", .baseColor = {0.40f, 0.36f, 0.30f, 1.0f}, .roughness = 0.9f});
  glb.addObject("terrain", terrain(kSide, 212, kHills, 23), soil);  // 89,888 triangles

  const std::array stones = {
      glb.addMaterial({.name = "granite", .baseColor = {0.45f, 0.44f, 0.43f, 1.0f}, .roughness = 0.7f}),
      glb.addMaterial({.name = "wet slate", .baseColor = {0.16f, 0.18f, 0.21f, 1.0f}, .roughness = 0.25f}),
      glb.addMaterial({.name = "ore", .baseColor = {0.75f, 0.60f, 0.42f, 1.0f}, .metallic = 1.0f, .roughness = 0.4f})};
  std::array<int, 3> rocks{};
  for (std::uint32_t k = 0; k < rocks.size(); ++k) {
    TriangleMesh rock = icosphere(1.0f, 4);  // 5,120 triangles
    for (vec3& p : rock.positions) p *= 1.0f + 0.45f * fbm(1.4f * p, 5, 31 + k);
    computeNormals(rock);
    rocks[k] = glb.addMesh("rock", rock, stones[k]);
  }
  Random random(9);
  for (std::size_t i = 0; i < kRocks; ++i) {
    const float x = random(-0.45f, 0.45f) * kSide, z = random(-0.45f, 0.45f) * kSide;
    glb.addInstance("rock", rocks[i % rocks.size()],
                    rotated({x, terrainHeight(x, z, kHills, 23), z}, random(0, 360), random(0.12f, 0.50f)));
  }
  glb.addCamera("main", {0, 2.6f, 7.0f}, {0, 0, 0}, 45.0f, kWide);
  return glb.finish();
}

std::vector<std::byte> planeLight() {
  constexpr float kHalf = 0.5f * kPlaneLightSide;
  GlbWriter glb;
  glb.addObject("plane", quad({-10, 0, 10}, {20, 0, 0}, {0, 0, -20}), addDiffuse(glb, "plane", vec3(kPlaneAlbedo)));
  glb.addObject("light", quad({-kHalf, kPlaneLightHeight, -kHalf}, {kPlaneLightSide, 0, 0}, {0, 0, kPlaneLightSide}),
                addLight(glb, "light", vec3(kPlaneLightRadiance)));
  glb.addCamera("main", {0, 0.8f, 2.0f}, {0, 0, 0}, 40.0f, 1.0f);
  return glb.finish();
}

std::span<const TestScene> testScenes() {
  static constexpr TestScene kScenes[] = {{"cornell", cornell},        {"glass", glass},    {"furnace", furnace},
                                          {"many_lights", manyLights}, {"bench", bench},    {"plane_light", planeLight},
                                          {"lanterns", lanterns},      {"panes", panes},    {"window", window},
                                          {"foliage", foliage},        {"thicket", thicket}};
  return kScenes;
}

}  // namespace quintet::demo
