// SPDX-License-Identifier: Apache-2.0
// Specular lobe: reflection by the base. GGX with Schlick's Fresnel, single and multiple scattering. Metals and
// dielectrics share the lobe, because both are linear in f0 and f90.
#ifndef QUINTET_BSDF_SPECULAR_GLSL
#define QUINTET_BSDF_SPECULAR_GLSL

#include "base.glsl"
#include "fresnel.glsl"
#include "ggx.glsl"
#include "multiple.glsl"

struct SpecularLobe {
  vec3 f0;
  float f90;
  float alpha;
  vec3 multiple;              // multiple scattering divided by multipleEval
  float multipleProbability;  // of sampling multiple scattering
  bool delta;
};

// `albedo`: estimate of the lobe's albedo, for the choice of a lobe.
SpecularLobe makeSpecular(BaseLayer base, out float albedo) {
  SpecularLobe lobe;
  lobe.f0 = base.metallic * base.color + base.reflecting * base.colorF0;
  lobe.f90 = base.metallic + base.reflecting * base.specular;
  lobe.alpha = base.alpha;
  lobe.delta = base.delta;
  vec3 multiple = base.lb.x * (base.metallic * multipleFactor(base.color, 1.0, base.average.x) + base.reflecting * base.colorMultiple);
  vec3 single = albedoSingle(lobe.f0, lobe.f90, base.lb);
  lobe.multiple = multiple / base.average.x;
  lobe.multipleProbability = luminance(multiple) / max(luminance(single + multiple), 1e-20);
  albedo = base.underCoat * luminance(single + multiple);
  return lobe;
}

vec3 specularFresnel(SpecularLobe lobe, float cosine) { return mix(lobe.f0, vec3(lobe.f90), schlickWeight(cosine)); }

// `lb`: the layer's albedoSchlick at wi.
vec3 specularEval(SpecularLobe lobe, vec3 wo, vec3 wi, vec2 lb) {
  vec3 h = wo + wi;
  float h2 = dot(h, h);
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  vec3 single = ggxReflection(d, wo.z, wi.z, lobe.alpha) * specularFresnel(lobe, 0.5 * sqrt(h2));
  return wi.z > 0.0 ? single + lobe.multiple * multipleEval(wi, lb) : vec3(0.0);
}

// m: sampled by ggxSample with the bound ggxBound. uPart chooses between single and multiple scattering.
vec3 specularSample(SpecularLobe lobe, vec3 wo, vec3 m, float uPart, vec2 u) {
  return uPart < lobe.multipleProbability ? multipleSample(lobe.alpha, u) : reflect(-wo, m);
}

float specularPdf(SpecularLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + wi;
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  float single = ggxReflectionPdf(d, wo.z, lobe.alpha, ggxBound(wo.z, lobe.alpha));
  return wi.z > 0.0 ? mix(single, multiplePdf(wi, lobe.alpha), lobe.multipleProbability) : 0.0;
}

#endif
