// SPDX-License-Identifier: Apache-2.0
// Intersection of a line with a canonical sphere, box, cylinder or cone: one interval, because all of them are convex.
// The formulas never confuse inside and outside for an origin near the surface. In the quadratic a t² + 2 b t + c, the
// sign of c depends only on the origin's side of the surface, and the nearest root is c / q (Kahan's form). The
// discriminant is that of Haines et al. 2019, "Precision Improvements for Ray/Sphere Intersection".
#ifndef QUINTET_PROCEDURAL_CONVEX_GLSL
#define QUINTET_PROCEDURAL_CONVEX_GLSL

#include "../frame.glsl"

// Replaces a value near 0 by ±1e-30, for divisions.
float nonZero(float x) { return abs(x) < 1e-30 ? (x < 0.0 ? -1e-30 : 1e-30) : x; }

// x² + z² + sign·h² <= bound, with h = o.y + t d.y. The sphere: h = y, sign 1, bound 1; the cylinder: sign 0, bound 1;
// the cone: h = (1 - y)/2, sign -1, bound 0: the half with h >= 0 alone. Empty if x > y.
vec2 quadricInterval(vec3 o, vec3 d, float sign, float bound) {
  const float lengthSquared = dot(d, d);
  const float a = d.x * d.x + d.z * d.z + sign * d.y * d.y;
  const float b = o.x * d.x + o.z * d.z + sign * o.y * d.y;
  const float c = o.x * o.x + o.z * o.z + sign * o.y * o.y - bound;
  // The discriminant does not depend on the origin of the line. For an origin outside, compute it from the point of the
  // line nearest to the center, where it does not cancel. For an origin inside (c < 0, a > 0), it is a sum of positive
  // terms: it does not cancel, and the line always hits.
  float discriminant = b * b - a * c;
  if (!(c < 0.0 && a > 0.0)) {
    const vec3 m = o - (dot(o, d) / lengthSquared) * d;
    const float bm = m.x * d.x + m.z * d.z + sign * m.y * d.y;
    discriminant = bm * bm - a * (m.x * m.x + m.z * m.z + sign * m.y * m.y - bound);
  }
  // No crossing: along the cylinder's axis, or through the cone's apex.
  if (!(discriminant > 0.0)) return c < 0.0 ? vec2(-kInfinity, kInfinity) : vec2(kInfinity, -kInfinity);
  const float root = sqrt(discriminant);
  const float q = b < 0.0 ? root - b : -(root + b);
  const float t0 = q / nonZero(a);
  const float t1 = c / q;
  if (a >= 0.0) return vec2(min(t0, t1), max(t0, t1));
  // A steep line through both halves of the double cone: keep the half with h >= 0.
  return d.y > 0.0 ? vec2(max(t0, t1), kInfinity) : vec2(-kInfinity, min(t0, t1));
}

// Interval of t in which the line o + t d is inside the solid; empty if x > y. d can have any length.
vec2 convexInterval(uint type, vec3 o, vec3 d) {
  vec2 inside = vec2(-kInfinity, kInfinity);
  if (type != kPrimitiveSphere) {
    const vec3 inverse = 1.0 / vec3(nonZero(d.x), nonZero(d.y), nonZero(d.z));
    const vec3 low = (-1.0 - o) * inverse;
    const vec3 high = (1.0 - o) * inverse;
    const vec3 near = min(low, high);
    const vec3 far = max(low, high);
    inside = type == kPrimitiveBox ? vec2(max(max(near.x, near.y), near.z), min(min(far.x, far.y), far.z)) : vec2(near.y, far.y);
  }
  if (type != kPrimitiveBox) {
    const bool cone = type == kPrimitiveCone;
    const vec3 oh = cone ? vec3(o.x, 0.5 * (1.0 - o.y), o.z) : o;
    const vec3 dh = cone ? vec3(d.x, -0.5 * d.y, d.z) : d;
    const vec2 quadric = quadricInterval(oh, dh, cone ? -1.0 : type == kPrimitiveSphere ? 1.0 : 0.0, cone ? 0.0 : 1.0);
    inside = vec2(max(inside.x, quadric.x), min(inside.y, quadric.y));
  }
  return inside;
}

#endif
