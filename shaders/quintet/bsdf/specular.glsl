// SPDX-License-Identifier: Apache-2.0
// Specular lobe: reflection by the base. GGX with Schlick's Fresnel, single and multiple scattering. Metals and
// dielectrics share the lobe, because both are linear in f0 and f90.
#ifndef QUINTET_BSDF_SPECULAR_GLSL
#define QUINTET_BSDF_SPECULAR_GLSL

#include "base.glsl"
#include "fresnel.glsl"
#include "multiple.glsl"

struct SpecularLobe {
  vec3 f0;
  float f90;
  Film film;                  // replaces a part of Schlick's Fresnel
  vec3 metalF0;
  vec3 layerF0;
  float metal;                // weights of the film over the metal and over the dielectric
  float layer;
  vec2 alpha;
  vec3 multiple;              // multiple scattering divided by multipleEval
  float multipleProbability;  // of sampling multiple scattering
  bool delta;
};

// Returns the reflectance of the film over metal and dielectric together.
vec3 specularFilm(SpecularLobe lobe, float cosine) {
  vec3 f = vec3(0.0);
  if (lobe.metal > 0.0) f += lobe.metal * filmReflectance(lobe.film, cosine, lobe.metalF0);
  if (lobe.layer > 0.0) f += lobe.layer * filmReflectance(lobe.film, cosine, lobe.layerF0);
  return f;
}

vec3 specularFresnel(SpecularLobe lobe, float cosine) {
  vec3 f = mix(lobe.f0, vec3(lobe.f90), schlickWeight(cosine));
  if (kHasIridescence && lobe.film.weight > 0.0) f = mix(f, specularFilm(lobe, cosine), lobe.film.weight);
  return f;
}

// `cosine`: of wo. `albedo`: estimate of the lobe's albedo, for the choice of a lobe.
SpecularLobe makeSpecular(BaseLayer base, float cosine, out float albedo) {
  SpecularLobe lobe;
  lobe.f0 = base.metallic * base.color + base.reflecting * base.colorF0;
  lobe.f90 = base.metallic + base.reflecting * base.specular;
  lobe.alpha = base.alpha;
  lobe.delta = base.delta;
  lobe.film = base.film;
  lobe.metalF0 = base.color;
  lobe.layerF0 = base.clearF0;
  lobe.metal = base.metallic;
  lobe.layer = base.reflecting * base.specular;
  vec3 multiple = base.lb.x * (base.metallic * base.metalMultiple + base.reflecting * base.colorMultiple);
  vec3 single = albedoSingle(lobe.f0, lobe.f90, base.lb.xy);
  if (kHasIridescence && base.film.weight > 0.0)
    single = mix(single, (1.0 - base.lb.x) * specularFilm(lobe, cosine), base.film.weight);
  lobe.multiple = multiple / base.average.x;
  lobe.multipleProbability = luminance(multiple) / max(luminance(single + multiple), 1e-20);
  albedo = base.underCoat * luminance(single + multiple);
  return lobe;
}

// `lb`: layerTerms at wi.
vec3 specularEval(SpecularLobe lobe, vec3 wo, vec3 wi, vec3 lb) {
  vec3 h = wo + wi;
  float h2 = dot(h, h);
  float d = ggxDistribution(h, lobe.alpha);
  vec3 single = ggxReflection(d, wo, wi, lobe.alpha) * specularFresnel(lobe, 0.5 * sqrt(h2));
  return wi.z > 0.0 ? single + lobe.multiple * multipleEval(wi, lb) : vec3(0.0);
}

// m: sampled by ggxSample with the bound ggxBound. uPart chooses between single and multiple scattering.
vec3 specularSample(SpecularLobe lobe, vec3 wo, vec3 m, float uPart, vec2 u) {
  return uPart < lobe.multipleProbability ? multipleSample(lobe.alpha, u) : reflect(-wo, m);
}

float specularPdf(SpecularLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + wi;
  float d = ggxDistribution(h, lobe.alpha);
  float single = ggxReflectionPdf(d, wo, lobe.alpha, ggxBound(wo, lobe.alpha));
  return wi.z > 0.0 ? mix(single, multiplePdf(wi, lobe.alpha), lobe.multipleProbability) : 0.0;
}

#endif
