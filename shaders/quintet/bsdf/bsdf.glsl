// The BSDF of glTF 2.0's metallic-roughness material with KHR_materials_transmission, _volume, _ior, _specular
// and _clearcoat: a mixture of at most four lobes.
//
// Contract of this file and of every lobe beside it:
// - Directions are unit vectors in a local frame whose z is the shading normal on the side of wo: wo.z > 0.
//   Both point away from the surface; light comes from wi and leaves to wo.
// - eval returns f(wo, wi) |cos wi|; pdf is the density of wi per solid angle; sample takes numbers in [0,1).
// - f transports radiance: refraction into a solid scales by (index at wo / index at wi)^2.
// - Lobes narrower than kDeltaAlpha are deltas: they can be sampled only and are absent from eval and pdf.
// - ggx.glsl, sampled once here, hands its micronormal to the sample functions of the microfacet lobes. These
//   may return a direction on the wrong side of the surface, to be rejected.
// - Each lobe is written flat, without branches: the lobes' common terms are then computed once.
#ifndef QUINTET_BSDF_BSDF_GLSL
#define QUINTET_BSDF_BSDF_GLSL

#include "local_frame.glsl"
#include "mixture.glsl"

struct BsdfSample {
  vec3 wi;
  vec3 weight;       // f |cos wi| / pdf
  float pdf;         // of all lobes together; 0 for a delta
  bool delta;
  bool transmitted;  // wi is on the other side
  bool straight;     // wi = -wo: a pane, behind which the path goes on as if nothing but its weight had happened
};

// Is there anything but deltas, so that sampling lights makes sense?
bool bsdfHasSmooth(Bsdf b) {
  return dot(b.chance, vec4(!b.clearcoatDelta, !b.specularDelta, true, !b.transmissionDelta)) > 0.0;
}

vec3 bsdfEval(Bsdf b, vec3 wo, vec3 wi) {
  vec2 lb = albedoSchlick(b.row, abs(wi.z));
  vec3 transmission = vec3(0.0);
  if (kHasSolidTransmission) transmission = dielectricEval(b.dielectric, wo, wi);
  if (kHasThinTransmission) transmission = b.refractive ? transmission : thinEval(b.thin, wo, wi, lb);
  vec3 base = diffuseEval(b.diffuse, wi, lb);
  base += b.specularDelta ? vec3(0.0) : specularEval(b.specular, wo, wi, lb);
  if (kHasTransmission) base += b.transmissionDelta ? vec3(0.0) : transmission;
  if (!kHasClearcoat) return base;
  float coat = b.clearcoatDelta || b.clearcoat.weight == 0.0 ? 0.0 : clearcoatEval(b.clearcoat, wo, wi);
  return vec3(coat) + b.underCoat * base;
}

// The part of bsdfEval that the diffuse lobe gives.
vec3 bsdfEvalDiffuse(Bsdf b, vec3 wi) { return b.underCoat * diffuseEval(b.diffuse, wi, albedoSchlick(b.row, abs(wi.z))); }

float bsdfPdf(Bsdf b, vec3 wo, vec3 wi) {
  float coat = !kHasClearcoat || b.clearcoatDelta || b.clearcoat.weight == 0.0 ? 0.0 : clearcoatPdf(b.clearcoat, wo, wi);
  float specular = b.specularDelta ? 0.0 : specularPdf(b.specular, wo, wi);
  float transmission = 0.0;
  if (kHasSolidTransmission) transmission = dielectricPdf(b.dielectric, wo, wi);
  if (kHasThinTransmission) transmission = b.refractive ? transmission : thinPdf(b.thin, wo, wi);
  float density = dot(b.chance, vec4(coat, specular, diffusePdf(wi), b.transmissionDelta ? 0.0 : transmission));
  // Half vectors of no length (wi = -wo) give what a device likes: no density there.
  return density > 0.0 && density < 1e30 ? density : 0.0;
}

// What a pane, a smooth thin wall, lets straight through: the weight of that event without its chance. 0 for all other
// surfaces. Shadow rays multiply the light by the same number.
vec3 bsdfStraight(Bsdf b, float cosine) {
  return kHasPanes && !b.refractive && b.transmissionDelta ? b.underCoat * thinTransmittance(b.thin, cosine) : vec3(0.0);
}

// The weight of a delta at its direction: b.chance goes in at the caller.
vec3 bsdfDeltaWeight(Bsdf b, int lobe, float cosine, bool transmitted) {
  if (kHasClearcoat && lobe == 0) return vec3(clearcoatFresnel(b.clearcoat, cosine));
  if (!kHasTransmission || lobe == 1) return b.underCoat * specularFresnel(b.specular, cosine);
  if (!kHasSolidTransmission || !b.refractive) return bsdfStraight(b, cosine);
  DielectricSplit split = dielectricSplit(b.dielectric, cosine);
  return b.underCoat * (transmitted ? split.transmittance / (b.dielectric.eta * b.dielectric.eta * (1.0 - split.reflectChance))
                                    : split.reflectance / split.reflectChance);
}

// The direction of a sample, and all of it for a delta; for the rest bsdfFinish gives weight and pdf. In two
// steps so that a program can evaluate this direction and a light's by one loop: compilers that inline
// the evaluation then see it once. False if the direction is worth nothing.
bool bsdfSampleDirection(Bsdf b, vec3 wo, float uLobe, vec2 u, out BsdfSample s) {
  vec3 edge = vec3(b.chance.x, b.chance.x + b.chance.y, b.chance.x + b.chance.y + b.chance.z);
  int lobe = kHasClearcoat && uLobe < edge.x ? 0 : uLobe < edge.y ? 1 : !kHasTransmission || uLobe < edge.z || b.chance.w == 0.0 ? 2 : 3;
  bool coat = kHasClearcoat && lobe == 0;
  bool transmits = kHasTransmission && lobe == 3;
  s.delta = lobe == 0 ? b.clearcoatDelta : lobe == 1 ? b.specularDelta : lobe == 3 && b.transmissionDelta;

  vec3 normal = coat ? b.clearcoat.normal : vec3(0.0, 0.0, 1.0);
  mat3 basis = kHasClearcoat ? localFrame(normal) : mat3(1.0);
  vec3 o = wo * basis;
  float alpha = coat ? b.clearcoat.alpha : b.specular.alpha;
  float bound = transmits && b.refractive ? 1.0 : ggxBound(o.z, alpha);
  vec3 m = s.delta ? normal : basis * ggxSample(o, alpha, bound, u);

  // Where in the lobe's share uLobe is: chooses within the lobe.
  float uPart = lobe == 3 ? (uLobe - edge.z) / b.chance.w : (uLobe - edge.x) / b.chance.y;
  if (transmits) s.wi = b.refractive ? dielectricSample(b.dielectric, wo, m, uPart) : thinSample(b.thin, wo, m, uPart, u);
  else if (coat) s.wi = clearcoatSample(b.clearcoat, wo, m);
  else s.wi = lobe == 2 ? diffuseSample(u) : specularSample(b.specular, wo, m, uPart, u);
  s.transmitted = transmits && (!b.refractive || dot(s.wi, m) < 0.0);
  s.straight = kHasPanes && transmits && !b.refractive && s.delta;
  s.pdf = 0.0;
  s.weight = s.delta ? bsdfDeltaWeight(b, lobe, dot(wo, m), s.transmitted) / b.chance[lobe] : vec3(0.0);
  // A microfacet may reflect below the surface (or the coat's), or refract above it.
  return s.transmitted ? s.wi.z < 0.0 : min(s.wi.z, dot(s.wi, normal)) > 0.0;
}

// Completes a sample that is no delta with f |cos wi| and the density of its direction.
void bsdfFinish(inout BsdfSample s, vec3 f, float density) {
  s.pdf = density;
  s.weight = f / density;
}

// Worth following: not zero, no NaN.
bool bsdfUseful(BsdfSample s) {
  float size = s.weight.x + s.weight.y + s.weight.z;
  return size > 0.0 && size < 1e30;
}

// One sample of the mixture; false if it is worth nothing.
bool bsdfSample(Bsdf b, vec3 wo, float uLobe, vec2 u, out BsdfSample s) {
  if (!bsdfSampleDirection(b, wo, uLobe, u, s)) return false;
  if (!s.delta) bsdfFinish(s, bsdfEval(b, wo, s.wi), bsdfPdf(b, wo, s.wi));
  return bsdfUseful(s);
}

#endif
