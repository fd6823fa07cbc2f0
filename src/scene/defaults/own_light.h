// SPDX-License-Identifier: Apache-2.0
// How well a scene is lit without an environment.
#ifndef QUINTET_SCENE_DEFAULTS_OWN_LIGHT_H
#define QUINTET_SCENE_DEFAULTS_OWN_LIGHT_H

#include "scene/model/scene.h"

namespace quintet::scene {

enum class OwnLight {
  none,      // nothing emits light
  faint,     // lights that leave most of the scene dark, such as the displays of a device, or a lamp over a mirror
  emission,  // emissive surfaces that light most of the scene, such as the lamp of a room
  punctual,  // punctual lights that light a part of it, such as a street lamp at night
};

// The images of the scene may be without data. The result does not depend on the device.
//
// Emissive solids (PrimitiveSet) count as `emission`, since only scenes that are written by hand have solids. Punctual lights and
// emissive triangles count by litShare(); emission with a texture is `faint`.
OwnLight ownLight(const Scene&);

// Radiance from which a surface counts as lit; after tone mapping it is a quarter of white.
inline constexpr float kLitRadiance = 0.05f;
// Share of the surfaces from which emissive triangles light a scene.
inline constexpr double kLitShare = 0.5;
// The same for punctual lights. It is smaller, because a file has them for their light only, and the sun does not reach
// the half of the surfaces that faces away from it.
inline constexpr double kPunctualShare = 0.2;

// Estimates the share of the area of all triangles that the scene's lights light: the emission of a surface, or the radiance that it
// gets from them directly, has at least the luminance kLitRadiance. Surfaces count on their front side, those of
// double-sided materials on a random side. Emission with a texture counts as 0. Materials that transmit light, or have alpha, cast no
// shadows. From 0 to 1, with a standard deviation of about 0.03; 0 if nothing emits.
//
// Emissive triangles light each surface as a white diffuse one, since mirrors show them, too. Punctual lights light it by its base color;
// smooth metals and clear surfaces show nothing of them. Textures of these values count as white dielectrics.
// Animated lights count with their largest intensity, at their place in frame 0.
double litShare(const Scene&);

}  // namespace quintet::scene
#endif
