// SPDX-License-Identifier: Apache-2.0
// Transforms of animated instances.
#ifndef QUINTET_SCENE_ANIMATION_KEYFRAMES_H
#define QUINTET_SCENE_ANIMATION_KEYFRAMES_H

#include "scene/model/scene.h"

namespace quintet::scene {

// translate · rotate · scale.
mat4 matrixOf(const Keyframe&);

// Interpolated keyframe · animatedFromObject: linear for translation and scale, spherical along the shorter arc for the
// rotation. Constant before the first and after the last keyframe. Without keyframes, worldFromObject.
mat4 worldFromObjectAt(const Instance&, float frame);

}  // namespace quintet::scene
#endif
