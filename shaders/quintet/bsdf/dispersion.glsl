// SPDX-License-Identifier: Apache-2.0
// Dispersion: the index of refraction of a solid depends on the wavelength (KHR_materials_dispersion). The parameter is
// 20 / V with the Abbe number V = (n_d - 1) / (n_F - n_C). As the extension proposes for three color channels, the indices
// of red and blue are n_d - s and n_d + s with s = (n_d - 1) / (2 V); that of green is n_d.
//
// A path chooses one channel with probability 1/3. Until it is refracted, a dispersive surface has the index of this
// channel; reflected light keeps all channels, and the reflectance is thus the mean of the three. Transmitted light keeps
// only the chosen channel, times 3, which makes each channel unbiased (Wilkie et al. 2014, "Hero Wavelength Spectral
// Sampling", describe this as sampling a single wavelength). From then on, the path has one channel.
#ifndef QUINTET_BSDF_DISPERSION_GLSL
#define QUINTET_BSDF_DISPERSION_GLSL

#include "lobes.glsl"

// State of a path: the channel, 0 to 2, and this bit if all other channels are 0.
const uint kChannelOnly = 4u;

// Returns true if refraction depends on the channel. Thin walls do not refract.
bool isDispersive(BsdfParameters p) {
  return kHasDispersion && p.dispersion > 0.0 && !p.thin && p.transmission > 0.0 && p.ior > 0.0;
}

// Returns the index of refraction for a channel, at least 1.
float dispersedIor(float ior, float dispersion, uint channel) {
  return max(ior + (float(channel) - 1.0) * 0.025 * dispersion * (ior - 1.0), 1.0);
}

// Light that the surface transmits keeps only the path's channel.
void chooseChannel(inout BsdfParameters p, uint channel) {
  if ((channel & kChannelOnly) == 0u) p.transmitted = 3.0 * vec3(equal(uvec3(channel & 3u), uvec3(0u, 1u, 2u)));
}

// Gives a dispersive material the index for the path's channel.
void disperse(inout BsdfParameters p, uint channel) {
  if (!isDispersive(p)) return;
  p.ior = dispersedIor(p.ior, p.dispersion, channel & 3u);
  chooseChannel(p, channel);
}

// Returns the state of a path that a surface has transmitted.
uint channelBehind(BsdfParameters p, uint channel) { return isDispersive(p) ? channel | kChannelOnly : channel; }

#endif
