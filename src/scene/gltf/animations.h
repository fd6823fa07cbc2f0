// SPDX-License-Identifier: Apache-2.0
// Animations of a glTF file: a summary of all, and the one that plays, with the node tree and the skins.
#ifndef QUINTET_SCENE_GLTF_ANIMATIONS_H
#define QUINTET_SCENE_GLTF_ANIMATIONS_H

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scene/gltf/document.h"
#include "scene/gltf/nodes.h"

namespace quintet::scene {

// All animations of the file, in its order. Reports channels that can never play, and animations whose samplers are
// invalid. `materials`: those of the scene, in the order of the file.
std::vector<AnimationSummary> summarizeAnimations(const Document&, const std::vector<Material>& materials, Report&);

// The animation that plays, and what it changes.
struct PlayedAnimation {
  std::shared_ptr<const NodeAnimation> data;  // null: none plays
  int index = kNone;                          // in the file
  std::vector<bool> moves;                    // per node: the world transform changes
  std::vector<bool> morphs;                   // per node: the morph weights change
  std::vector<bool> toggles;                  // per node: the visibility changes, of the node or an ancestor
  // Values of KHR_animation_pointer by the index of the object in the file, sorted by property.
  std::map<int, std::vector<AnimatedValue>> materials, lights, cameras;

  bool movesNode(int node) const { return data && moves[static_cast<std::size_t>(node)]; }
  bool morphsNode(int node) const { return data && morphs[static_cast<std::size_t>(node)]; }
  bool togglesNode(int node) const { return data && toggles[static_cast<std::size_t>(node)]; }
  std::vector<AnimatedValue> lightValues(int light) const { return valuesOf(lights, light); }
  std::vector<AnimatedValue> cameraValues(int camera) const { return valuesOf(cameras, camera); }
  // The node has a skin, and the animation deforms its mesh.
  bool movesSkin(const Document&, int node) const;

 private:
  static std::vector<AnimatedValue> valuesOf(const std::map<int, std::vector<AnimatedValue>>& all, int object);
};

// `name`: name or index of the animation; empty means the first. A file without animations plays none if the name is
// empty, and an animation without channels that can play moves nothing: `data` is then null. Throws UsageError if the
// animation does not exist, FileError if it is invalid.
PlayedAnimation playAnimation(const Document&, const NodeTree&, const std::vector<Material>& materials,
                              const std::string& name, double framesPerSecond);

}  // namespace quintet::scene
#endif
