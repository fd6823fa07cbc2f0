// SPDX-License-Identifier: Apache-2.0
// All crossings of a ray with one solid of the scene.
#ifndef QUINTET_PROCEDURAL_CROSSINGS_GLSL
#define QUINTET_PROCEDURAL_CROSSINGS_GLSL

#include "convex.glsl"
#ifndef QUINTET_NO_TORUS
#include "torus.glsl"
#endif

vec3 primitivePoint(vec4 rows[3], vec3 p) {
  return vec3(dot(rows[0].xyz, p) + rows[0].w, dot(rows[1].xyz, p) + rows[1].w, dot(rows[2].xyz, p) + rows[2].w);
}
vec3 primitiveVector(vec4 rows[3], vec3 v) { return vec3(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v)); }

// Crossings in ascending t, alternately entering and leaving; kInfinity after the last one. The ray is in object space.
// t is in units of its direction, which need not be normalized.
vec4 primitiveCrossings(PrimitiveData primitive, vec3 origin, vec3 direction) {
  const vec3 o = primitivePoint(primitive.primitiveFromObject, origin);
  const vec3 d = primitiveVector(primitive.primitiveFromObject, direction);
#ifndef QUINTET_NO_TORUS
  if (primitive.type == kPrimitiveTorus) return torusCrossings(o, d, primitive.parameter);
#endif
  const vec2 inside = convexInterval(primitive.type, o, d);
  return inside.x < inside.y ? vec4(inside, kInfinity, kInfinity) : vec4(kInfinity);
}

// For iterating over the crossings: whether the ray is inside just after t, and the t of the next crossing.
bool insideAfter(vec4 crossings, float t) {
  return (crossings.x <= t && t < crossings.y) || (crossings.z <= t && t < crossings.w);
}
float nextCrossing(vec4 crossings, float t) {
  return crossings.x > t ? crossings.x : crossings.y > t ? crossings.y : crossings.z > t ? crossings.z : crossings.w > t ? crossings.w : kInfinity;
}

#endif
