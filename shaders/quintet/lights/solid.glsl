// SPDX-License-Identifier: Apache-2.0
// Light sampling of emissive spheres, boxes, cylinders, cones and tori, which emit on both sides. A sphere in world space
// that is seen from outside is sampled on its near side (ball.glsl). For all others, a point of the whole surface is
// sampled: uniform by area on the canonical sphere, cylinder and cone, by the areas of the faces in world space on a box,
// and uniform in both angles on a torus. The transform changes its density.
#ifndef QUINTET_LIGHTS_SOLID_GLSL
#define QUINTET_LIGHTS_SOLID_GLSL

#include "../sampling/warp.glsl"
#include "../surface.glsl"
#include "ball.glsl"
#include "light_sample.glsl"
#include "triangle.glsl"

#ifndef QUINTET_NO_PROCEDURALS

// Returns the linear part of worldFromPrimitive.
mat3 worldFromPrimitive(InstanceData instance, PrimitiveData primitive) {
  mat3 m;
  for (int i = 0; i < 3; ++i) {
    const vec3 column = vec3(primitive.objectFromPrimitive[0][i], primitive.objectFromPrimitive[1][i], primitive.objectFromPrimitive[2][i]);
    m[i] = rowsTimesVector(instance.worldFromObject, column);
  }
  return m;
}

vec3 solidCenter(InstanceData instance, PrimitiveData primitive) {
  const vec3 center = vec3(primitive.objectFromPrimitive[0].w, primitive.objectFromPrimitive[1].w, primitive.objectFromPrimitive[2].w);
  return rowsTimesPoint(instance.worldFromObject, center);
}

// Returns the area vector of a transformed unit area with normal n, by the cofactors of m. Its length is the area ratio.
vec3 areaVector(mat3 m, vec3 n) { return n.x * cross(m[1], m[2]) + n.y * cross(m[2], m[0]) + n.z * cross(m[0], m[1]); }

// Returns the world areas of the box's faces along each axis, as fractions of their sum.
vec3 boxFaceParts(mat3 m) {
  const vec3 areas = vec3(length(cross(m[1], m[2])), length(cross(m[2], m[0])), length(cross(m[0], m[1])));
  return areas / (areas.x + areas.y + areas.z);
}

// Returns the density of canonicalPoint per canonical area; `p` is on the surface.
float canonicalDensity(uint type, float parameter, mat3 m, uint face, vec3 p) {
  if (type == kPrimitiveSphere) return 1.0 / (4.0 * kPi);
  if (type == kPrimitiveBox) return 0.125 * boxFaceParts(m)[face >> 1];
  if (type == kPrimitiveCylinder) return 1.0 / (6.0 * kPi);
  if (type == kPrimitiveCone) return 1.0 / (kPi * 3.2360679775);  // base 1, side √5
  return 1.0 / (4.0 * kPi * kPi * parameter * length(p.xz));
}

// Returns a point of the canonical surface for two random numbers.
vec3 canonicalPoint(uint type, float parameter, mat3 m, vec2 u, out uint face) {
  face = kFaceSide;
  if (type == kPrimitiveSphere) return sampleSphere(u);
  if (type == kPrimitiveTorus) {
    const float ring = 1.0 + parameter * cos(2.0 * kPi * u.y);
    return vec3(ring * sin(2.0 * kPi * u.x), parameter * sin(2.0 * kPi * u.y), ring * cos(2.0 * kPi * u.x));
  }
  if (type == kPrimitiveBox) {
    const vec3 parts = boxFaceParts(m);
    const int axis = u.x < parts.x ? 0 : u.x < parts.x + parts.y ? 1 : 2;
    const float before = axis == 0 ? 0.0 : axis == 1 ? parts.x : parts.x + parts.y;
    const float w = clamp(2.0 * (u.x - before) / parts[axis], 0.0, 1.9999999);
    const bool positive = w >= 1.0;
    face = uint(2 * axis) + (positive ? 1u : 0u);
    vec3 p;
    p[axis] = positive ? 1.0 : -1.0;
    p[(axis + 1) % 3] = 2.0 * (positive ? w - 1.0 : w) - 1.0;
    p[(axis + 2) % 3] = 2.0 * u.y - 1.0;
    return p;
  }
  const float phi = 2.0 * kPi * u.y;
  const vec2 around = vec2(sin(phi), cos(phi));
  if (type == kPrimitiveCylinder) {
    if (u.x < 4.0 / 6.0) return vec3(around.x, 3.0 * u.x - 1.0, around.y);
    const bool top = u.x >= 5.0 / 6.0;
    face = top ? kFaceTop : kFaceBottom;
    const float radius = sqrt(clamp(6.0 * u.x - (top ? 5.0 : 4.0), 0.0, 1.0));
    return vec3(radius * around.x, top ? 1.0 : -1.0, radius * around.y);
  }
  const float basePart = 0.30901699437;  // 1 / (1 + √5)
  const bool base = u.x < basePart;
  if (base) face = kFaceBottom;
  const float radius = sqrt(base ? u.x / basePart : clamp((u.x - basePart) / (1.0 - basePart), 0.0, 1.0));
  return vec3(radius * around.x, base ? -1.0 : 1.0 - 2.0 * radius, radius * around.y);
}

// Returns the density per solid angle at `from` with which sampleSolidLight finds the point of the hit, at `distance` along
// a unit ray with cosine = |ray · normal|, on the outside (`front`) or inside. The far side of a ball seen from outside,
// which alpha and panes can show, is not sampled.
float pdfSolid(InstanceData instance, PrimitiveData primitive, uint face, vec2 coordinates, bool front, vec3 from, float distance,
               float cosine) {
  const mat3 m = worldFromPrimitive(instance, primitive);
  const float radius = ballRadius(primitive.type, m);
  const vec3 toCenter = solidCenter(instance, primitive) - from;
  if (seesBallFromOutside(radius, toCenter)) return front ? pdfBall(toCenter, radius) : 0.0;
  const SolidPoint point = solidPoint(primitive.type, primitive.parameter, face, coordinates);
  const float stretch = length(areaVector(m, normalize(point.normal)));
  const float density = canonicalDensity(primitive.type, primitive.parameter, m, face, point.position);
  const float pdf = density * distance * distance / (stretch * cosine);
  return stretch * cosine > 0.0 && !isinf(pdf) ? pdf : 0.0;
}

bool sampleSolidLight(LightData light, vec3 position, vec2 u, inout LightSample s) {
  const InstanceData instance = InstanceArray(frame.instances).at[light.instance];
  const GeometryData geometry = GeometryArray(frame.geometries).at[instance.firstGeometry + light.geometry];
  const PrimitiveData primitive = PrimitiveArray(geometry.primitives).at[light.primitive];
  const mat3 m = worldFromPrimitive(instance, primitive);
  const vec3 toCenter = solidCenter(instance, primitive) - position;
  const float radius = ballRadius(primitive.type, m);
  uint face = kFaceSide;
  vec3 p;
  if (seesBallFromOutside(radius, toCenter)) p = transpose(m) * sampleBall(toCenter, radius, u);
  else p = canonicalPoint(primitive.type, primitive.parameter, m, u, face);
  const vec2 coordinates = pointCoordinates(primitive.type, face, p);
  const SolidPoint point = solidPoint(primitive.type, primitive.parameter, face, coordinates);
  const vec3 world = rowsTimesPoint(instance.worldFromObject, rowsTimesPoint(primitive.objectFromPrimitive, point.position));
  lightFromPoint(world, vec3(1.0), position, s);
  s.normal = safeNormalize(areaVector(m, point.normal) / maxComponent(abs(areaVector(m, point.normal))), s.wi);
  const float cosine = abs(dot(s.normal, s.wi));
  s.radiance = surfaceEmission(instance, primitive.material, 1.0, point.uv, point.uv, cosine);
  s.pdf = pdfSolid(instance, primitive, face, coordinates, true, position, s.distance, cosine);
  const BoxData box = BoxArray(geometry.boxes).at[light.primitive];
  s.error = solidError(instance, primitive, point.position, max(abs(box.min), abs(box.max)), world, s.normal);
  s.delta = false;
  return s.pdf > 0.0 && maxComponent(s.radiance) > 0.0;
}

#endif
#endif
