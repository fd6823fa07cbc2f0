// SPDX-License-Identifier: Apache-2.0
#include "demo/still_life.h"

#include <array>

#include "demo/glb_writer.h"
#include "demo/mesh_builder.h"
#include "demo/noise.h"
#include "demo/textures.h"

namespace quintet::demo {
namespace {

constexpr float kPlinthRadius = 0.50f, kPlinthHeight = 0.055f;
constexpr float kTerraceRadius = 3.4f;

mat4 transformAt(float x, float z, float y = kPlinthHeight, float turnDegrees = 0.0f, float tiltDegrees = 0.0f) {
  mat4 m = glm::translate(mat4(1.0f), vec3(x, y, z));
  m = glm::rotate(m, glm::radians(turnDegrees), vec3(0, 1, 0));
  return glm::rotate(m, glm::radians(tiltDegrees), vec3(1, 0, 0));
}

// Maps the texture of a disc from the center of its top over the rim.
void unrollFromTop(TriangleMesh& mesh, float profileLength, float metersPerTile) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const vec2 p(mesh.positions[i].x, mesh.positions[i].z);
    const vec2 outward = p == vec2(0.0f) ? p : glm::normalize(p);
    mesh.uvs[i] = outward * (1.0f - mesh.uvs[i].y) * profileLength / metersPerTile;
  }
}

void addGround(GlbWriter& glb, const StillLifeSettings& settings) {
  const SurfaceMaps oak = oakHerringbone(settings.oakTextureSize);
  const int floor = glb.addMaterial({.name = "oiled oak",
                                     .baseColorTexture = glb.addTexture("oak color", oak.baseColor),
                                     .metallicRoughnessTexture = glb.addTexture("oak roughness", oak.metallicRoughness),
                                     .normalTexture = glb.addTexture("oak normal", oak.normal)});
  TriangleMesh disc = flatDisc(0.0f, kTerraceRadius, 96, kOakTile);
  const float turn = glm::radians(38.0f);
  for (vec2& uv : disc.uvs) {
    uv = {std::cos(turn) * uv.x - std::sin(turn) * uv.y, std::sin(turn) * uv.x + std::cos(turn) * uv.y};
  }
  computeTangents(disc);
  glb.addObject("terrace", disc, floor);

  const int stone =
      glb.addMaterial({.name = "pale stone", .baseColor = {0.50f, 0.45f, 0.38f, 1.0f}, .roughness = 0.75f});
  const float r = kTerraceRadius;
  const std::array kerb = {vec2(r, -0.3f),          vec2(r + 0.34f, -0.3f), vec2(r + 0.34f, 0.06f),
                           vec2(r + 0.33f, 0.075f), vec2(r + 0.31f, 0.08f), vec2(r + 0.03f, 0.08f),
                           vec2(r + 0.01f, 0.075f), vec2(r, 0.06f),         vec2(r, -0.3f)};
  glb.addObject("kerb", revolve(kerb, 160, 50.0f), stone);

  const SurfaceMaps veins = marble(settings.textureSize);
  const int marbled =
      glb.addMaterial({.name = "white marble",
                       .baseColorTexture = glb.addTexture("marble color", veins.baseColor),
                       .metallicRoughnessTexture = glb.addTexture("marble roughness", veins.metallicRoughness)});
  const std::vector<vec2> profile = discProfile(kPlinthRadius, kPlinthHeight, 0.008f, 6);
  TriangleMesh plinth = revolve(profile, 192);
  unrollFromTop(plinth, 2.0f * kPlinthRadius + kPlinthHeight, kMarbleTile);
  glb.addObject("plinth", plinth, marbled);
}

void addVase(GlbWriter& glb, const mat4& transform) {
  const int ceramic = glb.addMaterial({.name = "celadon glaze",
                                       .baseColor = {0.50f, 0.60f, 0.55f, 1.0f},
                                       .roughness = 0.42f,
                                       .clearcoat = 1.0f,
                                       .clearcoatRoughness = 0.05f});
  const std::array outside = {vec2(0.050f, 0.006f), vec2(0.056f, 0.012f),  vec2(0.085f, 0.085f), vec2(0.104f, 0.165f),
                              vec2(0.096f, 0.235f), vec2(0.060f, 0.290f),  vec2(0.034f, 0.335f), vec2(0.031f, 0.370f),
                              vec2(0.045f, 0.402f), vec2(0.0465f, 0.406f), vec2(0.044f, 0.408f), vec2(0.040f, 0.404f),
                              vec2(0.026f, 0.370f), vec2(0.028f, 0.335f),  vec2(0.055f, 0.285f)};
  std::vector<vec2> profile{{0.0f, 0.0f}, {0.030f, 0.0f}, {0.046f, 0.001f}};
  for (const vec2& p : smoothCurve(outside, 6)) profile.push_back(p);
  profile.insert(profile.end(), {{0.030f, 0.27f}, {0.0f, 0.265f}});
  glb.addInstance("vase", glb.addMesh("vase", revolve(profile, 112), ceramic), transform);
}

// Olive twigs in the vase.
void addTwigs(GlbWriter& glb, const mat4& transform) {
  const int bark = glb.addMaterial({.name = "bark", .baseColor = {0.20f, 0.15f, 0.10f, 1.0f}, .roughness = 0.85f});
  const int green = glb.addMaterial(
      {.name = "olive leaf", .baseColor = {0.235f, 0.29f, 0.16f, 1.0f}, .roughness = 0.45f, .doubleSided = true});
  struct Twig {
    vec3 lean;  // direction at the top
    float length;
  };
  const std::array twigs = {Twig{{-0.80f, 0.02f, 0.15f}, 0.36f}, Twig{{0.70f, 0.10f, -0.25f}, 0.33f},
                            Twig{{-0.20f, 0.15f, -0.65f}, 0.29f}};
  Random random(5);
  TriangleMesh stems, leaves;
  for (const Twig& twig : twigs) {
    const vec3 lean = glm::normalize(twig.lean);
    std::vector<vec3> curve;
    for (int i = 0; i <= 24; ++i) {
      const float t = static_cast<float>(i) / 24.0f;
      const vec3 wave = 0.008f * vec3(std::sin(9.0f * t), 0.0f, std::cos(7.0f * t) - 1.0f);
      curve.push_back(vec3(0, 0.28f, 0) + twig.length * (vec3(0, t * (1.0f - 0.35f * t), 0) + 0.75f * t * t * lean) +
                      wave);
    }
    stems.append(tube(curve, 0.0035f, 0.0012f, 8));
    for (std::size_t i = 9; i < curve.size(); ++i) {
      const vec3 along = glm::normalize(curve[i] - curve[i - 1]);
      for (int side = 0; side < 2; ++side) {
        const float angle = 2.4f * static_cast<float>(i) + kPi * static_cast<float>(side) + random(-0.35f, 0.35f);
        const vec3 a = glm::normalize(glm::cross(along, vec3(0.3f, 0.1f, 1.0f))), b = glm::cross(along, a);
        const vec3 away = std::cos(angle) * a + std::sin(angle) * b;
        const float size = random(0.85f, 1.15f) * glm::mix(1.0f, 0.6f, static_cast<float>(i) / 24.0f);
        leaves.append(leaf(curve[i], glm::normalize(along * random(0.5f, 0.9f) + away), along, 0.062f * size,
                           0.0155f * size, random(0.05f, 0.35f)));
      }
    }
  }
  glb.addInstance("stems", glb.addMesh("stems", stems, bark), transform);
  glb.addInstance("leaves", glb.addMesh("leaves", leaves, green), transform);
}

void addMetals(GlbWriter& glb) {
  const int gold = glb.addMaterial(
      {.name = "satin gold", .baseColor = {0.98f, 0.75f, 0.40f, 1.0f}, .metallic = 1.0f, .roughness = 0.30f});
  const float radius = 0.092f, swing = 0.040f, rope = 0.0285f;
  glb.addInstance("knot", glb.addMesh("knot", torusKnot(2, 3, radius, swing, rope, 360, 36), gold),
                  transformAt(0.02f, -0.15f, kPlinthHeight + radius + swing + rope - 0.006f, 14.0f));

  const SurfaceMaps brush = brushedMetal(512, 0.40f);
  const int copper =
      glb.addMaterial({.name = "brushed copper",
                       .baseColor = {0.95f, 0.56f, 0.38f, 1.0f},
                       .metallic = 1.0f,
                       .metallicRoughnessTexture = glb.addTexture("brush roughness", brush.metallicRoughness),
                       .normalTexture = glb.addTexture("brush normal", brush.normal)});
  TriangleMesh cushion = superellipsoid({0.082f, 0.075f, 0.082f}, 4.0f, 36);
  computeTangents(cushion);
  glb.addInstance("cushion", glb.addMesh("cushion", cushion, copper),
                  transformAt(-0.095f, 0.12f, kPlinthHeight + 0.075f, 24.0f));

  const int steel = glb.addMaterial(
      {.name = "polished steel", .baseColor = {0.80f, 0.80f, 0.81f, 1.0f}, .metallic = 1.0f, .roughness = 0.03f});
  glb.addInstance("bearing", glb.addMesh("bearing", icosphere(0.030f, 4), steel),
                  transformAt(0.065f, 0.275f, kPlinthHeight + 0.030f));
}

void addGlass(GlbWriter& glb) {
  const int clear = glb.addMaterial({.name = "clear glass",
                                     .roughness = 0.0f,
                                     .ior = 1.5f,
                                     .transmission = 1.0f,
                                     .thickness = 0.2f,
                                     .attenuationColor = {0.78f, 0.93f, 0.91f},
                                     .attenuationDistance = 0.18f});
  glb.addInstance("sphere", glb.addMesh("sphere", icosphere(0.098f, 5), clear),
                  transformAt(0.185f, 0.115f, kPlinthHeight + 0.098f));

  const int amber = glb.addMaterial({.name = "amber glass",
                                     .roughness = 0.0f,
                                     .ior = 1.5f,
                                     .transmission = 1.0f,
                                     .thickness = 0.1f,
                                     .attenuationColor = {0.95f, 0.62f, 0.28f},
                                     .attenuationDistance = 0.19f});
  const PrismShape prism{.sides = 3,
                         .radius = 0.098f,
                         .rounding = 0.020f,
                         .bevel = 0.007f,
                         .height = 0.39f,
                         .twist = 2.0f,
                         .taper = 0.70f};
  glb.addInstance("prism", glb.addMesh("prism", twistedPrism(prism), amber), transformAt(0.325f, -0.13f));
}

void addStone(GlbWriter& glb) {
  const int lapis = glb.addMaterial({.name = "lapis", .baseColor = {0.05f, 0.12f, 0.29f, 1.0f}, .roughness = 0.25f});
  glb.addInstance("gem", glb.addMesh("gem", icosphere(0.058f, 1, true), lapis),
                  transformAt(-0.32f, 0.17f, kPlinthHeight + 0.050f, 20.0f));
}

}  // namespace

std::vector<std::byte> stillLife(const StillLifeSettings& settings) {
  GlbWriter glb;
  const mat4 vase = transformAt(-0.275f, -0.11f);
  addGround(glb, settings);
  addVase(glb, vase);
  addTwigs(glb, vase);
  addMetals(glb);
  addGlass(glb);
  addStone(glb);
  glb.addCamera("hero", {0.06f, 0.40f, 2.05f}, {-0.005f, 0.245f, 0.0f}, 20.5f, 16.0f / 9.0f);
  return glb.finish();
}

SkySettings stillLifeSky() {
  const float azimuth = glm::radians(160.0f), elevation = glm::radians(32.0f);  // azimuth from +x towards +z
  return {.sunDirection = {std::cos(elevation) * std::cos(azimuth), std::sin(elevation),
                           std::cos(elevation) * std::sin(azimuth)},
          .turbidity = 2.0f,
          .skyIrradiance = 1.7f,
          .sunIrradiance = 2.8f,
          .sunRadius = glm::radians(24.0f),
          .clouds = 0.8f,
          .haze = 0.4f,
          .hills = true};
}

}  // namespace quintet::demo
