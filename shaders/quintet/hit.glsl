// SPDX-License-Identifier: Apache-2.0
// For closest-hit and any-hit shaders on triangles: the payload of a hit.
#ifndef QUINTET_HIT_GLSL
#define QUINTET_HIT_GLSL

#include "hit_geometry.glsl"
#include "triangle_hit.glsl"

HitPayload hitOf(GeometryData geometry, uint seed) {
  return hitAt(gl_HitTEXT, uvec3(gl_InstanceCustomIndexEXT, gl_GeometryIndexEXT, hitTriangle(geometry)), seed);
}

// The payload of a committed triangle hit; `seed` is kept.
HitPayload triangleHit(vec2 attributes, uint seed) {
  return triangleHitAt(driverHitIndices(), gl_HitTEXT, attributes, gl_ObjectRayOriginEXT, gl_ObjectRayDirectionEXT, seed);
}

#endif
