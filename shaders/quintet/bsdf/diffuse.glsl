// SPDX-License-Identifier: Apache-2.0
// Diffuse lobe: Lambert's reflection under a specular layer. The layer's albedo E couples the two, multiple scattering
// included. What the layer does not reflect reaches the diffuse base, so a white base loses nothing:
// f = color (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_average)). This is reciprocal.
// Kelemen and Szirmay-Kalos 2001, "A Microfacet Based Coupled Specular-Matte BRDF Model with Importance
// Sampling", eq. 3 and 4.
#ifndef QUINTET_BSDF_DIFFUSE_GLSL
#define QUINTET_BSDF_DIFFUSE_GLSL

#include "base.glsl"

struct DiffuseLobe {
  vec3 color;    // factors of f that do not depend on wi, without 1/pi
  vec3 passing;  // layerPassing
};

// `albedo`: estimate of the lobe's albedo, for the choice of a lobe.
DiffuseLobe makeDiffuse(BaseLayer base, out float albedo) {
  albedo = base.underCoat * base.diffuse * luminance(base.color) * base.passed;
  return DiffuseLobe(base.diffuse * base.color * (base.passed / max(layerPassed(base.passing, base.average), 1e-4)), base.passing);
}

// `lb`: layerTerms at wi.
vec3 diffuseEval(DiffuseLobe lobe, vec3 wi, vec3 lb) {
  return lobe.color * (layerPassed(lobe.passing, lb) * max(wi.z, 0.0) / kPi);
}

vec3 diffuseSample(vec2 u) {
  float r = sqrt(u.x);
  float phi = 2.0 * kPi * u.y;
  return vec3(r * cos(phi), r * sin(phi), sqrt(max(1.0 - u.x, 0.0)));
}

float diffusePdf(vec3 wi) { return max(wi.z, 0.0) / kPi; }

#endif
