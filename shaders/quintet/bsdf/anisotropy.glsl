// SPDX-License-Identifier: Apache-2.0
// The anisotropic GGX (KHR_materials_anisotropy): the functions of ggx.glsl with a width along x and a width along y of the
// local frame. D = 1 / (pi a_x a_y ((h_x / a_x)^2 + (h_y / a_y)^2 + h_z^2)^2) for a unit half vector h, and
// cos theta (1 + 2 Lambda) = sqrt((a_x w_x)^2 + (a_y w_y)^2 + w_z^2). Heitz 2014, "Understanding the Masking-Shadowing
// Function", eq. 85 and 86; visible normals: Heitz 2018, "Sampling the GGX Distribution of Visible Normals".
// In scenes without anisotropic materials, both widths are equal and the compiler uses the isotropic functions.
#ifndef QUINTET_BSDF_ANISOTROPY_GLSL
#define QUINTET_BSDF_ANISOTROPY_GLSL

#include "../features.glsl"
#include "ggx.glsl"

// Returns the widths of the extension: alpha across the direction of anisotropy, and mix(alpha, 1, strength^2) along it.
vec2 ggxWidths(float alpha, float strength) {
  return vec2(kHasAnisotropy ? mix(alpha, 1.0, strength * strength) : alpha, alpha);
}

// Returns the root mean square of the widths, for approximations that take one width.
float ggxMeanWidth(vec2 alpha) { return kHasAnisotropy ? sqrt(0.5 * dot(alpha, alpha)) : alpha.y; }

// Returns D of a half vector of any length.
float ggxDistribution(vec3 h, vec2 alpha) {
  if (!kHasAnisotropy) return ggxDistribution(h.z * h.z, dot(h.xy, h.xy), alpha.y);
  float product = alpha.x * alpha.y;
  float q = (product * h.z * h.z + alpha.y / alpha.x * h.x * h.x + alpha.x / alpha.y * h.y * h.y) / dot(h, h);
  return product / (kPi * q * q);
}

float ggxStretch(vec3 w, vec2 alpha) {
  return kHasAnisotropy ? length(vec3(alpha * w.xy, w.z)) : ggxStretch(w.z, alpha.y);
}

// w.z is positive.
float ggxMasking(vec3 w, vec2 alpha) { return 2.0 * w.z / (w.z + ggxStretch(w, alpha)); }

// Reflection without Fresnel, times cos_i; wo.z and wi.z are positive.
float ggxReflection(float d, vec3 wo, vec3 wi, vec2 alpha) {
  return 0.5 * d * wi.z / (wo.z * ggxStretch(wi, alpha) + wi.z * ggxStretch(wo, alpha));
}

// Eto and Tokuyoshi 2023 bound the cap of an anisotropic surface by the smaller width.
float ggxBound(vec3 wo, vec2 alpha) { return ggxBound(wo.z, kHasAnisotropy ? min(alpha.x, alpha.y) : alpha.y); }

float ggxReflectionPdf(float d, vec3 wo, vec2 alpha, float bound) {
  return 0.5 * d / (bound * wo.z + ggxStretch(wo, alpha));
}

vec3 ggxSample(vec3 wo, vec2 alpha, float bound, vec2 u) {
  return ggxSampleVisible(wo, kHasAnisotropy ? alpha : alpha.yy, bound, u);
}

#endif
