// SPDX-License-Identifier: Apache-2.0
// Concise construction of scenes for analytic tests.
#ifndef QUINTET_TESTS_GPU_RENDER_SCENE_BUILDER_H
#define QUINTET_TESTS_GPU_RENDER_SCENE_BUILDER_H

#include <cstdint>
#include <memory>
#include <vector>

#include "scene/model/scene.h"

namespace quintet::test {

scene::Material lambert(const vec3& albedo);    // without specular layer, so that its albedo is exact
scene::Material emitter(const vec3& radiance);  // reflects nothing
scene::Material unlit(const vec3& color, float alpha = 1.0f);
scene::Material clearGlass(float ior, float thickness);  // smooth; thickness 0 means a thin wall

// Returns the parallelogram corner + u·a + v·b with the normal a × b.
scene::Geometry quad(const vec3& corner, const vec3& a, const vec3& b);
scene::Geometry box(const vec3& low, const vec3& high);  // front faces outside
// Returns a convex polyhedron of 20 · 4^level flat triangles with its vertices on the sphere.
scene::Geometry sphere(const vec3& center, float radius, int level);

// Returns small quads in all directions within a unit cube around the origin.
scene::Geometry scatteredQuads(int count, std::uint32_t seed);

// Adds a texture with one row of RGBA texels and nearest filtering, so that filtering does not affect results. Returns its
// index.
int addTexel(scene::Scene& scene, const std::vector<std::uint8_t>& rgba,
             io::ColorEncoding encoding = io::ColorEncoding::linear);

// Returns a scene with one custom primitive: the box from -1 to 1.
std::shared_ptr<const scene::Scene> boxScene();

class SceneBuilder {
 public:
  // Adds a mesh, its instance, and its material.
  SceneBuilder& add(scene::Geometry geometry, const scene::Material& material,
                    const mat4& worldFromObject = mat4(1.0f));
  SceneBuilder& light(const scene::Light& light);
  SceneBuilder& sky(const vec3& radiance);
  SceneBuilder& camera(const scene::Camera& camera);

  scene::Scene scene;
  scene::Environment environment;  // black unless sky() was called
};

// A ground, and stems and leaves in the same space, turned and mirrored alike. The leaves (mesh 2) have two
// geometries, one of which emits. The sky is bright.
SceneBuilder thicket();

mat4 moved(float x, float y, float z);
mat4 scaled(float x, float y, float z);
// Returns the transform of a camera that looks from `eye` to `target`. Up is y, or -z if the view is along y.
mat4 lookAt(const vec3& eye, const vec3& target);
scene::Camera perspective(const vec3& eye, const vec3& target, float verticalFovDegrees);
scene::Camera orthographic(const vec3& eye, const vec3& target, float halfSize);

}  // namespace quintet::test
#endif
