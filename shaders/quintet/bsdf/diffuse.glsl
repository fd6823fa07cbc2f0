// Lambert's diffuse reflection under a specular layer. The two are coupled by the layer's albedo E so that
// what the layer does not reflect reaches the diffuse base and a white base loses nothing:
// f = color (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_average)); reciprocal.
// Kelemen and Szirmay-Kalos 2001, "A Microfacet Based Coupled Specular-Matte BRDF Model with Importance
// Sampling", eq. 3 and 4, with E of the compensated GGX layer.
#ifndef QUINTET_BSDF_DIFFUSE_GLSL
#define QUINTET_BSDF_DIFFUSE_GLSL

#include "albedo.glsl"

struct DiffuseLobe {
  vec3 color;      // all of f that does not depend on wi, without 1/pi
  float f0;        // of the layer
  float f90;
  AlbedoCell row;  // of the layer's roughness
};

// `ab`: the layer's albedoSchlick at wo.
DiffuseLobe makeDiffuse(vec3 color, float f0, float f90, AlbedoCell row, vec2 ab) {
  float passed = 1.0 - albedoCompensated(f0, f90, ab);
  return DiffuseLobe(color * max(passed, 0.0) / max(1.0 - albedoAverage(f0, f90, row), 1e-4), f0, f90, row);
}

vec3 diffuseEval(DiffuseLobe lobe, vec3 wi) {
  float reflected = albedoCompensated(lobe.f0, lobe.f90, albedoSchlick(lobe.row, wi.z));
  return lobe.color * (max(1.0 - reflected, 0.0) * max(wi.z, 0.0) / kPi);
}

vec3 diffuseSample(vec2 u) {
  float r = sqrt(u.x);
  float phi = 2.0 * kPi * u.y;
  return vec3(r * cos(phi), r * sin(phi), sqrt(max(1.0 - u.x, 0.0)));
}

float diffusePdf(vec3 wi) { return max(wi.z, 0.0) / kPi; }

#endif
