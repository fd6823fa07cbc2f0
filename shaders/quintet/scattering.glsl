// SPDX-License-Identifier: Apache-2.0
// Homogeneous media that scatter (KHR_materials_volume_scatter): distances along a ray, and the phase function of Henyey and
// Greenstein 1941, "Diffuse radiation in the galaxy".
#ifndef QUINTET_SCATTERING_GLSL
#define QUINTET_SCATTERING_GLSL

#include "bsdf/local_frame.glsl"
#include "frame.glsl"
#include "sampling/warp.glsl"

// A path scatters at most this number of times its limit of bounces inside of solids.
const uint kScatteringsPerBounce = 64u;

// Transmittance of a medium without end, for light from infinity: exp(-absorption · ∞).
vec3 endlessTransmittance(vec3 absorption) { return vec3(lessThanEqual(absorption, vec3(0.0))); }

// What a ray meets in a medium.
struct MediumStep {
  float distance;  // meters, at which the ray scatters; below 0: it arrives at the end
  vec3 weight;     // of the throughput: transmittance, times the scattering coefficient, over the density of the event
};

// `attenuation`: absorption and scattering together, 1/m. `albedo`: the fraction of it that scatters. `throughput`: of the
// path; the channel that determines the distance is chosen in proportion to it, and the densities of all channels are
// combined (balance heuristic), so the weight is bounded. `end`: length of the ray; kInfinity if it leaves the scene.
MediumStep sampleMediumStep(vec3 attenuation, vec3 albedo, vec3 throughput, float end, vec2 u) {
  const vec3 probability = throughput / max(throughput.x + throughput.y + throughput.z, 1e-37);
  const float chosen = u.x < probability.x                   ? attenuation.x
                       : u.x < probability.x + probability.y ? attenuation.y
                                                             : attenuation.z;
  const float t = chosen > 0.0 ? -log(1.0 - min(u.y, 0.99999994)) / chosen : kInfinity;
  MediumStep s;
  if (t < end) {
    const vec3 density = attenuation * exp(-attenuation * t);
    s.distance = t;
    s.weight = albedo * density / max(dot(probability, density), 1e-37);
  } else {
    // exp(-0 · kInfinity) is NaN on NVIDIA GPUs.
    const vec3 transmittance = end < kInfinity ? exp(-attenuation * end) : endlessTransmittance(attenuation);
    s.distance = -1.0;
    s.weight = transmittance / max(dot(probability, transmittance), 1e-37);
  }
  return s;
}

// Density per solid angle. `cosine`: between the directions of travel before and after; g > 0 scatters forwards.
float phaseFunction(float cosine, float g) {
  const float d = max(1.0 + g * g - 2.0 * g * cosine, 1e-12);
  return (1.0 - g * g) / (4.0 * kPi * d * sqrt(d));
}

// Samples phaseFunction.
vec3 samplePhaseFunction(vec3 direction, float g, vec2 u) {
  const float s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u.x);
  const float cosine = abs(g) < 1e-3 ? 1.0 - 2.0 * u.x : clamp((1.0 + g * g - s * s) / (2.0 * g), -1.0, 1.0);
  const float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
  const float phi = 2.0 * kPi * u.y;
  return normalize(localFrame(direction) * vec3(sine * cos(phi), sine * sin(phi), cosine));
}

#endif
