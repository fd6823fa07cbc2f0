// SPDX-License-Identifier: Apache-2.0
// Transforms of animated instances.
#ifndef QUINTET_SCENE_ANIMATION_KEYFRAMES_H
#define QUINTET_SCENE_ANIMATION_KEYFRAMES_H

#include "scene/model/scene.h"

namespace quintet::scene {

// translate · rotate · scale.
mat4 matrixOf(const Keyframe&);

// The interpolated keyframe. Constant before the first and after the last keyframe. At least one keyframe.
// Step: that of the last keyframe at or before the frame. Linear: linear for translation and scale, spherical along the
// shorter arc for the rotation. Cubic: a Hermite spline whose slope at a keyframe is that of the line between its
// neighbors (Catmull and Rom 1974); the quaternion is normalized, and a scale stays between the keyframes around it.
mat4 keyframeMatrixAt(const std::vector<Keyframe>&, float frame, const KeyframeInterpolation& = {});

// Interpolated keyframe · animatedFromObject, of an instance that follows no node. Without keyframes, worldFromObject.
mat4 worldFromObjectAt(const Instance&, float frame);

}  // namespace quintet::scene
#endif
