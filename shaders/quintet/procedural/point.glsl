// SPDX-License-Identifier: Apache-2.0
// Points on canonical solids: the point that a ray has hit, its two coordinates, and the surface at it. A point
// computed from its coordinates lies on the surface up to a few rounding errors, for any distance of the ray's origin.
//
// Texture coordinates, upright on each surface seen from outside with y up, v downwards as in glTF:
//   sphere    u = 1/2 + atan2(x, z)/2π (seam at -z), v = acos(y)/π
//   box       each face has the unit square; top and bottom are oriented as if rotated from the front (+z) face
//   cylinder  side: u as on the sphere, v = (1 - y)/2; caps: the square around them, as top and bottom of the box
//   cone      as the cylinder
//   torus     u as on the sphere, v = 1/2 - atan2(y, ρ - 1)/2π, the outer equator at 1/2
// The tangent is the direction of increasing u.
#ifndef QUINTET_PROCEDURAL_POINT_GLSL
#define QUINTET_PROCEDURAL_POINT_GLSL

#include "../lights/equirect.glsl"

// HitPayload::part
const uint kPartPrimitiveMask = 0x07FFFFFFu;  // index in GeometryData::primitives
const uint kPartFaceShift = 27u;              // 3 bits: face
const uint kPartFlipped = 0x40000000u;        // surface of a subtracted solid: the outward normal points into the solid
const uint kPartFront = 0x80000000u;          // the ray comes from outside

// Faces. Box: 2 axis + (1 if positive). Cylinder and cone: the curved side, or the caps, numbered as for the box.
const uint kFaceSide = 6u;
const uint kFaceBottom = 2u;
const uint kFaceTop = 3u;

struct SolidPoint {
  vec3 position;   // canonical space
  vec3 normal;     // out of the solid, not normalized
  vec3 tangent;    // along u, not normalized
  vec3 bitangent;  // along -v
  vec2 uv;
};

// Angle around y, (sin, cos) = (x, z)/ρ, as one number in [-2, 2]: the arc length along the square |x| + |z| = 1. It is
// proportional to the arc length on the circle up to a factor of 2.
float squareAngle(vec2 zx) {
  const float s = abs(zx.x) + abs(zx.y);
  const float x = s > 0.0 ? zx.y / s : 0.0;
  return zx.x >= 0.0 ? x : (zx.y < 0.0 ? -2.0 - x : 2.0 - x);
}
vec2 fromSquareAngle(float a) {  // unit (z, x)
  const vec2 p = abs(a) <= 1.0 ? vec2(1.0 - abs(a), a) : vec2(1.0 - abs(a), a < 0.0 ? -2.0 - a : 2.0 - a);
  return normalize(p);
}

// Octahedral map of the sphere (Cigolle et al. 2014), in 32-bit floats.
vec2 octahedral(vec3 n) {
  const vec2 p = n.xz / (abs(n.x) + abs(n.y) + abs(n.z));
  return n.y >= 0.0 ? p : (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
}
vec3 fromOctahedral(vec2 e) {
  vec2 p = e;
  const float y = 1.0 - abs(e.x) - abs(e.y);
  if (y < 0.0) p = (1.0 - abs(e.yx)) * vec2(e.x >= 0.0 ? 1.0 : -1.0, e.y >= 0.0 ? 1.0 : -1.0);
  return normalize(vec3(p.x, y, p.y));
}

vec3 faceNormal(uint face) {
  vec3 n = vec3(0.0);
  n[face >> 1] = (face & 1u) != 0u ? 1.0 : -1.0;
  return n;
}

// The face that a point near the surface belongs to. d: direction of the ray; `entering`: the ray enters this solid at
// p. Considers only the faces that such a ray can hit.
uint nearestFace(uint type, vec3 p, vec3 d, bool entering) {
  if (type == kPrimitiveSphere || type == kPrimitiveTorus) return kFaceSide;
  const vec3 facing = entering ? -d : d;  // the normal's side
  const vec3 height = vec3(facing.x >= 0.0 ? p.x : -p.x, facing.y >= 0.0 ? p.y : -p.y, facing.z >= 0.0 ? p.z : -p.z);
  const uint cap = facing.y >= 0.0 ? kFaceTop : kFaceBottom;
  if (type == kPrimitiveBox) {
    // A ray parallel to a face does not hit it.
    const vec3 gap = vec3(d.x == 0.0 ? 4.0 : 1.0 - height.x, d.y == 0.0 ? 4.0 : 1.0 - height.y, d.z == 0.0 ? 4.0 : 1.0 - height.z);
    if (abs(gap.x) <= abs(gap.y) && abs(gap.x) <= abs(gap.z)) return facing.x >= 0.0 ? 1u : 0u;
    if (abs(gap.y) <= abs(gap.z)) return cap;
    return facing.z >= 0.0 ? 5u : 4u;
  }
  const float radius = length(p.xz);
  const bool cone = type == kPrimitiveCone;
  const float sideGap = cone ? (radius - 0.5 * (1.0 - p.y)) * 0.8944272 : radius - 1.0;
  const float slope = p.x * facing.x + p.z * facing.z + (cone ? 0.5 * radius * facing.y : 0.0);
  const bool capMet = d.y != 0.0 && !(cone && cap == kFaceTop);
  return capMet && (abs(1.0 - height.y) < abs(sideGap) || slope < 0.0) ? cap : kFaceSide;
}

// The two coordinates of the surface point nearest to p.
vec2 pointCoordinates(uint type, uint face, vec3 p) {
  if (type == kPrimitiveSphere) return octahedral(p);
  if (type == kPrimitiveTorus) return vec2(squareAngle(p.zx), squareAngle(vec2(length(p.xz) - 1.0, p.y)));
  if (face != kFaceSide) {
    const vec2 q = face < 2u ? p.zy : face < 4u ? p.xz : p.xy;
    return type == kPrimitiveBox ? clamp(q, -1.0, 1.0) : q / max(1.0, length(q));
  }
  if (type == kPrimitiveCylinder) return vec2(squareAngle(p.zx), clamp(p.y, -1.0, 1.0));
  // Cone: project along the normal in the plane of the axis. Near the apex, both coordinates are as small as the
  // distance to it, so that they keep their relative precision.
  const float radius = length(p.xz);
  const float along = clamp(radius - 0.8 * (radius - 0.5 * (1.0 - p.y)), 0.0, 1.0);
  return radius > 0.0 ? p.xz * (along / radius) : vec2(along, 0.0);
}

const float kInverseTwoPi = 0.15915494309189535;

SolidPoint solidPoint(uint type, float parameter, uint face, vec2 e) {
  SolidPoint s;
  s.bitangent = vec3(0.0, 1.0, 0.0);
  if (face != kFaceSide) {
    const vec3 n = faceNormal(face);
    const float side = (face & 1u) != 0u ? 1.0 : -1.0;
    s.normal = n;
    if (face < 2u) {
      s.position = vec3(side, e.y, e.x);
      s.tangent = vec3(0.0, 0.0, -side);
      s.uv = vec2(0.5 - 0.5 * side * e.x, 0.5 - 0.5 * e.y);
    } else if (face < 4u) {
      s.position = vec3(e.x, side, e.y);
      s.tangent = vec3(1.0, 0.0, 0.0);
      s.bitangent = vec3(0.0, 0.0, -side);
      s.uv = vec2(0.5 + 0.5 * e.x, 0.5 + 0.5 * side * e.y);
    } else {
      s.position = vec3(e, side);
      s.tangent = vec3(side, 0.0, 0.0);
      s.uv = vec2(0.5 + 0.5 * side * e.x, 0.5 - 0.5 * e.y);
    }
    return s;
  }
  vec2 zx;  // the direction from the axis
  if (type == kPrimitiveSphere) {
    s.position = fromOctahedral(e);
    s.normal = s.position;
    const float radius = length(s.position.xz);
    zx = radius > 0.0 ? s.position.zx / radius : vec2(1.0, 0.0);
    s.bitangent = vec3(-zx.y * s.position.y, radius, -zx.x * s.position.y);
    s.uv.y = preciseAtan2(radius, s.position.y) * (2.0 * kInverseTwoPi);
  } else if (type == kPrimitiveTorus) {
    zx = fromSquareAngle(e.x);
    const vec2 tube = fromSquareAngle(e.y);  // outwards, up
    const float ring = 1.0 + parameter * tube.x;
    s.position = vec3(zx.y * ring, parameter * tube.y, zx.x * ring);
    s.normal = vec3(zx.y * tube.x, tube.y, zx.x * tube.x);
    s.bitangent = vec3(-zx.y * tube.y, tube.x, -zx.x * tube.y);
    s.uv.y = 0.5 - preciseAtan2(tube.y, tube.x) * kInverseTwoPi;
  } else if (type == kPrimitiveCylinder) {
    zx = fromSquareAngle(e.x);
    s.position = vec3(zx.y, e.y, zx.x);
    s.normal = vec3(zx.y, 0.0, zx.x);
    s.uv.y = 0.5 - 0.5 * e.y;
  } else {
    const float radius = length(e);
    zx = radius > 0.0 ? e.yx / radius : vec2(1.0, 0.0);
    s.position = vec3(e.x, 1.0 - 2.0 * radius, e.y);
    s.normal = vec3(zx.y, 0.5, zx.x);
    s.bitangent = vec3(-zx.y, 2.0, -zx.x);
    s.uv.y = radius;
  }
  s.tangent = vec3(zx.x, 0.0, -zx.y);
  s.uv.x = 0.5 + preciseAtan2(zx.y, zx.x) * kInverseTwoPi;
  return s;
}

#endif
