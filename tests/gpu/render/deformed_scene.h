// SPDX-License-Identifier: Apache-2.0
// Scenes of deformed meshes with random vertices, morph targets and skins.
#ifndef QUINTET_TESTS_GPU_RENDER_DEFORMED_SCENE_H
#define QUINTET_TESTS_GPU_RENDER_DEFORMED_SCENE_H

#include <array>
#include <cstdint>
#include <random>

#include "scene/model/scene.h"

namespace quintet::test {

// What deforms a mesh, and which attributes its geometry has.
struct DeformedMeshOptions {
  std::size_t targets = 0;
  bool targetNormals = false, targetTangents = false;  // displacements of these
  int skin = -1;                                       // index in the scene's skins
  std::size_t skinSets = 0;                            // with a skin and 0 sets, the vertices follow the node
  bool normals = true, tangents = false;
  bool faceNormals = false;
  bool broken = false;  // values that are not finite, weights of 0, and normals and tangents without a direction
};

// A scene whose animation takes one second.
class DeformedScene {
 public:
  explicit DeformedScene(std::uint32_t seed) : random_(seed) {}

  // Adds a skin whose joints turn, move and change their size. `scale`: of the joints at rest; negative values mirror.
  int addSkin(std::size_t joints, const vec3& scale) { return addSkin(joints, {scale, scale}, scale); }
  // The same, with the scales at 0 s of even and odd joints, and that of all joints at 1 s.
  int addSkin(std::size_t joints, const std::array<vec3, 2>& first, const vec3& last);
  // Adds a mesh with one geometry, and its instance.
  void addMesh(const DeformedMeshOptions& options);
  scene::Scene build();

 private:
  float number(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  vec3 vector(float size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  int addNode();
  void addChannel(int node, scene::AnimatedProperty property, std::vector<float> values);
  scene::Geometry geometry(const DeformedMeshOptions& options);
  scene::GeometryDeformation deformation(const scene::Geometry& geometry, const DeformedMeshOptions& options);
  void breakVertices(scene::GeometryDeformation& deformation);

  std::mt19937 random_;
  scene::Scene scene_;
  scene::NodeAnimation animation_;
};

}  // namespace quintet::test
#endif
