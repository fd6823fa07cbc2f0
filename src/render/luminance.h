// How bright a light counts when samples are shared out. Only a choice of probabilities: nothing that
// is rendered depends on it.
#ifndef QUINTET_RENDER_LUMINANCE_H
#define QUINTET_RENDER_LUMINANCE_H

#include "base/math.h"

namespace quintet::render {

// Rec. 709 luminance; positive as soon as one component is. Negative and non-finite components count as 0.
inline float lightLuminance(const vec3& color) {
  const auto clean = [](float c) { return c > 0.0f && c < std::numeric_limits<float>::infinity() ? c : 0.0f; };
  return 0.2126f * clean(color.x) + 0.7152f * clean(color.y) + 0.0722f * clean(color.z);
}

}  // namespace quintet::render
#endif
