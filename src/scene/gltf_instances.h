// Which meshes the scene needs, in which pose, and where they stand.
#ifndef QUINTET_SCENE_GLTF_INSTANCES_H
#define QUINTET_SCENE_GLTF_INSTANCES_H

#include <map>
#include <utility>
#include <vector>

#include "scene/gltf_mesh.h"
#include "scene/gltf_nodes.h"
#include "scene/memory_budget.h"

namespace quintet::scene {

class InstanceBuilder {
 public:
  InstanceBuilder(const Document&, const NodeTree&, Report&);

  void addNode(int node);
  // Reads all meshes (also those that no node shows, to check them) on all cores and fills meshes and
  // instances; scene.materials must be complete. Throws FileError, MemoryError.
  void finish(Scene&, MemoryBudget&);

 private:
  struct Pose {
    int mesh;
    Deformation deformation;
    bool shown = true;
  };
  int sharedPose(int mesh, const std::vector<double>& morphWeights);
  int newPose(int mesh, Deformation deformation);
  void addSkinned(int node);
  void addInstance(int node, int pose, const mat4& worldFromObject);
  void addPlaced(int node, const mat4& worldFromObject);
  std::vector<mat4> jointMatrices(int node) const;
  std::vector<mat4> instanceTransforms(int node) const;

  const Document& document_;
  const NodeTree& tree_;
  Report& report_;
  std::vector<Pose> poses_;
  std::map<std::pair<int, std::vector<double>>, int> shared_;
  std::vector<Instance> instances_;  // Instance::mesh is an index into poses_ until finish
};

}  // namespace quintet::scene
#endif
