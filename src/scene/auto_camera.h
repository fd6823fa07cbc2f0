// A camera for files that have none.
#ifndef QUINTET_SCENE_AUTO_CAMERA_H
#define QUINTET_SCENE_AUTO_CAMERA_H

#include "scene/scene.h"

namespace quintet::scene {

// A three-quarter view: from the front right (glTF models face +z), 30° to the side, 20° above, vertical
// field of view 40°. All eight corners of `bounds` are inside the picture of this aspect (width / height)
// with a margin of 4 % on the tighter axis, and centred. Finite for empty, flat, pointlike and huge
// bounds; focused on the centre, pinhole.
Camera frameScene(const Bounds3& bounds, float aspect);

// At `eye`, looking at `target`, which is sharp; the image's vertical axis is as near to `up` as can be (any
// direction if the view is along it). Throws UsageError if both points are the same or `up` has no length.
Camera lookAtCamera(const vec3& eye, const vec3& target, const vec3& up, float verticalFov, float apertureRadius);

}  // namespace quintet::scene
#endif
