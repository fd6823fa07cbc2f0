// SPDX-License-Identifier: Apache-2.0
// Instances of the scene, and the meshes that they need in each pose.
#ifndef QUINTET_SCENE_GLTF_INSTANCES_H
#define QUINTET_SCENE_GLTF_INSTANCES_H

#include <map>
#include <utility>
#include <vector>

#include "scene/gltf/mesh.h"
#include "scene/gltf/nodes.h"
#include "scene/memory_budget.h"

namespace quintet::scene {

class InstanceBuilder {
 public:
  InstanceBuilder(const Document&, const NodeTree&, Report&);

  // Adds the instances of a node of the scene. Throws FileError.
  void addNode(int node);
  // Fills the meshes and instances of the scene, on all cores. scene.materials must be complete. Meshes without a node
  // are read as well, to check them. Throws FileError, MemoryError.
  void finish(Scene&, MemoryBudget&);

 private:
  // A mesh with one deformation: it becomes one mesh of the scene.
  struct Pose {
    int mesh;
    Deformation deformation;
    bool instanced = true;
  };
  int sharedPose(int mesh, const std::vector<double>& morphWeights);
  int newPose(int mesh, Deformation deformation);
  void addSkinned(int node);
  void addInstance(int node, int pose, const mat4& worldFromObject);
  void addRigid(int node, const mat4& worldFromObject);
  std::vector<mat4> jointMatrices(int node) const;
  std::vector<mat4> instanceTransforms(int node) const;

  const Document& document_;
  const NodeTree& tree_;
  Report& report_;
  std::vector<Pose> poses_;
  std::map<std::pair<int, std::vector<double>>, int> shared_;  // mesh and morph weights → index into poses_
  std::vector<Instance> instances_;                            // Instance::mesh is an index into poses_ until finish
};

}  // namespace quintet::scene
#endif
