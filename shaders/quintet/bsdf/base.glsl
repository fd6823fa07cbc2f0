// SPDX-License-Identifier: Apache-2.0
// Terms that the lobes of the base share: the specular, diffuse and transmission lobes below the clearcoat.
// makeBsdf (lobes.glsl) computes them once for each wo.
#ifndef QUINTET_BSDF_BASE_GLSL
#define QUINTET_BSDF_BASE_GLSL

#include "albedo.glsl"
#include "film.glsl"

// Factors are linear and in [0,1]. "Layer" is the dielectric's specular layer.
struct BaseLayer {
  vec3 color;          // base color
  float metallic;
  float opaque;        // weight of the opaque dielectric
  float diffuse;       // weight of diffuse reflection, a part of `opaque`
  float translucent;   // weight of diffuse transmission, the other part
  float clear;         // weight of the transmissive dielectric
  vec2 alpha;          // GGX widths along x and y, at least kDeltaAlpha
  bool delta;          // the surface is smooth
  bool entering;       // wo is on the outside
  float ior;           // of the denser side over the other, at least 1
  bool intoDenser;     // wi is in the denser medium if it is refracted
  bool refractive;     // transmission is that of a solid (DielectricLobe), not of a thin wall (ThinLobe)
  bool bends;          // refractive, and the ior is not 0
  bool solid;          // light enters a closed volume here, by refraction or diffusely
  float reflecting;    // weight of the dielectric whose reflection is in the specular lobe
  float specular;      // KHR_materials_specular; also f90 of the layer
  vec3 clearF0;        // reflectance at normal incidence without `specular`
  vec3 colorF0;        // reflectance at normal incidence
  float f0;            // largest component of colorF0
  AlbedoRoughness roughness;  // position of the widths in the albedo tables
  Film film;           // over the base; weight 0 if there is none
  AlbedoFilm filmExtra;  // reflectance that the film adds to the layer
  vec3 lb;             // layerTerms at wo
  vec3 average;        // average of layerTerms
  vec3 colorMultiple;  // multipleFactor of the layer
  vec3 metalMultiple;  // multipleFactor of the metal
  float layerMultiple; // its largest component
  vec3 passing;        // layerPassing
  float passed;        // 1 - E(wo) of the layer
  float underCoat;     // fraction of light that passes the clearcoat and, from wo, the sheen; for estimates of albedos
};

// Returns (L, B, X) for the direction w, with w.z >= 0: those of albedoSchlick, and the albedo that the film adds.
vec3 layerTerms(AlbedoRoughness roughness, AlbedoFilm extra, vec3 w) {
  vec3 terms = vec3(albedoSchlick(roughness, w), 0.0);
  if (kHasIridescence) terms.z = albedoFilm(extra, ggxMeanWidth(roughness.alpha), w.z);
  return terms;
}

// Returns (a, b, c) such that 1 - E = a + b L + c B - X for the albedo E of a layer with Schlick's Fresnel and a film.
// `multiple` is the factor of its multiple scattering: E = f0 (1 - L - B) + f90 B + X + multiple L.
vec3 layerPassing(float f0, float f90, float multiple) { return vec3(1.0 - f0, f0 - multiple, f0 - f90); }
float layerPassed(vec3 passing, vec3 lb) { return max(passing.x + dot(passing.yz, lb.xy) - lb.z, 0.0); }

#endif
