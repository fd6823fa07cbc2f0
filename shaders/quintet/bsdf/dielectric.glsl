// SPDX-License-Identifier: Apache-2.0
// Rough interface of a solid dielectric: reflection, refraction and total reflection, from both sides.
// Walter, Marschner, Li, Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces": eq. 20 and 21
// with GGX. Masking is height-correlated for reflection and separable for refraction. The sum is divided by the
// tabulated albedo of single scattering at wo (Turquin 2019, eq. 15), so white glass loses nothing. For that reason it is
// not reciprocal.
// f transports radiance: refraction scales it by 1/eta^2, because the solid angle changes (Veach 1997, section 5.2).
// These factors cancel along a path that enters and leaves a solid. One of the two forms of the transmission lobe
// (transmission.glsl).
#ifndef QUINTET_BSDF_DIELECTRIC_GLSL
#define QUINTET_BSDF_DIELECTRIC_GLSL

#include "base.glsl"
#include "fresnel.glsl"
#include "ggx.glsl"

struct DielectricLobe {
  vec3 color;          // of transmission, times compensation
  vec3 f0;             // with the material's specularColor, without its specular
  float specular;      // scales all reflection except total reflection
  float compensation;  // of reflection
  float eta;           // index on the side of wi over the side of wo, for refraction
  float alpha;
};

// `glass`: albedoGlass at wo, or 1 if the lobe is a delta.
DielectricLobe makeDielectric(BaseLayer base, vec2 glass) {
  DielectricLobe lobe;
  lobe.compensation = base.clear / mix(glass.y, glass.x, base.specular);
  lobe.color = lobe.compensation * (base.bends ? 1.0 : base.passed) * base.color;
  lobe.f0 = base.clearF0;
  lobe.specular = base.bends ? base.specular : 0.0;
  lobe.eta = base.entering ? base.ior : 1.0 / base.ior;
  lobe.alpha = base.alpha;
  return lobe;
}

// Fractions of the light at a micronormal m with dot(wo, m) = cosine.
struct DielectricSplit {
  vec3 reflectance;
  vec3 transmittance;  // without the scaling of radiance
  float reflectProbability;
};

DielectricSplit dielectricSplit(DielectricLobe lobe, float cosine) {
  float fresnel = fresnelDielectric(cosine, lobe.eta);
  float exactF0 = reflectanceFromIor(lobe.eta);
  // Interpolates from f0 to 1 as the exact reflectance does. It is exact where f0 is that of the ior.
  vec3 f = lobe.specular * mix(lobe.f0, vec3(1.0), (fresnel - exactF0) / (1.0 - exactF0));
  f = fresnel < 1.0 ? clamp(f, 0.0, 1.0) : vec3(1.0);
  DielectricSplit split;
  split.reflectance = lobe.compensation * f;
  split.transmittance = lobe.color * (1.0 - maxComponent(f));
  float r = luminance(split.reflectance);
  split.reflectProbability = r / max(r + luminance(split.transmittance), 1e-20);
  return split;
}

// Returns the half vector in the upper hemisphere, not normalized; for refraction if wi.z < 0 (eq. 13 and 16).
vec3 dielectricHalf(DielectricLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + (wi.z > 0.0 ? 1.0 : lobe.eta) * wi;
  return h.z < 0.0 ? -h : h;
}

vec3 dielectricEval(DielectricLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = dielectricHalf(lobe, wo, wi);
  float h2 = dot(h, h);
  float cosO = dot(wo, h) * inversesqrt(h2);
  float cosI = dot(wi, h) * inversesqrt(h2);
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  DielectricSplit split = dielectricSplit(lobe, cosO);
  // eq. 21 times cos_i. The scaling of radiance cancels eta^2.
  float masking = ggxMasking(wo.z, lobe.alpha) * ggxMasking(-wi.z, lobe.alpha);
  float refraction = d * masking * cosO * -cosI / (wo.z * h2);
  vec3 reflected = ggxReflection(d, wo.z, wi.z, lobe.alpha) * split.reflectance;
  vec3 refracted = cosO > 0.0 && cosI < 0.0 ? refraction * split.transmittance : vec3(0.0);
  return wi.z > 0.0 ? reflected : refracted;
}

// m: sampled by ggxSample with bound 1. `u` chooses between reflection and refraction (eq. 39 and 40).
vec3 dielectricSample(DielectricLobe lobe, vec3 wo, vec3 m, float u) {
  float cosine = dot(wo, m);
  return u < dielectricSplit(lobe, cosine).reflectProbability ? reflect(-wo, m) : refract(-wo, m, 1.0 / lobe.eta);
}

float dielectricPdf(DielectricLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = dielectricHalf(lobe, wo, wi);
  float h2 = dot(h, h);
  float cosO = dot(wo, h) * inversesqrt(h2);
  float cosI = dot(wi, h) * inversesqrt(h2);
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  float probability = dielectricSplit(lobe, cosO).reflectProbability;
  float density = ggxReflectionPdf(d, wo.z, lobe.alpha, 1.0);  // multiply by 4 (wo.m) for the density over m
  float jacobian = lobe.eta * lobe.eta * -cosI / h2;           // eq. 17
  float refracted = cosO > 0.0 && cosI < 0.0 ? 4.0 * cosO * density * jacobian * (1.0 - probability) : 0.0;
  return wi.z > 0.0 ? density * probability : refracted;
}

#endif
