// How bright a light counts when samples are shared out. Only a choice of probabilities: nothing that
// is rendered depends on it.
#ifndef QUINTET_RENDER_LUMINANCE_H
#define QUINTET_RENDER_LUMINANCE_H

#include <algorithm>

#include "base/math.h"

namespace quintet::render {

// Rec. 709 luminance; positive as soon as one component is. Negative components and NaN count as 0,
// infinite ones as 1e30.
inline float lightLuminance(const vec3& color) {
  const auto clean = [](float c) { return c > 0.0f ? std::min(c, 1e30f) : 0.0f; };
  return 0.2126f * clean(color.x) + 0.7152f * clean(color.y) + 0.0722f * clean(color.z);
}

}  // namespace quintet::render
#endif
