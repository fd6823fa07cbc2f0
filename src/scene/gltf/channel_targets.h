// SPDX-License-Identifier: Apache-2.0
// What the channels of a glTF animation change: properties of nodes, and with KHR_animation_pointer also of materials,
// lights and cameras.
#ifndef QUINTET_SCENE_GLTF_CHANNEL_TARGETS_H
#define QUINTET_SCENE_GLTF_CHANNEL_TARGETS_H

#include <compare>
#include <string>
#include <vector>

#include "scene/gltf/document.h"

namespace quintet::scene {

// A property of an object of the file.
struct ChannelTarget {
  enum class Object { node, material, light, camera };
  Object object = Object::node;
  int index = kNone;         // of the object in the file
  std::size_t property = 0;  // an AnimatedProperty of a node; else see animation/properties.h
  std::size_t size = 1;      // number of floats of a value
  AnimatedProperty nodeProperty() const { return static_cast<AnimatedProperty>(property); }
  // The size follows from the rest.
  auto operator<=>(const ChannelTarget&) const = default;
};

struct ResolvedChannel {
  std::vector<ChannelTarget> targets;  // several for the weights of a mesh that several nodes use
  std::string location;                // JSON pointer in the target of the channel: "" or "/extensions/…"
  std::string problem;                 // why the channel cannot play; empty if it can
};

// `materials`: those of the scene, in the order of the file.
ResolvedChannel resolveChannel(const Document&, const std::vector<Material>& materials,
                               const tinygltf::AnimationChannel&);

// "the translation of node 1", "/materials/0/alphaCutoff"
std::string describeTarget(const tinygltf::AnimationChannel&);

std::size_t morphTargetCount(const Document&, const tinygltf::Node&);

}  // namespace quintet::scene
#endif
