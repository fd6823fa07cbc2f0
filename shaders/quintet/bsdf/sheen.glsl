// SPDX-License-Identifier: Apache-2.0
// Sheen lobe: fibers over all lobes except the clearcoat (KHR_materials_sheen). f = color D V, with
// D = (2 + 1/alpha) sin(h)^(1/alpha) / (2 pi) and V = 1 / (4 cos_o cos_i (1 + Lambda(o) + Lambda(i))): the "Charlie"
// distribution of Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF", eq. 2 and 3, without Fresnel.
// Two changes keep the energy without a loss of reciprocity:
// - For alpha below 0.07, the albedo E of D V exceeds 1 at grazing angles. f is divided by max(1, E(o), E(i)). The albedo
//   that remains is called A.
// - The specular and transmission lobes are scaled by min(P(o), P(i)) with P = 1 - max(color) A, as the extension states.
//   The diffuse lobe is scaled by P(o) P(i) / N, where N makes its albedo P(o) times that without sheen. The minimum would
//   lose light there, because A is largest at grazing angles. Kelemen and Szirmay-Kalos 2001 couple layers in this way.
// Emission is not scaled. The sheen of a solid is on its outside only.
#ifndef QUINTET_BSDF_SHEEN_GLSL
#define QUINTET_BSDF_SHEEN_GLSL

#include "base.glsl"

const float kSheenCosine = 1e-4;  // D V is computed with cosines of at least this value, where V is not finite

struct SheenLobe {
  vec3 color;       // black if the side of wo has no sheen
  float alpha;      // at least kDeltaAlpha
  float strength;   // largest component of the material's color; scales A in P
  AlbedoCell row;   // of the sheen tables
  float lambda;     // Lambda(wo)
  float divisor;    // max(1, E(wo))
  float passed;     // P(wo)
  float diffuse;    // P(wo) / N
  bool nearSide;    // the side of wo has sheen
  bool farSide;     // the other side has sheen
};

// The fit of Estevez and Kulla 2017, table 1: log Lambda for a cosine up to 1/2. Interpolated by (1 - alpha)^2.
float sheenLogLambda(float cosine, float alpha) {
  float t = (1.0 - alpha) * (1.0 - alpha);
  float a = mix(21.5473, 25.3245, t), b = mix(3.82987, 3.32435, t), c = mix(0.19823, 0.16801, t);
  float d = mix(-1.97760, -1.27393, t), e = mix(-4.32054, -4.85967, t);
  return a / (1.0 + b * pow(cosine, c)) + d * cosine + e;
}

// `cosine`: at least kSheenCosine.
float sheenLambda(float cosine, float alpha) {
  bool low = cosine < 0.5;
  float fit = sheenLogLambda(low ? cosine : max(1.0 - cosine, 1e-6), alpha);
  return exp(low ? fit : 2.0 * sheenLogLambda(0.5, alpha) - fit);
}

// Returns P for a direction at `cosine` to the normal, on a side with sheen.
float sheenPassed(SheenLobe lobe, float cosine) {
  return 1.0 - lobe.strength * min(albedoSheen(lobe.row, cosine).y, 1.0);
}

// `alpha`: sheenRoughness squared. `base`: without underCoat. `albedo`: estimate of the lobe's albedo, for the choice of a
// lobe.
SheenLobe makeSheen(BaseLayer base, vec3 color, float alpha, float cosine, out float albedo) {
  SheenLobe lobe;
  lobe.nearSide = base.entering || !base.solid;
  lobe.farSide = !base.entering || !base.solid;
  lobe.color = lobe.nearSide ? color : vec3(0.0);
  lobe.alpha = max(alpha, kDeltaAlpha);
  lobe.strength = maxComponent(color);
  lobe.row = albedoRow(lobe.alpha, kSheenRoughnesses);
  vec2 sheen = albedoSheen(lobe.row, cosine);
  lobe.lambda = sheenLambda(max(cosine, kSheenCosine), lobe.alpha);
  lobe.divisor = max(sheen.x, 1.0);
  lobe.passed = lobe.nearSide ? 1.0 - lobe.strength * min(sheen.y, 1.0) : 1.0;
  vec3 averages = albedoSheenAverages(lobe.row, base.roughness.row);
  float covered = (dot(base.passing, averages) - base.average.z * averages.x) / max(layerPassed(base.passing, base.average), 1e-4);
  lobe.diffuse = lobe.nearSide ? lobe.passed / max(1.0 - lobe.strength * covered, 1e-4) : 1.0;
  albedo = luminance(lobe.color) * sheen.y;
  return lobe;
}

// Returns the factor of the specular and transmission lobes: min(P(wo), P(wi)).
float sheenScale(SheenLobe lobe, vec3 wi) {
  bool covered = wi.z > 0.0 ? lobe.nearSide : lobe.farSide;
  return min(lobe.passed, covered ? sheenPassed(lobe, abs(wi.z)) : 1.0);
}

// Returns the factor of the diffuse lobes: P(wo) P(wi) / N, or the P of the only side with sheen.
float sheenScaleDiffuse(SheenLobe lobe, vec3 wi) {
  bool covered = wi.z > 0.0 ? lobe.nearSide : lobe.farSide;
  return (lobe.nearSide && covered ? lobe.diffuse : lobe.passed) * (covered ? sheenPassed(lobe, abs(wi.z)) : 1.0);
}

vec3 sheenEval(SheenLobe lobe, vec3 wo, vec3 wi) {
  vec3 h = wo + wi;
  float sin2 = dot(h.xy, h.xy) / max(dot(h, h), 1e-20);
  float cosO = max(wo.z, kSheenCosine), cosI = max(wi.z, kSheenCosine);
  float d = (2.0 + 1.0 / lobe.alpha) * pow(sin2, 0.5 / lobe.alpha) / (2.0 * kPi);
  float v = 1.0 / (4.0 * cosO * cosI * (1.0 + lobe.lambda + sheenLambda(cosI, lobe.alpha)));
  float divisor = max(lobe.divisor, albedoSheen(lobe.row, abs(wi.z)).x);
  return wi.z > 0.0 ? lobe.color * (d * v * wi.z / divisor) : vec3(0.0);
}

// Uniform on the hemisphere: for a rough sheen, the relative variance of the weights is below 1.
vec3 sheenSample(vec2 u) {
  float r = sqrt(max(1.0 - u.x * u.x, 0.0));
  float phi = 2.0 * kPi * u.y;
  return vec3(r * cos(phi), r * sin(phi), u.x);
}

float sheenPdf(vec3 wi) { return wi.z > 0.0 ? 0.5 / kPi : 0.0; }

#endif
