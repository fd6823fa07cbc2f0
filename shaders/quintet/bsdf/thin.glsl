// Transmission through a thin wall: straight on, roughened like the reflection. The lobe is the base's GGX
// reflection mirrored at the surface, times 1 - F per micronormal (KHR_materials_transmission, "Implementation
// notes": one interface). Scaled so that reflection and transmission of a white wall sum to 1 (as Turquin
// 2019); therefore not reciprocal. No radiance scaling: both sides are the same medium.
#ifndef QUINTET_BSDF_THIN_GLSL
#define QUINTET_BSDF_THIN_GLSL

#include "albedo.glsl"
#include "specular.glsl"

struct ThinLobe {
  vec3 color;  // tint times compensation
  float f0;
  float f90;
  float alpha;
};

// `ab`: the layer's albedoSchlick at wo.
ThinLobe makeThin(vec3 color, float f0, float f90, float alpha, vec2 ab) {
  float passed = 1.0 - albedoCompensated(f0, f90, ab);
  float single = (1.0 - f0) * ab.x + (1.0 - f90) * ab.y;
  return ThinLobe(color * clamp(passed / max(single, 1e-4), 0.0, 4.0), f0, f90, alpha);
}

vec3 thinTransmittance(ThinLobe lobe, float cosine) {
  return lobe.color * (1.0 - mix(lobe.f0, lobe.f90, schlickWeight(cosine)));
}

vec3 thinEval(ThinLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + vec3(wi.xy, -wi.z);
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  float f = ggxReflection(d, wo.z, -wi.z, lobe.alpha);
  return wi.z < 0.0 ? f * thinTransmittance(lobe, 0.5 * length(h)) : vec3(0.0);
}

// m: drawn by ggxSample with the bound ggxBound.
vec3 thinSample(vec3 wo, vec3 m) {
  vec3 r = reflect(-wo, m);
  return vec3(r.xy, -r.z);
}

float thinPdf(ThinLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + vec3(wi.xy, -wi.z);
  float d = ggxDistribution(h.z * h.z, dot(h.xy, h.xy), lobe.alpha);
  return wi.z < 0.0 ? ggxReflectionPdf(d, wo.z, lobe.alpha, ggxBound(wo.z, lobe.alpha)) : 0.0;
}

#endif
