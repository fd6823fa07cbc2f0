// SPDX-License-Identifier: Apache-2.0
// Directions and equirectangular texture coordinates: u = atan2(d.z, d.x) / 2pi + 0.5, v = acos(d.y) / pi. d is in the
// environment's frame (EnvironmentData: rotated about +y). The formulas are precise at the poles, where acos(y) is not.
// They do not use the built-in functions: Vulkan allows an error of 2^-11 in sin and cos and of 4096 ulp in atan, more
// than a texel of a large map. The minimax fits (Remez) have relative errors of 4e-9 and 9e-8.
#ifndef QUINTET_LIGHTS_EQUIRECT_GLSL
#define QUINTET_LIGHTS_EQUIRECT_GLSL

#include "../frame.glsl"

// x in [-pi/2, pi/2].
float preciseSin(float x) {
  const float s = x * x;
  float p = -0.00019809068967169673 + 2.6052102620887418e-6 * s;
  p = 0.008333050979911378 + p * s;
  p = -0.16666657988482123 + p * s;
  p = 0.9999999957306893 + p * s;
  return p * x;
}

// A polynomial in x² for atan(x)/x on [0,1]; other octants by symmetry.
float preciseAtan2(float y, float x) {
  const float high = max(abs(x), abs(y));
  const float low = min(abs(x), abs(y));
  const float t = high > 0.0 ? low / high : 0.0;
  const float s = t * t;
  float p = 0.02455712952457009 - 0.004780456974619508 * s;
  p = -0.059904721565096956 + p * s;
  p = 0.09942759431121459 + p * s;
  p = -0.14029419835957174 + p * s;
  p = 0.19971375159775548 + p * s;
  p = -0.3333209351368038 + p * s;
  p = 0.9999999114138739 + p * s;
  float angle = p * t;
  if (abs(y) > abs(x)) angle = 0.5 * kPi - angle;
  if (x < 0.0) angle = kPi - angle;
  return y < 0.0 ? -angle : angle;
}

vec2 equirectFromDirection(EnvironmentData e, vec3 d) {
  const float x = e.cosRotation * d.x - e.sinRotation * d.z;
  const float z = e.sinRotation * d.x + e.cosRotation * d.z;
  return vec2(preciseAtan2(z, x) * (0.5 / kPi) + 0.5, preciseAtan2(length(d.xz), d.y) * (1.0 / kPi));
}

// Returns the direction at horizontal coordinate u. The polar angle θ is given as sin²(θ/2), from the pole +y, or from -y
// if `below`.
vec3 directionFromEquirect(EnvironmentData e, float u, float halfSineSquared, bool below) {
  const float phi = 2.0 * kPi * (u - 0.5);
  const float r = 2.0 * sqrt(halfSineSquared * (1.0 - halfSineSquared));
  const float y = 1.0 - 2.0 * halfSineSquared;
  const float x = r * preciseSin(0.5 * kPi - abs(phi));
  const float z = r * preciseSin(abs(phi) > 0.5 * kPi ? sign(phi) * kPi - phi : phi);
  return vec3(e.cosRotation * x + e.sinRotation * z, below ? -y : y, e.cosRotation * z - e.sinRotation * x);
}

#endif
