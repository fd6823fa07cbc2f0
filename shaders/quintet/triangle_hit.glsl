// SPDX-License-Identifier: Apache-2.0
// The payload of a triangle that a ray has hit, from what the driver reports. Any stage can include this file.
#ifndef QUINTET_TRIANGLE_HIT_GLSL
#define QUINTET_TRIANGLE_HIT_GLSL

#include "hit_indices.glsl"
#include "payload.glsl"

// Computes the barycentrics of the hit from the ray, because on some drivers a candidate that any-hit has rejected
// overwrites the attributes of the committed hit (docs/design/quirks.md).
vec2 barycentricsFromRay(vec3 origin, vec3 direction, vec3 p0, vec3 p1, vec3 p2) {
  const vec3 edge1 = p1 - p0;
  const vec3 edge2 = p2 - p0;
  const vec3 p = cross(direction, edge2);
  const float determinant = dot(edge1, p);
  const float inverse = determinant != 0.0 ? 1.0 / determinant : 0.0;
  const vec3 s = origin - p0;
  const vec3 q = cross(s, edge1);
  vec2 b = clamp(vec2(dot(s, p), dot(direction, q)) * inverse, 0.0, 1.0);
  return b / max(1.0, b.x + b.y);
}

// The members of the payload that are common to all hits: indices (instance, geometry, primitive) in the scene, and t.
// `seed` is kept.
HitPayload hitAt(float t, uvec3 indices, uint seed) {
  HitPayload hit;
  hit.t = t;
  hit.instance = indices.x;
  hit.geometry = indices.y;
  hit.primitive = indices.z;
  hit.barycentric = vec2(0.0);
#ifndef QUINTET_NO_PROCEDURALS
  hit.part = 0u;
#endif
  setRaySeed(hit, seed);
  return hit;
}

// The payload of a committed triangle hit at distance t, with the driver's barycentrics. The ray is in object space.
HitPayload triangleHitAt(HitIndices at, float t, vec2 barycentric, vec3 origin, vec3 direction, uint seed) {
  uvec3 indices = uvec3(at.instance, at.geometry, at.primitive);
  GeometryData geometry;
#ifdef QUINTET_MERGED_INSTANCES
  const InstanceData instance = InstanceArray(frame.instances).at[at.instance];
  if ((instance.flags & kInstanceMerged) != 0u) {
    const uint64_t merged = packUint2x32(uvec2(instance.firstGeometry, instance.firstLightSlot));
    indices = Uvec3Array(merged).at[at.primitive];
    geometry = geometryOf(indices.x, indices.y);
  } else
#endif
  {
    geometry = geometryOf(at.instance, at.geometry);
    indices.z = scenePrimitive(geometry, at.primitive);
  }
  HitPayload hit = hitAt(t, indices, seed);
#ifdef QUINTET_RECOMPUTE_BARYCENTRICS
  const uvec3 v = Uvec3Array(geometry.triangles).at[hit.primitive];
  Vec3Array positions = Vec3Array(geometry.positions);
  hit.barycentric = barycentricsFromRay(origin, direction, positions.at[v.x], positions.at[v.y], positions.at[v.z]);
#else
  hit.barycentric = barycentric;
#endif
  return hit;
}

#endif
