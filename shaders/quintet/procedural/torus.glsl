// SPDX-License-Identifier: Apache-2.0
// Crossings of a line with the canonical torus (about the y axis, major radius 1, minor radius r): up to four. The
// signed distance defines inside and surface, so that rounding of the quartic's coefficients has no effect. The extrema
// of the quartic, which are roots of a depressed cubic, only separate its roots.
#ifndef QUINTET_PROCEDURAL_TORUS_GLSL
#define QUINTET_PROCEDURAL_TORUS_GLSL

#include "convex.glsl"

float torusDistance(vec3 p, float r) {
  const float ring = length(p.xz) - 1.0;
  return sqrt(ring * ring + p.y * p.y) - r;
}

// The root of t³ + p t - q in [low, high], where the cubic is monotonic; the nearer end of the interval if there is
// none.
float cubicRoot(float p, float q, float low, float high) {
  const bool rising = (low * low + p) * low < (high * high + p) * high;
  for (int i = 0; i < 24; ++i) {
    const float middle = 0.5 * (low + high);
    const bool below = (middle * middle + p) * middle < q;
    if (below == rising) low = middle;
    else high = middle;
  }
  return 0.5 * (low + high);
}

// The zero of the signed distance along o + t d, |d| = 1, between low and high, where its signs differ.
float torusRoot(vec3 o, vec3 d, float r, float low, float high, bool insideLow) {
  float t = 0.5 * (low + high);
  for (int i = 0; i < 24; ++i) {
    const vec3 p = o + t * d;
    const float radius = length(p.xz);
    const float ring = radius - 1.0;
    const float tube = sqrt(ring * ring + p.y * p.y);
    const float value = tube - r;
    if ((value < 0.0) == insideLow) low = t;
    else high = t;
    // Newton step, or bisection if it leaves the bracket.
    const float slope = (ring * (p.x * d.x + p.z * d.z) / max(radius, 1e-20) + p.y * d.y) / max(tube, 1e-20);
    const float next = t - value / nonZero(slope);
    const float before = t;
    t = next > low && next < high ? next : 0.5 * (low + high);
    if (abs(t - before) < 3e-8) break;
  }
  return t;
}

// Crossings of o + t d in ascending t; the first one enters. kInfinity fills up the missing ones.
vec4 torusCrossings(vec3 o, vec3 d, float r) {
  vec4 crossings = vec4(kInfinity);
  // Move the origin to the point nearest to the center and normalize the direction: all numbers below are around 1.
  const float scale = 1.0 / length(d);
  const vec3 u = d * scale;
  const float shift = -dot(o, u);
  const vec3 m = o + shift * u;
  const float squared = dot(m, m);
  const float reach = 1.001 * (1.0 + r);
  if (squared >= reach * reach) return crossings;
  const float end = sqrt(reach * reach - squared);

  // The quartic (|p|² + 1 - r²)² - 4 (x² + z²) has its extrema where t³ + p t = q.
  const float p = squared + 1.0 - r * r - 2.0 * (u.x * u.x + u.z * u.z);
  const float q = 2.0 * (m.x * u.x + m.z * u.z);
  const float turn = p < 0.0 ? min(sqrt(-p / 3.0), end) : 0.0;
  const vec4 stops = vec4(cubicRoot(p, q, -end, -turn), cubicRoot(p, q, -turn, turn), cubicRoot(p, q, turn, end), end);

  float low = -end;
  bool insideLow = false;
  vec4 left = stops;
  for (int i = 0; i < 4; ++i) {
    const float high = left.x;
    left = vec4(left.yzw, 0.0);
    const bool insideHigh = i < 3 && torusDistance(m + high * u, r) < 0.0;
    // Shift new crossings in from the back; the loop below moves them to the front.
    if (insideHigh != insideLow) crossings = vec4(crossings.yzw, (shift + torusRoot(m, u, r, low, high, insideLow)) * scale);
    low = high;
    insideLow = insideHigh;
  }
  for (int i = 0; i < 4; ++i)
    if (crossings.x == kInfinity) crossings = vec4(crossings.yzw, kInfinity);
  return crossings;
}

#endif
