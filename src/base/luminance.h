// SPDX-License-Identifier: Apache-2.0
// The brightness of a color.
#ifndef QUINTET_BASE_LUMINANCE_H
#define QUINTET_BASE_LUMINANCE_H

#include "base/math.h"

namespace quintet {

// Returns the relative luminance of a linear color with the primaries of ITU-R BT.709.
inline float luminance(const vec3& color) { return 0.2126f * color.r + 0.7152f * color.g + 0.0722f * color.b; }

}  // namespace quintet
#endif
