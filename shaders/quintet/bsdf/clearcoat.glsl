// SPDX-License-Identifier: Apache-2.0
// Clearcoat lobe: a clear layer over all other lobes (KHR_materials_clearcoat). GGX with f0 = 0.04 around its own normal.
// The lobes below are scaled by 1 - weight E(wo), where E is the coat's albedo. The extension's formula uses Fresnel at
// the normal instead of E; with E no energy is lost or gained for rough coats. The factor depends on wo alone, so it is
// not reciprocal.
#ifndef QUINTET_BSDF_CLEARCOAT_GLSL
#define QUINTET_BSDF_CLEARCOAT_GLSL

#include "albedo.glsl"
#include "fresnel.glsl"
#include "ggx.glsl"

const float kClearcoatF0 = 0.04;

struct ClearcoatLobe {
  vec3 normal;   // in the local frame of the shading normal
  float weight;  // 0 means no coat on this side
  float alpha;
  bool delta;
};

float clearcoatFresnel(ClearcoatLobe lobe, float cosine) {
  return lobe.weight * mix(kClearcoatF0, 1.0, schlickWeight(cosine));
}

// Returns the fraction of light from wo that the coat reflects.
float clearcoatAlbedo(ClearcoatLobe lobe, vec3 wo) {
  float cosine = dot(wo, lobe.normal);
  vec2 lb = albedoSchlick(albedoRow(lobe.alpha), cosine);
  return lobe.delta ? clearcoatFresnel(lobe, cosine) : lobe.weight * albedoSingle(vec3(kClearcoatF0), 1.0, lb).x;
}

// `alpha`: clearcoatRoughness squared. `coated`: this side has a coat.
ClearcoatLobe makeClearcoat(vec3 normal, float weight, float alpha, bool coated) {
  return ClearcoatLobe(normal, coated ? weight : 0.0, max(alpha, kDeltaAlpha), alpha < kDeltaAlpha);
}

// Returns the fraction 1 - E of emitted light that passes the coat, at `cosine` to the normal. So a coated black body
// emits as much as it absorbs (Kirchhoff's law). It is the same factor as for all light from below (Bsdf::underCoat).
float clearcoatPassed(float weight, float alpha, float cosine) {
  ClearcoatLobe lobe = makeClearcoat(vec3(0.0, 0.0, 1.0), weight, alpha, true);
  return 1.0 - clearcoatAlbedo(lobe, vec3(0.0, 0.0, cosine));
}

float clearcoatDistribution(ClearcoatLobe lobe, vec3 h) {
  float cosine = dot(h, lobe.normal);
  vec3 sine = cross(h, lobe.normal);
  return ggxDistribution(cosine * cosine, dot(sine, sine), lobe.alpha);
}

float clearcoatEval(ClearcoatLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + wi;
  float cosI = dot(wi, lobe.normal);
  float f = ggxReflection(clearcoatDistribution(lobe, h), dot(wo, lobe.normal), cosI, lobe.alpha);
  return cosI > 0.0 && wi.z > 0.0 ? f * clearcoatFresnel(lobe, 0.5 * length(h)) : 0.0;
}

// m: sampled in the frame of the coat's normal by ggxSample with the bound ggxBound.
vec3 clearcoatSample(ClearcoatLobe lobe, vec3 wo, vec3 m) { return reflect(-wo, m); }

float clearcoatPdf(ClearcoatLobe lobe, vec3 wo, vec3 wi) {
  float cosO = dot(wo, lobe.normal);
  float d = clearcoatDistribution(lobe, wo + wi);
  return dot(wi, lobe.normal) > 0.0 && wi.z > 0.0 ? ggxReflectionPdf(d, cosO, lobe.alpha, ggxBound(cosO, lobe.alpha)) : 0.0;
}

#endif
