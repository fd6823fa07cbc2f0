// SPDX-License-Identifier: Apache-2.0
// Cameras from the bounds of a scene, or from two points.
#ifndef QUINTET_SCENE_DEFAULTS_AUTO_CAMERA_H
#define QUINTET_SCENE_DEFAULTS_AUTO_CAMERA_H

#include "scene/model/scene.h"

namespace quintet::scene {

// Three-quarter view from the front right (glTF models face +z): 30° to the side, 20° above, vertical field of view
// 40°. The eight corners of `bounds` are centered in the image of this aspect (width / height), with a margin of 4 % on
// the tighter axis. The result is finite for empty, flat, point-like and huge bounds. A pinhole camera; the focus
// distance is that of the center.
Camera frameScene(const Bounds3& bounds, float aspect);

// Camera at `eye` that looks at and focuses on `target`. The vertical axis of the image is as close to `up` as
// possible; a fixed axis replaces `up` if the view is along it. Throws UsageError if both points are the same or `up`
// is zero.
Camera lookAtCamera(const vec3& eye, const vec3& target, const vec3& up, float verticalFov, float apertureRadius);

// The frame of a camera at `eye` that looks along `direction`, with `up` as in lookAtCamera(). Both are unit.
mat4 lookingFrame(const vec3& eye, const vec3& direction, const vec3& up);

}  // namespace quintet::scene
#endif
