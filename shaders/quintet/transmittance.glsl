// SPDX-License-Identifier: Apache-2.0
// Transmittance of a surface for a shadow ray, in any-hit shaders: the part that alpha does not cover, plus, for the
// covered part, the weight of a path that passes undeflected (bsdfStraight: only smooth thin walls).
#ifndef QUINTET_TRANSMITTANCE_GLSL
#define QUINTET_TRANSMITTANCE_GLSL

#include "material.glsl"

// `hit`: a candidate of a ray in `direction`, with the alpha coverage `coverage`.
vec3 candidateTransmittance(HitPayload hit, uint material, float coverage, vec3 direction) {
  vec3 straight = vec3(0.0);
  if (kHasPanes && (MaterialArray(frame.materials).at[material].flags & kMaterialPane) != 0u) {
    const vec3 woWorld = -normalize(direction);
    const Shading shading = shadeSurface(fetchSurface(hit, woWorld), woWorld);
    const vec3 wo = toLocal(shading, woWorld);
    straight = bsdfStraight(makeBsdf(shading.bsdf, wo), wo.z);
  }
  return mix(vec3(1.0), straight, coverage);
}

// True if the surface blocks all remaining light, so that the ray can end.
bool blocksRay(inout ShadowPayload payload, vec3 transmittance) {
#ifdef QUINTET_NO_TRANSMITTANCE
  return maxComponent(transmittance) <= 0.0;
#else
  payload.transmittance *= transmittance;
  return maxComponent(payload.transmittance) <= 0.0;
#endif
}

#endif
