// SPDX-License-Identifier: Apache-2.0
// The edges of a box in the image of a camera, to mark the selected object.
#ifndef QUINTET_OVERLAY_BOX_OUTLINE_H
#define QUINTET_OVERLAY_BOX_OUTLINE_H

#include <utility>
#include <vector>

#include "base/math.h"
#include "scene/model/scene.h"

namespace quintet::overlay {

// Pixels, from the top left corner; can be outside of the image.
using ImageLine = std::pair<vec2, vec2>;

// The visible parts of the 12 edges of `bounds` after the transform `worldFromObject`; those behind the camera are
// omitted. `size`: of the image, pixels. Empty for empty bounds.
std::vector<ImageLine> boxOutline(const scene::Camera& camera, uvec2 size, const Bounds3& bounds,
                                  const mat4& worldFromObject);

}  // namespace quintet::overlay
#endif
