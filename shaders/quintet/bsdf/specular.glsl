// Reflection by the opaque base: GGX with Schlick's Fresnel, metals and dielectrics in one lobe (both are
// linear in f0 and f90). Energy lost to multiple scattering is put back by scaling with a factor of wo
// (Turquin 2019, eq. 16), so f is not reciprocal where the factor is not 1.
#ifndef QUINTET_BSDF_SPECULAR_GLSL
#define QUINTET_BSDF_SPECULAR_GLSL

#include "fresnel.glsl"
#include "ggx.glsl"

struct SpecularLobe {
  vec3 f0;   // both times the compensation
  vec3 f90;
  float alpha;
};

vec3 specularFresnel(SpecularLobe lobe, float cosine) { return mix(lobe.f0, lobe.f90, schlickWeight(cosine)); }

vec3 specularEval(SpecularLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + wi;
  float h2 = dot(h, h);
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  float f = ggxReflection(d, wo.z, wi.z, lobe.alpha);
  return wi.z > 0.0 ? f * specularFresnel(lobe, 0.5 * sqrt(h2)) : vec3(0.0);
}

// m: drawn by ggxSample with the bound ggxBound.
vec3 specularSample(vec3 wo, vec3 m) { return reflect(-wo, m); }

float specularPdf(SpecularLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + wi;
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  return wi.z > 0.0 ? ggxReflectionPdf(d, wo.z, lobe.alpha, ggxBound(wo.z, lobe.alpha)) : 0.0;
}

#endif
