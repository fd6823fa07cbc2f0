// SPDX-License-Identifier: Apache-2.0
// The @WORDS@ lobe. Replace this example: Lambert's reflection, f = color / pi. Without color, the lobe reflects nothing.
//
// The contract of bsdf.glsl holds for each function. tests/gpu/bsdf/@NAME@_test.cpp tests them: the lobe reflects no more
// light than arrives, f is reciprocal, the pdf is the density of the samples, and it is positive where f is.
#ifndef QUINTET_BSDF_@UPPER@_GLSL
#define QUINTET_BSDF_@UPPER@_GLSL

#include "base.glsl"

// What eval, sample and pdf need, computed once for each wo.
struct @Name@Lobe {
  vec3 color;  // in [0,1]; black means that the lobe does not exist
};

// `albedo`: estimate of the lobe's albedo, for the choice of a lobe.
@Name@Lobe make@Name@(vec3 color, vec3 wo, out float albedo) {
  albedo = luminance(color);
  return @Name@Lobe(color);
}

// Returns f(wo, wi) |cos wi|.
vec3 @name@Eval(@Name@Lobe lobe, vec3 wo, vec3 wi) { return lobe.color * (max(wi.z, 0.0) / kPi); }

// Returns a unit vector wi with the density @name@Pdf. `u`: uniform in [0,1).
vec3 @name@Sample(@Name@Lobe lobe, vec3 wo, vec2 u) {
  float r = sqrt(u.y);  // not of u.x as in the diffuse lobe: mixing_test.cpp recognizes a lobe by the wi for a u
  float phi = 2.0 * kPi * u.x;
  return vec3(r * cos(phi), r * sin(phi), sqrt(max(1.0 - u.y, 0.0)));
}

// Returns the density of wi per solid angle.
float @name@Pdf(@Name@Lobe lobe, vec3 wo, vec3 wi) { return max(wi.z, 0.0) / kPi; }

#endif
