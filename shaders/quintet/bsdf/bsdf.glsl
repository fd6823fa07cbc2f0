// SPDX-License-Identifier: Apache-2.0
// The BSDF of glTF 2.0's metallic-roughness material with KHR_materials_transmission, _volume, _ior, _specular,
// _clearcoat, _sheen, _diffuse_transmission, _anisotropy, _iridescence and _dispersion: a sum of lobes. lobes.glsl lists
// them; this file evaluates and samples the sum.
//
// Contract of this file and of every lobe:
// - Directions are unit vectors in a local frame whose z is the shading normal on the side of wo, so wo.z > 0. Both point
//   away from the surface. Light arrives from wi and leaves to wo.
// - eval returns f(wo, wi) |cos wi|. pdf is the density of wi per solid angle. sample takes numbers in [0,1).
// - f transports radiance: refraction into a solid scales it by (index at wo / index at wi)^2.
// - Lobes narrower than kDeltaAlpha are deltas. They can be sampled only; eval and pdf leave them out.
// - The micronormal is sampled once, here, and passed to the sample functions of the microfacet lobes. These may return a
//   direction on the wrong side of the surface; the sample is then rejected.
// - Lobes have no branches, so that compilers compute terms that lobes share only once.
#ifndef QUINTET_BSDF_BSDF_GLSL
#define QUINTET_BSDF_BSDF_GLSL

#include "../explain_hooks.glsl"
#include "lobes.glsl"
#include "local_frame.glsl"

struct BsdfSample {
  vec3 wi;
  vec3 weight;       // f |cos wi| / pdf
  float pdf;         // of all lobes together; 0 for a delta
  bool delta;
  bool transmitted;  // wi is on the other side
  bool straight;     // wi = -wo, through a pane: the path continues and only its throughput changes
};

// Returns true if a lobe is not a delta, so that light sampling is useful.
bool bsdfHasSmooth(Bsdf b) {
  bool smoothLobe = false;
  for (int i = 0; i < kLobeCount; ++i) smoothLobe = smoothLobe || (b.lobeProbability[i] > 0.0 && !lobeIsDelta(b, i));
  return smoothLobe;
}

vec3 bsdfEval(Bsdf b, vec3 wo, vec3 wi) { return lobesEval(b, wo, wi); }

// Returns the part of bsdfEval that the diffuse lobe contributes.
vec3 bsdfEvalDiffuse(Bsdf b, vec3 wi) {
  float passed = kHasSheen ? b.underCoat * sheenScaleDiffuse(b.sheen, wi) : b.underCoat;
  return passed * diffuseEval(b.diffuse, wi, baseTerms(b, wi));
}

float bsdfPdf(Bsdf b, vec3 wo, vec3 wi) {
  float pdf[kLobeCount];
  lobePdfs(b, wo, wi, pdf);
  float density = 0.0;
  for (int i = 0; i < kLobeCount; ++i) density += b.lobeProbability[i] * pdf[i];
  // For half vectors of length 0 (wi = -wo) the result depends on the device. The density is 0 there.
  return density > 0.0 && density < 1e30 ? density : 0.0;
}

// Returns the weight of passing straight through a pane, a smooth thin wall, without the event's probability; 0 for all
// other surfaces. Shadow rays multiply the light by the same number.
vec3 bsdfStraight(Bsdf b, float cosine) {
  return lobesPassLayers(b, vec3(0.0, 0.0, -cosine)) * transmissionStraight(b.transmission, cosine);
}

// A lobe chosen by a random number.
struct LobeChoice {
  int lobe;
  float probability;
  float u;  // the random number's position in the lobe's interval, uniform in [0,1): chooses within the lobe
};

// If rounding keeps the sum of the probabilities at or below u, the last lobe is chosen that is possible or diffuse.
LobeChoice chooseLobe(Bsdf b, float u) {
  LobeChoice choice = LobeChoice(kLobeDiffuse, 0.0, 0.0);
  float sum = 0.0;
  float before = 0.0;  // sum of the probabilities of the lobes before the chosen one
  for (int i = 0; i < kLobeCount; ++i) {
    if (lobeInScene(i) && u >= sum && (b.lobeProbability[i] > 0.0 || i == kLobeDiffuse)) {
      choice.lobe = i;
      choice.probability = b.lobeProbability[i];
      before = sum;
    }
    sum += b.lobeProbability[i];
  }
  choice.u = (u - before) / choice.probability;
  return choice;
}

// Samples a direction. For a delta the sample is then complete; otherwise bsdfFinish adds weight and pdf. The two steps
// allow a program to evaluate this direction and a light's in one loop: compilers that inline the evaluation then compile
// it once. Returns false if the direction contributes nothing.
bool bsdfSampleDirection(Bsdf b, vec3 wo, float uLobe, vec2 u, out BsdfSample s) {
  LobeChoice choice = chooseLobe(b, uLobe);
  explainLobe(choice.lobe, choice.probability);
  s.delta = lobeIsDelta(b, choice.lobe);

  Microfacets facets = lobeMicrofacets(b, choice.lobe);
  mat3 basis = kLobesShareNormal ? mat3(1.0) : localFrame(facets.normal);
  vec3 o = wo * basis;
  float bound = facets.bounded ? ggxBound(o, facets.alpha) : 1.0;
  vec3 m = s.delta ? facets.normal : basis * ggxSample(o, facets.alpha, bound, u);

  s.wi = lobeSample(b, choice.lobe, wo, m, choice.u, u);
  s.transmitted = lobeTransmits(b, choice.lobe, s.wi, m);
  s.straight = lobePassesStraight(b, choice.lobe);
  s.pdf = 0.0;
  s.weight = s.delta ? lobeDeltaWeight(b, choice.lobe, dot(wo, m), s.wi, s.transmitted) / choice.probability : vec3(0.0);
  // A microfacet may reflect below the surface (or below the clearcoat's), or refract above it.
  return s.transmitted ? s.wi.z < 0.0 : min(s.wi.z, dot(s.wi, facets.normal)) > 0.0;
}

// Completes a sample that is not a delta with f |cos wi| and the density of its direction.
void bsdfFinish(inout BsdfSample s, vec3 f, float density) {
  s.pdf = density;
  s.weight = f / density;
}

// Returns true if the weight is positive and finite.
bool bsdfUseful(BsdfSample s) {
  float size = s.weight.x + s.weight.y + s.weight.z;
  return size > 0.0 && size < 1e30;
}

// Samples the sum of the lobes. Returns false if the sample contributes nothing.
bool bsdfSample(Bsdf b, vec3 wo, float uLobe, vec2 u, out BsdfSample s) {
  if (!bsdfSampleDirection(b, wo, uLobe, u, s)) return false;
  if (!s.delta) bsdfFinish(s, bsdfEval(b, wo, s.wi), bsdfPdf(b, wo, s.wi));
  return bsdfUseful(s);
}

#endif
