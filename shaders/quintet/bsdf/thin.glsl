// SPDX-License-Identifier: Apache-2.0
// Transmission through a thin wall, without refraction. It is the base's GGX reflection mirrored at the surface, times
// 1 - F per micronormal (KHR_materials_transmission, "Implementation notes": one interface). Multiple scattering that
// is not reflected is transmitted, so reflection and transmission of a white wall sum to 1. Both sides are the same
// medium, so radiance is not scaled. One of the two forms of the transmission lobe (transmission.glsl).
#ifndef QUINTET_BSDF_THIN_GLSL
#define QUINTET_BSDF_THIN_GLSL

#include "base.glsl"
#include "fresnel.glsl"
#include "multiple.glsl"

struct ThinLobe {
  vec3 color;                 // tint
  float f0;
  float f90;
  Film film;                  // replaces a part of Schlick's Fresnel
  vec3 filmF0;
  vec2 alpha;
  vec3 multiple;              // multiple scattering divided by multipleEval
  float multipleProbability;  // of sampling multiple scattering
};

ThinLobe makeThin(BaseLayer base) {
  vec3 color = base.clear * base.color;
  float through = base.lb.x * (1.0 - base.layerMultiple);
  return ThinLobe(color, base.f0, base.specular, base.film, base.clearF0, base.alpha, through / base.average.x * color,
                  min(through / max(base.passed, 1e-20), 1.0));
}

vec3 thinTransmittance(ThinLobe lobe, float cosine) {
  float f = mix(lobe.f0, lobe.f90, schlickWeight(cosine));
  if (kHasIridescence && lobe.film.weight > 0.0)
    f = mix(f, lobe.f90 * maxComponent(filmReflectance(lobe.film, cosine, lobe.filmF0)), lobe.film.weight);
  return lobe.color * max(1.0 - f, 0.0);
}

// `lb`: layerTerms at |wi.z|.
vec3 thinEval(ThinLobe lobe, vec3 wo, vec3 wi, vec3 lb) {
  vec3 mirrored = vec3(wi.xy, -wi.z);
  vec3 h = wo + mirrored;
  float d = ggxDistribution(h, lobe.alpha);
  vec3 single = ggxReflection(d, wo, mirrored, lobe.alpha) * thinTransmittance(lobe, 0.5 * length(h));
  return wi.z < 0.0 ? single + lobe.multiple * multipleEval(wi, lb) : vec3(0.0);
}

// m: sampled by ggxSample with the bound ggxBound. uPart chooses between single and multiple scattering.
vec3 thinSample(ThinLobe lobe, vec3 wo, vec3 m, float uPart, vec2 u) {
  vec3 r = uPart < lobe.multipleProbability ? multipleSample(lobe.alpha, u) : reflect(-wo, m);
  return vec3(r.xy, -r.z);
}

float thinPdf(ThinLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + vec3(wi.xy, -wi.z);
  float d = ggxDistribution(h, lobe.alpha);
  float single = ggxReflectionPdf(d, wo, lobe.alpha, ggxBound(wo, lobe.alpha));
  return wi.z < 0.0 ? mix(single, multiplePdf(wi, lobe.alpha), lobe.multipleProbability) : 0.0;
}

#endif
