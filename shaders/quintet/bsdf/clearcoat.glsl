// Clear lacquer over everything else: GGX with f0 = 0.04 around a normal of its own (KHR_materials_clearcoat).
// What lies below is scaled by 1 - weight E(wo), E the coat's albedo: as the extension's formula, which takes
// Fresnel at the normal, with nothing lost or gained for rough coats; a factor of wo alone, not reciprocal.
#ifndef QUINTET_BSDF_CLEARCOAT_GLSL
#define QUINTET_BSDF_CLEARCOAT_GLSL

#include "albedo.glsl"
#include "fresnel.glsl"
#include "ggx.glsl"

const float kClearcoatF0 = 0.04;

struct ClearcoatLobe {
  vec3 normal;   // in the local frame of the shading normal
  float weight;  // 0: no coat on this side
  float alpha;
};

float clearcoatFresnel(ClearcoatLobe lobe, float cosine) {
  return lobe.weight * mix(kClearcoatF0, 1.0, schlickWeight(cosine));
}

// The part of light from wo that the coat reflects.
float clearcoatAlbedo(ClearcoatLobe lobe, vec3 wo, bool delta) {
  float cosine = dot(wo, lobe.normal);
  vec2 lb = albedoSchlick(albedoRow(lobe.alpha), cosine);
  return delta ? clearcoatFresnel(lobe, cosine) : lobe.weight * albedoSingle(vec3(kClearcoatF0), 1.0, lb).x;
}

// What light that the surface itself emits keeps on its way out: 1 - E, at `cosine` to the normal. So a coat over a
// black body emits as much as it absorbs (Kirchhoff's law), and as much as any light from below (bsdf underCoat).
float clearcoatPassed(float weight, float alpha, float cosine) {
  ClearcoatLobe lobe = ClearcoatLobe(vec3(0.0, 0.0, 1.0), weight, max(alpha, kDeltaAlpha));
  return 1.0 - clearcoatAlbedo(lobe, vec3(0.0, 0.0, cosine), alpha < kDeltaAlpha);
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

// m: drawn in the frame of the coat's normal by ggxSample with the bound ggxBound.
vec3 clearcoatSample(ClearcoatLobe lobe, vec3 wo, vec3 m) { return reflect(-wo, m); }

float clearcoatPdf(ClearcoatLobe lobe, vec3 wo, vec3 wi) {
  float cosO = dot(wo, lobe.normal);
  float d = clearcoatDistribution(lobe, wo + wi);
  return dot(wi, lobe.normal) > 0.0 && wi.z > 0.0 ? ggxReflectionPdf(d, cosO, lobe.alpha, ggxBound(cosO, lobe.alpha)) : 0.0;
}

#endif
