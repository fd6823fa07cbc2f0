// What every light sampler hands back. Only the receiving position goes in, no normal: so it also serves volumes.
#ifndef QUINTET_LIGHTS_LIGHT_SAMPLE_GLSL
#define QUINTET_LIGHTS_LIGHT_SAMPLE_GLSL

#include "../frame.glsl"

struct LightSample {
  vec3 wi;         // world, unit, from the receiver to the light
  float distance;  // metres; kInfinity: directional, environment
  vec3 radiance;   // arriving along wi; delta lights: irradiance of a surface that faces the light
  float pdf;       // per solid angle, selection included; delta lights: the selection probability alone
  vec3 point;      // world, on the light (finite only)
  vec3 normal;     // world, unit, of the emitting triangle; 0 elsewhere
  float error;     // metres along `normal` within which rays may meet the triangle itself
  bool delta;      // BSDF sampling cannot find this light
  bool finite;     // `point` exists
};

// End of a shadow ray from `origin`: the point itself, or for a triangle just in front of it on the
// origin's side, so that the ray cannot meet its own light.
vec3 shadowTarget(LightSample light, vec3 origin) {
  return light.point + (dot(origin - light.point, light.normal) < 0.0 ? -light.error : light.error) * light.normal;
}

// A delta light at `point` whose radiant intensity towards the receiver is `intensity`; false: on the spot.
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

// A light infinitely far in direction wi.
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
