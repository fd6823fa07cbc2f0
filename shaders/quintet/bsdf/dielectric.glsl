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

// Returns albedoGlass for an anisotropic surface, which would need a table of five dimensions: the mean over 40 visible
// micronormals, with Gauss-Legendre quadrature along the axis of their cap (as in src/render/scene/albedo_tables.cpp).
vec2 anisotropicGlass(vec3 wo, vec2 alpha, float eta) {
  const float rests[5] = float[5](0.04691008, 0.23076534, 0.5, 0.76923466, 0.95308992);
  const float weights[5] = float[5](0.23692689, 0.47862867, 0.56888889, 0.47862867, 0.23692689);
  float stretchO = ggxStretch(wo, alpha);
  vec3 axis = vec3(alpha * wo.xy, wo.z) / stretchO;
  vec2 sum = vec2(0.0);
  for (int i = 0; i < 40; ++i) {
    int ring = i / 8;
    float z = 1.0 - (1.0 - rests[ring] * rests[ring]) * (1.0 + axis.z);
    float r = sqrt(max(1.0 - z * z, 0.0));
    float phi = 2.0 * kPi * (float(i % 8) + 0.5) / 8.0;
    vec3 onCap = axis + vec3(r * cos(phi), r * sin(phi), z);
    vec3 m = normalize(vec3(alpha * onCap.xy, max(onCap.z, 1e-6)));
    float fresnel = fresnelDielectric(dot(wo, m), eta);
    vec3 mirrored = reflect(-wo, m), bent = refract(-wo, m, 1.0 / eta);
    float shadowing = mirrored.z * (wo.z + stretchO) / (wo.z * ggxStretch(mirrored, alpha) + mirrored.z * stretchO);
    float reflected = mirrored.z > 0.0 ? shadowing : 0.0;
    float refracted = bent.z < 0.0 ? ggxMasking(vec3(bent.xy, -bent.z), alpha) : 0.0;
    float other = fresnel < 1.0 ? refracted : reflected;
    sum += weights[ring] * rests[ring] / 8.0 * vec2(mix(other, reflected, fresnel), other);
  }
  return max(sum, vec2(1e-3));
}

struct DielectricLobe {
  vec3 color;          // of transmission, times compensation
  vec3 f0;             // with the material's specularColor, without its specular
  float specular;      // scales all reflection except total reflection
  Film film;           // replaces a part of the reflectance
  float compensation;  // of reflection
  float eta;           // index on the side of wi over the side of wo, for refraction
  vec2 alpha;
};

// `glass`: albedoGlass at wo, or 1 if the lobe is a delta.
DielectricLobe makeDielectric(BaseLayer base, vec2 glass) {
  DielectricLobe lobe;
  lobe.compensation = base.clear / mix(glass.y, glass.x, base.specular);
  lobe.color = lobe.compensation * (base.bends ? 1.0 : base.passed) * base.color;
  lobe.f0 = base.clearF0;
  lobe.specular = base.bends ? base.specular : 0.0;
  lobe.film = base.film;
  lobe.eta = base.intoDenser ? base.ior : 1.0 / base.ior;
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
  if (kHasIridescence && lobe.film.weight > 0.0) {
    // The film reflects light from both sides alike. Its reflectance depends on the angle outside.
    float inside2 = 1.0 - (1.0 - cosine * cosine) / (lobe.eta * lobe.eta);
    float outside = lobe.eta < 1.0 ? sqrt(max(inside2, 0.0)) : cosine;
    f = mix(f, lobe.specular * filmReflectance(lobe.film, outside, lobe.f0), lobe.film.weight);
  }
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
  float d = ggxDistribution(h, lobe.alpha);
  DielectricSplit split = dielectricSplit(lobe, cosO);
  // eq. 21 times cos_i. The scaling of radiance cancels eta^2.
  float masking = ggxMasking(wo, lobe.alpha) * ggxMasking(vec3(wi.xy, -wi.z), lobe.alpha);
  float refraction = d * masking * cosO * -cosI / (wo.z * h2);
  vec3 reflected = ggxReflection(d, wo, wi, lobe.alpha) * split.reflectance;
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
  float d = ggxDistribution(h, lobe.alpha);
  float probability = dielectricSplit(lobe, cosO).reflectProbability;
  float density = ggxReflectionPdf(d, wo, lobe.alpha, 1.0);  // multiply by 4 (wo.m) for the density over m
  float jacobian = lobe.eta * lobe.eta * -cosI / h2;           // eq. 17
  float refracted = cosO > 0.0 && cosI < 0.0 ? 4.0 * cosO * density * jacobian * (1.0 - probability) : 0.0;
  return wi.z > 0.0 ? density * probability : refracted;
}

#endif
