// SPDX-License-Identifier: Apache-2.0
// Conversion of the scene's camera to the device's form, and to matrices for other programs.
#ifndef QUINTET_RENDER_SCENE_CAMERA_H
#define QUINTET_RENDER_SCENE_CAMERA_H

#include <cstdint>

#include "base/math.h"
#include "quintet/shared/frame.h"
#include "scene/model/scene.h"

namespace quintet::render {

// Returns the device's camera for an image of this size in pixels.
shared::CameraData makeCamera(const scene::Camera& camera, std::uint32_t width, std::uint32_t height);

// OpenEXR's worldToCamera and worldToNDC (ImfStandardAttributes.h), for column vectors as everywhere in Quintet. A lens
// is replaced by a pinhole at its center.
struct CameraMatrices {
  // Left-handed, in meters: x points right, y up, z into the image.
  mat4 cameraFromWorld{1.0f};
  // After division by w, x is 0 at the left edge of the whole image and 1 at the right edge; y is 0 at the top and 1 at
  // the bottom. OpenEXR does not define z: here it is 1 - 1 m / depth for a perspective camera, and the depth in meters
  // for an orthographic camera.
  mat4 ndcFromWorld{1.0f};
};
CameraMatrices cameraMatrices(const scene::Camera& camera, std::uint32_t width, std::uint32_t height);

}  // namespace quintet::render
#endif
