// SPDX-License-Identifier: Apache-2.0
// The isotropic GGX (Trowbridge-Reitz) microfacet distribution with Smith's shadowing, and sampling of its visible normals.
// Half vectors may have any length, and no tangent is computed from a cosine. So the functions are precise down to
// alpha = 1e-4.
#ifndef QUINTET_BSDF_GGX_GLSL
#define QUINTET_BSDF_GGX_GLSL

#include "../frame.glsl"

// Lobes of smaller width are deltas: perfect mirrors or smooth glass. The roughness is 0.022.
const float kDeltaAlpha = 5e-4;

// Returns D of the direction with squared cosine cos2 and squared sine sin2, up to a common factor of both.
// Walter et al. 2007, eq. 33, multiplied out.
float ggxDistribution(float cos2, float sin2, float alpha) {
  float a2 = alpha * alpha;
  float q = (a2 * cos2 + sin2) / (cos2 + sin2);
  return a2 / (kPi * q * q);
}

// Returns cos theta (1 + 2 Lambda), the length of the direction in the space where the surface has alpha 1.
float ggxStretch(float cosine, float alpha) {
  float cos2 = cosine * cosine;
  return sqrt(cos2 + alpha * alpha * max(1.0 - cos2, 0.0));
}

// Smith's masking. Heitz 2014, "Understanding the Masking-Shadowing Function", eq. 43 and 72.
float ggxMasking(float cosine, float alpha) { return 2.0 * cosine / (cosine + ggxStretch(cosine, alpha)); }

// Returns D G2 / (4 cos_o) with height-correlated masking and shadowing (Heitz 2014, eq. 99): reflection without Fresnel,
// times cos_i. `d` is D of the half vector; both cosines are positive.
float ggxReflection(float d, float cosO, float cosI, float alpha) {
  return 0.5 * d * cosI / (cosO * ggxStretch(cosI, alpha) + cosI * ggxStretch(cosO, alpha));
}

// Returns the factor that reduces the spherical cap of visible normals, so that few reflections go below the surface.
// Eto and Tokuyoshi 2023, "Bounded VNDF Sampling for Smith-GGX Reflections", eq. 5 and 6. 1 means the whole cap.
float ggxBound(float cosO, float alpha) {
  float a2 = min(alpha * alpha, 1.0);
  float s = 1.0 + sqrt(max(1.0 - cosO * cosO, 0.0));
  float s2 = s * s;
  return (1.0 - a2) * s2 / (s2 + a2 * cosO * cosO);
}

// Returns the density per solid angle of wi = reflect(-wo, m) with m from ggxSample; eq. 8 of the same paper.
float ggxReflectionPdf(float d, float cosO, float alpha, float bound) {
  return 0.5 * d / (bound * cosO + ggxStretch(cosO, alpha));
}

// Samples a normal that is visible from wo (wo.z > 0). Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical
// Caps", listing 3, with the cap bounded as above. With bound 1 the density over m is D G1(wo) (wo.m) / wo.z, which is
// 4 (wo.m) ggxReflectionPdf (Heitz 2018, "Sampling the GGX Distribution of Visible Normals"). `alpha`: widths along x and y.
vec3 ggxSampleVisible(vec3 wo, vec2 alpha, float bound, vec2 u) {
  vec3 o = normalize(vec3(alpha * wo.xy, wo.z));
  float b = bound * o.z;
  float z = (1.0 - u.x) * (1.0 + b) - b;
  float r = sqrt(max(1.0 - z * z, 0.0));
  float phi = 2.0 * kPi * u.y;
  vec3 m = o + vec3(r * cos(phi), r * sin(phi), z);
  return normalize(vec3(alpha * m.xy, max(m.z, 1e-6)));
}
vec3 ggxSample(vec3 wo, float alpha, float bound, vec2 u) { return ggxSampleVisible(wo, vec2(alpha), bound, u); }

#endif
