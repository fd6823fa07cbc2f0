// SPDX-License-Identifier: Apache-2.0
#include "scene/animation/animated_bounds.h"

#include "scene/animation/pose.h"
#include "scene/model/mesh_bounds.h"

namespace quintet::scene {
namespace {

constexpr int kIntervals = 16;

// Of the instances that the animation moves or deforms.
void extendByPose(Bounds3& bounds, const Scene& scene, const Pose& pose) {
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    const mat4 worldFromObject = worldFromObjectAt(instance, pose);
    if (!mesh.deformation) {
      if (instance.animated()) bounds.extend(meshBounds(mesh, worldFromObject));
      continue;
    }
    Mesh deformed;
    deformed.geometries.resize(mesh.geometries.size());
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g) {
      deformed.geometries[g].triangles = mesh.geometries[g].triangles;
      deformGeometry(*mesh.deformation, g, *scene.nodeAnimation, pose, deformed.geometries[g]);
    }
    bounds.extend(meshBounds(deformed, worldFromObject));
  }
}

}  // namespace

Bounds3 animatedBounds(const Scene& scene) {
  Bounds3 bounds = worldBounds(scene);
  if (!scene.nodeAnimation) return bounds;
  const double last = lastFrame(scene);
  for (int i = 1; i <= kIntervals; ++i)
    extendByPose(bounds, scene, poseAt(scene.nodeAnimation.get(), last * i / kIntervals));
  return bounds;
}

}  // namespace quintet::scene
