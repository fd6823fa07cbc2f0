// SPDX-License-Identifier: Apache-2.0
// For closest-hit and any-hit shaders on solids and CSG trees: the surface that was hit, and the point on it.
// Everything is computed from the ray and t. Hit attributes are not used, because some drivers corrupt them
// (docs/design/quirks.md).
#ifndef QUINTET_PROCEDURAL_HIT_GLSL
#define QUINTET_PROCEDURAL_HIT_GLSL

#include "../hit.glsl"
#include "point.glsl"
#include "crossings.glsl"
#ifndef QUINTET_NO_CSG
#include "csg.glsl"
#endif

// The payload of the hit (in any-hit shaders: the candidate) at gl_HitTEXT; `seed` is kept.
HitPayload solidHit(uint seed) {
  const GeometryData geometry = hitGeometry();
  HitPayload hit = hitOf(geometry, seed);
  const vec3 origin = gl_ObjectRayOriginEXT;
  const vec3 direction = gl_ObjectRayDirectionEXT;
  const bool front = gl_HitKindEXT == kHitEntering;
  bool entering = front;
  uint index = hit.primitive;
#ifndef QUINTET_NO_CSG
  if (geometry.kind == kGeometryCsg)
    index = csgLeaf(geometry, CsgTreeArray(geometry.trees).at[hit.primitive], origin, direction, hit.t, entering);
#endif
  const PrimitiveData primitive = PrimitiveArray(geometry.primitives).at[index];
  const vec3 d = primitiveVector(primitive.primitiveFromObject, direction);
  const vec3 p = primitivePoint(primitive.primitiveFromObject, origin) + hit.t * d;
  const uint face = nearestFace(primitive.type, p, d, entering);
  hit.barycentric = pointCoordinates(primitive.type, face, p);
  hit.part = index | (face << kPartFaceShift) | (front ? kPartFront : 0u) | (entering != front ? kPartFlipped : 0u);
  return hit;
}

#endif
