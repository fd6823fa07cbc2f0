// SPDX-License-Identifier: Apache-2.0
// Coverage of a surface from its alpha and the alpha mode of its material.
#ifndef QUINTET_COVERAGE_GLSL
#define QUINTET_COVERAGE_GLSL

#include "frame.glsl"

// Coverage in [0,1]: 0 or 1 for alpha mask, alpha for blend, 1 for all other materials.
float coverageOf(MaterialData material, float alpha) {
  if ((material.flags & kMaterialMask) != 0u) return alpha < material.alphaCutoff ? 0.0 : 1.0;
  return (material.flags & kMaterialBlend) != 0u ? clamp(alpha, 0.0, 1.0) : 1.0;
}

#endif
