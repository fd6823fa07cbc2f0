// SPDX-License-Identifier: Apache-2.0
// How well a scene is lit without an environment.
#ifndef QUINTET_SCENE_DEFAULTS_OWN_LIGHT_H
#define QUINTET_SCENE_DEFAULTS_OWN_LIGHT_H

#include "scene/model/scene.h"

namespace quintet::scene {

enum class OwnLight {
  none,      // nothing emits light
  faint,     // emissive surfaces that leave most of the scene dark, such as the displays of a device
  emission,  // emissive surfaces that light most of the scene, such as the lamp of a room
  punctual,  // a punctual light; its author has lit the scene, even if it is a night scene
};

// The images of the scene may be without data. The result does not depend on the device.
//
// A punctual light counts if it shines at any time. Emissive solids (PrimitiveSet) count as `emission`, since only scenes
// that are written by hand have solids. Emissive triangles count by litShare(); emission with a texture is `faint`.
OwnLight ownLight(const Scene&);

// Radiance of a white diffuse surface from which it counts as lit; after tone mapping it is a quarter of white.
inline constexpr float kLitRadiance = 0.05f;
// Share of the surfaces from which a scene counts as lit.
inline constexpr double kLitShare = 0.5;

// Estimates the share of the area of all triangles that the emissive triangles light: their emission, or the radiance that a
// white diffuse surface gets from them directly, has at least the luminance kLitRadiance. Surfaces count on their front side,
// those of double-sided materials on a random side. Emission with a texture counts as 0. Materials that transmit light, or
// have alpha, cast no shadows. From 0 to 1, with a standard deviation of about 0.03; 0 if nothing emits.
double litShare(const Scene&);

}  // namespace quintet::scene
#endif
