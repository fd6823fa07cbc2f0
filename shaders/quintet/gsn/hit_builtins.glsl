// SPDX-License-Identifier: Apache-2.0
// The built-ins of a hit, copied at the start of the shader, because a nested trace overwrites them on some drivers
// (docs/design/quirks.md). Indices of primitives and instances are those of the scene, which can differ from the order
// in the acceleration structure.
uint gsnPrimitive_;
uint gsnInstance_;
uint gsnGeometryIndex_;
int gsnCustomIndex_;
mat4x3 gsnObjectToWorld_;
mat4x3 gsnWorldToObject_;
int gsnPrimitive() { return int(gsnPrimitive_); }
int gsnInstance() { return int(gsnInstance_); }
int gsnGeometryIndex() { return int(gsnGeometryIndex_); }
int gsnCustomIndex() { return gsnCustomIndex_; }
mat4x3 gsnObjectToWorld() { return gsnObjectToWorld_; }
mat4x3 gsnWorldToObject() { return gsnWorldToObject_; }
mat3x4 gsnObjectToWorld3x4() { return transpose(gsnObjectToWorld_); }
mat3x4 gsnWorldToObject3x4() { return transpose(gsnWorldToObject_); }
#ifndef QUINTET_GSN_INTERSECTION
uint gsnHitKind_;
uint gsnHitKind() { return gsnHitKind_; }
#endif

GeometryData gsnHitGeometry_() {
  const uint first = InstanceArray(frame.instances).at[gsnInstance_].firstGeometry;
  return GeometryArray(frame.geometries).at[first + gsnGeometryIndex_];
}

#if defined(QUINTET_GSN_TRIANGLES)
hitAttributeEXT vec2 gsnBaryAttribute_;
vec2 baryCoord;

// Computes the barycentrics from the ray by Cramer's rule, for drivers where the attribute can be that of a rejected
// candidate.
vec2 gsnBaryFromRay_(GeometryData geometry) {
  const uvec3 v = Uvec3Array(geometry.triangles).at[gsnPrimitive_];
  Vec3Array positions = Vec3Array(geometry.positions);
  const vec3 a = positions.at[v.x];
  const vec3 i = positions.at[v.y] - a;
  const vec3 j = positions.at[v.z] - a;
  const vec3 k = gl_ObjectRayOriginEXT - a;
  const vec3 rxj = cross(gl_ObjectRayDirectionEXT, j);
  const float determinant = dot(rxj, i);
  const vec2 uv = vec2(dot(rxj, k), dot(cross(k, i), gl_ObjectRayDirectionEXT));
  const vec2 b = clamp(uv * (determinant != 0.0 ? 1.0 / determinant : 0.0), 0.0, 1.0);
  return b / max(1.0, b.x + b.y);
}
#elif !defined(QUINTET_GSN_INTERSECTION)
const vec2 baryCoord = vec2(0.0);
#endif

#ifdef QUINTET_GSN_INTERSECTION
#ifdef QUINTET_CORRUPTS_HIT_ATTRIBUTES
const bool gsnCorruptsAttributes_ = true;
#else
const bool gsnCorruptsAttributes_ = false;
#endif
float gsnNearest_;  // t of the closest hit so far, including reports of this invocation
bool gsnInRange_(float t) { return t >= gl_RayTminEXT && t <= gsnNearest_; }
bool gsnReportRaw_(float t, uint hitKind) { return reportIntersectionEXT(t, hitKind); }
#endif

void gsnLoadHit_() {
  gsnInstance_ = uint(gl_InstanceCustomIndexEXT);
  gsnCustomIndex_ = int(InstanceArray(frame.instances).at[gsnInstance_].customIndex);
  gsnGeometryIndex_ = uint(gl_GeometryIndexEXT);
  gsnObjectToWorld_ = gl_ObjectToWorldEXT;
  gsnWorldToObject_ = gl_WorldToObjectEXT;
  const GeometryData geometry = gsnHitGeometry_();
  gsnPrimitive_ = uint(gl_PrimitiveID);
  if (geometry.primitiveMap != 0ul) gsnPrimitive_ = PrimitiveIndexArray(geometry.primitiveMap).at[gl_PrimitiveID];
#ifdef QUINTET_GSN_INTERSECTION
  gsnNearest_ = gl_RayTmaxEXT;
#else
  gsnHitKind_ = gl_HitKindEXT;
#endif
#ifdef QUINTET_GSN_TRIANGLES
#if defined(QUINTET_CORRUPTS_HIT_ATTRIBUTES) && defined(QUINTET_GSN_CANDIDATES) && defined(QUINTET_GSN_CLOSEST_HIT)
  baryCoord = gsnBaryFromRay_(geometry);
#else
  baryCoord = gsnBaryAttribute_;
#endif
#endif
}
