// What a surface lets straight through to a shadow ray, for any-hit shaders: what alpha leaves open, and where the
// surface is there, the weight with which a path goes straight through it (bsdfStraight: only smooth thin walls).
#ifndef QUINTET_TRANSMITTANCE_GLSL
#define QUINTET_TRANSMITTANCE_GLSL

#include "material.glsl"

// The surface of `hit`, a candidate of a ray towards `direction`, of which `coverage` is there.
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

// True if the ray ends here: nothing is left of its light.
bool takesAll(inout ShadowPayload payload, vec3 transmittance) {
#ifdef QUINTET_NO_TRANSMITTANCE
  return maxComponent(transmittance) <= 0.0;
#else
  payload.transmittance *= transmittance;
  return maxComponent(payload.transmittance) <= 0.0;
#endif
}

#endif
