// SPDX-License-Identifier: Apache-2.0
// Animations of a glTF file: a summary of all, and the one that plays, with the node tree and the skins.
#ifndef QUINTET_SCENE_GLTF_ANIMATIONS_H
#define QUINTET_SCENE_GLTF_ANIMATIONS_H

#include <memory>
#include <string>
#include <vector>

#include "scene/gltf/document.h"
#include "scene/gltf/nodes.h"

namespace quintet::scene {

// All animations of the file, in its order. Reports channels that can never play, and animations whose samplers are
// invalid.
std::vector<AnimationSummary> summarizeAnimations(const Document&, Report&);

// The animation that plays, and what it changes.
struct PlayedAnimation {
  std::shared_ptr<const NodeAnimation> data;  // null: none plays
  int index = kNone;                          // in the file
  std::vector<bool> moves;                    // per node: the world transform changes
  std::vector<bool> morphs;                   // per node: the morph weights change

  bool movesNode(int node) const { return data && moves[static_cast<std::size_t>(node)]; }
  bool morphsNode(int node) const { return data && morphs[static_cast<std::size_t>(node)]; }
  // The node has a skin, and the animation deforms its mesh.
  bool movesSkin(const Document&, int node) const;
};

// `name`: name or index of the animation; empty means the first. A file without animations plays none if the name is
// empty, and an animation without channels that can play moves nothing: `data` is then null. Throws UsageError if the
// animation does not exist, FileError if it is invalid.
PlayedAnimation playAnimation(const Document&, const NodeTree&, const std::string& name, double framesPerSecond);

}  // namespace quintet::scene
#endif
