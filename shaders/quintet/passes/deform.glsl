// SPDX-License-Identifier: Apache-2.0
// Arrays and functions of the passes that deform vertices.
#ifndef QUINTET_PASSES_DEFORM_GLSL
#define QUINTET_PASSES_DEFORM_GLSL
#include <quintet/passes/not_finite.glsl>
#include <quintet/passes/pass_index.glsl>
#include <quintet/shared/deform.h>

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer DeformVec3Array { vec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer DeformVec4Array { vec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer DeformFloatArray { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer DeformUintArray { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer DeformUvec2Array { uvec2 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer DeformUvec3Array { uvec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer DeformMatrixArray { DeformMatrix at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DeformTargetArray { DeformTarget at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DeformSkinSetArray { DeformSkinSet at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DeformGeometryArray {
  DeformGeometry at[];
};

bool isNotFinite(vec3 v) { return hasInfOrNan(floatBitsToUint(vec4(v, 0.0))); }

// Scales by the largest component first, so that tiny and huge vectors neither underflow nor overflow. Returns false,
// and changes nothing, if v is zero or not finite.
bool normalizeDirection(inout vec3 v) {
  const float largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
  if (isNotFinite(v) || !(largest > 0.0)) return false;
  const vec3 scaled = v / largest;
  v = scaled / length(scaled);
  return true;
}

#endif
