// Lambert's diffuse reflection under a specular layer. The two are coupled by the layer's albedo E, multiple
// scattering included, so that what the layer does not reflect reaches the diffuse base and a white base loses
// nothing: f = color (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_average)); reciprocal.
// Kelemen and Szirmay-Kalos 2001, "A Microfacet Based Coupled Specular-Matte BRDF Model with Importance
// Sampling", eq. 3 and 4.
#ifndef QUINTET_BSDF_DIFFUSE_GLSL
#define QUINTET_BSDF_DIFFUSE_GLSL

#include "albedo.glsl"

struct DiffuseLobe {
  vec3 color;    // all of f that does not depend on wi, without 1/pi
  vec3 passing;  // layerPassing
};

// (a, b, c) with 1 - E = a + b L + c B, for a layer whose multiple scattering has the factor `multiple`: E is
// f0 (1 - L - B) + f90 B + multiple L (albedoSchlick has L and B).
vec3 layerPassing(float f0, float f90, float multiple) { return vec3(1.0 - f0, f0 - multiple, f0 - f90); }
float layerPassed(vec3 passing, vec2 lb) { return max(passing.x + dot(passing.yz, lb), 0.0); }

// `lb`: the layer's albedoSchlick at wi.
vec3 diffuseEval(DiffuseLobe lobe, vec3 wi, vec2 lb) {
  return lobe.color * (layerPassed(lobe.passing, lb) * max(wi.z, 0.0) / kPi);
}

vec3 diffuseSample(vec2 u) {
  float r = sqrt(u.x);
  float phi = 2.0 * kPi * u.y;
  return vec3(r * cos(phi), r * sin(phi), sqrt(max(1.0 - u.x, 0.0)));
}

float diffusePdf(vec3 wi) { return max(wi.z, 0.0) / kPi; }

#endif
