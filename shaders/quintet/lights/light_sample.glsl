// SPDX-License-Identifier: Apache-2.0
// The result of light samplers. They take a position and no normal, so they also work for points in volumes.
#ifndef QUINTET_LIGHTS_LIGHT_SAMPLE_GLSL
#define QUINTET_LIGHTS_LIGHT_SAMPLE_GLSL

#include "../frame.glsl"

struct LightSample {
  vec3 wi;         // world, unit, from the shading point to the light
  float distance;  // meters; kInfinity: directional, environment
  vec3 radiance;   // arriving along wi; delta lights: irradiance of a surface that faces the light
  float pdf;       // per solid angle, selection included; delta lights: the selection probability alone
  vec3 point;      // world, on the light (finite only)
  vec3 normal;     // world, unit, of the emitting triangle; 0 elsewhere
  float error;     // meters along `normal` within which rays may hit the triangle itself
  bool delta;      // BSDF sampling cannot find this light
  bool finite;     // `point` exists
};

// Returns the end of a shadow ray from `origin`: the point itself, or for a triangle a point just in front of it on the
// origin's side, so that the ray cannot hit its own light.
vec3 shadowTarget(LightSample light, vec3 origin) {
  return light.point + (dot(origin - light.point, light.normal) < 0.0 ? -light.error : light.error) * light.normal;
}

// Fills the sample of a delta light at `point` with radiant intensity `intensity` towards `position`. Returns false if it
// does not contribute, for example at distance 0.
bool lightFromPoint(vec3 point, vec3 intensity, vec3 position, inout LightSample s) {
  const vec3 d = point - position;
  const float squared = dot(d, d);
  s.distance = sqrt(squared);
  s.wi = d / s.distance;
  s.radiance = intensity / squared;
  s.pdf = 1.0;
  s.point = point;
  s.normal = vec3(0.0);
  s.error = 0.0;
  s.delta = true;
  s.finite = true;
  return squared > 0.0 && maxComponent(intensity) > 0.0;
}

// Attenuation of KHR_lights_punctual besides the inverse square law: 1 - (distance / range)^4, and 0 beyond the range.
// `inverseRange` is 0 without a range.
float rangeAttenuation(float distance, float inverseRange) {
  if (inverseRange == 0.0) return 1.0;
  const float ratio = distance * inverseRange;
  const float squared = ratio * ratio;
  return clamp(1.0 - squared * squared, 0.0, 1.0);
}

// Fills the sample of a light at infinity in direction wi.
void lightFromInfinity(vec3 wi, vec3 radiance, bool delta, inout LightSample s) {
  s.wi = wi;
  s.distance = kInfinity;
  s.radiance = radiance;
  s.pdf = 1.0;
  s.point = vec3(0.0);
  s.normal = vec3(0.0);
  s.error = 0.0;
  s.delta = delta;
  s.finite = false;
}

#endif
