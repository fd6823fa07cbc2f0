// SPDX-License-Identifier: Apache-2.0
// Diffuse transmission lobe: Lambert's transmission to the other side, below the specular layer
// (KHR_materials_diffuse_transmission). It replaces a part of the diffuse reflection, and is coupled to the layer in the
// same way (diffuse.glsl): f = color (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_average)) for wi on the other side. It is
// reciprocal, and a white surface loses nothing. Light is not refracted, so radiance is not scaled.
#ifndef QUINTET_BSDF_DIFFUSE_TRANSMISSION_GLSL
#define QUINTET_BSDF_DIFFUSE_TRANSMISSION_GLSL

#include "base.glsl"
#include "diffuse.glsl"

struct DiffuseTransmissionLobe {
  vec3 color;    // factors of f that do not depend on wi, without 1/pi
  vec3 passing;  // layerPassing
};

// `albedo`: estimate of the lobe's albedo, for the choice of a lobe.
DiffuseTransmissionLobe makeDiffuseTransmission(BaseLayer base, vec3 color, out float albedo) {
  albedo = base.underCoat * base.translucent * luminance(color) * base.passed;
  return DiffuseTransmissionLobe(base.translucent * color * (base.passed / max(layerPassed(base.passing, base.average), 1e-4)), base.passing);
}

// `lb`: layerTerms at |wi.z|.
vec3 diffuseTransmissionEval(DiffuseTransmissionLobe lobe, vec3 wi, vec3 lb) {
  return lobe.color * (layerPassed(lobe.passing, lb) * max(-wi.z, 0.0) / kPi);
}

vec3 diffuseTransmissionSample(vec2 u) { return diffuseSample(u) * vec3(1.0, 1.0, -1.0); }

float diffuseTransmissionPdf(vec3 wi) { return max(-wi.z, 0.0) / kPi; }

#endif
