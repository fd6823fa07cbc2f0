// SPDX-License-Identifier: Apache-2.0
#include "pane_scenes.h"

#include <utility>

namespace quintet::test {

scene::Material pane(const vec3& color) {
  scene::Material m = clearGlass(1.5f, 0.0f);
  m.baseColor = vec4(color, 1.0f);
  return m;
}

scene::Material veil(scene::Material material, float alpha, scene::AlphaMode mode) {
  material.baseColor.a = alpha;
  material.alphaMode = mode;
  return material;
}

void addBubble(SceneBuilder& scene, const scene::Material& material, const vec3& center, float radius, bool tree) {
  scene::PrimitiveSet set;
  scene::Primitive& ball = set.primitives.emplace_back();
  ball.material = static_cast<int>(scene.scene.materials.size());
  if (tree) {
    set.kind = scene::PrimitiveSetKind::csg;
    set.nodes = {{scene::CsgOperation::leaf, 0}};
    set.trees = {{0, 1}};
  }
  scene.scene.materials.push_back(material);
  scene::Instance& instance = scene.scene.instances.emplace_back();
  instance.mesh = static_cast<int>(scene.scene.meshes.size());
  instance.worldFromObject = glm::scale(glm::translate(mat4(1.0f), center), vec3(radius));
  scene.scene.meshes.emplace_back().primitiveSets.push_back(std::move(set));
}

}  // namespace quintet::test
