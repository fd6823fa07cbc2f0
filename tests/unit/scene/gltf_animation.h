// SPDX-License-Identifier: Apache-2.0
// Small animated glTF files: a moved triangle, a bent strip, a morphed triangle.
#ifndef QUINTET_TESTS_GLTF_ANIMATION_H
#define QUINTET_TESTS_GLTF_ANIMATION_H

#include <optional>
#include <string>
#include <vector>

#include "scene/gltf_builder.h"

namespace quintet::test {

class AnimationBuilder : public GltfBuilder {
 public:
  // Adds a channel to the last animation, which is created if the file has none. `type` of the values: "SCALAR", "VEC3"
  // or "VEC4".
  void addChannel(int node, const std::string& path, const std::vector<float>& times, const std::vector<float>& values,
                  const std::string& interpolation = "LINEAR");
  // The same for a target of KHR_animation_pointer. `type` is that of the values.
  void addPointer(const std::string& pointer, const std::vector<float>& times, const std::vector<float>& values,
                  const std::string& type, const std::string& interpolation = "LINEAR");
  void addAnimation(const std::string& name);
  // Writes a temporary .glb and loads it with the animation. Unset: rest pose.
  scene::Scene loadAnimated(const std::optional<std::string>& animation = "", double framesPerSecond = 24.0) const;
};

// The triangle of GltfBuilder at node 0. Node 1 is its parent, moved by 1 m to the right.
AnimationBuilder movingTriangle();

// Two quads above each other, 1 m wide and 2 m high in the plane z = 0, with the joints 1 at y = 0 and 2 at y = 1.
// Joint 2 turns about z from 0 to 90° within one second. `sets` joints and weights sets have the same influence.
AnimationBuilder bendingStrip(std::size_t sets = 1);

// A triangle with two morph targets: (0,0,1) for all vertices with the normal (1,0,0) added, and (0,2,0) for vertex 2.
// Their weights are 0 and 0 at 0 s, 1 and 0 at 1 s, 0 and 1 at 2 s. In the rest pose they are 0.5 and 0.
AnimationBuilder morphingTriangle();

}  // namespace quintet::test
#endif
