// SPDX-License-Identifier: Apache-2.0
// Values of animation samplers between their times (glTF 2.0 appendix C).
#ifndef QUINTET_SCENE_ANIMATION_INTERPOLATE_H
#define QUINTET_SCENE_ANIMATION_INTERPOLATE_H

#include <span>

#include "scene/model/animation.h"

namespace quintet::scene {

// Writes the value at `seconds`; `out` has AnimationSampler::valueSize elements. Step: the last value at or before the
// time. Linear: componentwise. Cubic spline: Hermite, with the tangents scaled by the length of the interval; clamped to finite numbers.
void interpolate(const AnimationSampler&, double seconds, std::span<float> out);

// The same for quaternions x, y, z, w: linear is spherical, along the shorter arc. The result is normalized; the
// identity if it has no length.
glm::dquat interpolateRotation(const AnimationSampler&, double seconds);

}  // namespace quintet::scene
#endif
