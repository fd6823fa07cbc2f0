// SPDX-License-Identifier: Apache-2.0
// The node hierarchy: world transforms, the nodes of the chosen scene, and the cameras and lights of nodes.
#ifndef QUINTET_SCENE_GLTF_NODES_H
#define QUINTET_SCENE_GLTF_NODES_H

#include <string>
#include <vector>

#include "scene/gltf/document.h"

namespace quintet::scene {

struct NodeTree {
  std::vector<mat4> worldFromNode;  // of every node of the file, because joints can be outside the chosen scene
  std::vector<bool> visible;        // of every node: its own KHR_node_visibility and that of its ancestors
  int scene = kNone;                // the chosen scene; kNone if the file has none, and all root nodes are used
  std::vector<int> sceneNodes;      // nodes of the chosen scene, parents before children, in the file's order
  std::vector<int> order;           // all nodes, parents before children
  std::vector<int> parents;         // of every node; kNone for a root
};

// Index of the scene with this name, else with this index; kNone for an empty text. Throws UsageError.
int findScene(const Document&, const std::string& nameOrIndex);

// `sceneIndex` kNone means the file's default scene, else its first scene, else all root nodes. Throws FileError for
// cycles, second parents and transforms that are not finite or not affine.
NodeTree readNodes(const Document&, int sceneIndex, Report&);

// Whether KHR_node_visibility shows the node itself, without regard to its ancestors.
bool isVisible(const Document&, std::size_t node);

// The transform of a node to its parent. Throws FileError if its matrix is not affine.
glm::dmat4 localTransform(const Document&, std::size_t node);

// One matrix per joint of a skin; identities if the file has none. Throws FileError for too few matrices.
std::vector<mat4> readInverseBindMatrices(const Document&, std::size_t skin);

// Translation · rotation · scale. The quaternion (x, y, z, w) is normalized; zero means no rotation.
glm::dmat4 composeTransform(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale);

// The camera of a node. Its frame is rigid: scale and mirroring of the node are removed.
Camera readCamera(const Document&, int camera, const tinygltf::Node&, const mat4& worldFromNode);

// Adds the light of a node to the scene. A light of unknown type is reported and not added.
void readLight(const Document&, int light, const tinygltf::Node&, const mat4& worldFromNode, Scene&);

}  // namespace quintet::scene
#endif
