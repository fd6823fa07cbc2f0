// SPDX-License-Identifier: Apache-2.0
// Multiple scattering at a rough surface. For f0 = f90 = 1 single scattering loses the fraction L(wo) of the light
// (albedoSchlick). This lobe returns it: f = F L(wo) L(wi) / (pi M), where M is the average of L. It is reciprocal and
// its albedo is F L(wo). Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks".
#ifndef QUINTET_BSDF_MULTIPLE_GLSL
#define QUINTET_BSDF_MULTIPLE_GLSL

#include "albedo.glsl"

// Returns F. Each scattering reflects the average f of Fresnel. After each one except the first, the fraction 1 - M
// escapes. F is the sum over all orders from the second on; it is 1 for a white mirror.
vec3 multipleFactor(vec3 f, float lostAverage) {
  return min(f * f * (1.0 - lostAverage) / (1.0 - f * lostAverage), vec3(1.0));  // rounding may exceed 1
}

// The same for Schlick's Fresnel, whose average is (20 f0 + f90) / 21.
vec3 multipleFactor(vec3 f0, float f90, float lostAverage) { return multipleFactor((20.0 * f0 + f90) / 21.0, lostAverage); }

// f cos_i without F L(wo) / M. `lb`: layerTerms at wi.
float multipleEval(vec3 wi, vec3 lb) { return lb.x * abs(wi.z) / kPi; }

// L is nearly proportional to 1 / (cos^2 + a^2) with a^2 = 2 alpha^2. The product with the cosine can be sampled.
// No sample of an isotropic surface then has a weight above twice the average, at any roughness.
float multipleWidth(vec2 alpha) {
  float mean = ggxMeanWidth(alpha);
  return 2.0 * mean * mean;
}

vec3 multipleSample(vec2 alpha, vec2 u) {
  float a2 = multipleWidth(alpha);
  float z2 = min(a2 * (exp(u.x * log(1.0 + 1.0 / a2)) - 1.0), 1.0);
  float phi = 2.0 * kPi * u.y;
  return vec3(sqrt(1.0 - z2) * vec2(cos(phi), sin(phi)), sqrt(z2));
}

float multiplePdf(vec3 wi, vec2 alpha) {
  float a2 = multipleWidth(alpha);
  return abs(wi.z) / (kPi * (wi.z * wi.z + a2) * log(1.0 + 1.0 / a2));
}

#endif
