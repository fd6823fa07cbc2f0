// SPDX-License-Identifier: Apache-2.0
// Area-preserving maps from the unit square to other domains: the density of the result is constant (or
// cosine-weighted), and stratified points stay stratified. u in [0,1)²; z is the local up direction.
#ifndef QUINTET_SAMPLING_WARP_GLSL
#define QUINTET_SAMPLING_WARP_GLSL

#include "../frame.glsl"

// Unit disk, density 1/pi. Concentric squares become concentric circles: P. Shirley & K. Chiu, "A Low
// Distortion Map Between Disk and Square" (1997).
vec2 sampleDisk(vec2 u) {
  const vec2 p = 2.0 * u - 1.0;
  if (p.x == 0.0 && p.y == 0.0) return vec2(0.0);
  const bool wide = abs(p.x) > abs(p.y);
  const float r = wide ? p.x : p.y;
  const float phi = wide ? 0.25 * kPi * (p.y / p.x) : 0.5 * kPi - 0.25 * kPi * (p.x / p.y);
  return r * vec2(cos(phi), sin(phi));
}

// Hemisphere around z, density z/pi: points of the disk, lifted (Malley's method).
vec3 sampleCosineHemisphere(vec2 u) {
  const vec2 d = sampleDisk(u);
  return vec3(d, sqrt(max(0.0, 1.0 - dot(d, d))));
}

// Directions within the cone z ≥ cosMax, density 1 / (2 pi (1 - cosMax)). Computes with 1 - z, which is precise in
// narrow cones.
vec3 sampleCone(vec2 u, float cosMax) {
  const float h = u.x * (1.0 - cosMax);
  const float r = sqrt(max(0.0, h * (2.0 - h)));
  const float phi = 2.0 * kPi * u.y;
  return vec3(r * cos(phi), r * sin(phi), 1.0 - h);
}

// Whole sphere, density 1 / (4 pi).
vec3 sampleSphere(vec2 u) { return sampleCone(u, -1.0); }

// Barycentrics (weights of vertices 1 and 2), density 1/area: E. Heitz, "A Low-Distortion Map Between
// Triangle and Square" (2019).
vec2 sampleTriangle(vec2 u) {
  return u.y > u.x ? vec2(0.5 * u.x, u.y - 0.5 * u.x) : vec2(u.x - 0.5 * u.y, 0.5 * u.y);
}

#endif
