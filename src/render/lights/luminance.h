// SPDX-License-Identifier: Apache-2.0
// The luminance by which samples are distributed over lights. It affects sampling probabilities only, never the
// expected image.
#ifndef QUINTET_RENDER_LIGHTS_LUMINANCE_H
#define QUINTET_RENDER_LIGHTS_LUMINANCE_H

#include <algorithm>

#include "base/luminance.h"
#include "base/math.h"
#include "scene/model/limits.h"

namespace quintet::render {

// Returns the Rec. 709 luminance, which is positive if any component is. Negative components and NaN count as 0,
// components above the largest radiance as that.
inline float lightLuminance(const vec3& color) {
  const auto clean = [](float c) { return c > 0.0f ? std::min(c, scene::kMaxRadiance) : 0.0f; };
  return luminance({clean(color.x), clean(color.y), clean(color.z)});
}

}  // namespace quintet::render
#endif
