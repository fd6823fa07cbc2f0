// The node hierarchy: world transforms, and which nodes a scene shows.
#ifndef QUINTET_SCENE_GLTF_NODES_H
#define QUINTET_SCENE_GLTF_NODES_H

#include <vector>

#include "scene/gltf_document.h"

namespace quintet::scene {

struct NodeTree {
  std::vector<mat4> worldFromNode;  // for every node of the file, shown or not: joints may lie outside
  std::vector<int> shown;           // the nodes of the scene, parents before children, in the file's order
};

// `sceneIndex` kNone: the file's default scene, else its first, else all root nodes. Loops, second parents and
// transforms that are not finite or not affine throw FileError; an index beyond the file's scenes a UsageError.
NodeTree readNodes(const Document&, int sceneIndex, Report&);

// Translation · rotation · scale; the quaternion (x, y, z, w) need not be a unit one (zero: no rotation).
glm::dmat4 composeTransform(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale);

}  // namespace quintet::scene
#endif
