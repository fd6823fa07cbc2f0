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

mat4 keyframeMatrixAt(const std::vector<Keyframe>& keys, float frame) {
  const auto next = std::ranges::upper_bound(keys, frame, {}, &Keyframe::frame);
  if (next == keys.begin()) return matrixOf(keys.front());
  if (next == keys.end()) return matrixOf(keys.back());
  const Keyframe& a = *(next - 1);
  const Keyframe& b = *next;
  const float t = (frame - a.frame) / (b.frame - a.frame);
  return matrixOf({frame, glm::mix(a.translation, b.translation, t),
                   glm::slerp(glm::normalize(a.rotation), glm::normalize(b.rotation), t),
                   glm::mix(a.scale, b.scale, t)});
}

mat4 worldFromObjectAt(const Instance& instance, float frame) {
  if (instance.keyframes.empty()) return instance.worldFromObject;
  return keyframeMatrixAt(instance.keyframes, frame) * instance.animatedFromObject;
}

}  // namespace quintet::scene
