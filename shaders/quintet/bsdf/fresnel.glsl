// SPDX-License-Identifier: Apache-2.0
// Fresnel reflectance: exact for dielectrics, Schlick's approximation for all others.
#ifndef QUINTET_BSDF_FRESNEL_GLSL
#define QUINTET_BSDF_FRESNEL_GLSL

// Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering", eq. 24, without f0 and f90:
// reflectance = mix(f0, f90, schlickWeight(cosine)).
float schlickWeight(float cosine) {
  float x = clamp(1.0 - cosine, 0.0, 1.0);
  return x * x * x * x * x;
}

// Returns the reflectance at normal incidence. An ior of 0 gives 1, as KHR_materials_ior specifies.
float reflectanceFromIor(float ior) {
  float r = (ior - 1.0) / (ior + 1.0);
  return r * r;
}

// Unpolarized reflectance of a smooth interface; eta: index on the far side over the near side.
// Walter, Marschner, Li, Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces", eq. 22.
// Returns 1 for total reflection.
float fresnelDielectric(float cosine, float eta) {
  float g2 = eta * eta - 1.0 + cosine * cosine;
  float g = sqrt(max(g2, 0.0));
  float a = (g - cosine) / (g + cosine);
  float b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
  return g2 > 0.0 ? min(0.5 * a * a * (1.0 + b * b), 1.0) : 1.0;
}

#endif
