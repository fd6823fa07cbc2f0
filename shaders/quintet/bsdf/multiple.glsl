// Light that meets a rough surface more than once. Single scattering loses L(wo) of it for f0 = f90 = 1
// (albedoSchlick); that leaves by f = F L(wo) L(wi) / (pi M), M the average of L, which is reciprocal and reflects
// F L(wo): Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks".
#ifndef QUINTET_BSDF_MULTIPLE_GLSL
#define QUINTET_BSDF_MULTIPLE_GLSL

#include "albedo.glsl"

// F: each meeting reflects Schlick's average (20 f0 + f90) / 21, each but the first lets 1 - M of the light escape; the
// sum over two and more of them. 1 for a white mirror.
vec3 multipleFactor(vec3 f0, float f90, float lostAverage) {
  vec3 f = (20.0 * f0 + f90) / 21.0;
  return min(f * f * (1.0 - lostAverage) / (1.0 - f * lostAverage), vec3(1.0));  // a device's quotient may exceed 1
}

// f cos_i without F L(wo) / M. `lb`: the layer's albedoSchlick at wi.
float multipleEval(vec3 wi, vec2 lb) { return lb.x * abs(wi.z) / kPi; }

// L is nearly proportional to 1 / (cos^2 + a^2) with a^2 = 2 alpha^2, and that times the cosine can be drawn:
// no sample is worth more than twice the average, at any roughness.
float multipleWidth(float alpha) { return 2.0 * alpha * alpha; }

vec3 multipleSample(float alpha, vec2 u) {
  float a2 = multipleWidth(alpha);
  float z2 = min(a2 * (exp(u.x * log(1.0 + 1.0 / a2)) - 1.0), 1.0);
  float phi = 2.0 * kPi * u.y;
  return vec3(sqrt(1.0 - z2) * vec2(cos(phi), sin(phi)), sqrt(z2));
}

float multiplePdf(vec3 wi, float alpha) {
  float a2 = multipleWidth(alpha);
  return abs(wi.z) / (kPi * (wi.z * wi.z + a2) * log(1.0 + 1.0 / a2));
}

#endif
