// SPDX-License-Identifier: Apache-2.0
// Facts that a program states about its sample, for quintet explain-pixel: what it sampled, and the contributions whose
// sum is the sample's value. They are logged only in the instrumented variant (explain.glsl); in all other variants the
// macros are empty, and their arguments are not evaluated.
#ifndef QUINTET_EXPLAIN_HOOKS_GLSL
#define QUINTET_EXPLAIN_HOOKS_GLSL

#ifdef QUINTET_EXPLAIN_GLSL
#include "frame.glsl"

void explainCamera(vec2 lens, vec2 film) { explain_(ExplainCamera(film, lens)); }

void explainSurface(vec3 position, vec3 geometricNormal, vec3 shadingNormal, vec2 uv, uint material, bool frontFace) {
  explain_(ExplainSurface(position, geometricNormal, shadingNormal, uv, material, frontFace ? 1u : 0u));
}

void explainShading(vec3 normal, vec3 emission, vec3 baseColor, float metallic, float alpha, float transmission, float ior,
                    float clearcoat, vec3 sheenColor, float sheenAlpha, float diffuseTransmission, float anisotropy, float iridescence,
                    float iridescenceThickness, float dispersion, bool unlit) {
  explain_(ExplainShading(normal, emission, baseColor, metallic, alpha, transmission, ior, clearcoat, sheenColor, sheenAlpha,
                          diffuseTransmission, anisotropy, iridescence, iridescenceThickness, dispersion, unlit ? 1u : 0u));
}

void explainLobe(int lobe, float probability) { explain_(ExplainLobe(uint(lobe), probability)); }

void explainLightChoice(uint index, float probability) {
  ExplainLightChoice choice = ExplainLightChoice(index, 0u, 0u, 0u, 0u, 0.0);
  if (index != kNoLight) {
    const LightData light = LightArray(frame.lights).at[index];
    choice = ExplainLightChoice(index, light.type, light.instance, light.geometry, light.primitive, probability);
  }
  explain_(choice);
}

// For a light that can contribute.
void explainLightSample(bool delta, vec3 direction, float distance, vec3 radiance, float pdf, vec3 bsdf, float bsdfPdf, float weight,
                        vec3 throughput) {
  explain_(ExplainLightSample(delta ? 1u : 0u, direction, distance, radiance, pdf, bsdf, bsdfPdf, weight, throughput));
}

// The light sample of the last explainLightSample() is traced if u < survival. Without a call, it is traced.
void explainLightRoulette(float survival, float u) { explain_(ExplainLightRoulette(survival, u)); }

void explainVisibility(vec3 transmittance) { explain_(ExplainVisibility(transmittance)); }

void explainBsdfSample(bool useful, bool delta, bool transmitted, bool straight, vec3 direction, float pdf, vec3 weight) {
  if (useful)
    explain_(ExplainBsdfSample(1u, delta ? 1u : 0u, transmitted ? 1u : 0u, straight ? 1u : 0u, direction, pdf, weight));
  else
    explain_(ExplainBsdfSample(0u, 0u, 0u, 0u, vec3(0.0), 0.0, vec3(0.0)));
}

void explainRoulette(float survival, float u, vec3 throughput) { explain_(ExplainRoulette(survival, u, throughput)); }

float explainLightPdf_ = 0.0;
// The density with which light sampling finds the emitter of the next explainEmission(); default: 0.
void explainLightPdf(float pdf) { explainLightPdf_ = pdf; }
// `source`: kExplainFrom…; `weight`: of MIS
void explainEmission(uint source, vec3 radiance, vec3 throughput, float bsdfPdf, float weight) {
  explain_(ExplainEmission(source, radiance, throughput, bsdfPdf, explainLightPdf_, weight));
  explainLightPdf_ = 0.0;
}

vec3 explainUnclamped_ = vec3(0.0);
void explainUnclamped(vec3 contribution) { explainUnclamped_ = contribution; }
// `value` is added to the value of the sample; explainUnclamped() was called before.
void explainContribution(uint source, uint scatterings, vec3 value) {
  explain_(ExplainContribution(source, scatterings, value, explainUnclamped_));
}

// The path ends here if `ends` is true. `reason`: kExplainUnlit, kExplainBounces or kExplainInconsistent.
void explainEnd(bool ends, uint reason) {
  if (ends) explain_(ExplainPathEnd(reason));
}

// For estimators without MIS and clamping: an emitter that the path has found, and its contribution.
void explainFound(uint source, vec3 radiance, vec3 throughput, uint scatterings) {
  if (radiance == vec3(0.0)) return;
  explainEmission(source, radiance, throughput, 0.0, 1.0);
  explainUnclamped(throughput * radiance);
  explainContribution(source, scatterings, throughput * radiance);
}
#else
#define explainCamera(lens, film)
#define explainSurface(position, geometricNormal, shadingNormal, uv, material, frontFace)
#define explainShading(normal, emission, baseColor, metallic, alpha, transmission, ior, clearcoat, sheenColor, sheenAlpha, diffuseTransmission, anisotropy, iridescence, iridescenceThickness, dispersion, unlit)
#define explainLobe(lobe, probability)
#define explainLightChoice(index, probability)
#define explainLightSample(delta, direction, distance, radiance, pdf, bsdf, bsdfPdf, weight, throughput)
#define explainLightRoulette(survival, u)
#define explainVisibility(transmittance)
#define explainBsdfSample(useful, delta, transmitted, straight, direction, pdf, weight)
#define explainRoulette(survival, u, throughput)
#define explainLightPdf(pdf)
#define explainEmission(source, radiance, throughput, bsdfPdf, weight)
#define explainUnclamped(contribution)
#define explainContribution(source, scatterings, value)
#define explainEnd(ends, reason)
#define explainFound(source, radiance, throughput, scatterings)
#endif

#endif
