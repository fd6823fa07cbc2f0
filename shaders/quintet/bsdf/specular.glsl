// Reflection by the opaque base: GGX with Schlick's Fresnel, metals and dielectrics in one lobe (both are
// linear in f0 and f90), and what multiple scattering adds.
#ifndef QUINTET_BSDF_SPECULAR_GLSL
#define QUINTET_BSDF_SPECULAR_GLSL

#include "fresnel.glsl"
#include "ggx.glsl"
#include "multiple.glsl"

struct SpecularLobe {
  vec3 f0;
  float f90;
  float alpha;
  vec3 multiple;         // all of multiple scattering but multipleEval
  float multipleChance;  // of sampling it
};

vec3 specularFresnel(SpecularLobe lobe, float cosine) { return mix(lobe.f0, vec3(lobe.f90), schlickWeight(cosine)); }

// `lb`: the layer's albedoSchlick at wi.
vec3 specularEval(SpecularLobe lobe, vec3 wo, vec3 wi, vec2 lb) {
  vec3 h = wo + wi;
  float h2 = dot(h, h);
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  vec3 single = ggxReflection(d, wo.z, wi.z, lobe.alpha) * specularFresnel(lobe, 0.5 * sqrt(h2));
  return wi.z > 0.0 ? single + lobe.multiple * multipleEval(wi, lb) : vec3(0.0);
}

// m: drawn by ggxSample with the bound ggxBound; uPart chooses between single and multiple scattering.
vec3 specularSample(SpecularLobe lobe, vec3 wo, vec3 m, float uPart, vec2 u) {
  return uPart < lobe.multipleChance ? multipleSample(lobe.alpha, u) : reflect(-wo, m);
}

float specularPdf(SpecularLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + wi;
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  float single = ggxReflectionPdf(d, wo.z, lobe.alpha, ggxBound(wo.z, lobe.alpha));
  return wi.z > 0.0 ? mix(single, multiplePdf(wi, lobe.alpha), lobe.multipleChance) : 0.0;
}

#endif
