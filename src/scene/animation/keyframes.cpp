// SPDX-License-Identifier: Apache-2.0
#include "scene/animation/keyframes.h"

#include <algorithm>

namespace quintet::scene {

mat4 matrixOf(const Keyframe& key) {
  mat4 m = glm::mat4_cast(glm::normalize(key.rotation));
  for (int axis = 0; axis < 3; ++axis) m[axis] *= key.scale[axis];
  m[3] = vec4(key.translation, 1.0f);
  return m;
}

mat4 worldFromObjectAt(const Instance& instance, float frame) {
  const std::vector<Keyframe>& keys = instance.keyframes;
  if (keys.empty()) return instance.worldFromObject;
  const auto next = std::ranges::upper_bound(keys, frame, {}, &Keyframe::frame);
  if (next == keys.begin()) return matrixOf(keys.front()) * instance.animatedFromObject;
  if (next == keys.end()) return matrixOf(keys.back()) * instance.animatedFromObject;
  const Keyframe& a = *(next - 1);
  const Keyframe& b = *next;
  const float t = (frame - a.frame) / (b.frame - a.frame);
  const Keyframe between{frame, glm::mix(a.translation, b.translation, t),
                         glm::slerp(glm::normalize(a.rotation), glm::normalize(b.rotation), t),
                         glm::mix(a.scale, b.scale, t)};
  return matrixOf(between) * instance.animatedFromObject;
}

}  // namespace quintet::scene
