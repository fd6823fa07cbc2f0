// SPDX-License-Identifier: Apache-2.0
// Transmission lobe. A solid refracts and reflects (dielectric.glsl); a thin wall transmits without refraction (thin.glsl).
// A smooth thin wall is a pane: light passes it straight on.
#ifndef QUINTET_BSDF_TRANSMISSION_GLSL
#define QUINTET_BSDF_TRANSMISSION_GLSL

#include "../features.glsl"
#include "dielectric.glsl"
#include "thin.glsl"

struct TransmissionLobe {
  ThinLobe thin;
  DielectricLobe dielectric;
  bool refractive;  // selects `dielectric`; otherwise `thin`
  bool delta;
};

// `albedo`: estimate of the lobe's albedo, for the choice of a lobe.
TransmissionLobe makeTransmission(BaseLayer base, vec3 wo, out float albedo) {
  TransmissionLobe lobe;
  lobe.refractive = base.refractive;
  lobe.thin = makeThin(base);
  // Refraction between nearly equal indices is too narrow for its half vector. It counts as a delta.
  lobe.delta = base.delta || (base.refractive && (base.ior < 1.01 || base.alpha.y * (base.ior - 1.0) < 1e-5));
  vec2 glass = vec2(1.0);
  if (base.refractive && !lobe.delta) glass = albedoGlass(wo.z, ggxMeanWidth(base.alpha), base.ior, base.intoDenser);
  if (base.refractive && !lobe.delta && base.roughness.anisotropic)
    glass = anisotropicGlass(wo, base.alpha, base.intoDenser ? base.ior : 1.0 / base.ior);
  lobe.dielectric = makeDielectric(base, glass);
  float tint = luminance(base.color);
  float glassAlbedo = mix(tint, 1.0, max(fresnelDielectric(wo.z, lobe.dielectric.eta), 0.1));
  albedo = kHasTransmission ? base.underCoat * base.clear * (base.bends ? glassAlbedo : tint * base.passed) : 0.0;
  return lobe;
}

// `lb`: layerTerms at |wi.z|.
vec3 transmissionEval(TransmissionLobe lobe, vec3 wo, vec3 wi, vec3 lb) {
  vec3 f = vec3(0.0);
  if (kHasSolidTransmission) f = dielectricEval(lobe.dielectric, wo, wi);
  if (kHasThinTransmission) f = lobe.refractive ? f : thinEval(lobe.thin, wo, wi, lb);
  return f;
}

float transmissionPdf(TransmissionLobe lobe, vec3 wo, vec3 wi) {
  float density = 0.0;
  if (kHasSolidTransmission) density = dielectricPdf(lobe.dielectric, wo, wi);
  if (kHasThinTransmission) density = lobe.refractive ? density : thinPdf(lobe.thin, wo, wi);
  return density;
}

// m: sampled by ggxSample; with bound 1 if refractive, else with ggxBound. uPart chooses reflection or refraction, or
// single or multiple scattering.
vec3 transmissionSample(TransmissionLobe lobe, vec3 wo, vec3 m, float uPart, vec2 u) {
  return lobe.refractive ? dielectricSample(lobe.dielectric, wo, m, uPart) : thinSample(lobe.thin, wo, m, uPart, u);
}

// Returns true if the sampled wi is on the other side of the surface.
bool transmissionTransmits(TransmissionLobe lobe, vec3 wi, vec3 m) { return !lobe.refractive || dot(wi, m) < 0.0; }

bool transmissionIsPane(TransmissionLobe lobe) { return kHasPanes && !lobe.refractive && lobe.delta; }

// Returns the fraction of light that passes a pane straight on, without the probability of the event; 0 for all other
// surfaces.
vec3 transmissionStraight(TransmissionLobe lobe, float cosine) {
  return transmissionIsPane(lobe) ? thinTransmittance(lobe.thin, cosine) : vec3(0.0);
}

// Returns f |cos wi| / pdf of a delta, without the probability of the lobe.
vec3 transmissionDeltaWeight(TransmissionLobe lobe, float cosine, bool transmitted) {
  if (!kHasSolidTransmission || !lobe.refractive) return transmissionStraight(lobe, cosine);
  DielectricSplit split = dielectricSplit(lobe.dielectric, cosine);
  return transmitted ? split.transmittance / (lobe.dielectric.eta * lobe.dielectric.eta * (1.0 - split.reflectProbability))
                     : split.reflectance / split.reflectProbability;
}

#endif
