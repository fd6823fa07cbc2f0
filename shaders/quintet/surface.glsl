// SPDX-License-Identifier: Apache-2.0
// The surface at a hit: position and its error bound, frames, texture coordinates.
#ifndef QUINTET_SURFACE_GLSL
#define QUINTET_SURFACE_GLSL

#include "explain_hooks.glsl"
#include "payload.glsl"
#include "texture.glsl"

struct Surface {
  vec3 position;         // world
  float error;           // meters along the geometric normal; bounds the distance to the surface that rays intersect
  vec3 geometricNormal;  // world, unit, on the side of wo
  vec3 shadingNormal;    // world, unit, interpolated, on the side of wo; before normal mapping
  vec3 tangent;          // world, unit, orthogonal to shadingNormal, for normal maps
  vec3 bitangent;
  bool frontFace;        // wo sees the triangle counter-clockwise; for solids: wo is outside
  uint material;
  vec4 color;            // vertex color; 1 if there is none
  vec2 uvs[2];
};

vec3 rowsTimesPoint(vec4 rows[3], vec3 p) {
  return vec3(dot(rows[0].xyz, p) + rows[0].w, dot(rows[1].xyz, p) + rows[1].w, dot(rows[2].xyz, p) + rows[2].w);
}
vec3 rowsTimesVector(vec4 rows[3], vec3 v) { return vec3(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v)); }
// Returns the transpose of the linear part times v. It transforms normals if `rows` is the inverse transform.
vec3 transposeTimesVector(vec4 rows[3], vec3 v) { return rows[0].xyz * v.x + rows[1].xyz * v.y + rows[2].xyz * v.z; }

// Returns a bound of the distance, along the world normal n, between the computed point p of triangle (p0, p1, p2) and the
// triangle that the traversal intersects. It uses the standard model of floating-point error (Higham 2002, chapter 3; for
// ray offsets: Wächter and Binder 2019, pbrt chapter 6.8), with e = 2^-24 and k roundings bounded by k·e. The errors are
// those of interpolation in object space, of the transform to world, of the traversal's transform of the ray origin back to
// object space, and of its subtraction of origin and vertices. The last one applies to all axes: watertight tests shear the
// triangle along the ray, so the extent of one axis affects the others. An axis-aligned plane through the origin has no
// other error. Derivation: docs/design/path-tracer.md, "Ray offsets".
float surfaceError(InstanceData instance, vec3 p0, vec3 p1, vec3 p2, vec3 p, vec3 n) {
  const float e = 5.9604645e-8;
  const vec3 largest = max(max(abs(p0), abs(p1)), abs(p2));
  const vec3 extent = max(max(abs(p1 - p0), abs(p2 - p0)), abs(p2 - p1));
  vec3 world = abs(p);
  vec3 back;
  for (int i = 0; i < 3; ++i) {
    world[i] += 4.0 * (dot(abs(instance.worldFromObject[i].xyz), largest) + abs(instance.worldFromObject[i].w));
    back[i] = dot(abs(instance.objectFromWorld[i].xyz), abs(p)) + abs(instance.objectFromWorld[i].w);
  }
  const vec3 object = 5.0 * largest + 4.0 * back + vec3(8.0 * maxComponent(extent));
  return 2.0 * e * (dot(abs(n), world) + dot(abs(transposeTimesVector(instance.worldFromObject, n)), object));
}

// Returns the origin of a ray that leaves the surface towards `direction`, such that it cannot hit the surface itself.
vec3 offsetOrigin(Surface surface, vec3 direction) {
  return surface.position + (dot(direction, surface.geometricNormal) < 0.0 ? -surface.error : surface.error) * surface.geometricNormal;
}

// Returns a tangent for surfaces without tangents (Duff et al. 2017).
vec3 anyTangent(vec3 n) {
  const float s = n.z >= 0.0 ? 1.0 : -1.0;
  const float a = -1.0 / (s + n.z);
  return vec3(1.0 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x);
}

vec3 safeNormalize(vec3 v, vec3 fallback) {
  const float squared = dot(v, v);
  return squared > 1e-38 ? v * inversesqrt(squared) : fallback;
}

#ifndef QUINTET_NO_PROCEDURALS
#include "procedural/surface.glsl"
#endif

Surface fetchSurface(HitPayload hit, vec3 wo) {
  const InstanceData instance = InstanceArray(frame.instances).at[hit.instance];
  const GeometryData geometry = GeometryArray(frame.geometries).at[instance.firstGeometry + hit.geometry];
#ifndef QUINTET_NO_PROCEDURALS
  if (geometry.kind != kGeometryTriangles) return fetchSolid(hit, instance, geometry, wo);
#endif
  const uvec3 v = Uvec3Array(geometry.triangles).at[hit.primitive];
  const vec3 b = vec3(1.0 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);
  Vec3Array positions = Vec3Array(geometry.positions);
  const vec3 p0 = positions.at[v.x];
  const vec3 p1 = positions.at[v.y];
  const vec3 p2 = positions.at[v.z];

  Surface s;
  s.position = rowsTimesPoint(instance.worldFromObject, b.x * p0 + b.y * p1 + b.z * p2);
  // The normal comes from world-space edges, because the inverse transpose loses precision for large scales.
  const vec3 edge1 = rowsTimesVector(instance.worldFromObject, p1 - p0);
  const vec3 edge2 = rowsTimesVector(instance.worldFromObject, p2 - p0);
  const float size = max(maxComponent(abs(edge1)), maxComponent(abs(edge2)));
  vec3 front = safeNormalize(cross(edge1 / size, edge2 / size), wo);
  if ((instance.flags & kInstanceMirrored) != 0u) front = -front;
  s.frontFace = dot(front, wo) >= 0.0;
  s.geometricNormal = s.frontFace ? front : -front;
  s.error = surfaceError(instance, p0, p1, p2, s.position, front);

  vec3 n = front;
  if (geometry.normals != 0ul) {
    Vec3Array normals = Vec3Array(geometry.normals);
    const vec3 object = b.x * normals.at[v.x] + b.y * normals.at[v.y] + b.z * normals.at[v.z];
    n = safeNormalize(transposeTimesVector(instance.objectFromWorld, object), front);
  }
  s.shadingNormal = s.frontFace ? n : -n;

  s.tangent = vec3(0.0);
  s.bitangent = vec3(0.0);
  if (geometry.tangents != 0ul) {
    Vec4Array tangents = Vec4Array(geometry.tangents);
    const vec4 t = b.x * tangents.at[v.x] + b.y * tangents.at[v.y] + b.z * tangents.at[v.z];
    const vec3 world = rowsTimesVector(instance.worldFromObject, t.xyz);
    const float handedness = (t.w < 0.0 ? -1.0 : 1.0) * ((instance.flags & kInstanceMirrored) != 0u ? -1.0 : 1.0);
    const vec3 across = world - n * dot(n, world);
    // Of a tangent along the normal only rounding errors remain.
    const bool along = dot(across, across) <= 1e-10 * dot(world, world);
    s.tangent = along ? anyTangent(n) : safeNormalize(across, anyTangent(n));
    s.bitangent = handedness * cross(n, s.tangent);
  } else {
    s.tangent = anyTangent(n);
    s.bitangent = cross(n, s.tangent);
  }

  s.material = geometry.material;
  s.color = vec4(1.0);
  if (geometry.colors != 0ul) {
    Vec4Array colors = Vec4Array(geometry.colors);
    s.color = b.x * colors.at[v.x] + b.y * colors.at[v.y] + b.z * colors.at[v.z];
  }
  s.uvs[0] = interpolateUv(geometry, v, b, 0u);
  s.uvs[1] = interpolateUv(geometry, v, b, 1u);
  explainSurface(s.position, s.geometricNormal, s.shadingNormal, s.uvs[0], s.material, s.frontFace);
  return s;
}

#endif
