// SPDX-License-Identifier: Apache-2.0
// Instances of the scene, and the meshes that they need in each pose.
#ifndef QUINTET_SCENE_GLTF_INSTANCES_H
#define QUINTET_SCENE_GLTF_INSTANCES_H

#include <map>
#include <utility>
#include <vector>

#include "base/memory_budget.h"
#include "scene/gltf/animations.h"
#include "scene/gltf/mesh.h"
#include "scene/gltf/nodes.h"

namespace quintet::scene {

class InstanceBuilder {
 public:
  InstanceBuilder(const Document&, const NodeTree&, const PlayedAnimation&, Report&);

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
    int node = kNone;  // of an animated deformation
    int skin = kNone;  // of an animated deformation
  };
  // An instance of a node's mesh.
  struct Transform {
    mat4 worldFromObject{1.0f};
    mat4 nodeFromObject{1.0f};  // of EXT_mesh_gpu_instancing
  };
  int sharedPose(int mesh, const std::vector<double>& morphWeights);
  int newPose(int mesh, Deformation deformation);
  int animatedPose(int node);  // of a mesh that the animation deforms
  void addSkinned(int node);
  Instance& addInstance(int node, int pose, const mat4& worldFromObject);
  void addRigid(int node, const Transform& transform);
  std::vector<mat4> jointMatrices(int node) const;
  std::vector<Transform> instanceTransforms(int node) const;
  // Moves the instances to the scene. `meshOf`: the mesh of each pose. Those beyond the largest coordinate are ignored.
  void addInstances(const std::vector<int>& meshOf, Scene&);

  const Document& document_;
  const NodeTree& tree_;
  const PlayedAnimation& animation_;
  Report& report_;
  std::vector<Pose> poses_;
  std::map<std::pair<int, std::vector<double>>, int> shared_;  // mesh and morph weights → index into poses_
  std::map<int, int> animated_;                                // node → index into poses_
  std::vector<Instance> instances_;                            // Instance::mesh is an index into poses_ until finish
  std::vector<int> nodes_;                                     // of the instances
};

}  // namespace quintet::scene
#endif
