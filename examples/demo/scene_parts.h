// SPDX-License-Identifier: Apache-2.0
// Parts of the test scenes: materials, terrain, transforms.
#ifndef QUINTET_DEMO_SCENE_PARTS_H
#define QUINTET_DEMO_SCENE_PARTS_H

#include "demo/glb_writer.h"
#include "demo/mesh_builder.h"
#include "demo/noise.h"

namespace quintet::demo {

inline constexpr float kWide = 16.0f / 9.0f;

// A Lambert reflector without specular reflection.
inline int addDiffuse(GlbWriter& glb, const char* name, vec3 albedo) {
  return glb.addMaterial({.name = name, .baseColor = vec4(albedo, 1.0f), .specular = 0.0f});
}

// Emits without reflecting.
inline int addLight(GlbWriter& glb, const char* name, vec3 radiance) {
  return glb.addMaterial({.name = name, .baseColor = {0, 0, 0, 1}, .emissive = radiance, .specular = 0.0f});
}

inline float terrainHeight(float x, float z, float roughness, std::uint32_t seed) {
  return roughness * fbm(vec3(x, z, 0.5f), 6, seed);
}

// A square of hilly terrain centered at the origin, with `cells` along each side.
inline TriangleMesh terrain(float side, int cells, float roughness, std::uint32_t seed) {
  TriangleMesh mesh = parametric(cells, cells, false, false, [&](float u, float v) {
    const float x = side * (u - 0.5f), z = side * (0.5f - v);
    return vec3(x, terrainHeight(x, z, roughness, seed), z);
  });
  computeNormals(mesh);
  return mesh;
}

// Scale, rotation about the y axis, translation, in this order.
inline mat4 rotated(vec3 position, float degrees, float scale = 1.0f) {
  mat4 m = glm::translate(mat4(1.0f), position);
  m = glm::rotate(m, glm::radians(degrees), vec3(0, 1, 0));
  return glm::scale(m, vec3(scale));
}

// A random direction, not exactly uniform.
inline vec3 anyDirection(Random& random) {
  return glm::normalize(vec3(random(-1, 1), random(-1, 1), random(-1, 1)) + 1e-3f);
}

}  // namespace quintet::demo
#endif
