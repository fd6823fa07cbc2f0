// SPDX-License-Identifier: Apache-2.0
// Reflectance of a thin film over the base (KHR_materials_iridescence). Light that the film's two interfaces reflect
// interferes. Belcour and Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence":
// Airy summation (eq. 3), integrated over the spectrum in the Fourier domain (eq. 5 to 10) with their Gaussian fits of the
// CIE color matching functions. As in the extension, both interfaces have Schlick's Fresnel, phases are 0 or pi, two orders
// are summed, and the result is converted to linear Rec. 709. Results are limited to [0,1]: a film reflects no more light
// than arrives.
#ifndef QUINTET_BSDF_FILM_GLSL
#define QUINTET_BSDF_FILM_GLSL

#include "../features.glsl"
#include "../frame.glsl"
#include "fresnel.glsl"

struct Film {
  float weight;     // of the film's reflectance; the rest has that of the base. 0 means no film
  float ior;        // at least 1; the outside has 1
  float thickness;  // nanometers
};

// Returns the Fourier transform of the sensitivities of red, green and blue at the optical path difference `opd`
// (nanometers), for interference whose phase is shifted by `shift`; at 0, it is 1. Three Gaussians and a second lobe of x.
vec3 filmSensitivity(float opd, vec3 shift) {
  const float k = 2.0 * kPi * 1e-9 * opd;  // phase per wave number (1/m)
  const vec3 height = vec3(5.4856e-13, 4.4201e-13, 5.2481e-13), center = vec3(1.6810e6, 1.7953e6, 2.2084e6);
  const vec3 variance = vec3(4.3278e9, 9.3046e9, 6.6121e9);
  vec3 xyz = height * sqrt(2.0 * kPi * variance) * cos(center * k + shift) * exp(-variance * k * k);
  xyz.x += 9.7470e-14 * sqrt(2.0 * kPi * 4.5282e9) * cos(2.2399e6 * k + shift.x) * exp(-4.5282e9 * k * k);
  xyz /= 1.0685e-7;
  return mat3(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.0415560, 1.0572252) * xyz;
}

// Returns the film with a weight that fades to 0 below 0.03 nm. (The extension fades the index, which leaves a reflectance
// at grazing angles.)
Film makeFilm(float weight, float ior, float thickness) {
  return Film(kHasIridescence ? weight * smoothstep(0.0, 0.03, thickness) : 0.0, ior, thickness);
}

// Returns the reflectance of the film over a base that reflects `baseF0` at normal incidence without it. `cosine`: of the
// angle outside the film.
vec3 filmReflectance(Film film, float cosine, vec3 baseF0) {
  float ior = film.ior;
  float inside = sqrt(max(1.0 - (1.0 - cosine * cosine) / (ior * ior), 0.0));
  float upper = mix(reflectanceFromIor(ior), 1.0, schlickWeight(cosine));
  float passing = 1.0 - upper;

  vec3 root = sqrt(clamp(baseF0, 0.0, 0.9999));
  vec3 baseIor = (1.0 + root) / (1.0 - root);
  vec3 ratio = (baseIor - ior) / (baseIor + ior);
  vec3 lower = mix(ratio * ratio, vec3(1.0), schlickWeight(inside));
  // Reflection at a denser medium shifts the phase by pi. The lower side of the upper interface does so, too: its
  // amplitude has the sign opposite to that of the upper side.
  vec3 shift = kPi * (1.0 + vec3(lessThan(baseIor, vec3(ior))));

  float opd = 2.0 * ior * film.thickness * inside;
  vec3 both = clamp(upper * lower, 1e-5, 0.9999);
  vec3 through = passing * passing * lower / (1.0 - both);  // all orders of reflection in the film, without interference
  vec3 amplitude = through - passing;
  vec3 sum = upper + through;
  for (float order = 1.0; order < 2.5; order += 1.0) {
    amplitude *= sqrt(both);
    sum += 2.0 * amplitude * filmSensitivity(order * opd, order * shift);
  }
  return clamp(sum, 0.0, 1.0);
}

#endif
