// SPDX-License-Identifier: Apache-2.0
// Alpha in any-hit shaders on solids and CSG trees. As in quintet/alpha.glsl, the result of the test depends only on
// the ray's seed and on the surface point, which is computed from the ray and the candidate's t.
#ifndef QUINTET_PROCEDURAL_ALPHA_GLSL
#define QUINTET_PROCEDURAL_ALPHA_GLSL

#include "../coverage.glsl"
#include "hit.glsl"

// Coverage of the candidate `hit`.
float solidCoverage(HitPayload hit) {
  const PrimitiveData primitive = PrimitiveArray(hitGeometry().primitives).at[hit.part & kPartPrimitiveMask];
  const MaterialData material = MaterialArray(frame.materials).at[primitive.material];
  if ((material.flags & (kMaterialMask | kMaterialBlend)) == 0u) return 1.0;
  float alpha = material.baseColor.a;
  if (material.baseColorTexture.index != kNoTexture) {
    const uint face = (hit.part >> kPartFaceShift) & 7u;
    alpha *= sampleTexture(material.baseColorTexture, solidPoint(primitive.type, primitive.parameter, face, hit.barycentric).uv).a;
  }
  return coverageOf(material, alpha);
}

// True if the candidate must be ignored: alpha mask below its cutoff, or blend with probability 1 - alpha.
bool solidAlphaRejects(uint seed) {
  const HitPayload hit = solidHit(seed);
  // Independent of all other random numbers of the path, and of the ray's other crossings of the same solid.
  const uint surface = hashCombine(hashCombine(hit.part, hit.primitive), hit.geometry);
  const uint random = hashCombine(hashCombine(seed, hit.instance), hashCombine(surface, floatBitsToUint(hit.t)));
  return float(random >> 8) * (1.0 / 16777216.0) >= solidCoverage(hit);
}

#endif
