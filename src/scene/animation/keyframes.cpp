// SPDX-License-Identifier: Apache-2.0
#include "scene/animation/keyframes.h"

#include <algorithm>

namespace quintet::scene {
namespace {

// Value of a cubic Hermite spline at the fraction t of an interval. The tangents are per interval.
template <class T>
T hermite(const T& a, const T& leaving, const T& b, const T& arriving, float t) {
  const float t2 = t * t, t3 = t2 * t;
  return (2.0f * t3 - 3.0f * t2 + 1.0f) * a + (t3 - 2.0f * t2 + t) * leaving + (3.0f * t2 - 2.0f * t3) * b +
         (t3 - t2) * arriving;
}

// The same rotation, in the half space of `other`.
quat alignedTo(const quat& other, const quat& q) { return glm::dot(other, q) < 0.0f ? -q : q; }

// Two keyframes with a frame between them, and their other neighbors, which are themselves at the ends of the list.
struct KeyInterval {
  const Keyframe &a, &b, &before, &after;
  float frame;

  float length() const { return b.frame - a.frame; }
  float fraction() const { return (frame - a.frame) / length(); }
  template <class T>
  T spline(const T& valueBefore, const T& valueA, const T& valueB, const T& valueAfter) const {
    const T leaving = (valueB - valueBefore) * (length() / (b.frame - before.frame));
    const T arriving = (valueAfter - valueA) * (length() / (after.frame - a.frame));
    return hermite(valueA, leaving, valueB, arriving, fraction());
  }
  vec3 vectorAt(vec3 Keyframe::*part, Interpolation interpolation) const {
    if (interpolation == Interpolation::step) return a.*part;
    if (interpolation == Interpolation::linear) return glm::mix(a.*part, b.*part, fraction());
    const vec3 value = spline(before.*part, a.*part, b.*part, after.*part);
    return isFinite(value) ? value : a.*part;
  }
  vec3 scaleAt(Interpolation interpolation) const {
    return glm::clamp(vectorAt(&Keyframe::scale, interpolation), glm::min(a.scale, b.scale),
                      glm::max(a.scale, b.scale));
  }
  quat rotationAt(Interpolation interpolation) const {
    const quat from = glm::normalize(a.rotation);
    if (interpolation == Interpolation::step) return from;
    if (interpolation == Interpolation::linear) return glm::slerp(from, glm::normalize(b.rotation), fraction());
    const quat to = alignedTo(from, glm::normalize(b.rotation));
    const quat mixed = spline(alignedTo(from, glm::normalize(before.rotation)), from, to,
                              alignedTo(to, glm::normalize(after.rotation)));
    return glm::length(mixed) > 1e-6f ? mixed : from;
  }
};

}  // namespace

mat4 matrixOf(const Keyframe& key) {
  mat4 m = glm::mat4_cast(glm::normalize(key.rotation));
  for (int axis = 0; axis < 3; ++axis) m[axis] *= key.scale[axis];
  m[3] = vec4(key.translation, 1.0f);
  return m;
}

mat4 keyframeMatrixAt(const std::vector<Keyframe>& keys, float frame, const KeyframeInterpolation& interpolation) {
  const auto next = std::ranges::upper_bound(keys, frame, {}, &Keyframe::frame);
  if (next == keys.begin()) return matrixOf(keys.front());
  if (next == keys.end()) return matrixOf(keys.back());
  const KeyInterval interval{*(next - 1), *next, next - keys.begin() > 1 ? *(next - 2) : *(next - 1),
                             keys.end() - next > 1 ? *(next + 1) : *next, frame};
  return matrixOf({frame, interval.vectorAt(&Keyframe::translation, interpolation.translation),
                   interval.rotationAt(interpolation.rotation), interval.scaleAt(interpolation.scale)});
}

mat4 worldFromObjectAt(const Instance& instance, float frame) {
  if (instance.keyframes.empty()) return instance.worldFromObject;
  return keyframeMatrixAt(instance.keyframes, frame, instance.interpolation) * instance.animatedFromObject;
}

}  // namespace quintet::scene
