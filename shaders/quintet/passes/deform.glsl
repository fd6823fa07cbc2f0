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
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer DeformUvec3Array { uvec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer DeformMatrixArray { DeformMatrix at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DeformTargetArray { DeformTarget at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DeformSkinSetArray { DeformSkinSet at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DeformGeometryArray {
  DeformGeometry at[];
};

bool isNotFinite(vec3 v) { return hasInfOrNan(floatBitsToUint(vec4(v, 0.0))); }

float weightWithFlag(DeformMatrixArray matrices, uint joint, float weight, uint flag) {
  return (matrices.at[joint].flags & flag) != 0u ? weight : 0.0;
}

// Whether the matrices with this flag have more than half of the weight of the vertex. As scene::applySkin.
bool isMirrored(DeformGeometry g, uint vertex, uint flag) {
  DeformMatrixArray matrices = DeformMatrixArray(g.matrices);
  if (g.skinSetCount == 0u) return (matrices.at[0].flags & flag) != 0u;
  float sum = 0.0, mirrored = 0.0;
  for (uint s = 0u; s < g.skinSetCount; ++s) {
    const DeformSkinSet set = DeformSkinSetArray(g.skinSets).at[s];
    const uvec2 pairs = DeformUvec2Array(set.joints).at[vertex];
    const uvec4 joints = uvec4(pairs.x & 0xFFFFu, pairs.x >> 16u, pairs.y & 0xFFFFu, pairs.y >> 16u);
    const vec4 weights = DeformVec4Array(set.weights).at[vertex];
    for (int c = 0; c < 4; ++c) {
      sum += weights[c];
      mirrored += weightWithFlag(matrices, joints[c], weights[c], flag);
    }
  }
  if (!isNotFinite(vec3(sum)) && sum > 0.0) return mirrored > 0.5 * sum;
  const uint first = DeformUvec2Array(DeformSkinSetArray(g.skinSets).at[0].joints).at[vertex].x & 0xFFFFu;
  return (matrices.at[first].flags & flag) != 0u;
}

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
