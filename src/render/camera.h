// The scene's camera for an image: as the device has it, and as matrices that other programs read.
#ifndef QUINTET_RENDER_CAMERA_H
#define QUINTET_RENDER_CAMERA_H

#include <cstdint>

#include "base/math.h"
#include "quintet/shared/frame.h"
#include "scene/scene.h"

namespace quintet::render {

// The device's camera for an image of this size.
shared::CameraData makeCamera(const scene::Camera& camera, std::uint32_t width, std::uint32_t height);

// OpenEXR's worldToCamera and worldToNDC (ImfStandardAttributes.h), for column vectors as everything here. A lens is
// taken as the pinhole in its middle.
struct CameraMatrices {
  // Left-handed, in metres: x to the right, y up, z into the picture.
  mat4 cameraFromWorld{1.0f};
  // After the division by w: x from 0 at the left edge of the whole image to 1, y from 0 at its top edge to 1. z, of which
  // OpenEXR says nothing, is 1 - 1 m / depth of a perspective camera, the depth in metres of an orthographic one.
  mat4 ndcFromWorld{1.0f};
};
CameraMatrices cameraMatrices(const scene::Camera& camera, std::uint32_t width, std::uint32_t height);

}  // namespace quintet::render
#endif
