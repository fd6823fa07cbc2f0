// SPDX-License-Identifier: Apache-2.0
// The list of lobes: their indices, the material's parameters, the lobes for one wo, and the functions that dispatch to
// a lobe. Each function has one line per lobe. bsdf.glsl works on this list and names no lobe.
// To add a lobe: docs/design/path-tracer.md, "How to add a lobe".
#ifndef QUINTET_BSDF_LOBES_GLSL
#define QUINTET_BSDF_LOBES_GLSL

#include "../features.glsl"
#include "clearcoat.glsl"
#include "diffuse.glsl"
#include "diffuse_transmission.glsl"
#include "sheen.glsl"
#include "specular.glsl"
#include "transmission.glsl"

const int kLobeClearcoat = 0;
const int kLobeSpecular = 1;
const int kLobeDiffuse = 2;
const int kLobeTransmission = 3;
const int kLobeSheen = 4;
const int kLobeDiffuseTransmission = 5;
const int kLobeCount = 6;

// Bits of the lobes; 0 for those that no material of the scene has. The compiler then removes their code.
const uint kLobesInScene = uint(kHasClearcoat) << kLobeClearcoat | 1u << kLobeSpecular | 1u << kLobeDiffuse |
                           uint(kHasTransmission) << kLobeTransmission | uint(kHasSheen) << kLobeSheen |
                           uint(kHasDiffuseTransmission) << kLobeDiffuseTransmission;
bool lobeInScene(int lobe) { return (kLobesInScene & 1u << lobe) != 0u; }
// True if all lobes have the normal z.
const bool kLobesShareNormal = !kHasClearcoat;

// Colors and factors are linear and in [0,1] unless the comment says otherwise.
struct BsdfParameters {
  vec3 baseColor;
  float metallic;
  float alpha;           // roughness squared; GGX width along y
  float transmission;
  float ior;             // relative to the medium outside, above 0; 0 means that the reflectance is specular * specularColor
  bool entering;         // wo is on the outside
  bool thin;             // a thin wall, not a solid: transmission does not refract
  float specular;
  vec3 specularColor;    // at least 0
  float clearcoat;
  float clearcoatAlpha;  // clearcoatRoughness squared
  vec3 clearcoatNormal;  // unit, in the local frame
  vec3 sheenColor;
  float sheenAlpha;      // sheenRoughness squared
  float diffuseTransmission;
  vec3 diffuseTransmissionColor;
  float anisotropy;      // strength; x of the local frame is the direction of the larger width
  float iridescence;           // weight of the thin film
  float iridescenceIor;        // of the film, at least 1
  float iridescenceThickness;  // of the film, nanometers
  float dispersion;            // 20 / Abbe number
  vec3 transmitted;            // scales transmitted light: 1, or 3 for one channel and 0 for the others (dispersion.glsl)
};

// Returns true if light can pass the surface.
bool bsdfTransmits(BsdfParameters p) {
  return (kHasTransmission && p.transmission > 0.0) || (kHasDiffuseTransmission && p.diffuseTransmission > 0.0);
}

// The lobes of a material for one wo.
struct Bsdf {
  ClearcoatLobe clearcoat;
  SpecularLobe specular;
  DiffuseLobe diffuse;
  TransmissionLobe transmission;
  SheenLobe sheen;
  DiffuseTransmissionLobe diffuseTransmission;
  float lobeProbability[kLobeCount];  // of sampling each lobe; the sum is 1, or 0 for a black surface
  AlbedoRoughness roughness;          // of the base
  AlbedoFilm filmExtra;               // reflectance that a film adds to the base's layer
  vec3 transmitted;                   // scales transmitted light
  float underCoat;                    // fraction of light that passes the clearcoat
};

// Adds the film to the terms of the layer: the reflectance at the nodes of the tables, and the averages.
void addFilm(inout BaseLayer base, vec3 wo) {
  vec3 layerMean = vec3(0.0), metalMean = vec3(0.0);
  float weights = 0.0;
  for (uint k = 0u; k < kFilmNodes; ++k) {
    float root = float(k) / float(kFilmNodes - 1u);
    float cosine = root * root;
    float schlick = schlickWeight(cosine);
    vec3 layer = base.specular * filmReflectance(base.film, cosine, base.clearF0);
    float extra = base.film.weight * (maxComponent(layer) - mix(base.f0, base.specular, schlick));
    if (k < 4u) base.filmExtra.low[k] = extra;
    else base.filmExtra.high[k - 4u] = extra;
    // Cosine-weighted integral of the node's part of the piecewise linear reflectance; the parts add up to 1.
    float step = 1.0 / float(kFilmNodes - 1u);
    float weight = k + 1u < kFilmNodes ? 4.0 * step * (root * root * root + 0.5 * root * step * step) : 1.0 - weights;
    weights += weight;
    layerMean += weight * layer;
    if (base.metallic > 0.0) metalMean += weight * filmReflectance(base.film, cosine, base.color);
  }
  base.colorMultiple = mix(base.colorMultiple, multipleFactor(layerMean, base.average.x), base.film.weight);
  base.metalMultiple = mix(base.metalMultiple, multipleFactor(metalMean, base.average.x), base.film.weight);
  float alpha = ggxMeanWidth(base.alpha);
  float layerAtO = base.specular * maxComponent(filmReflectance(base.film, wo.z, base.clearF0));
  float extraAtO = base.film.weight * (layerAtO - mix(base.f0, base.specular, schlickWeight(wo.z)));
  base.lb.z = base.delta ? extraAtO : albedoFilm(base.filmExtra, alpha, wo.z);
  base.average.z = albedoFilmAverage(base.filmExtra, alpha);
}

// Returns the shared terms of the base, except underCoat.
BaseLayer makeBaseLayer(BsdfParameters p, vec3 wo) {
  BaseLayer base;
  float dielectric = 1.0 - p.metallic;
  float transmission = kHasTransmission ? p.transmission : 0.0;
  base.color = clamp(p.baseColor, 0.0, 1.0);
  base.metallic = p.metallic;
  base.opaque = dielectric * (1.0 - transmission);
  base.translucent = kHasDiffuseTransmission ? base.opaque * p.diffuseTransmission : 0.0;
  base.diffuse = kHasDiffuseTransmission ? base.opaque * (1.0 - p.diffuseTransmission) : base.opaque;
  base.clear = dielectric * transmission;
  vec2 alpha = ggxWidths(p.alpha, p.anisotropy);
  base.alpha = max(alpha, vec2(kDeltaAlpha));
  base.delta = alpha.x < kDeltaAlpha;  // the larger width
  base.entering = p.entering;
  bool rarer = kHasNestedMedia && p.ior > 0.0 && p.ior < 1.0;  // than the medium outside
  base.ior = rarer ? 1.0 / p.ior : max(p.ior, 1.0);
  base.intoDenser = p.entering != rarer;
  base.refractive = kHasSolidTransmission && base.clear > 0.0 && !(kHasThinTransmission && p.thin);
  // The specular lobe reflects for the metal and for the part of the dielectric that DielectricLobe does not cover. With
  // ior 0, DielectricLobe reflects and bends nothing: what the layer does not reflect passes straight on.
  base.bends = base.refractive && p.ior > 0.0;
  base.solid = kHasSolidTransmission && !p.thin && base.clear + base.translucent > 0.0;
  base.reflecting = base.bends ? base.opaque : dielectric;

  // KHR_materials_specular: reflectance of the dielectric part.
  base.specular = p.specular;
  base.clearF0 = min(reflectanceFromIor(p.ior) * p.specularColor, 1.0);
  base.colorF0 = p.specular * base.clearF0;
  base.f0 = maxComponent(base.colorF0);

  base.roughness = albedoRoughness(base.alpha);
  float schlick = schlickWeight(wo.z);
  base.lb = vec3(base.delta ? vec2(0.0, schlick) : albedoSchlick(base.roughness, wo), 0.0);
  base.average = vec3(albedoAverage(base.roughness), 0.0);
  base.colorMultiple = multipleFactor(base.colorF0, p.specular, base.average.x);
  base.metalMultiple = multipleFactor(base.color, 1.0, base.average.x);
  base.film = makeFilm(p.iridescence, p.iridescenceIor, p.iridescenceThickness);
  base.filmExtra = AlbedoFilm(vec4(0.0), vec4(0.0));
  if (kHasIridescence && base.film.weight > 0.0) addFilm(base, wo);
  base.layerMultiple = maxComponent(base.colorMultiple);
  base.passing = layerPassing(base.f0, p.specular, base.layerMultiple);
  base.passed = layerPassed(base.passing, base.lb);
  return base;
}

// The probability of a lobe is proportional to an estimate of its albedo.
Bsdf makeBsdf(BsdfParameters p, vec3 wo) {
  BaseLayer base = makeBaseLayer(p, wo);
  Bsdf b;
  // The clearcoat of a solid is on its outside only.
  bool coated = dot(wo, p.clearcoatNormal) > 0.0 && (p.entering || !base.solid);
  b.clearcoat = makeClearcoat(p.clearcoatNormal, p.clearcoat, p.clearcoatAlpha, coated);
  float coat = kHasClearcoat ? clearcoatAlbedo(b.clearcoat, wo) : 0.0;
  b.underCoat = 1.0 - coat;
  b.roughness = base.roughness;
  b.filmExtra = base.filmExtra;
  b.transmitted = kHasDispersion ? p.transmitted : vec3(1.0);
  float sheen = 0.0;
  if (kHasSheen) b.sheen = makeSheen(base, p.sheenColor, p.sheenAlpha, wo.z, sheen);
  base.underCoat = kHasSheen ? b.underCoat * b.sheen.passed : b.underCoat;

  b.lobeProbability[kLobeClearcoat] = coat;
  b.specular = makeSpecular(base, wo.z, b.lobeProbability[kLobeSpecular]);
  b.diffuse = makeDiffuse(base, b.lobeProbability[kLobeDiffuse]);
  b.transmission = makeTransmission(base, wo, b.lobeProbability[kLobeTransmission]);
  b.lobeProbability[kLobeSheen] = b.underCoat * sheen;
  b.lobeProbability[kLobeDiffuseTransmission] = 0.0;
  if (kHasDiffuseTransmission) {
    vec3 color = clamp(p.diffuseTransmissionColor, 0.0, 1.0);
    b.diffuseTransmission = makeDiffuseTransmission(base, color, b.lobeProbability[kLobeDiffuseTransmission]);
  }

  float sum = 0.0;
  for (int i = 0; i < kLobeCount; ++i) sum += b.lobeProbability[i];
  float scale = sum > 0.0 ? 1.0 / sum : 0.0;
  for (int i = 0; i < kLobeCount; ++i) b.lobeProbability[i] *= scale;
  return b;
}

// Returns layerTerms of the base at wi, on either side.
vec3 baseTerms(Bsdf b, vec3 wi) { return layerTerms(b.roughness, b.filmExtra, vec3(wi.xy, abs(wi.z))); }

// Returns true if `lobe` is `which`; false at once for lobes that no material of the scene has.
bool isLobe(int lobe, int which) { return lobeInScene(which) && lobe == which; }

bool lobeIsDelta(Bsdf b, int lobe) {
  if (isLobe(lobe, kLobeClearcoat)) return b.clearcoat.delta;
  if (lobe == kLobeSpecular) return b.specular.delta;
  return isLobe(lobe, kLobeTransmission) && b.transmission.delta;
}

// Returns f |cos wi| of all lobes that are not deltas.
vec3 lobesEval(Bsdf b, vec3 wo, vec3 wi) {
  vec3 lb = baseTerms(b, wi);
  vec3 transmission = transmissionEval(b.transmission, wo, wi, lb);
  float scale = kHasSheen ? sheenScale(b.sheen, wi) : 1.0;
  vec3 base = diffuseEval(b.diffuse, wi, lb);
  if (kHasDiffuseTransmission) base += diffuseTransmissionEval(b.diffuseTransmission, wi, lb);
  if (kHasSheen) base *= sheenScaleDiffuse(b.sheen, wi);
  base += b.specular.delta ? vec3(0.0) : scale * specularEval(b.specular, wo, wi, lb);
  if (kHasTransmission) base += b.transmission.delta ? vec3(0.0) : scale * transmission;
  if (kHasDispersion) base *= wi.z < 0.0 ? b.transmitted : vec3(1.0);
  if (kHasSheen) base += sheenEval(b.sheen, wo, wi);
  if (!kHasClearcoat) return base;
  float coat = b.clearcoat.delta || b.clearcoat.weight == 0.0 ? 0.0 : clearcoatEval(b.clearcoat, wo, wi);
  return vec3(coat) + b.underCoat * base;
}

// Computes the density of wi for each lobe; 0 for deltas.
void lobePdfs(Bsdf b, vec3 wo, vec3 wi, out float pdf[kLobeCount]) {
  pdf[kLobeClearcoat] = !kHasClearcoat || b.clearcoat.delta || b.clearcoat.weight == 0.0 ? 0.0 : clearcoatPdf(b.clearcoat, wo, wi);
  pdf[kLobeSpecular] = b.specular.delta ? 0.0 : specularPdf(b.specular, wo, wi);
  pdf[kLobeDiffuse] = diffusePdf(wi);
  float transmission = transmissionPdf(b.transmission, wo, wi);
  pdf[kLobeTransmission] = b.transmission.delta ? 0.0 : transmission;
  pdf[kLobeSheen] = kHasSheen ? sheenPdf(wi) : 0.0;
  pdf[kLobeDiffuseTransmission] = kHasDiffuseTransmission ? diffuseTransmissionPdf(wi) : 0.0;
}

// The microfacets of a lobe. bsdf.glsl samples their normal once for all lobes, because ggxSample is expensive.
struct Microfacets {
  vec3 normal;   // unit, in the local frame
  vec2 alpha;
  bool bounded;  // sample with ggxBound instead of bound 1
};

Microfacets lobeMicrofacets(Bsdf b, int lobe) {
  bool coat = isLobe(lobe, kLobeClearcoat);
  return Microfacets(coat ? b.clearcoat.normal : vec3(0.0, 0.0, 1.0), coat ? vec2(b.clearcoat.alpha) : b.specular.alpha,
                     !(isLobe(lobe, kLobeTransmission) && b.transmission.refractive));
}

// Returns a direction of the lobe. m is its micronormal; uPart is uniform in [0,1) and independent of u and m.
vec3 lobeSample(Bsdf b, int lobe, vec3 wo, vec3 m, float uPart, vec2 u) {
  if (isLobe(lobe, kLobeTransmission)) return transmissionSample(b.transmission, wo, m, uPart, u);
  if (isLobe(lobe, kLobeClearcoat)) return clearcoatSample(b.clearcoat, wo, m);
  if (isLobe(lobe, kLobeSheen)) return sheenSample(u);
  if (isLobe(lobe, kLobeDiffuseTransmission)) return diffuseTransmissionSample(u);
  return lobe == kLobeDiffuse ? diffuseSample(u) : specularSample(b.specular, wo, m, uPart, u);
}

// Returns true if the sampled wi is on the other side of the surface.
bool lobeTransmits(Bsdf b, int lobe, vec3 wi, vec3 m) {
  return isLobe(lobe, kLobeDiffuseTransmission) ||
         (isLobe(lobe, kLobeTransmission) && transmissionTransmits(b.transmission, wi, m));
}

// Returns true if the lobe lets light pass straight on through a pane.
bool lobePassesStraight(Bsdf b, int lobe) { return isLobe(lobe, kLobeTransmission) && transmissionIsPane(b.transmission); }

// Returns the fraction of light that passes the layers over the specular and transmission lobes, on its way from wi to wo.
float lobesPassLayers(Bsdf b, vec3 wi) { return kHasSheen ? b.underCoat * sheenScale(b.sheen, wi) : b.underCoat; }

// Returns f |cos wi| / pdf of a delta, without the lobe's probability. cosine = dot(wo, normal of the lobe).
vec3 lobeDeltaWeight(Bsdf b, int lobe, float cosine, vec3 wi, bool transmitted) {
  if (isLobe(lobe, kLobeClearcoat)) return vec3(clearcoatFresnel(b.clearcoat, cosine));
  float passed = lobesPassLayers(b, wi);
  if (!kHasTransmission || lobe == kLobeSpecular) return passed * specularFresnel(b.specular, cosine);
  vec3 weight = passed * transmissionDeltaWeight(b.transmission, cosine, transmitted);
  return kHasDispersion && transmitted ? weight * b.transmitted : weight;
}

#endif
